//! What a tile's receivers have in common.

use super::adaptive::{COUNT, TILE};
use super::kernels::{Ops, Work};
use super::leaves::ROOM;
use super::reach::Extent;
use super::receiver::Receiver;
use super::soa::Receivers;

/// How far, in nearness, the plane of [`Receiver::above`] lies above the receiver itself, at least.
#[inline(always)]
pub(crate) fn margin(receiver: &Receiver) -> f32 {
    let Receiver { u, v, nearness, hu, hv, hn, above, .. } = *receiver;
    let through = hn * nearness + (hu * u + hv * v);
    (above - through) / hn - ROOM * nearness
}

/// Finds the extent of a tile's receivers that see something of the light.
pub(crate) struct FindExtent<'a> {
    pub receivers: &'a Receivers,
    pub extent: &'a mut Extent,
}

impl Work for FindExtent<'_> {
    #[inline(always)]
    fn run(self, _: &impl Ops) {
        let r = self.receivers;
        let mut low = [[f32::INFINITY; TILE]; 3];
        let mut high = [[f32::NEG_INFINITY; TILE]; 3];
        for row in 0..COUNT / TILE {
            for lane in 0..TILE {
                let i = row * TILE + lane;
                let counts = r.sky[i] > 0.0;
                let values = [r.u[i], r.v[i], r.nearness[i]];
                for ((low, high), value) in low.iter_mut().zip(&mut high).zip(values) {
                    let (least, most) = (low[lane], high[lane]);
                    low[lane] = if counts & (value < least) { value } else { least };
                    high[lane] = if counts & (value > most) { value } else { most };
                }
            }
        }
        let range = |k: usize| {
            [
                low[k].iter().copied().fold(f32::INFINITY, f32::min),
                high[k].iter().copied().fold(f32::NEG_INFINITY, f32::max),
            ]
        };
        *self.extent = Extent { u: range(0), v: range(1), nearness: range(2) };
    }
}

/// Finds the least height of the receivers' planes above that of `plane` at four places.
pub(crate) struct FindLeast<'a> {
    pub receivers: &'a Receivers,
    pub plane: &'a Receiver,
    pub corners: [[f32; 2]; 4],
    /// Not finite if a plane is seen from below or nearly edge-on.
    pub least: &'a mut f32,
}

impl Work for FindLeast<'_> {
    #[inline(always)]
    fn run(self, _: &impl Ops) {
        let (r, plane) = (self.receivers, self.plane);
        let mut lows = [f32::INFINITY; TILE];
        let at_corner = self.corners.map(|[s, t]| {
            plane.nearness - (plane.hu * (s - plane.u) + plane.hv * (t - plane.v)) / plane.hn
        });
        for row in 0..COUNT / TILE {
            for (lane, low) in lows.iter_mut().enumerate() {
                let i = row * TILE + lane;
                let inverse = 1.0 / r.hn[i];
                let mut least = f32::INFINITY;
                for ([s, t], at) in self.corners.into_iter().zip(at_corner) {
                    let height = (r.above[i] - (r.hu[i] * s + r.hv[i] * t)) * inverse - at;
                    least = if height < least { height } else { least };
                }
                let is_seen = r.hn[i] > 1e-3;
                least = if is_seen { least - ROOM * r.nearness[i] } else { f32::NEG_INFINITY };
                *low = if (r.sky[i] > 0.0) & (least < *low) { least } else { *low };
            }
        }
        *self.least = lows.iter().copied().fold(f32::INFINITY, f32::min);
    }
}
