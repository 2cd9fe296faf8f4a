//! Depth discontinuities: between which texels skins hang (section 3.2).
//!
//! Nearness is affine in the image on every plane. So the difference between two neighbouring
//! texels says nothing by itself, a steep surface has a large one; a discontinuity is a difference
//! that the planes on its two sides do not explain. Both filters are zero on planes of any slope.
//!
//! Their threshold is a length in the map that the skin is warped into, since a skin shorter
//! than about a texel hides nothing. So it adapts to depth, and needs no tuning.

use crate::lanes::{LANES, Ops, lanes};

/// How depth discontinuities are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum EdgeFilter {
    /// The depth step between two neighbours of a row, unless the texels on both sides extrapolate
    /// to it.
    #[default]
    DepthStep,
    /// The 3 x 3 Laplacian of Gaussian of section 4: a discontinuity lies where its sign changes
    /// between two neighbours of a row.
    Laplacian,
}

/// Where depth discontinuities are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discontinuity {
    /// How they are found.
    pub filter: EdgeFilter,
    /// The least length of a skin, and the least deviation from a plane, in texels of the map that
    /// the skin is warped into. Positive; 1 by default.
    pub threshold: f32,
}

impl Default for Discontinuity {
    fn default() -> Self {
        Discontinuity { filter: EdgeFilter::default(), threshold: 1.0 }
    }
}

/// Three neighbouring rows of a map; at its border the middle one stands in for a missing one.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub above: &'a [f32],
    pub middle: &'a [f32],
    pub below: &'a [f32],
}

impl<'a> Rows<'a> {
    pub fn of(nearness: &'a [f32], width: usize, height: usize, y: usize) -> Rows<'a> {
        let row = |y: usize| &nearness[y * width..][..width];
        Rows {
            above: row(y.saturating_sub(1)),
            middle: row(y),
            below: row((y + 1).min(height - 1)),
        }
    }
}

/// Which of the two texels of a discontinuity holds the blocker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// The left one: nearness falls, and the next sample sees the skin.
    Left,
    /// The right one: nearness rises, and the previous sample sees the skin.
    Right,
}

impl Side {
    pub const fn sign(self) -> f32 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// The depth-step filter for the texels `b` and `c`, with `a` and `d` their neighbours further out.
#[inline(always)]
pub(crate) fn depth_step([a, b, c, d]: [f32; 4], side: Side, least: f32) -> bool {
    let step = (b - c) * side.sign();
    let left = step - (a - b) * side.sign();
    let right = step - (c - d) * side.sign();
    let surface = (left.abs() < least) & (right.abs() < least);
    (step >= least) & !surface
}

/// The Laplacian filter for the texels `b` and `c`, which have the responses `left` and `right`.
#[inline(always)]
pub(crate) fn zero_crossing(
    [b, c]: [f32; 2],
    [left, right]: [f32; 2],
    side: Side,
    least: f32,
) -> bool {
    let sign = side.sign();
    // The blocker's texel is nearer than what surrounds it, the receiver's farther.
    let crossing = (left * sign < 0.0) & (right * sign > 0.0);
    // A straight step of height 1 has the responses -4 and 4.
    ((b - c) * sign >= least) & crossing & ((right - left) * sign >= 8.0 * least)
}

/// The Laplacian of Gaussian at the middle of 3 x 3 texels: 1 2 1, 2 -12 2, 1 2 1.
#[inline(always)]
pub(crate) fn laplacian(above: [f32; 3], middle: [f32; 3], below: [f32; 3]) -> f32 {
    let corners = (above[0] + above[2]) + (below[0] + below[2]);
    let sides = (above[1] + below[1]) + (middle[0] + middle[2]);
    (corners + 2.0 * sides) - 12.0 * middle[1]
}

/// How many pairs are looked at in one go.
pub(crate) const BLOCK: usize = 64;

/// Which of the pairs (x, x + 1) of a row, for `BLOCK` values of x from `first` on, may have a step
/// of at least `least` in nearness: a bit each. No other pair is a discontinuity, and most blocks
/// have none. A pair with a NaN counts as one with a step.
#[inline(always)]
pub(crate) fn steps(ops: impl Ops, row: &[f32], side: Side, least: f32, first: usize) -> u64 {
    let pairs = (row.len() - 1 - first).min(BLOCK);
    let mut padded = [0.0; BLOCK + 1];
    let texels = match row[first..].first_chunk() {
        Some(texels) => texels,
        None => {
            padded[..=pairs].copy_from_slice(&row[first..]);
            &padded
        }
    };
    let (sign, least) = (side.sign(), [least; LANES]);
    let mut steps = 0;
    for start in (0..BLOCK).step_by(LANES) {
        let step = lanes(|i| (texels[start + i] - texels[start + i + 1]) * sign);
        steps |= u64::from(!ops.greater(&least, &step) & 0xffff) << start;
    }
    steps & (u64::MAX >> (BLOCK - pairs))
}

impl Discontinuity {
    /// Whether the pair (x, x + 1) of the middle row is a discontinuity. `least` is the threshold
    /// in nearness.
    #[inline(always)]
    pub(crate) fn is_between(&self, rows: &Rows<'_>, x: usize, side: Side, least: f32) -> bool {
        let four = around(rows.middle, x);
        match self.filter {
            EdgeFilter::DepthStep => depth_step(four, side, least),
            EdgeFilter::Laplacian => {
                let (above, below) = (around(rows.above, x), around(rows.below, x));
                let three = |[a, b, c, d]: [f32; 4]| [[a, b, c], [b, c, d]];
                let [[a0, a1], [m0, m1], [b0, b1]] = [above, four, below].map(three);
                let responses = [laplacian(a0, m0, b0), laplacian(a1, m1, b1)];
                zero_crossing([four[1], four[2]], responses, side, least)
            }
        }
    }
}

/// The texels x - 1 to x + 2 of a row, those of its ends beyond them.
#[inline(always)]
fn around(row: &[f32], x: usize) -> [f32; 4] {
    let whole = x.checked_sub(1).and_then(|start| row[start..].first_chunk());
    let at_end = |i: usize| row[(x + i).saturating_sub(1).min(row.len() - 1)];
    whole.copied().unwrap_or_else(|| core::array::from_fn(at_end))
}
