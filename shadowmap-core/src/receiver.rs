//! Receivers as a light's map sees them, and the hard shadow test.

use glam::{Vec2, Vec3};

use crate::{Bias, DepthMap, Plane, View};

/// A receiver in a light's texel space: where it lies in the map, and its tangent plane there.
///
/// Nearness is affine in the image for every plane, so the plane is two numbers: at texel
/// coordinates (s, t) the receiver's plane has the nearness
/// `nearness + slope.x * (s - u) + slope.y * (t - v)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// Texel coordinate along a row.
    pub u: f32,
    /// Texel coordinate down the map.
    pub v: f32,
    /// Nearness of the receiver.
    pub nearness: f32,
    /// Change of the plane's nearness per texel along u and v.
    pub slope: Vec2,
}

impl LightPoint {
    /// A receiver whose plane is parallel to the image: the constant layer of Brabec and Seidel
    /// 2002, section 3.2.
    #[must_use]
    pub fn flat(u: f32, v: f32, nearness: f32) -> LightPoint {
        LightPoint { u, v, nearness, slope: Vec2::ZERO }
    }

    /// Nearness of the receiver's plane at texel coordinates (s, t).
    #[must_use]
    pub fn plane_at(&self, s: f32, t: f32) -> f32 {
        self.nearness + (self.slope.x * (s - self.u) + self.slope.y * (t - self.v))
    }
}

impl View {
    /// The receiver at `position` with geometric unit `normal` (either side), in this view's
    /// texel space. `None` behind the viewer. A plane seen edge-on, or a zero normal, counts as
    /// flat.
    #[must_use]
    pub fn light_point(&self, position: Vec3, normal: Vec3) -> Option<LightPoint> {
        let seen = self.texel_from_world(position)?;
        let slope = Plane::through(position, normal).slope_in(self);
        Some(LightPoint { u: seen.x, v: seen.y, nearness: seen.z, slope })
    }
}

/// What one look into a depth map says of a receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HardShadow {
    /// The light's centre is seen.
    Lit,
    /// Something is nearer to the light.
    Blocked,
    /// The receiver projects outside the map, which knows nothing of it. It counts as lit.
    Outside,
}

/// The classic shadow-map test (Williams 1978): compares the texel that `point` falls on with
/// the receiver's plane at that texel's centre. A NaN in the map never blocks.
#[must_use]
pub fn hard_shadow(map: &DepthMap<'_>, point: &LightPoint, bias: Bias) -> HardShadow {
    let (width, height) = (map.width(), map.height());
    // Written so that NaN falls outside.
    let inside =
        point.u >= 0.0 && point.v >= 0.0 && point.u < width as f32 && point.v < height as f32;
    if !inside {
        return HardShadow::Outside;
    }
    let (x, y) = (point.u as u32, point.v as u32);
    let nearness = map.nearness()[y as usize * width as usize + x as usize];
    if nearness > point.plane_at(x as f32 + 0.5, y as f32 + 0.5) + bias.offset(point) {
        HardShadow::Blocked
    } else {
        HardShadow::Lit
    }
}
