//! From a camera's pixel to what its search needs.

use super::geometry::Geometry;
use crate::disc::disc_fraction;
use crate::math::sqrt;

/// A receiver in the light's texel space, with the light's disc as it sees it.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct Receiver {
    pub u: f32,
    pub v: f32,
    pub nearness: f32,
    /// The receiver's plane. A texel with centre (s, t) and nearness n is above it if
    /// `hn * n > (above - hv * t) - hu * s`. hn is negative for a receiver that has the light's
    /// centre below its horizon.
    pub hu: f32,
    pub hv: f32,
    pub hn: f32,
    pub above: f32,
    /// The fraction of the disc above the receiver's plane; 0 if the camera sees nothing.
    pub sky: f32,
}

/// Far outside of every map.
const NOWHERE: f32 = -1e9;

/// The plane of a surface with this normal through the camera's point (x, y, n).
#[inline(always)]
pub(crate) fn plane(g: &Geometry, x: f32, y: f32, n: f32, normal: [f32; 3]) -> [f32; 4] {
    let at = |r: &[f32; 4]| ((r[0] * x + r[1] * y) + r[2] * n) + r[3];
    let [px, py, pz, pw] = [at(&g.world[0]), at(&g.world[1]), at(&g.world[2]), at(&g.world[3])];
    let d = (normal[0] * px + normal[1] * py) + normal[2] * pz;
    [normal[0], normal[1], normal[2], -(d / pw)]
}

/// The camera's point (x, y, n) in the light's texel space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub u: f32,
    pub v: f32,
    pub nearness: f32,
    /// False for what lies behind the light's view or has no finite place.
    pub is_somewhere: bool,
}

impl Place {
    #[inline(always)]
    pub fn of(g: &Geometry, x: f32, y: f32, n: f32) -> Place {
        let at = |r: &[f32; 4]| ((r[0] * x + r[1] * y) + r[2] * n) + r[3];
        let inverse = 1.0 / at(&g.warp[3]);
        let u = at(&g.warp[0]) * inverse;
        let v = at(&g.warp[1]) * inverse;
        let nearness = at(&g.warp[2]) * inverse;
        let is_finite = (u.abs() < -NOWHERE) & (v.abs() < -NOWHERE) & (nearness.abs() < -NOWHERE);
        // False for NaN.
        Place { u, v, nearness, is_somewhere: (inverse > 0.0) & is_finite }
    }
}

/// The receiver at the camera's point (x, y, n) with that plane in world space, of any length.
///
/// Where the camera sees nothing its sky is 0; what lies behind the light's view, or has no finite
/// place, has what its horizon leaves of its sky and is nowhere near any blocker.
#[inline(always)]
pub(crate) fn receiver(g: &Geometry, x: f32, y: f32, n: f32, plane: [f32; 4]) -> Receiver {
    let (receiver, horizon) = receiver_and_horizon(g, x, y, n, plane);
    Receiver { sky: horizon.sky(g), ..receiver }
}

/// The receiver as if its horizon did not cut the light's disc, and the horizon.
#[inline(always)]
pub(crate) fn receiver_and_horizon(
    g: &Geometry,
    x: f32,
    y: f32,
    n: f32,
    plane: [f32; 4],
) -> (Receiver, Horizon) {
    let place = Place::of(g, x, y, n);
    let Place { u, v, nearness, is_somewhere } = place;
    let dot =
        |e: &[f32; 4]| ((plane[0] * e[0] + plane[1] * e[1]) + plane[2] * e[2]) + plane[3] * e[3];
    let length = sqrt((plane[0] * plane[0] + plane[1] * plane[1]) + plane[2] * plane[2]);
    let unit = 1.0 / length;
    let scale = if dot(&g.camera_eye) < 0.0 { -unit } else { unit };
    let is_flat = !((scale.abs() > 0.0) & (scale.abs() < f32::INFINITY));
    // Of all lanes: what only some of them load is gathered.
    let [hu, hv, hn] = [dot(&g.axes[0]) * scale, dot(&g.axes[1]) * scale, dot(&g.axes[2]) * scale];
    let hu = if is_flat { 0.0 } else { hu };
    let hv = if is_flat { 0.0 } else { hv };
    let hn = if is_flat { 1.0 } else { hn };
    let tolerance = g.bias.constant * (hn.abs() * nearness) + g.bias.slope * (hu.abs() + hv.abs());
    let above = tolerance + (hn * nearness + (hu * u + hv * v));

    let height = dot(&g.light_eye) * scale;
    let horizon = Horizon { place, height, is_flat, is_seen: n > 0.0 };
    let receiver = Receiver {
        u: if is_somewhere { u } else { NOWHERE },
        v: if is_somewhere { v } else { NOWHERE },
        nearness: if is_somewhere { nearness } else { -NOWHERE },
        hu,
        hv,
        hn,
        above,
        sky: horizon.uncut_sky(),
    };
    (receiver, horizon)
}

