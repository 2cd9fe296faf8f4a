//! From linear light to the bytes of a picture.

use std::sync::OnceLock;

/// Entries of the table per unit of linear light: finer than the steps of sRGB in its darkest
/// part, 3295 per unit. An index of 16 bits then reaches 16.
pub const STEPS: f32 = 4096.0;

/// Where the shoulder begins: darker values come out as they are.
const SHOULDER: f64 = 0.75;

/// What comes out white.
const BRIGHTEST: f64 = 4.0;

/// Linear light to sRGB bytes, with a soft shoulder above 0.75.
pub struct ToneTable(Box<[u8; 1 << 16]>);

impl ToneTable {
    /// The table, made at the first call.
    #[must_use]
    pub fn get() -> &'static ToneTable {
        static TABLE: OnceLock<ToneTable> = OnceLock::new();
        TABLE.get_or_init(|| {
            let mut table = Box::new([0; 1 << 16]);
            for (i, byte) in table.iter_mut().enumerate() {
                *byte = (srgb(shoulder(i as f64 / f64::from(STEPS))) * 255.0 + 0.5) as u8;
            }
            ToneTable(table)
        })
    }

    /// The byte of a linear value, given as the nearest multiple of 1 / [`STEPS`].
    #[inline(always)]
    #[must_use]
    pub fn byte(&self, steps: u16) -> u8 {
        self.0[usize::from(steps)]
    }
}

/// Identity up to [`SHOULDER`], then bending smoothly towards 1, which it reaches at
/// [`BRIGHTEST`].
fn shoulder(x: f64) -> f64 {
    if x <= SHOULDER {
        return x;
    }
    let x = x.min(BRIGHTEST);
    let room = 1.0 - SHOULDER;
    let excess = (x - SHOULDER) / room;
    let most = (BRIGHTEST - SHOULDER) / room;
    // Slope 1 at 0, 1 at `most` (Reinhard et al. 2002, equation 4).
    SHOULDER + room * excess * (1.0 + excess / (most * most)) / (1.0 + excess)
}

/// The sRGB encoding of a linear value in \[0, 1\] (IEC 61966-2-1).
#[must_use]
pub fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_bytes() {
        let byte = |linear: f32| ToneTable::get().byte((linear * STEPS).round() as u16);
        assert_eq!(byte(0.0), 0);
        assert_eq!(byte(0.215_861), 128);
        assert_eq!(byte(0.5), 188);
        assert_eq!(byte(4.0), 255);
        assert_eq!(byte(15.9), 255);
    }

    #[test]
    fn brighter_is_never_darker_and_no_step_is_skipped_in_the_dark() {
        let table = ToneTable::get();
        let steps = table.0.windows(2).map(|pair| i32::from(pair[1]) - i32::from(pair[0]));
        assert!(steps.clone().all(|step| (0..=1).contains(&step)));
    }
}
