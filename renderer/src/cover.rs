//! What the maps of a light must hold: the triangles that can block it, and those that are seen.

use glam::{DVec3, Vec3};
use shadowmap_core::{Light, View};

use crate::hull::points_around;
use crate::prepared::{Prepared, corners};
use crate::scene::Scene;

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
        let backdrops = prepared.backdrops();
        let lit = backdrops.lit_by(light);
        let mut corners = Corners::none(scene);
        for (&triangle, &on) in scene.mesh.triangles.iter().zip(backdrops.of_triangles()) {
            if on & lit == 0 {
                corners.add(triangle);
            }
        }
        let blockers = points_around(corners.points(scene));
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

/// The vertices of some triangles, each once.
struct Corners(Vec<bool>);

impl Corners {
    fn none(scene: &Scene) -> Corners {
        Corners(vec![false; scene.mesh.positions.len()])
    }

    /// Adds the vertices of a triangle, as far as they exist.
    fn add(&mut self, triangle: [u32; 3]) {
        for index in triangle {
            if let Some(added) = self.0.get_mut(index as usize) {
                *added = true;
            }
        }
    }

    fn points(&self, scene: &Scene) -> Vec<Vec3> {
        let vertices = scene.mesh.positions.iter().zip(&self.0);
        vertices.filter(|(_, added)| **added).map(|(position, _)| *position).collect()
    }
}

/// The bit of a vertex that has no place.
const NOWHERE: u8 = 1 << 6;

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
    // One bit for each border that a vertex does not lie inside of.
    let outcode = |p: &Vec3| {
        let heights = inside(p.as_dvec3()).into_iter().enumerate();
        let outside = |height: f64| height.is_nan() || height < 0.0;
        let code = heights.fold(0, |code, (i, height)| code | u8::from(outside(height)) << i);
        if p.is_finite() { code } else { NOWHERE }
    };
    let outcodes: Vec<u8> = scene.mesh.positions.iter().map(outcode).collect();
    let outcode = |index: u32| outcodes.get(index as usize).copied().unwrap_or(NOWHERE);
    let (mut whole, mut points) = (Corners::none(scene), Vec::new());
    let (mut polygon, mut clipped) = (Vec::new(), Vec::new());
    for &triangle in &scene.mesh.triangles {
        let [a, b, c] = triangle.map(outcode);
        if a | b | c == 0 {
            whole.add(triangle);
        }
        let outside = (a | b | c) & NOWHERE != 0 || a & b & c != 0;
        let Some(corners) = corners(scene, triangle).filter(|_| !outside && a | b | c != 0) else {
            continue;
        };
        polygon.clear();
        polygon.extend(corners.map(Vec3::as_dvec3));
        for border in 0..6 {
            clip(&polygon, |p| inside(p)[border], &mut clipped);
            std::mem::swap(&mut polygon, &mut clipped);
        }
        points.extend(polygon.iter().map(|p| p.as_vec3()));
    }
    points.extend(whole.points(scene));
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
