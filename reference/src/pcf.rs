//! Percentage-closer filtering (Reeves, Salesin and Cook, "Rendering Antialiased Shadows with
//! Depth Maps", 1987).

use shadowmap_core::{Bias, DepthMap, LightPoint};

use crate::sampling::{self, Samples};

/// Percentage-closer filtering: the receiver is compared with the depth map at many places around
/// its own, and the results are averaged (section 3).
///
/// Differences to the paper: the region is a square of fixed size and not the pixel's footprint in
/// the map, as in nearly all of today's uses, so that it can imitate a penumbra of one width;
/// and each comparison is made with the receiver's plane at the texel, with the workspace's own
/// bias, where the paper draws a random bias. As in the paper the places are jittered strata
/// (section 3.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pcf {
    /// Half the side of the square, in texels.
    pub radius: f32,
    /// Number of places compared.
    pub samples: u32,
}

impl Default for Pcf {
    /// The classic kernel of about four by four texels, with 16 samples as the paper's figure 7.
    fn default() -> Self {
        Pcf { radius: 2.0, samples: 16 }
    }
}

impl Pcf {
    /// The lit fraction of the places around `point`, in \[0, 1\]. What lies outside the map is
    /// lit. `receiver` is any number that differs between receivers: it chooses the jitter.
    #[must_use]
    pub fn visibility(
        &self,
        map: &DepthMap<'_>,
        point: &LightPoint,
        bias: Bias,
        receiver: u32,
    ) -> f32 {
        let samples = Samples::Jittered { count: self.samples, seed: 0 };
        let taps = sampling::unit_square(samples, receiver);
        let place = |[x, y]: [f32; 2]| [2.0 * x - 1.0, 2.0 * y - 1.0];
        lit_fraction(map, point, bias, self.radius, taps.map(place))
    }
}

/// The fraction of `taps`, given in units of `radius` texels, that nothing blocks.
pub(crate) fn lit_fraction(
    map: &DepthMap<'_>,
    point: &LightPoint,
    bias: Bias,
    radius: f32,
    taps: impl ExactSizeIterator<Item = [f32; 2]>,
) -> f32 {
    let count = taps.len() as f32;
    let blocked = taps.filter(|tap| blocker(map, point, bias, radius, *tap).is_some()).count();
    1.0 - blocked as f32 / count
}

/// The nearness of the texel under a tap, if it blocks the receiver's plane there.
pub(crate) fn blocker(
    map: &DepthMap<'_>,
    point: &LightPoint,
    bias: Bias,
    radius: f32,
    [x, y]: [f32; 2],
) -> Option<f32> {
    let (u, v) = (point.u + radius * x, point.v + radius * y);
    // Written so that NaN falls outside.
    let inside = u >= 0.0 && v >= 0.0 && u < map.width() as f32 && v < map.height() as f32;
    if !inside {
        return None;
    }
    let (s, t) = (u as u32, v as u32);
    let nearness = map.nearness()[t as usize * map.width() as usize + s as usize];
    let plane = point.plane_at(s as f32 + 0.5, t as f32 + 0.5);
    (nearness > plane + bias.offset(point)).then_some(nearness)
}
