//! Planes in world space, and the warp from a camera's image to a light's.

use glam::{DVec4, Vec2, Vec3};

use crate::View;

/// A plane in world space as a homogeneous row: points with `plane . (x, y, z, 1) = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane(pub [f32; 4]);

impl Plane {
    /// The plane through `position` with this `normal`, of any length.
    #[must_use]
    pub fn through(position: Vec3, normal: Vec3) -> Plane {
        Plane([normal.x, normal.y, normal.z, -normal.dot(position)])
    }

    /// Distance of a homogeneous point from the plane, times positive factors: the sign says on
    /// which side the point lies.
    #[must_use]
    pub fn side_of(&self, [x, y, z, w]: [f32; 4]) -> f32 {
        let p = self.0;
        ((p[0] * x + p[1] * y) + p[2] * z) + p[3] * w
    }

    /// The change of the plane's nearness per texel of a view, along u and v; zero for a plane
    /// seen edge-on.
    #[must_use]
    pub fn slope_in(&self, view: &View) -> Vec2 {
        // The row pulled back to texel space: a u + b v + c n + e = 0, so n falls by a / c per
        // texel of u.
        let p = self.0;
        let [x, y, z, w] = view.inverse_rows();
        let pull = |i: usize| ((p[0] * x[i] + p[1] * y[i]) + p[2] * z[i]) + p[3] * w[i];
        let c = pull(2);
        let slope = Vec2::new(-pull(0) / c, -pull(1) / c);
        if slope.is_finite() { slope } else { Vec2::ZERO }
    }
}

/// Camera texel space to light texel space, in one affine map.
///
/// Both views are projective maps of the world, so their composition takes a pixel (x, y, n) to
/// the light's homogeneous (U, V, N, Q), each affine in x, y and n: no position in the world is
/// ever needed. Composed in double precision and rounded once.
#[derive(Clone, Copy, Debug)]
pub struct Warp {
    /// Each over (x, y, n, 1).
    rows: [[f32; 4]; 4],
}

impl Warp {
    /// From the texel space of `camera` to that of `light`.
    #[must_use]
    pub fn new(camera: &View, light: &View) -> Warp {
        let world = camera.inverse_rows().map(|row| DVec4::from_array(row.map(f64::from)));
        let rows = light.rows().map(|row| {
            let [x, y, z, w] = row.map(f64::from);
            let sum = world[0] * x + world[1] * y + world[2] * z + world[3] * w;
            sum.to_array().map(|value| value as f32)
        });
        Warp { rows }
    }

    /// The rows U, V, N, Q of the light, each over (x, y, n, 1) of the camera.
    /// Kernels evaluate a row as `((r[0] * x + r[1] * y) + r[2] * n) + r[3]`.
    #[must_use]
    pub fn rows(&self) -> &[[f32; 4]; 4] {
        &self.rows
    }

    /// The light's (u, v, nearness) of the camera's point (x, y, n); `None` behind the light, or
    /// where it is not finite.
    #[must_use]
    pub fn at(&self, x: f32, y: f32, n: f32) -> Option<Vec3> {
        let [u, v, n, q] = self.rows.map(|r| ((r[0] * x + r[1] * y) + r[2] * n) + r[3]);
        let seen = Vec3::new(u / q, v / q, n / q);
        (q > 0.0 && seen.is_finite()).then_some(seen)
    }

    /// How many texels of the light's map the camera's point (x, y, n) moves by per unit of its
    /// nearness: the disparity of section 3.2 of Heidrich, Brabec and Seidel 2000. Not finite
    /// behind the light.
    #[must_use]
    pub fn disparity(&self, x: f32, y: f32, n: f32) -> f32 {
        let [u, v, _, q] = self.rows;
        let at = |r: [f32; 4]| ((r[0] * x + r[1] * y) + r[2] * n) + r[3];
        let depth = at(q);
        let du = (u[2] - at(u) / depth * q[2]) / depth;
        let dv = (v[2] - at(v) / depth * q[2]) / depth;
        if depth > 0.0 { Vec2::new(du, dv).length() } else { f32::NAN }
    }
}
