//! Depth and ID buffers from files.

use std::path::Path;

use glam::Vec3;

use crate::Error;
use crate::picture::{self, Format};

/// The longest side of a buffer.
const MAX_SIDE: u64 = 16_384;

/// The longest header of an .npy file that describes a plain array.
const MAX_NPY_HEADER: usize = 4_096;

/// Numbers per pixel, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Buffer {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Numbers per pixel.
    channels: usize,
    numbers: Numbers,
    /// What stands for 1 in a picture of whole numbers.
    full_scale: f32,
}

/// The numbers of a file, whole numbers kept whole: object IDs need all their bits.
#[derive(Clone, Debug, PartialEq)]
enum Numbers {
    Floats(Vec<f32>),
    Whole(Vec<u32>),
}

/// The kinds of files that hold a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// NumPy's: any plain number type, shape (height, width, channels); one channel may be left
    /// out.
    Npy,
    /// Grey of 8 or 16 bits.
    Png,
    /// Floats in a picture.
    Picture(Format),
}

impl Kind {
    /// By the ending of the file's name; `None` for all but .npy, .pfm, .exr and .png.
    #[must_use]
    pub fn of(path: &Path) -> Option<Kind> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "npy" => Some(Kind::Npy),
            "png" => Some(Kind::Png),
            "pfm" => Some(Kind::Picture(Format::Pfm)),
            "exr" => Some(Kind::Picture(Format::Exr)),
            _ => None,
        }
    }
}

impl Buffer {
    /// Reads a file of a [`Kind`] that its name tells, with that many channels.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, is of no such kind, has another number of channels or needs more
    /// than `max_memory` bytes; the message names it.
    pub fn read(path: &Path, channels: usize, max_memory: u64) -> Result<Buffer, Error> {
        let wrong = |why: String| Error::new(format_args!("{}: {why}", path.display()));
        let Some(kind) = Kind::of(path) else {
            return Err(wrong("a buffer must end in .npy, .pfm, .exr or .png".into()));
        };
        let bytes = picture::read_bytes(path, max_memory)?;
        Buffer::decode(kind, &bytes, channels, max_memory).map_err(wrong)
    }

    /// The buffer in the bytes of a file, as [`Buffer::read`].
    ///
    /// # Errors
    ///
    /// If they are no file of that kind, have another number of channels, or need more than
    /// `max_memory` bytes.
    pub fn decode(
        kind: Kind,
        bytes: &[u8],
        channels: usize,
        max_memory: u64,
    ) -> Result<Buffer, String> {
        let buffer = match kind {
            Kind::Npy => decode_npy(bytes)?,
            Kind::Png => decode_png(bytes, max_memory)?,
            Kind::Picture(format) => {
                let picture = picture::decode(format, bytes, max_memory)?;
                let (width, height) = sides(picture.width.into(), picture.height.into())?;
                let numbers = Numbers::Floats(picture.to_floats());
                Buffer { width, height, channels: picture.channels, numbers, full_scale: 1.0 }
            }
        };
        if buffer.channels != channels {
            let found = buffer.channels;
            return Err(format!("it has {found} numbers per pixel, not {channels}"));
        }
        Ok(buffer)
    }

    /// Turns the buffer upside down: files whose first row is the bottom one.
    pub fn flip(&mut self) {
        let row = self.width as usize * self.channels;
        match &mut self.numbers {
            Numbers::Floats(values) => flip_rows(values, row),
            Numbers::Whole(values) => flip_rows(values, row),
        }
    }

    /// The numbers as floats; those of a .png are divided by their greatest.
    #[must_use]
    pub fn into_floats(self) -> Vec<f32> {
        match self.numbers {
            Numbers::Floats(values) => values,
            Numbers::Whole(values) => {
                values.into_iter().map(|value| value as f32 / self.full_scale).collect()
            }
        }
    }

    /// The numbers as vectors, three each.
    #[must_use]
    pub fn into_vectors(self) -> Vec<Vec3> {
        let values = self.into_floats();
        values.as_chunks::<3>().0.iter().copied().map(Vec3::from_array).collect()
    }

    /// The numbers as object IDs; what is negative or no number is 0.
    #[must_use]
    pub fn into_ids(self) -> Vec<u32> {
        match self.numbers {
            Numbers::Floats(values) => values.into_iter().map(|value| value as u32).collect(),
            Numbers::Whole(values) => values,
        }
    }
}

fn flip_rows<T>(values: &mut [T], row: usize) {
    let rows = values.len() / row;
    for y in 0..rows / 2 {
        let (top, bottom) = values.split_at_mut((rows - 1 - y) * row);
        top[y * row..][..row].swap_with_slice(&mut bottom[..row]);
    }
}

