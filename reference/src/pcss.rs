//! Percentage-closer soft shadows (Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH 2005
//! sketches).

use shadowmap_core::{Bias, DepthMap, Light, LightPoint, Projection, View};

use crate::pcf::{blocker, lit_fraction};
use crate::sampling::{self, Samples};

/// Percentage-closer soft shadows, in three steps:
///
/// 1. Search the part of the map through which the receiver can see the light; average the depths
///    of all blockers there. Without any, the receiver is lit.
/// 2. From that one depth, as if all blockers were parallel planes, follows the width of the
///    penumbra: `(receiver - blocker) * light size / blocker`.
/// 3. Filter with a kernel of that width (percentage-closer filtering).
///
/// Differences to the sketch: the kernels are discs, since the lights are; the taps are jittered
/// strata; and the search is bounded by the nearest depth in the map, where the sketch takes the
/// near plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pcss {
    /// Texels of penumbra radius per unit of nearness between blocker and receiver.
    pub scale: f32,
    /// The greatest nearness in the map.
    pub nearest: f32,
    /// Taps of the blocker search.
    pub blocker_samples: u32,
    /// Taps of the filter.
    pub filter_samples: u32,
}

impl Pcss {
    /// For a sphere whose centre `view` looks from, or a sun that it looks along, and the map
    /// taken from there, with 32 + 64 taps. `None` for other lights, and other projections than
    /// theirs.
    #[must_use]
    pub fn new(light: &Light, view: &View, map: &DepthMap<'_>) -> Option<Pcss> {
        let radius = match (*light, view.projection()) {
            (Light::Sphere { radius, .. }, Projection::Perspective) => radius,
            (Light::Sun { angle, .. }, Projection::Orthographic) => {
                libm::tan(f64::from(angle) * 0.5) as f32
            }
            _ => return None,
        };
        let nearest = map.nearness().iter().fold(0.0_f32, |most, &n| most.max(n));
        Some(Pcss {
            scale: radius * view.focal().x,
            nearest,
            blocker_samples: 32,
            filter_samples: 64,
        })
    }

    /// The lit fraction, in \[0, 1\]. `receiver` is any number that differs between receivers: it
    /// chooses the jitter.
    #[must_use]
    pub fn visibility(
        &self,
        view: &View,
        map: &DepthMap<'_>,
        point: &LightPoint,
        bias: Bias,
        receiver: u32,
    ) -> f32 {
        let reach = self.scale * (self.nearest - point.nearness);
        let (mut depths, mut blockers) = (0.0, 0);
        for tap in disc_taps(self.blocker_samples, receiver, 1) {
            if let Some(nearness) = blocker(map, point, bias, reach, tap) {
                depths += view.depth_from_nearness(nearness);
                blockers += 1;
            }
        }
        if blockers == 0 {
            return 1.0;
        }
        let depth = depths / blockers as f32;
        let nearness = match view.projection() {
            Projection::Perspective => 1.0 / depth,
            Projection::Orthographic => view.max_nearness() - depth,
        };
        let radius = self.scale * (nearness - point.nearness);
        lit_fraction(map, point, bias, radius, disc_taps(self.filter_samples, receiver, 2))
    }
}

/// Jittered strata of the unit disc.
fn disc_taps(count: u32, receiver: u32, seed: u32) -> impl ExactSizeIterator<Item = [f32; 2]> {
    sampling::unit_square(Samples::Jittered { count, seed }, receiver)
        .map(|[x, y]| sampling::concentric(x, y))
}
