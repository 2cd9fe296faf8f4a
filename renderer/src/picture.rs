//! Pictures in memory, and their files.

mod read;
mod write;

pub use read::{decode, read, read_bytes};
pub use write::{Format, check_place, check_places, floats, write_file};

use nv_flip::magma_lut;

use crate::tone::srgb;

/// A picture of 8-bit or float values, row-major, the top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// 1 (grey) or 3 (red, green, blue).
    pub channels: usize,
    /// The values of all pixels.
    pub values: Values,
}

/// The values of a picture, `channels` per pixel.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// As a screen shows them: colours in sRGB.
    Bytes(Vec<u8>),
    /// Numbers, and how to show them on a screen.
    Floats(Vec<f32>, Display),
}

/// How numbers become bytes in formats that hold nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    /// Linear light: sRGB.
    Light,
    /// \[0, 1\] is black to white, in equal steps.
    Unit,
    /// \[-1, 1\] is black to white, in equal steps.
    Signed,
    /// From the smallest value other than 0, white, to the greatest, dark; 0 is black.
    Depth,
    /// Every whole number has a colour; 0 is black.
    Labels,
    /// From 0 to 0.25 in the colours of Matplotlib's magma, from black over red to pale yellow.
    Heat,
}

impl Picture {
    /// The bytes to show, and how many there are per pixel (1 or 3).
    #[must_use]
    pub fn to_bytes(&self) -> (Vec<u8>, usize) {
        let (values, display) = match &self.values {
            Values::Bytes(bytes) => return (bytes.clone(), self.channels),
            Values::Floats(values, display) => (values, display),
        };
        // A NaN becomes 0.
        let unit = |value: f32| (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let colors = |color: &dyn Fn(f32) -> [u8; 3]| {
            (values.iter().flat_map(|&value| color(value)).collect(), 3)
        };
        let bytes = match display {
            Display::Light => {
                let byte = |v: &f32| (srgb(f64::from(v.clamp(0.0, 1.0))) * 255.0 + 0.5) as u8;
                values.iter().map(byte).collect()
            }
            Display::Unit => values.iter().map(|&v| unit(v)).collect(),
            Display::Signed => values.iter().map(|&v| unit(v * 0.5 + 0.5)).collect(),
            Display::Depth => {
                let seen = values.iter().copied().filter(|&v| v.is_finite() && v != 0.0);
                let (near, far) =
                    seen.fold((f32::MAX, f32::MIN), |(near, far), v| (near.min(v), far.max(v)));
                let scale = if far > near { 0.85 / (far - near) } else { 0.0 };
                let byte = |&v: &f32| if v == 0.0 { 0 } else { unit(1.0 - (v - near) * scale) };
                values.iter().map(byte).collect()
            }
            Display::Labels => return colors(&|value| label_color(value as u32)),
            Display::Heat => {
                let magma = magma_lut().to_vec();
                let (magma, _) = magma.as_chunks::<3>();
                return colors(&|value| magma[usize::from(unit(value * 4.0))]);
            }
        };
        (bytes, self.channels)
    }

    /// The values as numbers; bytes are divided by 255.
    #[must_use]
    pub fn to_floats(&self) -> Vec<f32> {
        match &self.values {
            Values::Bytes(bytes) => bytes.iter().map(|&b| f32::from(b) / 255.0).collect(),
            Values::Floats(values, _) => values.clone(),
        }
    }
}

/// A colour for a whole number, black for 0, neighbours well apart.
fn label_color(label: u32) -> [u8; 3] {
    if label == 0 {
        return [0; 3];
    }
    // Steps of the golden angle around the hues, three brightnesses in turn.
    let hue = f64::from(label) * 0.618_033_988_749_895 % 1.0 * 6.0;
    let value = [0.95, 0.70, 0.82][label as usize % 3];
    [0.0, 4.0, 2.0].map(|offset: f64| {
        let distance = ((hue + offset) % 6.0 - 3.0).abs() - 1.0;
        let strength = 0.35 + 0.65 * distance.clamp(0.0, 1.0);
        (value * strength * 255.0 + 0.5) as u8
    })
}
