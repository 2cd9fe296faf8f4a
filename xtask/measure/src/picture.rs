//! Pictures of the report: what they show and how their values become colours.

use std::fs;
use std::io;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// Errors from here on have the full colour in pictures of errors.
pub const FULL_ERROR: f32 = 0.25;

/// A picture, ready to be shown and to be written to a file.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// PNG data.
    pub png: Vec<u8>,
}

impl Picture {
    /// Visibility as grey: 0 is black, 1 is white, in even steps of the byte.
    pub fn gray(width: usize, values: &[f32]) -> Picture {
        let bytes: Vec<u8> = values.iter().map(|&v| byte(v)).collect();
        Picture::encode(width, &bytes, ExtendedColorType::L8)
    }

    /// The signed error of `found`: white where it equals `truth`, blue where it is too dark,
    /// orange where it is too light.
    pub fn error(width: usize, found: &[f32], truth: &[f32]) -> Picture {
        let color = |(&found, &truth): (&f32, &f32)| {
            let t = ((found - truth) / FULL_ERROR).clamp(-1.0, 1.0);
            let end = if t < 0.0 { [0.0, 0.32, 0.60] } else { [0.80, 0.33, 0.0] };
            end.map(|c: f32| byte(1.0 + (c - 1.0) * t.abs()))
        };
        let bytes: Vec<u8> = found.iter().zip(truth).flat_map(color).collect();
        Picture::encode(width, &bytes, ExtendedColorType::Rgb8)
    }

    /// Red, green and blue bytes as they are.
    pub fn srgb(width: usize, bytes: &[u8]) -> Picture {
        Picture::encode(width, bytes, ExtendedColorType::Rgb8)
    }

    fn encode(width: usize, bytes: &[u8], color: ExtendedColorType) -> Picture {
        let channels = usize::from(color.channel_count());
        let height = bytes.len() / (width * channels).max(1);
        let mut png = Vec::new();
        PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive)
            .write_image(bytes, width as u32, height as u32, color)
            .expect("the bytes fill the picture, and memory takes all of them");
        Picture { width, height, png }
    }

    pub fn write(&self, file: &Path) -> io::Result<()> {
        fs::write(file, &self.png)
    }
}

fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}
