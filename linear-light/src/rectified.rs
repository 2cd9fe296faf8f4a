//! The frusta of a linear light, fitted to what blocks it and to what is looked at.

use alloc::vec::Vec;

use glam::{DVec2, DVec3, Vec3};
use shadowmap_core::{Extents, ImagePoint, Plane, Spread, Window, fit_extents};

use crate::views::{Frame, SampleViews, choose};

/// The widest tangent along the light, 76 degrees to either side, that a frustum takes in which
/// stands beside it. Receivers further along the light's line have frusta of their own.
pub const MAX_TANGENT: f64 = 4.0;

/// The frusta beyond an end of the light.
const BEYOND: [Beyond; 2] = [
    Beyond { receivers: 2.0, after: MAX_TANGENT, last: 16.0, fewer_rows: 2 },
    Beyond { receivers: 15.5, after: 16.0, last: LAST_TANGENT, fewer_rows: 8 },
];

struct Beyond {
    /// From which tangent on receivers belong to it. What stands close to the light can hide a part
    /// of it from a receiver and be seen further along the line, hence the difference to `after`.
    receivers: f64,
    /// Where the window before it ends.
    after: f64,
    /// Where its own ends.
    last: f64,
    /// How many times fewer rows its maps have: there the scene is seen so slantwise that rows lie
    /// close to each other.
    fewer_rows: u32,
}

/// The widest tangent of all: a quarter of a degree from the light's line.
pub(crate) const LAST_TANGENT: f64 = 256.0;

/// How far the frusta beyond an end reach back over it, for what stands close to the light.
const BACK: f64 = 2.0;

/// How much closer to the light's line they see: as close as a blocker right at the light's end
/// comes to it.
const NEARER: f64 = 1.0 / 64.0;

/// The most frusta of one light: four around it, with two beyond either end each.
pub const MAX_FRUSTA: usize = 20;

/// Texels left free around a fitted window, for rounding.
const MARGIN: f64 = 1.0 / 32.0;

/// A linear light's rectified views of a whole scene: one frustum if the scene lies to one side
/// of the light, several around its axis if the light stands in it or points into it.
///
/// | the scene, seen along the light's axis | frusta |
/// |---|--:|
/// | spans at most 120 degrees | 1 |
/// | spans at most 180 degrees | 2 |
/// | is all around | 4 |
///
/// **Beyond the ends.** Views perpendicular to the light see little of what lies along its line:
/// windows end at [`MAX_TANGENT`]. If receivers lie beyond, each of these frusta is followed by one
/// or two more for such an end, whose windows begin at the end's own plane and end 3.6 degrees and
/// a quarter of a degree from the light's line, and whose maps have fewer rows. What remains,
/// closer to the line than that, falls outside all maps.
///
/// A receiver belongs to exactly one frustum ([`RectifiedLight::frustum_of`]). All that can block
/// it from the light lies in its own half-plane through the light's line, hence in the same
/// frustum.
#[derive(Clone, Debug, PartialEq)]
pub struct RectifiedLight {
    frusta: Vec<SampleViews>,
    is_complete: bool,
}

impl RectifiedLight {
    /// Frusta of the light from `a` to `b` whose maps of `size` (width, height) texels cover
    /// `points`: the vertices of all blockers and receivers, or the corners of their bounds.
    /// Points that are not finite are passed over. A light without length is seen as a light
    /// along x.
    ///
    /// # Panics
    ///
    /// If `samples` is less than 2.
    #[must_use]
    pub fn fit(
        a: Vec3,
        b: Vec3,
        samples: usize,
        size: [u32; 2],
        points: impl Iterator<Item = Vec3> + Clone,
    ) -> RectifiedLight {
        RectifiedLight::fit_around(a, b, samples, size, points.clone(), points)
    }

