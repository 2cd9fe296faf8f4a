//! Rectified sample views: all maps of one linear light share an image plane and a window.
//!
//! The x axis of every view runs along the light, the view axis is perpendicular to it, and the
//! off-axis [`Window`] is the same for all. Then a point of nearness n that lies at (u, v) in the
//! first map lies at (u - k * disparity * n, v) in map k: every plane through the light is one
//! row in every map, and the warp of section 3.2 is a shift along it.

use alloc::vec::Vec;

use glam::{DVec2, DVec3, Vec3};
use shadowmap_core::{ImagePoint, LightPoint, Spread, View, Window, fit_extents};

/// The widest tangent along the light that a fitted window takes in, 76 degrees to either side.
/// What lies beyond, close to the light's own line, falls outside every map.
pub const MAX_TANGENT: f64 = 4.0;

/// Texels left free around a fitted window, for rounding.
const MARGIN: f64 = 1.0 / 32.0;

/// The rectified views of one frustum: `len()` samples at equal steps from end to end of the
/// light.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleViews {
    views: Vec<View>,
    a: Vec3,
    b: Vec3,
    axes: [Vec3; 3],
    window: Window,
    near: f32,
    disparity: f32,
}

impl SampleViews {
    /// Views of the light from `a` to `b` through a window of your own, in tangents. `towards` is
    /// any direction towards the scene; its part along the light is dropped. Geometry nearer
    /// than `near` metres (along the view axis) is not seen.
    ///
    /// # Panics
    ///
    /// If `samples` is less than 2.
    #[must_use]
    pub fn new(
        a: Vec3,
        b: Vec3,
        samples: usize,
        towards: Vec3,
        window: Window,
        [width, height]: [u32; 2],
        near: f32,
    ) -> SampleViews {
        assert!(samples >= 2, "a linear light needs a sample at either end");
        let axes = Frame::new(a, b, towards).axes();
        let mut rectified =
            SampleViews { views: Vec::new(), a, b, axes, window, near, disparity: 0.0 };
        let first = rectified.view(a, width, height);
        let step = a.as_dvec3().distance(b.as_dvec3()) / (samples - 1) as f64;
        rectified.disparity = (f64::from(first.focal().x) * step) as f32;
        rectified.views = (0..samples)
            .map(|k| rectified.view(rectified.position(k, samples), width, height))
            .collect();
        rectified
    }

    /// The view from parameter `t` of the light, 0 at its first end and 1 at its last, with the
    /// image plane and the window of all others: where a sample between two others would be.
    #[must_use]
    pub fn view_at(&self, t: f32) -> View {
        let position = self.a + (self.b - self.a) * t;
        self.view(position, self.views[0].width(), self.views[0].height())
    }

    /// [`SampleViews::view_at`] for a map of another size, which sees the same with other texels.
    #[must_use]
    pub fn trial_view(&self, t: f32, [width, height]: [u32; 2]) -> View {
        self.view(self.a + (self.b - self.a) * t, width, height)
    }

    /// The same frustum with another number of samples.
    ///
    /// # Panics
    ///
    /// If `samples` is less than 2.
    #[must_use]
    pub fn with_samples(&self, samples: usize) -> SampleViews {
        let size = [self.views[0].width(), self.views[0].height()];
        SampleViews::new(self.a, self.b, samples, self.axes[2], self.window, size, self.near)
    }

    fn view(&self, eye: Vec3, width: u32, height: u32) -> View {
        View::perspective_window(eye, self.axes, self.window, width, height, self.near)
    }

    fn position(&self, k: usize, samples: usize) -> Vec3 {
        // Exact at both ends.
        if k + 1 == samples {
            self.b
        } else {
            self.a + (self.b - self.a) * (k as f32 / (samples - 1) as f32)
        }
    }

    /// One view per sample, from the light's first end to its last.
    #[must_use]
    pub fn views(&self) -> &[View] {
        &self.views
    }
    /// The ends of the light.
    #[must_use]
    pub fn ends(&self) -> [Vec3; 2] {
        [self.a, self.b]
    }
    /// The window that all views share, in tangents.
    #[must_use]
    pub fn window(&self) -> Window {
        self.window
    }
    /// Texels that a point of nearness 1 moves along its row, to the left, from one sample's map
    /// to the next.
    #[must_use]
    pub fn disparity(&self) -> f32 {
        self.disparity
    }

    /// The receiver at `position` with geometric unit `normal` in the first sample's map; `None`
    /// behind the light. [`SampleViews::in_sample`] carries it to the others.
    #[must_use]
    pub fn light_point(&self, position: Vec3, normal: Vec3) -> Option<LightPoint> {
        self.views[0].light_point(position, normal)
    }

    /// A receiver of the first sample's map in the map of sample `k`: the column moves by the
    /// disparity, row and nearness stay, and the plane is sheared. A plane that sample `k` sees
    /// edge-on counts as flat.
    #[must_use]
    pub fn in_sample(&self, point: &LightPoint, k: usize) -> LightPoint {
        let shift = self.disparity * k as f32;
        // n = sx u0 + .. with u0 = uk + shift n, solved for n.
        let shear = 1.0 - point.slope.x * shift;
        let slope = point.slope / shear;
        LightPoint {
            u: point.u - shift * point.nearness,
            slope: if slope.is_finite() { slope } else { glam::Vec2::ZERO },
            ..*point
        }
    }
}

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
            let depth = frustum.axes[2].dot(position - frustum.a);
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

/// Right (along the light), down and forward, in double precision, around the light's first end.
struct Frame {
    origin: DVec3,
    right: DVec3,
    down: DVec3,
    forward: DVec3,
}

impl Frame {
    fn new(a: Vec3, b: Vec3, towards: Vec3) -> Frame {
        let (origin, towards) = (a.as_dvec3(), towards.as_dvec3());
        let right = (b.as_dvec3() - origin).normalize_or(DVec3::X);
        let flat = towards - right * towards.dot(right);
        let forward = if flat.length_squared() > 1e-12 * towards.length_squared() {
            flat.normalize()
        } else {
            right.any_orthonormal_vector()
        };
        Frame { origin, right, down: forward.cross(right), forward }
    }
    fn axes(&self) -> [Vec3; 3] {
        [self.right, self.down, self.forward].map(|axis| axis.as_vec3())
    }
    /// Where a point lies in the plane across the light, as (down, forward).
    fn across(&self, p: Vec3) -> DVec2 {
        let p = p.as_dvec3() - self.origin;
        DVec2::new(p.dot(self.down), p.dot(self.forward))
    }
    fn depth(&self, p: Vec3) -> f64 {
        (p.as_dvec3() - self.origin).dot(self.forward)
    }
    fn along(&self, p: Vec3) -> f64 {
        (p.as_dvec3() - self.origin).dot(self.right)
    }
    /// This frame, looking along `forward` = (down, forward).
    fn turned(&self, forward: DVec2) -> Frame {
        let forward = (self.down * forward.x + self.forward * forward.y).normalize_or(self.forward);
        Frame { down: forward.cross(self.right), forward, ..*self }
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
