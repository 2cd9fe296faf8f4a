//! Which texels block: the test of one receiver, and what is true of the tests of several.

use super::field::{LANE, Row};
use super::geometry::{Geometry, Tall};
use super::receiver::Receiver;

/// Texels above a plane and in a cone. The plane may have a crease along each axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Test<'a> {
    pub geometry: &'a Geometry,
    /// Where the creases cross, in texels.
    pub at: [f32; 2],
    /// A texel (s, t) from there with nearness n is above the plane if
    /// `hn * n > (above - hv * t) - hu * s`. hu and hv: towards greater coordinates, and lesser.
    pub hu: [f32; 2],
    pub hv: [f32; 2],
    pub hn: f32,
    pub above: f32,
    /// The cone's tip, and how far texels are from it: the greater distance to the two coordinates,
    /// less than the second and greater than the first counting as negative.
    pub nearness: f32,
    pub u: [f32; 2],
    pub v: [f32; 2],
    pub tall: Tall,
}

/// A [`Test`] for one block of texels: those in column x and row y with a nearness n for which
/// `hn * n > rows[y] - columns[x]`, `n > least_rows[y]` and `n > least_columns[x]`. A block has fewer
/// rows than columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub columns: Row,
    pub rows: Row,
    pub least_columns: Row,
    pub least_rows: Row,
    pub hn: f32,
}

impl<'a> Test<'a> {
    /// The texels that block a receiver ([`Receiver::is_blocked_by`]).
    #[inline(always)]
    pub fn of(geometry: &'a Geometry, receiver: &Receiver) -> Test<'a> {
        let Receiver { u, v, hu, hv, hn, above, nearness, .. } = *receiver;
        let (hu, hv, u, v) = ([hu; 2], [hv; 2], [u; 2], [v; 2]);
        Test { geometry, at: [0.0; 2], hu, hv, hn, above, nearness, u, v, tall: Tall::NEVER }
    }

    /// The test of the block whose first texel has its centre at `first`, and for whose cells
    /// `greatest` is an upper bound.
    #[inline(always)]
    pub fn limits(&self, first: [f32; 2], greatest: f32) -> Limits {
        let tall = self.tall.among(greatest);
        let least = |axis: usize, at: f32, [low, high]: [f32; 2]| {
            let (below, beyond) = (low - at, at - high);
            let apart = if below > beyond { below } else { beyond };
            let least = self.nearness + self.geometry.nearer(axis, apart);
            if least < tall { least } else { tall }
        };
        let [after, before] = self.hu;
        let (mut columns, mut least_columns) = (LANE, LANE);
        for x in 0..LANE.len() {
            let s = first[0] + LANE[x];
            least_columns[x] = least(0, s, self.u);
            let s = s - self.at[0];
            columns[x] = (if s < 0.0 { before } else { after }) * s;
        }
        let [after, before] = self.hv;
        let (mut rows, mut least_rows) = (LANE, LANE);
        for y in 0..LANE.len() {
            let t = first[1] + LANE[y];
            least_rows[y] = least(1, t, self.v);
            let t = t - self.at[1];
            rows[y] = self.above - (if t < 0.0 { before } else { after }) * t;
        }
        Limits { columns, rows, least_columns, least_rows, hn: self.hn }
    }
}
