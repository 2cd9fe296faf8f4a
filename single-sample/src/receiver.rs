//! From a camera's pixel to a receiver in the light's texel space.

use glam::{DVec4, Vec2, Vec3};
use shadowmap_core::{LightPoint, View};

use crate::{Camera, Surface, Surfaces};

/// Camera texel space to light texel space, in one affine map.
///
/// Both views are projective maps of the world, so their composition takes a pixel (x, y, n) to
/// the light's homogeneous (U, V, N, Q), each affine in x, y and n: no position in the world is
/// ever needed. Composed in double precision and rounded once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Warp {
    /// Each over (x, y, n, 1).
    rows: [[f32; 4]; 4],
}

impl Warp {
    pub fn new(camera: &View, light: &View) -> Warp {
        let world = camera.inverse_rows().map(|row| DVec4::from_array(row.map(f64::from)));
        let rows = light.rows().map(|row| {
            let [x, y, z, w] = row.map(f64::from);
            let sum = world[0] * x + world[1] * y + world[2] * z + world[3] * w;
            sum.to_array().map(|value| value as f32)
        });
        Warp { rows }
    }

    /// The light's (u, v, nearness) of the camera's point (x, y, n); `None` behind the light, or
    /// where it is not finite.
    pub fn at(&self, x: f32, y: f32, n: f32) -> Option<Vec3> {
        let [u, v, n, q] = self.rows.map(|r| ((r[0] * x + r[1] * y) + r[2] * n) + r[3]);
        let seen = Vec3::new(u / q, v / q, n / q);
        (q > 0.0 && seen.is_finite()).then_some(seen)
    }
}

/// A plane in world space as a homogeneous row: points with `plane . (x, y, z, 1) = 0`.
pub(crate) type Plane = [f32; 4];

/// One pixel's receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    /// Where it lies in the light's map; `None` behind the light.
    pub point: Option<LightPoint>,
    /// Object ID.
    pub id: u32,
    /// Whether the camera and the centre of the light are on different sides of the surface.
    pub turned_away: bool,
}

impl Camera<'_> {
    /// The surface and the tangent plane of pixel (x, y), whose nearness is positive.
    fn plane(&self, x: u32, y: u32, nearness: f32) -> (u32, Plane) {
        let surface = match self.surfaces() {
            Surfaces::FromDepth => {
                return (self.map().id(x, y), self.plane_from_depth(x, y, nearness));
            }
            Surfaces::Normals(normals) => {
                let index = y as usize * self.map().width() as usize + x as usize;
                Surface { normal: normals[index], id: self.map().id(x, y) }
            }
            Surfaces::Table(table) => {
                let index = self.map().id(x, y) as usize;
                table.get(index).copied().unwrap_or(Surface::UNKNOWN)
            }
        };
        let n = surface.normal;
        let position = self.view().world_from_texel(x as f32 + 0.5, y as f32 + 0.5, nearness);
        (surface.id, [n.x, n.y, n.z, -n.dot(position)])
    }

    /// The plane through a pixel and its neighbours: nearness is affine in the image on every
    /// plane, and of the two differences along each axis the smaller one stays on the surface.
    fn plane_from_depth(&self, x: u32, y: u32, nearness: f32) -> Plane {
        let (width, height) = (self.map().width(), self.map().height());
        let at = |x: u32, y: u32| self.map().nearness()[y as usize * width as usize + x as usize];
        let smaller = |before: Option<f32>, after: Option<f32>| {
            let before = before.map_or(f32::INFINITY, |n| nearness - n);
            let after = after.map_or(f32::INFINITY, |n| n - nearness);
            let slope = if after.abs() < before.abs() { after } else { before };
            if slope.is_finite() { slope } else { 0.0 }
        };
        let dx = smaller(
            (x > 0).then(|| at(x.wrapping_sub(1), y)),
            (x + 1 < width).then(|| at((x + 1).min(width - 1), y)),
        );
        let dy = smaller(
            (y > 0).then(|| at(x, y.wrapping_sub(1))),
            (y + 1 < height).then(|| at(x, (y + 1).min(height - 1))),
        );
        // dx u + dy v - n + e = 0 in the camera's texel space, pulled back to the world.
        let e = nearness - (dx * (x as f32 + 0.5) + dy * (y as f32 + 0.5));
        let [u, v, n, q] = self.view().rows();
        core::array::from_fn(|i| ((dx * u[i] + dy * v[i]) - n[i]) + e * q[i])
    }

    /// The receiver of pixel (x, y) as the light's view sees it. `None` where the camera sees
    /// nothing.
    pub(crate) fn receiver(&self, x: u32, y: u32, warp: &Warp, light: &View) -> Option<Receiver> {
        let nearness = self.map().nearness()[y as usize * self.map().width() as usize + x as usize];
        if nearness.is_nan() || nearness <= 0.0 {
            return None;
        }
        let (id, plane) = self.plane(x, y, nearness);
        let point = warp.at(x as f32 + 0.5, y as f32 + 0.5, nearness).map(|seen| LightPoint {
            u: seen.x,
            v: seen.y,
            nearness: seen.z,
            slope: slope_in(light, &plane),
        });
        let sides = side_of(&plane, self.view().eye()) * side_of(&plane, light.eye());
        Some(Receiver { point, id, turned_away: sides < 0.0 })
    }
}

/// Distance of a homogeneous point from a plane, times positive factors.
fn side_of(plane: &Plane, [x, y, z, w]: [f32; 4]) -> f32 {
    ((plane[0] * x + plane[1] * y) + plane[2] * z) + plane[3] * w
}

/// The change of a plane's nearness per texel in a view; zero for a plane seen edge-on.
fn slope_in(view: &View, plane: &Plane) -> Vec2 {
    let [x, y, z, w] = view.inverse_rows();
    let pull = |i: usize| ((plane[0] * x[i] + plane[1] * y[i]) + plane[2] * z[i]) + plane[3] * w[i];
    let c = pull(2);
    let slope = Vec2::new(-pull(0) / c, -pull(1) / c);
    if slope.is_finite() { slope } else { Vec2::ZERO }
}
