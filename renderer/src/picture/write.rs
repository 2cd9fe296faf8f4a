//! Pictures to files.

use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};
use std::{env, fs};

use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, WritableImage,
};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::Error;
use crate::picture::{Display, Picture, Values};

/// A kind of picture file, chosen by the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits, lossless.
    Png,
    /// 8 bits, small.
    Jpeg,
    /// Floats, ZIP-compressed.
    Exr,
    /// Floats, as they are in memory.
    Pfm,
}

impl Format {
    /// The format of a file of that name.
    ///
    /// # Errors
    ///
    /// If the ending is none of png, jpg, jpeg, exr, pfm.
    pub fn of(path: &Path) -> Result<Format, Error> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "png" => Ok(Format::Png),
            "jpg" | "jpeg" => Ok(Format::Jpeg),
            "exr" => Ok(Format::Exr),
            "pfm" => Ok(Format::Pfm),
            _ => {
                let path = path.display();
                Err(Error::new(format_args!(
                    "{path}: the name must end in .png, .jpg, .exr or .pfm"
                )))
            }
        }
    }

    /// Whether the format holds floats.
    #[must_use]
    pub fn is_float(self) -> bool {
        matches!(self, Format::Exr | Format::Pfm)
    }
}

impl Picture {
    /// The contents of a file in that format.
    ///
    /// # Errors
    ///
    /// If the picture is larger than the format can be.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>, String> {
        let mut file = Cursor::new(Vec::new());
        match format {
            Format::Png | Format::Jpeg => {
                let (bytes, channels) = self.to_bytes();
                let color =
                    if channels == 1 { ExtendedColorType::L8 } else { ExtendedColorType::Rgb8 };
                let done = if format == Format::Png {
                    let png = PngEncoder::new(&mut file);
                    png.write_image(&bytes, self.width, self.height, color)
                } else {
                    let jpeg = JpegEncoder::new_with_quality(&mut file, 92);
                    jpeg.write_image(&bytes, self.width, self.height, color)
                };
                done.map_err(|error| error.to_string())?;
            }
            Format::Exr => self.encode_exr(&mut file).map_err(|error| error.to_string())?,
            Format::Pfm => return Ok(self.encode_pfm()),
        }
        Ok(file.into_inner())
    }

    fn encode_exr(&self, file: &mut Cursor<Vec<u8>>) -> Result<(), exr::error::Error> {
        let values = self.to_floats();
        let names: &[&str] = if self.channels == 1 { &["Y"] } else { &["R", "G", "B"] };
        let channel = |(index, name): (usize, &&str)| {
            let samples = values.iter().skip(index).step_by(self.channels).copied().collect();
            AnyChannel::new(*name, FlatSamples::F32(samples))
        };
        let channels = AnyChannels::sort(names.iter().enumerate().map(channel).collect());
        let encoding = Encoding {
            compression: Compression::ZIP16,
            line_order: LineOrder::Increasing,
            ..Encoding::default()
        };
        let size = (self.width as usize, self.height as usize);
        let layer = Layer::new(size, LayerAttributes::default(), encoding, channels);
        // On one thread, so that the blocks come in one order.
        Image::from_layer(layer).write().non_parallel().to_buffered(file)
    }

    fn encode_pfm(&self) -> Vec<u8> {
        let kind = if self.channels == 1 { "Pf" } else { "PF" };
        let mut file = format!("{kind}\n{} {}\n-1.0\n", self.width, self.height).into_bytes();
        let values = self.to_floats();
        // The bottom row comes first, little-endian by the sign of the scale.
        for row in values.chunks_exact(self.width as usize * self.channels).rev() {
            file.extend(row.iter().flat_map(|value| value.to_le_bytes()));
        }
        file
    }
}

/// Writes a file whole or not at all: beside its place first, then moved there. What is no regular
/// file, such as a pipe, is written to directly.
///
/// # Errors
///
/// If the file cannot be made; whatever was at `path` is then as it was.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), Error> {
    let failed = |error: io::Error| Error::new(format_args!("{}: {error}", path.display()));
    if let Ok(place) = fs::metadata(path)
        && !place.is_file()
    {
        if place.is_dir() {
            return Err(Error::new(format_args!("{}: it is a folder", path.display())));
        }
        let mut file = fs::OpenOptions::new().write(true).open(path).map_err(failed)?;
        return file.write_all(contents).map_err(failed);
    }
    // A link keeps pointing to the file.
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.map_or_else(|| PathBuf::from("."), Path::to_owned);
    write_beside(&folder, &place, contents).map_err(failed)
}

/// Writes a file in `folder`, then moves it to `place`.
fn write_beside(folder: &Path, place: &Path, contents: &[u8]) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".penumbra-");
    #[cfg(target_os = "linux")]
    if let Some(mut file) = nameless(folder) {
        file.write_all(contents)?;
        // Only what is whole gets a name, so that a killed run leaves nothing behind: the right one
        // at once if it is free, else one for the moment until it takes the old file's.
        if name(&file, place).is_ok() {
            return Ok(());
        }
        let named = builder.make_in(folder, |draft| name(&file, draft))?;
        return named.persist(place).map(drop).map_err(|error| error.error);
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As for any new file: the process's mask takes away from this.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut draft = builder.tempfile_in(folder)?;
    draft.write_all(contents)?;
    draft.persist(place).map(drop).map_err(|error| error.error)
}

/// A file that has no name yet, where the file system knows such.
#[cfg(target_os = "linux")]
fn nameless(folder: &Path) -> Option<fs::File> {
    use rustix::fs::{Mode, OFlags, open};
    let flags = OFlags::WRONLY | OFlags::TMPFILE | OFlags::CLOEXEC;
    open(folder, flags, Mode::from_raw_mode(0o666)).ok().map(fs::File::from)
}

/// Gives a file a name, which must be free.
#[cfg(target_os = "linux")]
fn name(file: &fs::File, path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    use std::os::fd::AsRawFd;
    let file = format!("/proc/self/fd/{}", file.as_raw_fd());
    Ok(linkat(CWD, file, CWD, path, AtFlags::SYMLINK_FOLLOW)?)
}

/// Checks early, before the work, that a file could be written at `path`.
///
/// # Errors
///
/// If its folder does not exist or `path` is a folder.
pub fn check_place(path: &Path) -> Result<(), Error> {
    if path.is_dir() {
        return Err(Error::new(format_args!("{}: it is a folder", path.display())));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.map_or_else(|| env::current_dir().unwrap_or_default(), Path::to_owned);
    if folder.is_dir() {
        Ok(())
    } else {
        let folder = folder.display();
        Err(Error::new(format_args!("{}: there is no folder {folder}", path.display())))
    }
}

/// [`check_place`] for a result and its statistics, which must not take the same place.
///
/// # Errors
///
/// If one of them could not be written, or one would replace the other.
pub fn check_places(output: &Path, stats: Option<&Path>) -> Result<(), Error> {
    check_place(output)?;
    let Some(stats) = stats else { return Ok(()) };
    check_place(stats)?;
    let whole = |path: &Path| fs::canonicalize(path).or_else(|_| std::path::absolute(path)).ok();
    if whole(output).is_some_and(|output| whole(stats) == Some(output)) {
        let stats = stats.display();
        return Err(Error::new(format_args!("--stats {stats}: the output goes there")));
    }
    Ok(())
}

/// A picture of floats, shown as `display` says.
#[must_use]
pub fn floats(
    [width, height]: [u32; 2],
    channels: usize,
    values: Vec<f32>,
    display: Display,
) -> Picture {
    Picture { width, height, channels, values: Values::Floats(values, display) }
}
