//! What the maps of a light must hold: the triangles that can block it, and those that are seen.

use glam::{DVec3, Vec3};
use shadowmap_core::{Light, View};

use crate::hull::points_around;
use crate::prepared::{Prepared, corners};
use crate::scene::Scene;

/// How many of the largest triangles are tried as backdrops.
const CANDIDATES: usize = 64;

/// How far a point may lie behind a backdrop, of the scene's extent: what rounding leaves.
const TOLERANCE: f64 = 1e-5;

/// Few points instead of many vertices, to fit a light's views around.
#[derive(Clone, Debug)]
pub struct Cover {
    /// Their convex hull holds, closely, all triangles that can hide the light from another one.
    pub blockers: Vec<Vec3>,
    /// Their convex hull holds, closely, all that the camera sees.
    pub receivers: Vec<Vec3>,
}

impl Cover {
    /// What matters to `light` as `camera` sees the scene.
    #[must_use]
    pub fn new(prepared: &Prepared<'_>, light: &Light, camera: &View) -> Cover {
        let scene = prepared.scene();
        let backdrops: Vec<&Backdrop> =
            prepared.backdrops().iter().filter(|backdrop| backdrop.is_lit_by(light)).collect();
        let blocks = |triangle: &[Vec3; 3]| !backdrops.iter().any(|b| b.holds(triangle));
        let blockers = points_around(triangles(scene).filter(blocks).flatten().collect());
        let receivers = points_around(seen(scene, camera));
        // Without one of them there are no shadows, but maps all the same.
        match (blockers.is_empty(), receivers.is_empty()) {
            (true, _) => Cover { blockers: receivers.clone(), receivers },
            (_, true) => Cover { receivers: blockers.clone(), blockers },
            _ => Cover { blockers, receivers },
        }
    }

    /// All points.
    pub fn points(&self) -> impl Iterator<Item = DVec3> + Clone {
        self.blockers.iter().chain(&self.receivers).map(|p| p.as_dvec3())
    }
}

/// A plane with triangles on it and the whole scene on one side, such as the ground or a room's
/// wall: nothing lies behind it that it could hide from a light on that side.
#[derive(Clone, Copy, Debug)]
pub struct Backdrop {
    /// Towards the scene, of unit length.
    normal: DVec3,
    /// `normal . p` of its points.
    offset: f64,
    tolerance: f64,
}

impl Backdrop {
    /// The backdrops among the largest triangles of a scene.
    #[must_use]
    pub fn find(scene: &Scene) -> Vec<Backdrop> {
        let hull = points_around(triangles(scene).flatten().collect());
        let mut largest: Vec<(f64, [Vec3; 3])> =
            triangles(scene).map(|t| (doubled_area(&t).length(), t)).collect();
        largest.retain(|(area, _)| *area > 0.0);
        if largest.len() > CANDIDATES {
            largest.select_nth_unstable_by(CANDIDATES, |a, b| b.0.total_cmp(&a.0));
            largest.truncate(CANDIDATES);
        }
        let extent = scene.bounds().map_or(0.0, |bounds| bounds.extent().max_element());
        let tolerance = TOLERANCE * f64::from(extent);
        let mut found: Vec<Backdrop> = Vec::new();
        for (area, triangle) in largest {
            let normal = doubled_area(&triangle) / area;
            let offset = normal.dot(triangle[0].as_dvec3());
            if found.iter().any(|backdrop| backdrop.holds(&triangle)) {
                continue;
            }
            let front = Backdrop { normal, offset, tolerance };
            let back = Backdrop { normal: -normal, offset: -offset, tolerance };
            let holds_scene =
                |side: &Backdrop| hull.iter().all(|p| side.height(p.as_dvec3()) >= -tolerance);
            found.extend([front, back].into_iter().find(holds_scene));
        }
        found
    }

    fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }

    /// Whether a triangle lies on it.
    fn holds(&self, triangle: &[Vec3; 3]) -> bool {
        triangle.iter().all(|p| self.height(p.as_dvec3()).abs() <= self.tolerance)
    }

    /// Whether all of the light is on the scene's side.
    fn is_lit_by(&self, light: &Light) -> bool {
        let above = |p: Vec3| self.height(p.as_dvec3()) > self.tolerance;
        match *light {
            Light::Point { position } => above(position),
            Light::Sphere { center, radius } => {
                self.height(center.as_dvec3()) > self.tolerance + f64::from(radius.abs())
            }
            Light::Sun { direction, angle } => {
                let rise = -self.normal.dot(direction.as_dvec3().normalize_or_zero());
                rise > libm::sin(f64::from(angle).abs() * 0.5) + TOLERANCE
            }
            Light::Linear { a, b } => above(a) && above(b),
            Light::Triangle { a, b, c } => above(a) && above(b) && above(c),
            Light::Rectangle { corner, edge_u, edge_v } => {
                let far = corner + edge_u;
                [corner, far, corner + edge_v, far + edge_v].into_iter().all(above)
            }
            _ => false,
        }
    }
}

