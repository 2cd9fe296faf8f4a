//! Bounds on the planes of receivers.

use super::adaptive::TILE;
use super::groups::Groups;
use super::reach::{Extent, Reach};
use super::receiver::Receiver;
use super::soa::Receivers;
use super::texel_test::Test;

/// Room for rounding, relative to the greatest of what is added up to compare a texel with a plane.
pub(crate) const ROUNDING: f32 = 1.0 / 524288.0;

/// A range: the least and the greatest of something.
type Bounds = [f32; 2];

/// Bounds on the planes of some receivers. Above a plane are the texels with
/// `hn (n - nearness) + hu (s - u) + hv (t - v) > above`.
///
/// Components of normals have narrow ranges wherever a surface is smooth, while the slope of planes
/// that the light hardly sees from above has not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planes {
    /// Texel coordinates among the receivers, and their least nearness.
    pub at: [f32; 2],
    pub nearness: f32,
    pub hu: Bounds,
    pub hv: Bounds,
    pub hn: Bounds,
    pub above: Bounds,
}

impl Planes {
    /// Bounds with room for rounding on a receiver's own plane, for texels about as far from the
    /// map's first as the receiver.
    #[inline(always)]
    pub fn of(r: &Receiver) -> Planes {
        let room = room(r, [r.u.abs() * 4.0, r.v.abs() * 4.0, r.nearness.abs() * 4.0]);
        let above = r.above - (r.hn * r.nearness + (r.hu * r.u + r.hv * r.v));
        Planes {
            at: [r.u, r.v],
            nearness: r.nearness,
            hu: [r.hu; 2],
            hv: [r.hv; 2],
            hn: [r.hn; 2],
            above: [above - room, above + room],
        }
        .if_known()
    }

    /// Bounds on those of a group with this extent and reach.
    #[inline(always)]
    pub fn of_group(
        groups: &Groups,
        group: usize,
        r: &Receivers,
        extent: &Extent,
        reach: &Reach,
    ) -> Planes {
        // In the map, whatever the extent.
        let middle = |[low, high]: Bounds, [from, end]: [i32; 2]| {
            ((low + high) * 0.5).clamp(from as f32, end as f32)
        };
        let at = [middle(extent.u, reach.places.columns), middle(extent.v, reach.places.rows)];
        let nearness = extent.nearness[0];
        let far = |[from, end]: [i32; 2]| from.abs().max(end.abs()) as f32 + 1.0;
        let (columns, rows) = (far(reach.places.columns), far(reach.places.rows));
        let far = [columns, rows, reach.greatest.abs().max(nearness.abs())];
        let (mut hu, mut hv) = (Range::EMPTY, Range::EMPTY);
        let (mut hn, mut above) = (Range::EMPTY, Range::EMPTY);
        for row in 0..TILE {
            for lane in 0..TILE {
                let i = row * TILE + lane;
                let counts = groups.has(group, i);
                let r = r.get(i);
                let room = room(&r, far);
                let relative = r.above - (r.hn * nearness + (r.hu * at[0] + r.hv * at[1]));
                hu.add(lane, counts, r.hu, r.hu);
                hv.add(lane, counts, r.hv, r.hv);
                hn.add(lane, counts, r.hn, r.hn);
                above.add(lane, counts, relative - room, relative + room);
            }
        }
        let (hu, hv, hn, above) = (hu.all(), hv.all(), hn.all(), above.all());
        Planes { at, nearness, hu, hv, hn, above }.if_known()
    }

    /// Themselves if they are of use.
    #[inline(always)]
    fn if_known(self) -> Planes {
        let all = |[low, high]: Bounds| low.abs() + high.abs();
        let all = (all(self.hu) + all(self.hv)) + (all(self.hn) + all(self.above));
        // False for NaN.
        if all < 1e18 {
            return self;
        }
        let above = [f32::NEG_INFINITY, f32::INFINITY];
        Planes { hu: [0.0; 2], hv: [0.0; 2], hn: [0.0; 2], above, ..self }
    }

    /// The tests for what blocks some of the receivers, and for what blocks all, of which `most` is
    /// the greatest nearness.
    #[inline(always)]
    pub fn tests(&self, most: f32) -> [Test; 2] {
        let Planes { at, nearness, hu, hv, hn, above } = *self;
        let flip = |[low, high]: Bounds| [high, low];
        // Texels that block are nearer than the least nearness.
        let above = |i: usize| above[i] + hn[1 - i] * nearness;
        [
            Test { at, hu: flip(hu), hv: flip(hv), hn: hn[1], above: above(0), nearness },
            Test { at, hu, hv, hn: hn[0], above: above(1), nearness: most },
        ]
    }
}

/// Room for rounding up to texels so far away from the map's first, and with such nearness.
#[inline(always)]
fn room(r: &Receiver, far: [f32; 3]) -> f32 {
    let across = r.hu.abs() * far[0] + r.hv.abs() * far[1];
    (r.above.abs() + (r.hn.abs() * far[2] + across)) * ROUNDING
}

/// The range of something over the pixels of a tile, lane by lane.
#[derive(Clone, Copy)]
struct Range {
    low: [f32; TILE],
    high: [f32; TILE],
}

impl Range {
    const EMPTY: Range = Range { low: [f32::INFINITY; TILE], high: [f32::NEG_INFINITY; TILE] };

    #[inline(always)]
    fn add(&mut self, lane: usize, counts: bool, low: f32, high: f32) {
        let (least, most) = (self.low[lane], self.high[lane]);
        self.low[lane] = if counts & (low < least) { low } else { least };
        self.high[lane] = if counts & (high > most) { high } else { most };
    }

    #[inline(always)]
    fn all(&mut self) -> Bounds {
        let mut half = TILE / 2;
        while half > 0 {
            for lane in 0..half {
                self.low[lane] = self.low[lane].min(self.low[lane + half]);
                self.high[lane] = self.high[lane].max(self.high[lane + half]);
            }
            half /= 2;
        }
        [self.low[0], self.high[0]]
    }
}

/// The extent of a group of receivers.
#[inline(always)]
pub(crate) fn extent(groups: &Groups, group: usize, r: &Receivers) -> Extent {
    let (mut u, mut v, mut nearness) = (Range::EMPTY, Range::EMPTY, Range::EMPTY);
    for row in 0..TILE {
        for lane in 0..TILE {
            let i = row * TILE + lane;
            let counts = groups.has(group, i);
            u.add(lane, counts, r.u[i], r.u[i]);
            v.add(lane, counts, r.v[i], r.v[i]);
            nearness.add(lane, counts, r.nearness[i], r.nearness[i]);
        }
    }
    Extent { u: u.all(), v: v.all(), nearness: nearness.all() }
}
