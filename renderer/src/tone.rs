//! From linear light to the bytes of a picture.

use std::sync::OnceLock;

/// Linear values from 0 to this are told apart; what is brighter is white.
const BRIGHTEST: f32 = 4.0;

/// Entries per unit: finer than the steps of sRGB in its darkest part, 3295 per unit.
const STEPS: f32 = 4096.0;

/// Linear light from 0 to 4 to sRGB bytes, with a soft shoulder above [`SHOULDER`].
pub struct ToneTable(Vec<u8>);

/// Where the shoulder begins: darker values come out as they are.
const SHOULDER: f64 = 0.75;

impl ToneTable {
    /// The table, made at the first call.
    #[must_use]
    pub fn get() -> &'static ToneTable {
        static TABLE: OnceLock<ToneTable> = OnceLock::new();
        TABLE.get_or_init(|| {
            let entries = (BRIGHTEST * STEPS) as usize + 1;
            let byte = |i| (srgb(shoulder(i as f64 / f64::from(STEPS))) * 255.0 + 0.5) as u8;
            ToneTable((0..entries).map(byte).collect())
        })
    }

    /// The byte of a linear value; that of 0 for a NaN.
    #[inline(always)]
    #[must_use]
    pub fn byte(&self, linear: f32) -> u8 {
        // The conversion saturates, and turns NaN into 0.
        let index = (linear * STEPS + 0.5) as i32;
        self.0[index.clamp(0, self.0.len() as i32 - 1) as usize]
    }
}

/// Identity up to [`SHOULDER`], then bending smoothly towards 1, which it reaches at
/// [`BRIGHTEST`].
fn shoulder(x: f64) -> f64 {
    if x <= SHOULDER {
        return x;
    }
    let room = 1.0 - SHOULDER;
    let excess = (x - SHOULDER) / room;
    let most = (f64::from(BRIGHTEST) - SHOULDER) / room;
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
        let table = ToneTable::get();
        assert_eq!(table.byte(0.0), 0);
        assert_eq!(table.byte(-1.0), 0);
        assert_eq!(table.byte(f32::NAN), 0);
        assert_eq!(table.byte(f32::INFINITY), 255);
        assert_eq!(table.byte(4.0), 255);
        assert_eq!(table.byte(0.215_861), 128);
        assert_eq!(table.byte(0.5), 188);
    }

    #[test]
    fn brighter_is_never_darker_and_no_step_is_skipped_in_the_dark() {
        let table = ToneTable::get();
        let steps = table.0.windows(2).map(|pair| i32::from(pair[1]) - i32::from(pair[0]));
        assert!(steps.clone().all(|step| (0..=1).contains(&step)));
    }
}
