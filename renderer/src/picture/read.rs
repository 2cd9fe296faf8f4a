//! Pictures from files.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use exr::prelude::{ReadChannels, ReadLayers};

use crate::Error;
use crate::picture::{Display, Format, Picture, Values};

/// Reads a picture: png and jpg as bytes, exr and pfm as floats. Alpha is dropped.
///
/// # Errors
///
/// If the file cannot be read, or is no such picture.
pub fn read(path: &Path) -> Result<Picture, Error> {
    let wrong = |why: &dyn std::fmt::Display| Error::new(format_args!("{}: {why}", path.display()));
    let format = Format::of(path)?;
    let file = fs::read(path).map_err(|error| wrong(&error))?;
    match format {
        Format::Png | Format::Jpeg => {
            let image = image::load_from_memory(&file).map_err(|error| wrong(&error))?;
            let (width, height) = (image.width(), image.height());
            let (channels, bytes) = if image.color().has_color() {
                (3, image.into_rgb8().into_raw())
            } else {
                (1, image.into_luma8().into_raw())
            };
            Ok(Picture { width, height, channels, values: Values::Bytes(bytes) })
        }
        Format::Exr => read_exr(file).map_err(|why| wrong(&why)),
        Format::Pfm => read_pfm(&file).map_err(|why| wrong(&why)),
    }
}

/// Red, green and blue if the first layer has them, else its only channel (or Y).
fn read_exr(file: Vec<u8>) -> Result<Picture, String> {
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

fn read_pfm(file: &[u8]) -> Result<Picture, String> {
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
