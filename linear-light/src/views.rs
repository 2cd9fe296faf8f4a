//! Rectified sample views: all maps of one linear light share an image plane and a window.
//!
//! The x axis of every view runs along the light, the view axis is perpendicular to it, and the
//! off-axis [`Window`] is the same for all. Then a point of nearness n that lies at (u, v) in the
//! first map lies at (u - k * disparity * n, v) in map k: every plane through the light is one
//! row in every map, and the warp of section 3.2 is a shift along it.

use alloc::vec::Vec;

use glam::{DVec2, DVec3, Vec3};
use shadowmap_core::{LightPoint, Plane, View, Window};

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
    /// If this is the frustum beyond one end of the light: receivers on the positive side of both
    /// belong to it, and not to the frustum with the same axes that comes before it.
    beyond: Option<[Plane; 2]>,
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
        let mut rectified = SampleViews {
            views: Vec::new(),
            a,
            b,
            axes,
            window,
            near,
            disparity: 0.0,
            beyond: None,
        };
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
        self.trial_view(t, [self.views[0].width(), self.views[0].height()])
    }

    /// [`SampleViews::view_at`] for a map of another size, which sees the same with other texels.
    #[must_use]
    pub fn trial_view(&self, t: f32, [width, height]: [u32; 2]) -> View {
        self.view(self.a + (self.b - self.a) * t, width, height)
    }

    /// The same as the frustum beyond an end of the light, see `beyond`.
    pub(crate) fn beyond_end(self, planes: [Plane; 2]) -> SampleViews {
        SampleViews { beyond: Some(planes), ..self }
    }

    pub(crate) fn beyond(&self) -> Option<[Plane; 2]> {
        self.beyond
    }

    /// Distance of a position from the light's line along the view axis, in metres, and whether it
    /// lies beyond the end of the light that this is the frustum of: for [`choose`].
    pub(crate) fn rank(&self, position: Vec3) -> (f32, bool) {
        let depth = self.axes[2].dot(position - self.a);
        let p = position.extend(1.0).to_array();
        let is_beyond = |planes: [Plane; 2]| planes.iter().all(|plane| plane.side_of(p) > 0.0);
        (depth, self.beyond.is_some_and(is_beyond))
    }

    /// The same frustum with another number of samples.
    ///
    /// # Panics
    ///
    /// If `samples` is less than 2.
    #[must_use]
    pub fn with_samples(&self, samples: usize) -> SampleViews {
        let size = [self.views[0].width(), self.views[0].height()];
        let views =
            SampleViews::new(self.a, self.b, samples, self.axes[2], self.window, size, self.near);
        SampleViews { beyond: self.beyond, ..views }
    }

    fn view(&self, eye: Vec3, width: u32, height: u32) -> View {
        View::perspective_rectified(self.a, eye, self.axes, self.window, width, height, self.near)
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
    /// Whether the window ends at [`crate::MAX_TANGENT`] along the light or beyond it: there a
    /// fitted one is cut, and what blocks may lie beside it.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.widest() >= crate::MAX_TANGENT
    }
    /// The tangent of the direction along the light that is farthest out in the window.
    pub(crate) fn widest(&self) -> f64 {
        f64::from(self.window.right.max(-self.window.left))
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

/// The frustum that a receiver belongs to, from what [`SampleViews::rank`] says of each: the one
/// whose view axis is nearest to it, and of those with the same axes the one beyond the light's end
/// if the receiver lies there.
pub(crate) fn choose(ranks: impl Iterator<Item = (f32, bool)>) -> usize {
    let mut best = (0, f32::NEG_INFINITY);
    for (index, (depth, is_beyond)) in ranks.enumerate() {
        if depth > best.1 || (depth == best.1 && is_beyond) {
            best = (index, depth);
        }
    }
    best.0
}

/// Right (along the light), down and forward, in double precision, around the light's first end.
pub(crate) struct Frame {
    pub origin: DVec3,
    pub right: DVec3,
    pub down: DVec3,
    pub forward: DVec3,
}

impl Frame {
    pub fn new(a: Vec3, b: Vec3, towards: Vec3) -> Frame {
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
    pub fn across(&self, p: Vec3) -> DVec2 {
        let p = p.as_dvec3() - self.origin;
        DVec2::new(p.dot(self.down), p.dot(self.forward))
    }
    pub fn depth(&self, p: Vec3) -> f64 {
        (p.as_dvec3() - self.origin).dot(self.forward)
    }
    pub fn along(&self, p: Vec3) -> f64 {
        (p.as_dvec3() - self.origin).dot(self.right)
    }
    /// This frame, looking along `forward` = (down, forward).
    pub fn turned(&self, forward: DVec2) -> Frame {
        let forward = (self.down * forward.x + self.forward * forward.y).normalize_or(self.forward);
        Frame { down: forward.cross(self.right), forward, ..*self }
    }
}