/// What a receiver's sky follows from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Horizon {
    /// The receiver's place, wherever it is.
    place: Place,
    /// Of the light's centre above the receiver's plane.
    height: f32,
    /// Whether there is no such plane.
    is_flat: bool,
    /// Whether the camera sees something.
    is_seen: bool,
}

impl Horizon {
    /// Whether it may cut the light's disc. If not, [`Horizon::sky`] is [`Horizon::uncut_sky`].
    #[inline(always)]
    pub fn may_cut(&self, g: &Geometry) -> bool {
        let height = self.height.abs();
        // False for NaN. The disc may look smaller than it is, but not larger.
        let is_apart = (height >= g.radius) & (height < f32::INFINITY);
        !is_apart & !self.is_flat & self.is_seen
    }

    /// The fraction of the disc above a horizon that does not cut it.
    #[inline(always)]
    fn uncut_sky(&self) -> f32 {
        let is_below = (self.height < 0.0) & !self.is_flat;
        if self.is_seen & !is_below { 1.0 } else { 0.0 }
    }

    /// The fraction of the disc above the horizon; 0 if the camera sees nothing.
    #[inline(always)]
    pub fn sky(&self, g: &Geometry) -> f32 {
        let Horizon { place: Place { u, v, nearness, .. }, height, is_flat, is_seen } = *self;
        // The direction from the light, and the horizon in units of the disc's radius.
        let tx = (u - g.center[0]) * g.tangent[0];
        let ty = (v - g.center[1]) * g.tangent[1];
        let squared = 1.0 + (tx * tx + ty * ty);
        let depth = if g.perspective { g.unit / nearness } else { 1.0 };
        let sine = height / (depth * sqrt(squared));
        let cosine = sqrt(if sine * sine < 1.0 { 1.0 - sine * sine } else { 0.0 });
        let sky = disc_fraction(height / (g.radius * cosine));
        let sky = if is_flat { 1.0 } else { sky };
        if is_seen { sky } else { 0.0 }
    }
}

impl Receiver {
    /// Whether a texel with centre (s, t) blocks part of what this receiver could see.
    #[inline(always)]
    pub fn is_blocked_by(&self, s: f32, t: f32, nearness: f32) -> bool {
        self.hn * nearness > (self.above - self.hv * t) - self.hu * s && nearness > self.nearness
    }
}

/// What an integral over the disc needs of a receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub u: f32,
    pub v: f32,
    pub nearness: f32,
    /// Blockers count as nearer by at least this.
    pub least: f32,
    /// The disc's greatest radius in texels, per nearness above the receiver's.
    pub reach: f32,
    /// Offsets (x, y) in texels times nearness above the receiver's are those in the disc:
    /// (xx x + xy y, yy y) in radii.
    pub xx: f32,
    pub xy: f32,
    pub yy: f32,
    /// xx times yy.
    pub area: f32,
}

impl Seen {
    /// The disc faces the receiver, not the map: its image is stretched by the tangents of the
    /// direction it is seen in.
    #[inline(always)]
    pub fn of(g: &Geometry, r: &Receiver) -> Seen {
        let tx = (r.u - g.center[0]) * g.tangent[0];
        let ty = (r.v - g.center[1]) * g.tangent[1];
        let across = 1.0 + ty * ty;
        let squared = across + tx * tx;
        let (root, stretch) = (sqrt(across), sqrt(squared));
        let xx = root / (stretch * g.spread[0]);
        let yy = 1.0 / (root * g.spread[1]);
        Seen {
            u: r.u,
            v: r.v,
            nearness: r.nearness,
            least: r.nearness.abs() * (1.0 / 16384.0),
            reach: g.spread[0].max(g.spread[1]) * stretch,
            xx,
            xy: -(tx * ty) / ((stretch * root) * g.spread[1]),
            yy,
            area: xx * yy,
        }
    }

    /// The disc's greatest radius in texels at a blocker of this nearness; infinite if that is.
    #[inline(always)]
    pub fn disc(&self, nearness: f32) -> f32 {
        // A point light has no disc: its radius times infinity is no number.
        let is_clear = nearness == f32::INFINITY;
        if is_clear { nearness } else { self.reach * (nearness - self.nearness) }
    }

    /// Whether what lies (dx, dy) texels away may hide part of the disc, with a nearness that is
    /// greater than the receiver's by `nearer`, or would if it were `around` texels closer.
    #[inline(always)]
    pub fn reaches(&self, dx: f32, dy: f32, nearer: f32, around: f32) -> bool {
        // A texel is ample room for rounding.
        self.is_around(dx, dy, nearer, around + 1.0)
    }

    /// Whether it is no more than so many texels away from the disc.
    #[inline(always)]
    pub fn is_around(&self, dx: f32, dy: f32, nearer: f32, texels: f32) -> bool {
        let reach = self.reach * if nearer > self.least { nearer } else { self.least } + texels;
        dx * dx + dy * dy <= reach * reach
    }
}
