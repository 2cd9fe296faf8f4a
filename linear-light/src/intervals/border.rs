//! Where the maps of neighbouring samples leave a gap, and what goes on across it.
//!
//! Windows end somewhere along the light. What lies so close to it that neither of two
//! neighbouring samples has it in its window, nobody shows: between a light and the ceiling that it
//! hangs behind, most of the ceiling. But where a surface comes to the border of one window in the
//! plane in which the other window shows one, it is one surface, and it hides the light on its way.

use super::frame::Frustum;
use super::run::Vertex;
use super::scan::row_of;

/// How far, relative to its nearness, what the neighbouring map shows may be from a surface's plane
/// and still belong to it: walls have two sides, and ceilings beams.
const ALIKE: f32 = 0.25;

/// A surface that meets the light ends at so many times its nearness at the border, short of it by
/// one part in as many.
const FAR: f32 = 1024.0;

/// The map of a neighbouring sample as the border of a map sees it, in one row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Neighbour {
    /// The nearness from which on nothing is in both windows.
    gap: f32,
    /// Columns per nearness from one map to the other, over the columns of a map.
    shift: f32,
    /// What the neighbour shows at its border towards this map; 0 if nothing, if there is no
    /// neighbour, or if the windows hold all there is.
    nearness: f32,
}

impl Neighbour {
    /// The neighbours of a sample, the one before and the one after, in row `y`.
    #[inline(always)]
    pub fn both(frustum: &Frustum<'_>, sample: usize, y: usize) -> [Neighbour; 2] {
        let last = frustum.size[0] as usize - 1;
        if !frustum.is_cut || last == 0 {
            return [Neighbour::default(); 2];
        }
        let of = |neighbour: Option<usize>, column: usize| {
            let Some(neighbour) = neighbour.filter(|&other| other < frustum.samples.len()) else {
                return Neighbour::default();
            };
            let [own, other] = [sample, neighbour].map(|sample| frustum.samples[sample]);
            let shift = frustum.disparity * (own.t - other.t).abs() / last as f32;
            Neighbour { gap: 1.0 / shift, shift, nearness: row_of(&other.map, y)[column] }
        };
        [of(sample.checked_sub(1), last), of(Some(sample + 1), 0)]
    }

    /// The column and the nearness of what the neighbour shows at its border, in a map of which
    /// `last` is the last column; `sign` is 1 if the neighbour is that to the right.
    #[inline(always)]
    pub fn shown(&self, sign: f32, last: f32) -> Vertex {
        let column = if sign > 0.0 { 0.5 } else { last + 0.5 };
        let moved = sign * (self.shift * last) * self.nearness;
        Vertex { column: column + moved, nearness: self.nearness }
    }

    /// How many columns beyond the last texel a surface goes on that has `nearness` there and
    /// changes by `slope` per column, in a map of which `last` is the last column; `None` if it
    /// ends there for all that is known.
    #[inline(always)]
    pub fn reach(&self, nearness: f32, slope: f32, last: f32) -> Option<f32> {
        if !(self.nearness > 0.0 && nearness > self.gap) {
            return None;
        }
        // The column where it meets the border of the other window moves by `shift * last` per
        // nearness.
        let missing = self.shift * nearness - 1.0;
        let closing = 1.0 / last - self.shift * slope;
        let columns = missing / closing;
        let there = nearness + slope * columns;
        // It is one surface, or hidden behind another.
        let is_one = there > 0.0 && self.nearness > (1.0 - ALIKE) * there;
        // A surface that meets the light does so before the other window.
        let columns = if closing > 0.0 { columns } else { FAR * nearness / slope };
        (is_one && columns.is_finite()).then_some(columns)
    }
}
