//! What pixels between others are interpolated with.

use super::adaptive::TILE;

/// The line through the ends of a group of pixels, or the parabola through its middle, too.
#[derive(Clone, Copy)]
pub(crate) struct Curve {
    start: f32,
    slope: f32,
    bend: f32,
}

impl Curve {
    /// The line through the ends of a group of that length.
    #[inline(always)]
    pub fn line([start, stop]: [f32; 2], length: usize) -> Curve {
        Curve { start, slope: (stop - start) / length as f32, bend: 0.0 }
    }

    /// The value of pixel `i`, in \[0, 1\] as are those of the ends: a parabola may go beyond.
    #[inline(always)]
    pub fn at(&self, i: usize, length: usize) -> f32 {
        let value = (self.start + self.slope * i as f32) + self.bend * (i * (length - i)) as f32;
        let value = if value > 0.0 { value } else { 0.0 };
        if value < 1.0 { value } else { 1.0 }
    }

    /// This line with a bend that adds so much to pixel `i`.
    #[inline(always)]
    pub fn bent(self, i: usize, length: usize, by: f32) -> Curve {
        Curve { bend: by / (i * (length - i)) as f32, ..self }
    }
}

/// Those of groups side by side.
pub(crate) struct Curves {
    start: [f32; TILE],
    slope: [f32; TILE],
    bend: [f32; TILE],
}

impl Curves {
    pub const FLAT: Curves = Curves { start: [0.0; TILE], slope: [0.0; TILE], bend: [0.0; TILE] };

    #[inline(always)]
    pub fn get(&self, x: usize) -> Curve {
        Curve { start: self.start[x], slope: self.slope[x], bend: self.bend[x] }
    }

    #[inline(always)]
    pub fn set(&mut self, x: usize, Curve { start, slope, bend }: Curve) {
        (self.start[x], self.slope[x], self.bend[x]) = (start, slope, bend);
    }
}