/// The normal of a triangle, as long as twice its area.
fn doubled_area(triangle: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    (b - a).cross(c - a)
}

/// The triangles that have a place.
fn triangles(scene: &Scene) -> impl Iterator<Item = [Vec3; 3]> {
    let corners = scene.mesh.triangles.iter().filter_map(|&triangle| corners(scene, triangle));
    corners.filter(|triangle| triangle.iter().all(|p| p.is_finite()))
}

/// The corners of the triangles as far as they lie inside the camera's window.
fn seen(scene: &Scene, camera: &View) -> Vec<Vec3> {
    let size = [camera.width(), camera.height()].map(f64::from);
    let nearest = f64::from(camera.max_nearness());
    let rows = camera.rows().map(|row| row.map(f64::from));
    // How far inside each border of the window a point lies.
    let inside = |p: DVec3| {
        let [u, v, n, q] = rows.map(|r| r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3]);
        [u, size[0] * q - u, v, size[1] * q - v, nearest * q - n, n]
    };
    let mut points = Vec::new();
    let (mut polygon, mut clipped) = (Vec::new(), Vec::new());
    for triangle in triangles(scene) {
        let triangle = triangle.map(Vec3::as_dvec3);
        let heights = triangle.map(inside);
        if heights.iter().flatten().all(|&height| height >= 0.0) {
            points.extend(triangle.map(DVec3::as_vec3));
            continue;
        }
        if (0..6).any(|border| heights.iter().all(|heights| heights[border] < 0.0)) {
            continue;
        }
        polygon.clear();
        polygon.extend(triangle);
        for border in 0..6 {
            clip(&polygon, |p| inside(p)[border], &mut clipped);
            std::mem::swap(&mut polygon, &mut clipped);
        }
        points.extend(polygon.iter().map(|p| p.as_vec3()));
    }
    points
}

/// The part of a convex polygon where `height`, an affine function, is not negative.
fn clip(polygon: &[DVec3], height: impl Fn(DVec3) -> f64, out: &mut Vec<DVec3>) {
    out.clear();
    for (index, &b) in polygon.iter().enumerate() {
        let a = polygon[(index + polygon.len() - 1) % polygon.len()];
        let (height_a, height_b) = (height(a), height(b));
        if (height_a < 0.0) != (height_b < 0.0) {
            out.push(a + (b - a) * (height_a / (height_a - height_b)));
        }
        if height_b >= 0.0 {
            out.push(b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::camera::{CameraOptions, choose, view};

    fn cover(light: Light) -> (Scene, Cover) {
        let scene = builtin::scene("torus").unwrap();
        let prepared = Prepared::new(&scene);
        let camera = choose(&scene, &CameraOptions::default()).unwrap();
        let cover = Cover::new(&prepared, &light, &view(&camera, [64, 64], prepared.bounds()));
        (scene.clone(), cover)
    }

    #[test]
    fn the_ground_blocks_no_light_above_it() {
        let (_, cover) = cover(Light::Sphere { center: Vec3::new(1.5, 6.0, 1.5), radius: 0.5 });
        assert!(cover.blockers.iter().all(|p| p.y > 0.1 && p.x.abs() < 1.5));
    }

    #[test]
    fn the_ground_blocks_a_light_that_reaches_below_it() {
        let (scene, cover) = cover(Light::Sphere { center: Vec3::new(1.5, 0.4, 1.5), radius: 0.5 });
        assert!(scene.mesh.positions.iter().any(|p| cover.blockers.contains(p) && p.y == 0.0));
    }

    #[test]
    fn receivers_are_cut_at_the_edge_of_the_picture() {
        let (_, cover) = cover(Light::Point { position: Vec3::new(0.0, 6.0, 0.0) });
        // At the torus, 9.4 m from the eye, 40 degrees show 3.4 m to either side.
        let near = cover.receivers.iter().filter(|p| p.z > 0.0);
        let widest = near.map(|p| p.x.abs()).fold(0.0, f32::max);
        assert!(widest > 2.0 && widest < 3.6, "{widest}");
    }
}
