//! The receivers of a block as the map from the middle of the light sees them.

use super::bounds::BAND;
use super::frame::{Beyond, Frustum};
use crate::lanes::{INDEX, LANES, Lanes, Ops, lanes, max, min};

/// One bit per pixel of a block, row after row.
pub(super) type Pixels = u128;

/// Receivers beyond an end of the light that are less than this many rows beside the first or the
/// last row of the maps count as this many rows inside.
const EDGE: f32 = 0.25;

const _: () = assert!(LANES * BAND == Pixels::BITS as usize);

/// Those of `pixels` in row `y` of the block.
#[inline(always)]
pub(super) fn in_row(pixels: Pixels, y: usize) -> u32 {
    (pixels >> (y * LANES)) as u32 & 0xffff
}

/// Pixels of a block, from those of one of its rows.
#[inline(always)]
pub(super) fn from_row(pixels: u32, y: usize) -> Pixels {
    Pixels::from(pixels) << (y * LANES)
}

/// Column, row and nearness of every pixel of a block in the map from the middle of the light.
#[derive(Clone, Debug)]
pub(super) struct Receivers {
    pub column: [Lanes; BAND],
    pub row: [Lanes; BAND],
    pub nearness: [Lanes; BAND],
    /// Column and nearness before receivers were moved away from the light's line.
    unmoved: [[Lanes; BAND]; 2],
    /// The pixels that lie in front of the light, between the first and the last row.
    pub inside: Pixels,
    /// Those of them that the map from the middle of the light does not show.
    pub beside: Pixels,
}

impl Receivers {
    pub const NONE: Receivers = Receivers {
        column: [[0.0; LANES]; BAND],
        row: [[0.0; LANES]; BAND],
        nearness: [[0.0; LANES]; BAND],
        unmoved: [[[0.0; LANES]; BAND]; 2],
        inside: 0,
        beside: 0,
    };

    /// Warps the pixels from (x, y) on, whose nearness for the camera is given.
    #[inline(always)]
    pub fn warp(
        &mut self,
        ops: impl Ops,
        frustum: &Frustum<'_>,
        [x, y]: [usize; 2],
        nearness: &[Lanes; BAND],
    ) {
        let [width, height] = frustum.size.map(|size| [size as f32; LANES]);
        let (none, most) = ([0.0; LANES], [f32::MAX; LANES]);
        (self.inside, self.beside) = (0, 0);
        for (row, nearness) in nearness.iter().enumerate() {
            let at = [x, y + row];
            let q = warp_row(&frustum.warp[3], at, nearness);
            let one = lanes(|i| 1.0 / q[i]);
            let mut u = times(warp_row(&frustum.warp[0], at, nearness), &one);
            let mut v = times(warp_row(&frustum.warp[1], at, nearness), &one);
            let mut w = times(warp_row(&frustum.warp[2], at, nearness), &one);
            (self.unmoved[0][row], self.unmoved[1][row]) = (u, w);
            if let Some(beyond) = &frustum.beyond {
                let moved = away_from_line(ops, beyond, frustum.disparity, &mut u, &mut w);
                // Rounding carries receivers over the frustum's sides: any that are so close to the
                // line, others by a little.
                let beside = ops.greater(&v, &[-EDGE; LANES])
                    & ops.greater(&lanes(|i| height[i] + EDGE), &v);
                let kept = lanes(|i| min(max(v[i], EDGE), height[i] - EDGE));
                v = ops.select(moved | beside, &kept, &v);
            }
            let inside = ops.greater(&q, &none)
                & ops.greater(&v, &none)
                & ops.greater(&height, &v)
                & ops.greater(&most, &lanes(|i| u[i].abs()))
                & ops.greater(&most, &lanes(|i| w[i].abs()));
            let shown = ops.greater(&u, &none) & ops.greater(&width, &u);
            self.inside |= from_row(inside, row);
            self.beside |= from_row(inside & !shown, row);
            (self.column[row], self.row[row], self.nearness[row]) = (u, v, w);
        }
    }

    /// Where the pixels of `group`, which must not be empty, are.
    #[inline(always)]
    pub fn extent(&self, ops: impl Ops, group: Pixels) -> Extent {
        let (many, few) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        let (mut lo, mut hi) = ([many; 3], [few; 3]);
        for y in 0..BAND {
            let pixels = in_row(group, y);
            if pixels == 0 {
                continue;
            }
            for (axis, of) in [&self.column, &self.row, &self.nearness].into_iter().enumerate() {
                let (low, high) =
                    (ops.select(pixels, &of[y], &many), ops.select(pixels, &of[y], &few));
                lo[axis] = ops.min(&low, &lo[axis]);
                hi[axis] = ops.max(&high, &hi[axis]);
            }
        }
        Extent {
            columns: [ops.least(&lo[0]), ops.greatest(&hi[0])],
            rows: [ops.least(&lo[1]), ops.greatest(&hi[1])],
            nearness: [ops.least(&lo[2]), ops.greatest(&hi[2])],
        }
    }

    /// Column, row and nearness of one pixel, on its plane.
    #[inline(always)]
    pub fn at(&self, pixel: usize) -> [f32; 3] {
        let (y, x) = (pixel / LANES, pixel % LANES);
        [self.unmoved[0][y][x], self.row[y][x], self.unmoved[1][y][x]]
    }
}

/// The ranges that receivers span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub columns: [f32; 2],
    pub rows: [f32; 2],
    pub nearness: [f32; 2],
}

impl Extent {
    /// The ranges of the receivers of both.
    #[inline(always)]
    pub fn with(&self, other: &Extent) -> Extent {
        let range = |a: [f32; 2], b: [f32; 2]| [min(a[0], b[0]), max(a[1], b[1])];
        Extent {
            columns: range(self.columns, other.columns),
            rows: range(self.rows, other.rows),
            nearness: range(self.nearness, other.nearness),
        }
    }
}

/// Moves receivers that are too close to the light's line for the maps to show away from it, to
/// where the maps end: a quarter of a degree at most. Returns which were moved.
#[inline(always)]
fn away_from_line(
    ops: impl Ops,
    beyond: &Beyond,
    disparity: f32,
    column: &mut Lanes,
    nearness: &mut Lanes,
) -> u32 {
    let (center, most) = (beyond.center, beyond.most);
    let far = lanes(|i| (column[i] - center).abs() + 0.5 * disparity * nearness[i]);
    let moved = ops.greater(&far, &[most; LANES]);
    let kept = ops.select(moved, &lanes(|i| most / far[i]), &[1.0; LANES]);
    *column = lanes(|i| center + (column[i] - center) * kept[i]);
    *nearness = lanes(|i| nearness[i] * kept[i]);
    moved
}

/// One row of a warp for sixteen pixels from (x, y) on.
#[inline(always)]
pub(super) fn warp_row(r: &[f32; 4], [x, y]: [usize; 2], nearness: &Lanes) -> Lanes {
    let middle = y as f32 + 0.5;
    lanes(|i| {
        let column = x as f32 + (INDEX[i] + 0.5);
        ((r[0] * column + r[1] * middle) + r[2] * nearness[i]) + r[3]
    })
}

#[inline(always)]
fn times(x: Lanes, by: &Lanes) -> Lanes {
    lanes(|i| x[i] * by[i])
}
