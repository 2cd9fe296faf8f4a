//! Bounds on the planes of a group of receivers.

use super::adaptive::{COUNT, TILE};
use super::field::Test;
use super::groups::Groups;
use super::reach::Extent;
use super::soa::Receivers;

/// An affine function of texel coordinates: at (0, 0), and per texel along u and v.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub origin: f32,
    pub slope: [f32; 2],
}

impl Plane {
    /// The test for texels above it that are also nearer than `nearness`.
    #[inline(always)]
    pub fn test(&self, nearness: f32) -> Test {
        let [u, v] = self.slope;
        Test { hu: -u, hv: -v, hn: 1.0, above: self.origin, nearness }
    }
}

/// Room for rounding, relative to the greatest of what is added up to compare a texel with a plane.
const ROUNDING: f32 = 1.0 / 524288.0;

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
    fn all(&mut self) -> [f32; 2] {
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

/// Planes below and above all of a group's, within the box of `corners`. Their slope is that of
/// receiver `first`.
#[inline(always)]
pub(crate) fn bounds(
    groups: &Groups,
    group: usize,
    r: &Receivers,
    first: usize,
    corners: &[[f32; 2]; 4],
) -> [Plane; 2] {
    let slope = [-r.hu[first] / r.hn[first], -r.hv[first] / r.hn[first]];
    let mut at_corner = [0.0; 4];
    let (mut far_u, mut far_v) = (0.0_f32, 0.0_f32);
    for ([s, t], at) in corners.iter().zip(&mut at_corner) {
        *at = slope[0] * s + slope[1] * t;
        (far_u, far_v) = (far_u.max(s.abs()), far_v.max(t.abs()));
    }
    let mut range = Range::EMPTY;
    for row in 0..COUNT / TILE {
        for lane in 0..TILE {
            let i = row * TILE + lane;
            let inverse = 1.0 / r.hn[i];
            let (origin, u, v) = (r.above[i] * inverse, r.hu[i] * -inverse, r.hv[i] * -inverse);
            let room = (origin.abs() + (u.abs() * far_u + v.abs() * far_v)) * ROUNDING;
            for c in 0..4 {
                let [s, t] = corners[c];
                let height = (origin + (u * s + v * t)) - at_corner[c];
                range.add(lane, groups.has(group, i), height - room, height + room);
            }
        }
    }
    let [low, high] = range.all();
    [Plane { origin: low, slope }, Plane { origin: high, slope }]
}
