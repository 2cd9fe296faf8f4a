//! Pictures from files.

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use exr::prelude::{MetaData, ReadChannels, ReadLayers};

use crate::Error;
use crate::picture::{Display, Format, Picture, Values};

/// Reads a picture: png and jpg as bytes, exr and pfm as floats. Alpha is dropped. Neither the file
/// nor what it holds may take more than `max_memory` bytes.
///
/// # Errors
///
/// If the file cannot be read, is no such picture, or is too large.
pub fn read(path: &Path, max_memory: u64) -> Result<Picture, Error> {
    let format = Format::of(path)?;
    let file = read_bytes(path, max_memory)?;
    let picture = decode(format, &file, max_memory);
    picture.map_err(|why| Error::new(format_args!("{}: {why}", path.display())))
}

/// The bytes of a regular file of at most `max_memory` bytes.
///
/// # Errors
///
/// If it cannot be read or is larger; the message names it.
pub fn read_bytes(path: &Path, max_memory: u64) -> Result<Vec<u8>, Error> {
    let wrong = |why: &dyn std::fmt::Display| Error::new(format_args!("{}: {why}", path.display()));
    let file = File::open(path).map_err(|error| wrong(&error))?;
    let metadata = file.metadata().map_err(|error| wrong(&error))?;
    if !metadata.is_file() {
        return Err(wrong(&"it is not a file"));
    }
    check_memory("the file", metadata.len(), max_memory).map_err(|why| wrong(&why))?;
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    // A file that grows while it is read is cut at the size that was granted.
    file.take(metadata.len()).read_to_end(&mut bytes).map_err(|error| wrong(&error))?;
    Ok(bytes)
}

/// The picture in the bytes of a file, as [`read`].
///
/// # Errors
///
/// If they are no such picture, or it would take more than `max_memory` bytes.
pub fn decode(format: Format, file: &[u8], max_memory: u64) -> Result<Picture, String> {
    match format {
        Format::Png => decode_image(image::ImageFormat::Png, file, max_memory),
        Format::Jpeg => decode_image(image::ImageFormat::Jpeg, file, max_memory),
        Format::Exr => decode_exr(file, max_memory),
        Format::Pfm => decode_pfm(file),
    }
}

/// Before `needed` bytes are taken for `what`.
fn check_memory(what: &str, needed: u64, max_memory: u64) -> Result<(), String> {
    if needed <= max_memory {
        return Ok(());
    }
    let (needed, limit) = (needed >> 20, max_memory >> 20);
    Err(format!("{what} needs {needed} MB, the limit (--max-memory) is {limit}"))
}

fn decode_image(
    format: image::ImageFormat,
    file: &[u8],
    max_memory: u64,
) -> Result<Picture, String> {
    let mut reader = image::ImageReader::with_format(Cursor::new(file), format);
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(max_memory);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| error.to_string())?;
    let (width, height) = (image.width(), image.height());
    let (channels, bytes) = if image.color().has_color() {
        (3, image.into_rgb8().into_raw())
    } else {
        (1, image.into_luma8().into_raw())
    };
    Ok(Picture { width, height, channels, values: Values::Bytes(bytes) })
}

/// Red, green and blue if the first layer has them, else its only channel (or Y).
fn decode_exr(file: &[u8], max_memory: u64) -> Result<Picture, String> {
    // Reading takes memory for whatever sizes the headers name.
    let headers = MetaData::read_from_buffered(Cursor::new(file), false);
    for header in headers.map_err(|error| error.to_string())?.headers {
        let texels = (header.layer_size.0 as u64).saturating_mul(header.layer_size.1 as u64);
        // Each sample once as it is stored, of at most four bytes, and once as a float.
        let needed = texels.saturating_mul(header.channels.list.len() as u64).saturating_mul(8);
        check_memory("the picture", needed, max_memory)?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(file))
        .map_err(|error| error.to_string())?;
    let layer = &image.layer_data;
    let list = &layer.channel_data.list;
    let channel = |name: &str| list.iter().find(|channel| channel.name.eq(name));
    let chosen = match (channel("R"), channel("G"), channel("B")) {
        (Some(r), Some(g), Some(b)) => vec![r, g, b],
        _ => match (channel("Y"), list.as_slice()) {
            (Some(only), _) | (None, [only]) => vec![only],
            _ => return Err("it has neither channels R, G, B nor Y nor a single one".into()),
        },
    };
    let (width, height) = (layer.size.x(), layer.size.y());
    let mut values = vec![0.0; width * height * chosen.len()];
    for (index, channel) in chosen.iter().enumerate() {
        let places = values.iter_mut().skip(index).step_by(chosen.len());
        for (place, value) in places.zip(channel.sample_data.values_as_f32()) {
            *place = value;
        }
    }
    let side = |side: usize| u32::try_from(side).map_err(|_| "it is too large".to_owned());
    let display = if chosen.len() == 3 { Display::Light } else { Display::Unit };
    Ok(Picture {
        width: side(width)?,
        height: side(height)?,
        channels: chosen.len(),
        values: Values::Floats(values, display),
    })
}

fn decode_pfm(file: &[u8]) -> Result<Picture, String> {
    let mut rest = file;
    // Words with one white-space character after each.
    let mut word = || {
        let end = rest.iter().position(u8::is_ascii_whitespace).filter(|&end| end < 32)?;
        let word = std::str::from_utf8(&rest[..end]).ok();
        rest = &rest[end + 1..];
        word
    };
    let header = || "its header is not that of a PFM picture".to_owned();
    let channels = match word() {
        Some("Pf") => 1,
        Some("PF") => 3,
        _ => return Err(header()),
    };
    let mut side = || word()?.parse::<u32>().ok().filter(|&side| side > 0);
    let (width, height) = (side().ok_or_else(header)?, side().ok_or_else(header)?);
    let scale: f32 = word().and_then(|word| word.parse().ok()).ok_or_else(header)?;
    let count = u64::from(width) * u64::from(height) * channels;
    if rest.len() as u64 != 4 * count {
        let (needed, found) = (4 * count, rest.len());
        return Err(format!("{width} x {height} pixels need {needed} bytes, there are {found}"));
    }
    let (words, _) = rest.as_chunks::<4>();
    let decode = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let rows = words.chunks_exact(width as usize * channels as usize).rev();
    let values = rows.flatten().map(|&word| decode(word)).collect();
    let display = if channels == 3 { Display::Light } else { Display::Unit };
    Ok(Picture {
        width,
        height,
        channels: channels as usize,
        values: Values::Floats(values, display),
    })
}
