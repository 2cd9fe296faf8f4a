//! The formats a visibility mask can be written in.

/// A number that a visibility in \[0, 1\] is written as: `f32` as it is, `u16` and `u8` scaled to
/// their full range and rounded to nearest, or with a note of how it was [`Found`].
pub trait Visibility: sealed::Sealed + Copy + Send + Sync {
    /// The nearest value to `visibility`, which lies in \[0, 1\].
    #[must_use]
    fn from_unit(visibility: f32) -> Self;

    /// The same for a pixel whose visibility was found in that way.
    #[must_use]
    fn from_pixel(visibility: f32, found: Found) -> Self {
        let _ = found;
        Self::from_unit(visibility)
    }
}

/// How the visibility of a pixel was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Found {
    /// With its whole tile, or because nothing is seen there: without a look at its surroundings.
    #[default]
    Decided,
    /// Between searched pixels that agree (section 4.3).
    Interpolated,
    /// By a search.
    Searched,
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for u16 {}
    impl Sealed for u8 {}
    impl Sealed for (f32, super::Found) {}
}

impl Visibility for f32 {
    fn from_unit(visibility: f32) -> f32 {
        visibility
    }
}

impl Visibility for u16 {
    fn from_unit(visibility: f32) -> u16 {
        (visibility * 65535.0 + 0.5) as u16
    }
}

impl Visibility for u8 {
    fn from_unit(visibility: f32) -> u8 {
        (visibility * 255.0 + 0.5) as u8
    }
}

/// Visibility together with how it was found: what the paper's figure 5 shows.
impl Visibility for (f32, Found) {
    fn from_unit(visibility: f32) -> (f32, Found) {
        (visibility, Found::Searched)
    }
    fn from_pixel(visibility: f32, found: Found) -> (f32, Found) {
        (visibility, found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_range_and_nearest() {
        assert_eq!((u8::from_unit(0.0), u8::from_unit(0.5), u8::from_unit(1.0)), (0, 128, 255));
        assert_eq!((u16::from_unit(0.0), u16::from_unit(1.0)), (0, 65535));
        assert_eq!(u8::from_unit(0.0019), 0);
        assert_eq!(u8::from_unit(0.002), 1);
        assert_eq!(f32::from_unit(0.3), 0.3);
    }
}