fn sides(width: u64, height: u64) -> Result<(u32, u32), String> {
    if (1..=MAX_SIDE).contains(&width) && (1..=MAX_SIDE).contains(&height) {
        Ok((width as u32, height as u32))
    } else {
        Err(format!("{width} x {height} pixels: a side must be from 1 to {MAX_SIDE}"))
    }
}

fn decode_png(bytes: &[u8], max_memory: u64) -> Result<Buffer, String> {
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes));
    reader.set_format(image::ImageFormat::Png);
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(max_memory);
    (limits.max_image_width, limits.max_image_height) =
        (Some(MAX_SIDE as u32), Some(MAX_SIDE as u32));
    reader.limits(limits);
    let image = reader.decode().map_err(|error| error.to_string())?;
    let (width, height) = (image.width(), image.height());
    let (values, full_scale): (Vec<u32>, f32) = match image {
        image::DynamicImage::ImageLuma8(grey) => {
            (grey.into_raw().into_iter().map(u32::from).collect(), 255.0)
        }
        image::DynamicImage::ImageLuma16(grey) => {
            (grey.into_raw().into_iter().map(u32::from).collect(), 65_535.0)
        }
        other => return Err(format!("it holds {:?}, not one grey channel", other.color())),
    };
    Ok(Buffer { width, height, channels: 1, numbers: Numbers::Whole(values), full_scale })
}

fn decode_npy(bytes: &[u8]) -> Result<Buffer, String> {
    // The length of the header stands in two bytes (version 1) or four.
    let length = match bytes {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _, a, b, ..] => {
            usize::from(u16::from_le_bytes([*a, *b]))
        }
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _, a, b, c, d, ..] => {
            u32::from_le_bytes([*a, *b, *c, *d]) as usize
        }
        _ => return Err("it is no .npy file".into()),
    };
    if length > MAX_NPY_HEADER {
        return Err(format!("its header has {length} bytes, more than {MAX_NPY_HEADER}"));
    }
    let mut rest = bytes;
    let header = npyz::NpyHeader::from_reader(&mut rest).map_err(|error| error.to_string())?;
    let (width, height, channels) = match *header.shape() {
        [height, width] => (width, height, 1),
        [height, width, channels @ 1..=4] => (width, height, channels as usize),
        ref shape => return Err(format!("its shape is {shape:?}, not (height, width)")),
    };
    let (width, height) = sides(width, height)?;
    if header.order() != npyz::Order::C {
        return Err("it is in Fortran order: save numpy.ascontiguousarray of it".into());
    }
    let npyz::DType::Plain(kind) = header.dtype() else {
        return Err("it holds records, not numbers".into());
    };
    let kind = kind.to_string();
    let kind = kind.trim_matches('\'');
    let numbers = decode(kind, rest).ok_or_else(|| format!("it holds numbers of type {kind}"))?;
    let found = match &numbers {
        Numbers::Floats(values) => values.len(),
        Numbers::Whole(values) => values.len(),
    };
    let needed = width as usize * height as usize * channels;
    if found != needed {
        return Err(format!("{width} x {height} needs {needed} numbers, there are {found}"));
    }
    Ok(Buffer { width, height, channels, numbers, full_scale: 1.0 })
}

/// Numbers of a NumPy type such as `<f4`, `None` for a type that is none of ours.
fn decode(kind: &str, bytes: &[u8]) -> Option<Numbers> {
    fn each<const N: usize, T>(bytes: &[u8], decode: impl Fn([u8; N]) -> T) -> Vec<T> {
        bytes.as_chunks::<N>().0.iter().map(|&chunk| decode(chunk)).collect()
    }
    let whole = |value: i64| u32::try_from(value).unwrap_or(0);
    Some(match kind {
        "<f4" => Numbers::Floats(each(bytes, f32::from_le_bytes)),
        ">f4" => Numbers::Floats(each(bytes, f32::from_be_bytes)),
        "<f8" => Numbers::Floats(each(bytes, |b| f64::from_le_bytes(b) as f32)),
        ">f8" => Numbers::Floats(each(bytes, |b| f64::from_be_bytes(b) as f32)),
        "|u1" | "|b1" => Numbers::Whole(each(bytes, |[b]: [u8; 1]| u32::from(b))),
        "<u2" => Numbers::Whole(each(bytes, |b| u32::from(u16::from_le_bytes(b)))),
        ">u2" => Numbers::Whole(each(bytes, |b| u32::from(u16::from_be_bytes(b)))),
        "<u4" => Numbers::Whole(each(bytes, u32::from_le_bytes)),
        ">u4" => Numbers::Whole(each(bytes, u32::from_be_bytes)),
        "<i4" => Numbers::Whole(each(bytes, |b| whole(i64::from(i32::from_le_bytes(b))))),
        "<i8" => Numbers::Whole(each(bytes, |b| whole(i64::from_le_bytes(b)))),
        _ => return None,
    })
}