    /// [`RectifiedLight::fit`] to what matters alone: maps hold what of `blockers` can throw a
    /// shadow onto `receivers`, at the highest resolution for that. Receivers that fall outside
    /// are lit.
    ///
    /// `blockers` are the vertices of what can stand between the light and something else, and
    /// `receivers` those of what is looked at, cut to what a camera sees of it, say.
    ///
    /// # Panics
    ///
    /// If `samples` is less than 2.
    #[must_use]
    pub fn fit_around(
        a: Vec3,
        b: Vec3,
        samples: usize,
        size: [u32; 2],
        blockers: impl Iterator<Item = Vec3> + Clone,
        receivers: impl Iterator<Item = Vec3> + Clone,
    ) -> RectifiedLight {
        let axis = Frame::new(a, b, Vec3::NEG_Y);
        let blockers = blockers.filter(|p| p.is_finite());
        let receivers = receivers.filter(|p| p.is_finite());
        let faces = faces(&axis, [a, b], blockers, receivers.clone());
        let mut frusta = Vec::new();
        for Face { frame, extents, near } in &faces {
            let towards = frame.forward.as_vec3();
            let views = |extents: Extents, size, near: f64| {
                let window = with_margin(extents, size);
                SampleViews::new(a, b, samples, towards, window, size, near as f32)
            };
            let [left, top, right, bottom] = *extents;
            let cut = [left.max(-MAX_TANGENT), top, right.min(MAX_TANGENT), bottom];
            frusta.push(views(cut, size, *near));
            let may_hold = |plane: &Plane| {
                receivers.clone().any(|p| plane.side_of(p.extend(1.0).to_array()) > 0.0)
            };
            for (sign, reach, ends) in [(-1.0, -left, [b, a]), (1.0, right, [a, b])] {
                for Beyond { receivers, after, last, fewer_rows } in BEYOND {
                    let planes = end_planes(frame, sign, receivers, ends);
                    if reach > after && planes.iter().all(may_hold) {
                        let [x, back] = [sign * reach.min(last), -sign * BACK];
                        let window = [x.min(back), top, x.max(back), bottom];
                        let size = [size[0], size[1].div_ceil(fewer_rows)];
                        frusta.push(views(window, size, near * NEARER).beyond_end(planes));
                    }
                }
            }
        }
        let is_whole = |face: &Face| face.extents.iter().all(|e| e.abs() < LAST_TANGENT);
        RectifiedLight { frusta, is_complete: faces.len() == 1 && is_whole(&faces[0]) }
    }

    /// A light with one frustum of your own.
    #[must_use]
    pub fn from_frustum(views: SampleViews) -> RectifiedLight {
        RectifiedLight { frusta: alloc::vec![views], is_complete: false }
    }

    /// The frusta around the light, from 1 to [`MAX_FRUSTA`].
    #[must_use]
    pub fn frusta(&self) -> &[SampleViews] {
        &self.frusta
    }

    /// Whether the maps hold all that they were fitted to, so that what falls outside of them is
    /// lit indeed.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// The frustum that a receiver belongs to: the one whose view axis is nearest to it, beyond the
    /// light's end if it lies there. The receiver may still fall outside that frustum's window, and
    /// is then lit.
    #[must_use]
    pub fn frustum_of(&self, position: Vec3) -> usize {
        choose(self.frusta.iter().map(|frustum| frustum.rank(position)))
    }

    /// The same frusta with another number of samples.
    ///
    /// # Panics
    ///
    /// If `samples` is less than 2.
    #[must_use]
    pub fn with_samples(&self, samples: usize) -> RectifiedLight {
        let frusta = self.frusta.iter().map(|frustum| frustum.with_samples(samples)).collect();
        RectifiedLight { frusta, is_complete: self.is_complete }
    }
}

/// A direction across the light, and what is to be seen of the scene in it.
struct Face {
    frame: Frame,
    /// In tangents, not yet cut.
    extents: Extents,
    /// Nearer than all that matters, in metres.
    near: f64,
}

/// The faces around the light that hold what matters, with each receiver in one of them.
fn faces(
    axis: &Frame,
    [a, b]: [Vec3; 2],
    blockers: impl Iterator<Item = Vec3> + Clone,
    receivers: impl Iterator<Item = Vec3> + Clone,
) -> Vec<Face> {
    let points = blockers.clone().chain(receivers.clone());
    let across = |p: Vec3| Some(axis.across(p)).filter(|p| p.length_squared() > 0.0);
    // The far end of the scene scales what must not be zero.
    let reach = points.clone().map(|p| axis.across(p).length()).fold(0.0, f64::max).max(1e-6);
    // A shadow stays in its blocker's plane through the light: either set will do.
    let wedge = Wedge::around(blockers.clone().filter_map(across))
        .narrower(Wedge::around(receivers.clone().filter_map(across)));
    match wedge {
        Wedge::Within(lo, hi) if lo.dot(hi) >= -0.5 => {
            let frame = axis.turned(lo + hi);
            let (extents, near) = fitted_extents(&frame, b, blockers, receivers, reach);
            alloc::vec![Face { frame, extents, near }]
        }
        Wedge::Within(lo, hi) => {
            let middle = (lo + hi).try_normalize().unwrap_or(-lo.perp());
            // Half of each face's angle: a quarter of the wedge.
            let face = (hi + middle).normalize();
            let tangent = face.perp_dot(hi).abs() / face.dot(hi);
            let frame = axis.turned(middle);
            let depth = points.clone().map(|p| frame.depth(p)).fold(f64::INFINITY, f64::min);
            // Nothing in a face is nearer than 0.7 of what the middle direction says.
            let near = (depth * 0.7).max(reach * 1e-3);
            let [left, right] = along_range(axis, [a, b], points, near);
            let face = |forward| Face {
                frame: axis.turned(forward),
                extents: [left, -tangent, right, tangent],
                near,
            };
            alloc::vec![face(lo + middle), face(middle + hi)]
        }
        Wedge::Around => {
            let near = reach * 1e-3;
            let [left, right] = along_range(axis, [a, b], points, near);
            let face = |forward| Face {
                frame: axis.turned(forward),
                extents: [left, -1.0, right, 1.0],
                near,
            };
            [DVec2::Y, DVec2::X, DVec2::NEG_Y, DVec2::NEG_X].map(face).into()
        }
    }
}

