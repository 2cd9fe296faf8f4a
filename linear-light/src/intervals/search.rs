//! What to look for in the maps on behalf of receivers on one plane.

use shadowmap_core::Bias;

use super::bounds::BandSearch;
use super::frame::{Facing, Frustum};
use super::receivers::Extent;
use super::scan::REACH;
use crate::lanes::{max, min};

/// A plane as the maps see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tilt {
    /// A texel at column s, row t with nearness w is `a s + b t + c w + d` in front of the plane
    /// (times positive factors); a and b are the same for all maps.
    a: f32,
    b: f32,
    /// c for the two ends of the light, and linear in between.
    ends: [f32; 2],
    /// Change of the plane's nearness per row, as the middle of the light sees it.
    pub per_row: f32,
    /// Whether `per_row` had to be limited: then the receivers have to be judged one by one.
    pub steep: bool,
}

/// A plane is followed at most this many texel footprints towards the light within one row. One
/// seen more edge-on than that has no extent across the rows that a map could tell.
const STEEPEST: f32 = 8.0;

impl Tilt {
    #[inline(always)]
    pub fn new(facing: &Facing, frustum: &Frustum<'_>, nearness: f32) -> Tilt {
        let a = facing.plane.side_of(frustum.across[0]);
        let b = facing.plane.side_of(frustum.across[1]);
        let middle = 0.5 * (facing.ends[0] + facing.ends[1]);
        let limit = STEEPEST * frustum.footprint[1] * nearness;
        let slope = -b / middle;
        let per_row = if slope.is_nan() { 0.0 } else { max(-limit, min(limit, slope)) };
        Tilt { a, b, ends: facing.ends, per_row, steep: per_row != slope }
    }

    /// a, b, c and d for the map from parameter `t` of the light; the plane goes through a
    /// receiver.
    #[inline(always)]
    pub fn plane(&self, t: f32, [column, row, nearness]: [f32; 3]) -> [f32; 4] {
        let c = self.ends[0] + (self.ends[1] - self.ends[0]) * t;
        let d = -((self.a * column + self.b * row) + c * nearness);
        [self.a, self.b, c, d]
    }
}

/// What to look for in one map.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapSearch {
    /// Which part of the light the map is taken from.
    pub t: f32,
    /// The part of the light that it judges.
    pub span: [f32; 2],
    /// See [`Tilt`].
    pub plane: [f32; 4],
    /// By how much a texel has to be in front of the plane.
    pub bias: f32,
    /// Columns per nearness from the map of the middle of the light to this one.
    pub shift: f32,
}

impl MapSearch {
    /// `reference` is one of the receivers, in the map from the middle of the light.
    #[inline(always)]
    pub fn new(
        frustum: &Frustum<'_>,
        tilt: &Tilt,
        bias: Bias,
        [column, row, nearness]: [f32; 3],
        t: f32,
        span: [f32; 2],
    ) -> MapSearch {
        let shift = frustum.disparity * (0.5 - t);
        let plane = tilt.plane(t, [column + shift * nearness, row, nearness]);
        let [a, b, c, _] = plane;
        let bias = bias.constant * (nearness * c.abs()) + bias.slope * (a.abs() + b.abs());
        MapSearch { t, span, plane, bias, shift }
    }

    /// What to look for among the bounds of the map.
    #[inline(always)]
    pub fn among_bounds(&self, frustum: &Frustum<'_>, extent: &Extent, tilt: &Tilt) -> BandSearch {
        // Receivers move along their plane by up to a row.
        let moved = tilt.per_row.abs();
        let nearness = [extent.nearness[0] - moved, extent.nearness[1] + moved];
        let (p, q) = (self.shift * nearness[0], self.shift * nearness[1]);
        BandSearch {
            plane: self.plane,
            bias: self.bias,
            columns: [extent.columns[0] + min(p, q) - REACH, extent.columns[1] + max(p, q) + REACH],
            // Nothing, which has nearness 0, never blocks.
            nearness: max(nearness[0], 0.0),
            reach: [
                (self.t - self.span[0]) * frustum.disparity,
                (self.span[1] - self.t) * frustum.disparity,
            ],
        }
    }
}
