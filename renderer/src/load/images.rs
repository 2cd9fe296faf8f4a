//! Pictures: PNG and JPEG.

use std::io::Cursor;

use image::{ImageDecoder as _, ImageFormat, ImageReader, Limits as ImageLimits};

use super::error::Fault;
use super::limits::Budget;

/// The size and the texels of a picture, as sRGB with linear alpha.
#[derive(Clone)]
pub(super) struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) texels: Vec<[u8; 4]>,
}

/// Decodes a PNG or JPEG file. The inner error says why the picture cannot be used and leaves
/// the scene loadable; the outer one is a limit.
pub(super) fn decode(bytes: &[u8], budget: &mut Budget) -> Result<Result<Picture, String>, Fault> {
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        _ => return Ok(Err("it is neither PNG nor JPEG".into())),
    };
    let broken = |e: image::ImageError| {
        let text: String = e.to_string().chars().filter(|c| !c.is_control()).take(100).collect();
        match e {
            image::ImageError::Limits(_) => Err(Fault::TooLarge(format!("a picture: {text}"))),
            _ => Ok(Err(text)),
        }
    };
    // The header alone tells the size; only then is memory taken.
    let mut decoder = match ImageReader::with_format(Cursor::new(bytes), format).into_decoder() {
        Ok(decoder) => decoder,
        Err(e) => return broken(e),
    };
    let (width, height) = decoder.dimensions();
    // 16-bit decoding before, and 8-bit RGBA after.
    let needed = u64::from(width) * u64::from(height) * (8 + 4);
    budget.memory(needed, &format!("a picture of {width} x {height}"))?;
    let mut limits = ImageLimits::default();
    limits.max_alloc = Some(needed.saturating_add(1 << 20));
    if let Err(e) = decoder.set_limits(limits) {
        return broken(e);
    }
    let image = match image::DynamicImage::from_decoder(decoder) {
        Ok(image) => image.into_rgba8(),
        Err(e) => return broken(e),
    };
    let texels = image.as_raw().as_chunks::<4>().0.to_vec();
    Ok(Ok(Picture { width: image.width(), height: image.height(), texels }))
}
