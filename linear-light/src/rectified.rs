//! The frusta of a linear light, fitted to what blocks it and to what is looked at.

use alloc::vec::Vec;

use glam::{DVec2, Vec3};
use shadowmap_core::{ImagePoint, Spread, Window, fit_extents};

use crate::views::{Frame, SampleViews};

/// The widest tangent along the light that a fitted window takes in, 76 degrees to either side.
/// What lies beyond, close to the light's own line, falls outside every map.
pub const MAX_TANGENT: f64 = 4.0;

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
/// A receiver belongs to exactly one frustum ([`RectifiedLight::frustum_of`]); which one depends
/// on its angle around the axis alone, and so all that can block it from the light is in the
/// same frustum.
///
/// **The end caps.** Views perpendicular to the light cannot see along it. Windows reach as far
/// as the scene does, but at most [`MAX_TANGENT`] to either side, so that what remains unseen is
/// a cone of 14 degrees around the light's line beyond either end. Receivers in there fall outside
/// the maps and count as lit, as everywhere outside a light's frustum. They see the light nearly
/// end-on, where it gives a diffuse surface little light.
#[derive(Clone, Debug, PartialEq)]
pub struct RectifiedLight {
    frusta: Vec<SampleViews>,
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
        let points = blockers.clone().chain(receivers.clone());
        let across = |p: Vec3| Some(axis.across(p)).filter(|p| p.length_squared() > 0.0);
        let views = |forward: DVec2, window: Window, near: f64| {
            let towards = axis.down * forward.x + axis.forward * forward.y;
            SampleViews::new(a, b, samples, towards.as_vec3(), window, size, near as f32)
        };
        // The far end of the scene scales what must not be zero.
        let reach = points.clone().map(|p| axis.across(p).length()).fold(0.0, f64::max).max(1e-6);
        // A shadow stays in its blocker's plane through the light: either set will do.
        let wedge = Wedge::around(blockers.clone().filter_map(across))
            .narrower(Wedge::around(receivers.clone().filter_map(across)));
        let frusta = match wedge {
            Wedge::Within(lo, hi) if lo.dot(hi) >= -0.5 => {
                let forward = lo + hi;
                let frame = axis.turned(forward);
                let (window, near) = fitted_window(&frame, b, blockers, receivers, reach, size);
                alloc::vec![views(forward, window, near)]
            }
            Wedge::Within(lo, hi) => {
                let middle = (lo + hi).try_normalize().unwrap_or(-lo.perp());
                // Half of each face's angle: a quarter of the wedge.
                let face = (hi + middle).normalize();
                let tangent = face.perp_dot(hi).abs() / face.dot(hi);
                let frame = axis.turned(middle);
                let depth = points.clone().map(|p| frame.depth(p)).fold(f64::INFINITY, f64::min);
                // Nothing in a face is nearer than 0.7 of what the middle direction says.
                let nearest = (depth * 0.7).max(reach * 1e-3);
                let [left, right] = along_range(&axis, [a, b], points, nearest);
                let window = with_margin([left, -tangent, right, tangent], size);
                alloc::vec![
                    views(lo + middle, window, nearest),
                    views(middle + hi, window, nearest)
                ]
            }
            Wedge::Around => {
                let nearest = reach * 1e-3;
                let [left, right] = along_range(&axis, [a, b], points, nearest);
                let window = with_margin([left, -1.0, right, 1.0], size);
                [DVec2::Y, DVec2::X, DVec2::NEG_Y, DVec2::NEG_X]
                    .map(|forward| views(forward, window, nearest))
                    .into()
            }
        };
        RectifiedLight { frusta }
    }

    /// A light with one frustum of your own.
    #[must_use]
    pub fn from_frustum(views: SampleViews) -> RectifiedLight {
        RectifiedLight { frusta: alloc::vec![views] }
    }

    /// The frusta around the light, at least one.
    #[must_use]
    pub fn frusta(&self) -> &[SampleViews] {
        &self.frusta
    }

    /// Whether one frustum holds all that it was fitted to, nothing cut at [`MAX_TANGENT`].
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let widest = MAX_TANGENT as f32;
        let whole = |window: Window| window.left > -widest && window.right < widest;
        matches!(&self.frusta[..], [frustum] if whole(frustum.window()))
    }

    /// The frustum that a receiver belongs to: the one whose view axis is nearest to it. The
    /// receiver may still fall outside that frustum's window, and is then lit.
    #[must_use]
    pub fn frustum_of(&self, position: Vec3) -> usize {
        let mut best = (0, f32::NEG_INFINITY);
        for (index, frustum) in self.frusta.iter().enumerate() {
            let depth = frustum.depth_of(position);
            if depth > best.1 {
                best = (index, depth);
            }
        }
        best.0
    }

    /// The same frusta with another number of samples.
    ///
    /// # Panics
    ///
    /// If `samples` is less than 2.
    #[must_use]
    pub fn with_samples(&self, samples: usize) -> RectifiedLight {
        RectifiedLight { frusta: self.frusta.iter().map(|f| f.with_samples(samples)).collect() }
    }
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

/// The window that takes in, from both ends of the light, where `blockers` can throw a shadow and
/// what throws it onto `receivers`; and a depth nearer than all of them.
fn fitted_window(
    frame: &Frame,
    end: Vec3,
    mut blockers: impl Iterator<Item = Vec3>,
    mut receivers: impl Iterator<Item = Vec3>,
    reach: f64,
    size: [u32; 2],
) -> (Window, f64) {
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
    let Some(extents) = fit_extents(blockers, receivers, spread) else {
        return (with_margin([-1.0, -1.0, 1.0, 1.0], size), nearest);
    };
    let [left, top, right, bottom] = extents;
    let [left, right] = [left.max(-MAX_TANGENT), right.min(MAX_TANGENT)];
    // A hair nearer than the nearest vertex, which rounding must not clip.
    (with_margin([left, top, right, bottom], size), 0.999 / most)
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
    [(least / nearest).max(-MAX_TANGENT), (most / nearest).min(MAX_TANGENT)]
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