/// The planes on whose positive sides lies what is beyond the light's near end: past it, and at
/// more than `tangent` along the light as the far end sees it. `sign` is that of the way from the
/// far to the near end along the frame.
fn end_planes(frame: &Frame, sign: f64, tangent: f64, [far, near]: [Vec3; 2]) -> [Plane; 2] {
    let along = frame.right * sign;
    let plane = |normal: DVec3, through: Vec3| {
        let offset = normal.dot(through.as_dvec3());
        Plane(normal.extend(-offset).as_vec4().to_array())
    };
    [plane(along - frame.forward * tangent, far), plane(along, near)]
}

/// The directions that points take around the light's axis.
enum Wedge {
    /// Between two unit vectors less than 180 degrees apart, counter-clockwise.
    Within(DVec2, DVec2),
    /// No half-plane through the axis holds them all.
    Around,
}

impl Wedge {
    fn around(mut points: impl Iterator<Item = DVec2>) -> Wedge {
        let Some(first) = points.next() else { return Wedge::Within(DVec2::Y, DVec2::Y) };
        let (mut lo, mut hi) = (first, first);
        for p in points {
            // While the wedge is below 180 degrees, a point outside can widen it on one side only.
            let (after_lo, before_hi) = (lo.perp_dot(p) >= 0.0, p.perp_dot(hi) >= 0.0);
            match (after_lo, before_hi) {
                (true, true) if lo.dot(p) > 0.0 || hi.dot(p) > 0.0 => {}
                (true, false) => hi = p,
                (false, true) => lo = p,
                _ => return Wedge::Around,
            }
        }
        Wedge::Within(lo.normalize(), hi.normalize())
    }

    fn narrower(self, other: Wedge) -> Wedge {
        match (&self, &other) {
            (Wedge::Within(lo, hi), Wedge::Within(other_lo, other_hi)) => {
                if lo.dot(*hi) >= other_lo.dot(*other_hi) { self } else { other }
            }
            (Wedge::Within(..), Wedge::Around) => self,
            (Wedge::Around, _) => other,
        }
    }
}

/// Where, from both ends of the light, `blockers` can throw a shadow and what throws it onto
/// `receivers` is seen; and a depth nearer than all of them.
fn fitted_extents(
    frame: &Frame,
    end: Vec3,
    mut blockers: impl Iterator<Item = Vec3>,
    mut receivers: impl Iterator<Item = Vec3>,
    reach: f64,
) -> (Extents, f64) {
    let length = frame.along(end);
    let nearest = reach * 1e-3;
    let mut most = 0.0_f64;
    // As the light's middle sees them; `None` if one lies beside or behind the light.
    let mut see = |points: &mut dyn Iterator<Item = Vec3>| {
        let place = |p: Vec3| {
            let z = frame.depth(p);
            most = most.max(1.0 / z.max(nearest));
            let (x, y) = (frame.along(p) - 0.5 * length, frame.across(p).x);
            (z >= nearest).then(|| [x / z, y / z, 1.0 / z])
        };
        points.map(place).collect::<Option<Vec<ImagePoint>>>()
    };
    let sets = [see(&mut blockers), see(&mut receivers)];
    let [blockers, receivers] = sets.each_ref().map(|set| set.as_ref().map(|s| s.iter().copied()));
    let spread = Spread { views: [0.5 * length, 0.0], shadow: [length, 0.0] };
    match fit_extents(blockers, receivers, spread) {
        // A hair nearer than the nearest vertex, which rounding must not clip.
        Some(extents) => (extents, 0.999 / most),
        None => ([-1.0, -1.0, 1.0, 1.0], nearest),
    }
}

/// The tangents along the light at which `points`, no nearer than `nearest`, can appear.
fn along_range(
    frame: &Frame,
    ends: [Vec3; 2],
    points: impl Iterator<Item = Vec3>,
    nearest: f64,
) -> [f64; 2] {
    let length = frame.along(ends[1]);
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for p in points {
        least = least.min(frame.along(p) - length);
        most = most.max(frame.along(p));
    }
    [least / nearest, most / nearest]
}

/// A window with a few texels to spare on every side, and never without extent.
fn with_margin([left, top, right, bottom]: [f64; 4], [width, height]: [u32; 2]) -> Window {
    let widen = |lo: f64, hi: f64, texels: u32| {
        let center = (lo + hi) * 0.5;
        let spare = f64::from(texels) / (f64::from(texels) - 2.0 * MARGIN).max(1.0);
        let half = ((hi - lo) * 0.5).max(1e-3) * spare;
        [(center - half) as f32, (center + half) as f32]
    };
    let ([left, right], [top, bottom]) = (widen(left, right, width), widen(top, bottom, height));
    Window { left, top, right, bottom }
}
