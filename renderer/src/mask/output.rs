//! Masks to files.

use std::io::Cursor;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::Error;
use crate::picture::{Display, Format, floats};

/// What a .png holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Png {
    /// 8 bits per pixel, white where the light is seen.
    #[default]
    #[value(name = "8")]
    Bits8,
    /// 16 bits per pixel.
    #[value(name = "16")]
    Bits16,
    /// Black, with the shadow as alpha: to be laid over a picture.
    Catcher,
}

/// The contents of a mask's file: .npy, .pfm and .exr hold floats, .png what `png` says.
///
/// # Errors
///
/// If the ending is none of these; the message names the file.
pub fn encode(path: &Path, size: [u32; 2], mask: Vec<f32>, png: Png) -> Result<Vec<u8>, Error> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let wrong = |why: String| Error::new(format_args!("{}: {why}", path.display()));
    match ending.as_str() {
        "npy" => npy(size, &mask).map_err(|error| wrong(error.to_string())),
        "png" => encode_png(size, &mask, png).map_err(|error| wrong(error.to_string())),
        "pfm" | "exr" => {
            let format = Format::of(path)?;
            floats(size, 1, mask, Display::Unit).encode(format).map_err(wrong)
        }
        _ => Err(wrong("a mask must end in .npy, .pfm, .exr or .png".into())),
    }
}

fn npy([width, height]: [u32; 2], mask: &[f32]) -> std::io::Result<Vec<u8>> {
    use npyz::WriterBuilder;
    let mut file = Vec::new();
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .shape(&[u64::from(height), u64::from(width)])
        .writer(&mut file)
        .begin_nd()?;
    writer.extend(mask.iter().copied())?;
    writer.finish()?;
    Ok(file)
}

fn encode_png(
    [width, height]: [u32; 2],
    mask: &[f32],
    png: Png,
) -> Result<Vec<u8>, image::ImageError> {
    let scaled = |value: f32, most: f32| value.clamp(0.0, 1.0) * most + 0.5;
    let (bytes, color) = match png {
        Png::Bits8 => (
            mask.iter().map(|&v| scaled(v, 255.0) as u8).collect::<Vec<_>>(),
            ExtendedColorType::L8,
        ),
        Png::Bits16 => {
            let values = mask.iter().map(|&v| scaled(v, 65_535.0) as u16);
            (values.flat_map(u16::to_ne_bytes).collect(), ExtendedColorType::L16)
        }
        Png::Catcher => {
            let pixels = mask.iter().map(|&v| [0, scaled(1.0 - v, 255.0) as u8]);
            (pixels.flatten().collect(), ExtendedColorType::La8)
        }
    };
    let mut file = Cursor::new(Vec::new());
    PngEncoder::new(&mut file).write_image(&bytes, width, height, color)?;
    Ok(file.into_inner())
}
