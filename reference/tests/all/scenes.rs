//! Small scenes, made by code.

use glam::Vec3;
use shadowmap_core::{Mesh, View};

/// A mesh that owns its arrays.
#[derive(Default)]
pub struct Scene {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub ids: Vec<u32>,
}

impl Scene {
    pub fn mesh(&self) -> Mesh<'_> {
        Mesh { positions: &self.positions, triangles: &self.triangles, ids: &self.ids }
    }

    pub fn add_triangle(&mut self, corners: [Vec3; 3], id: u32) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
        self.ids.push(id);
    }

    /// A horizontal rectangle.
    pub fn add_rectangle(&mut self, x: [f32; 2], z: [f32; 2], y: f32, id: u32) {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| Vec3::new(x[i], y, z[j]));
        self.add_triangle([a, b, c], id);
        self.add_triangle([a, c, d], id);
    }

    pub fn add_torus(
        &mut self,
        center: Vec3,
        radii: [f64; 2],
        tilt: f64,
        cells: [u32; 2],
        id: u32,
    ) {
        let first = self.positions.len() as u32;
        let turn = std::f64::consts::TAU;
        let (sin, cos) = tilt.to_radians().sin_cos();
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                let (u, v) =
                    (f64::from(i) / f64::from(cells[0]), f64::from(j) / f64::from(cells[1]));
                let (u, v) = (turn * u, turn * v);
                let ring = radii[0] + radii[1] * v.cos();
                let (x, y, z) = (ring * u.cos(), radii[1] * v.sin(), ring * u.sin());
                let (y, z) = (y * cos - z * sin, y * sin + z * cos);
                self.positions.push((center.as_dvec3() + glam::DVec3::new(x, y, z)).as_vec3());
                let at = |i: u32, j: u32| first + i % cells[0] * cells[1] + j % cells[1];
                self.triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                self.triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                self.ids.extend([id, id]);
            }
        }
    }
}

pub fn ground() -> Scene {
    let mut scene = Scene::default();
    scene.add_rectangle([-5.0, 5.0], [-5.0, 5.0], 0.0, 1);
    scene
}

/// A rectangle of 2 m by 1 m, 1.5 m above the ground.
pub fn blocker() -> Scene {
    let mut scene = ground();
    scene.add_rectangle([-1.0, 1.0], [-0.5, 0.5], 1.5, 2);
    scene
}

/// A tilted torus of `2 * 64 * 32` triangles above the ground.
pub fn torus() -> Scene {
    let mut scene = ground();
    scene.add_torus(Vec3::new(0.0, 1.5, 0.0), [1.0, 0.35], 30.0, [64, 32], 2);
    scene
}

pub fn camera(eye: Vec3, target: Vec3, size: u32) -> View {
    View::perspective(eye, target, Vec3::Y, 40.0_f32.to_radians(), size, size, 0.01)
}
