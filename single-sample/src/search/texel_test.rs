//! Which texels block: the test of one receiver, and what is true of the tests of several.

use super::field::{LANE, Row};
use super::planes::ROUNDING;
use super::receiver::{Receiver, Seen};
use crate::math::sqrt;

/// Texels above a plane and nearer than something. The plane may have a crease along each axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Test {
    /// Where the creases cross, in texels.
    pub at: [f32; 2],
    /// A texel (s, t) from there with nearness n is above the plane if
    /// `hn * n > (above - hv * t) - hu * s`. hu and hv: towards greater coordinates, and lesser.
    pub hu: [f32; 2],
    pub hv: [f32; 2],
    pub hn: f32,
    pub above: f32,
    pub nearness: f32,
}

/// A [`Test`] for one block of texels: those in column x and row y with a nearness n for which
/// `hn * n > rows[y] - columns[x]`, and `n > nearness`. A block has fewer rows than columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub columns: Row,
    pub rows: Row,
    pub hn: f32,
    pub nearness: f32,
}

impl Test {
    /// The texels that block a receiver ([`Receiver::is_blocked_by`]).
    #[inline(always)]
    pub fn of(receiver: &Receiver) -> Test {
        let Receiver { hu, hv, hn, above, nearness, .. } = *receiver;
        Test { at: [0.0; 2], hu: [hu; 2], hv: [hv; 2], hn, above, nearness }
    }

    /// Passes all texels of a cell whose middle is `towards`, and not the receiver's own, that may
    /// have a part in what hides some of the disc.
    ///
    /// A texel at the distance d does if the disc's radius there is at least d. The distance is no
    /// less than the offset's part in any one direction: the cell's.
    #[inline(always)]
    pub fn in_reach(seen: &Seen, towards: [f32; 2]) -> Test {
        // Vertices are less than 4 texels from where their blockers are.
        const STRAY: f32 = 4.5;
        let (x, y) = ((towards[0] - seen.u).abs(), (towards[1] - seen.v).abs());
        let unit = 1.0 / sqrt(x * x + y * y);
        let (x, y) = (x * unit, y * unit);
        let own = seen.reach * seen.nearness;
        let above = own - (STRAY + own.abs() * ROUNDING + seen.reach * seen.least);
        let nearness = f32::NEG_INFINITY;
        Test { at: [seen.u, seen.v], hu: [-x, x], hv: [-y, y], hn: seen.reach, above, nearness }
    }

    /// The test of the block whose first texel has its centre at `first`.
    #[inline(always)]
    pub fn limits(&self, first: [f32; 2]) -> Limits {
        let [after, before] = self.hu;
        let mut columns = LANE;
        for x in 0..LANE.len() {
            let s = (first[0] + LANE[x]) - self.at[0];
            columns[x] = (if s < 0.0 { before } else { after }) * s;
        }
        let [after, before] = self.hv;
        let mut rows = LANE;
        for y in 0..LANE.len() {
            let t = (first[1] + LANE[y]) - self.at[1];
            rows[y] = self.above - (if t < 0.0 { before } else { after }) * t;
        }
        Limits { columns, rows, hn: self.hn, nearness: self.nearness }
    }
}
