//! Meshes that a rasterizer finds hard, and random numbers to make them of.
#![allow(dead_code)]

use glam::Vec3;
use shadowmap_core::{Mesh, View, Window};

/// SplitMix64 (Steele, Lea and Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }
    pub fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }
    pub fn point(&mut self, center: Vec3, radius: f32) -> Vec3 {
        center + Vec3::from_array([0; 3].map(|_| self.between(-radius, radius)))
    }
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

/// A mesh that owns its parts.
#[derive(Clone, Default)]
pub struct Soup {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub ids: Vec<u32>,
}

impl Soup {
    pub fn mesh(&self) -> Mesh<'_> {
        Mesh { positions: &self.positions, triangles: &self.triangles, ids: &self.ids }
    }
    pub fn push(&mut self, corners: [Vec3; 3], id: u32) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
        self.ids.push(id);
    }
}

/// Random triangles of one size in front of a camera at the origin that looks along -z.
pub fn soup(random: &mut Random, count: usize, size: f32) -> Soup {
    let mut soup = Soup::default();
    for _ in 0..count {
        let depth = random.between(1.0, 12.0);
        let center = Vec3::new(0.0, 0.0, -depth)
            + random.point(Vec3::ZERO, depth * 0.7) * Vec3::new(1.0, 1.0, 0.0);
        let corners = [0; 3].map(|_| random.point(center, size));
        soup.push(corners, random.below(9) as u32 + 1);
    }
    soup
}

/// Everything that is not ordinary.
pub fn torture(random: &mut Random, count: usize) -> Soup {
    let mut soup = Soup::default();
    for i in 0..count {
        let center = random.point(Vec3::ZERO, 8.0);
        let mut corners = match i % 12 {
            // Across the near plane, around the viewer, behind it.
            0 => [0; 3].map(|_| random.point(Vec3::ZERO, 3.0)),
            1 => [0; 3].map(|_| random.point(Vec3::ZERO, 0.3)),
            // Slivers.
            2 => {
                let (a, b) = (random.point(center, 4.0), random.point(center, 4.0));
                let t = random.unit();
                [a, b, random.point(a.lerp(b, t), 1e-4)]
            }
            // Degenerate.
            3 => {
                let a = random.point(center, 2.0);
                [a, a, random.point(center, 2.0)]
            }
            // Huge.
            4 => [0; 3].map(|_| random.point(Vec3::ZERO, 3e4)),
            5 => [0; 3].map(|_| random.point(Vec3::ZERO, 1e15)),
            // Tiny.
            6 => [0; 3].map(|_| random.point(center, 0.02)),
            7 => [0; 3].map(|_| random.point(center, 1e-5)),
            // Edge-on: in a plane through the viewer.
            8 => {
                let (a, b) = (random.point(center, 3.0), random.point(center, 3.0));
                [0; 3].map(|_| a * random.between(0.1, 2.0) + b * random.unit())
            }
            _ => [0; 3].map(|_| random.point(center, 1.5)),
        };
        if i % 29 == 0 {
            let wrong = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE];
            corners[random.below(3)][random.below(3)] = wrong[random.below(5)];
        }
        soup.push(corners, random.below(9) as u32);
        if i % 31 == 0 {
            soup.triangles[i][random.below(3)] = [u32::MAX, soup.positions.len() as u32][i % 2];
        }
        // Twins, so that ties happen.
        if i % 17 == 0 {
            soup.triangles[i] = soup.triangles[random.below(i + 1)];
        }
    }
    soup
}

/// Rectified views along -z, so far apart that a triangle may need clipping in some and not in
/// others.
pub fn rectified_views() -> Vec<View> {
    let axes = [Vec3::X, Vec3::NEG_Y, Vec3::NEG_Z];
    let window = Window { left: -0.9, top: -0.6, right: 0.7, bottom: 0.8 };
    let view = |x: f32| {
        let eye = Vec3::new(x, 0.1, 0.3);
        View::perspective_rectified(Vec3::new(0.0, 0.1, 0.3), eye, axes, window, 173, 141, 0.05)
    };
    [-1e4, -0.7, 0.0, 0.4, 30.0].map(view).to_vec()
}

/// Views from the origin along -z: perspective, off-axis, orthographic; sizes down to one texel.
pub fn views() -> Vec<View> {
    let axes = [Vec3::X, Vec3::NEG_Y, Vec3::NEG_Z];
    let off_axis = Window { left: -0.2, top: -0.9, right: 1.1, bottom: 0.3 };
    let perspective = |w, h| View::perspective(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.2, w, h, 0.1);
    vec![
        perspective(160, 120),
        perspective(333, 97),
        perspective(15, 40),
        perspective(1, 1),
        View::perspective_window(Vec3::ZERO, axes, off_axis, 128, 130, 0.02),
        View::orthographic_window(
            Vec3::ZERO,
            axes,
            Window::centered(6.0, 5.0),
            200,
            190,
            [-2.0, 9.0],
        ),
        View::orthographic_window(
            Vec3::ZERO,
            axes,
            Window::centered(0.01, 5.0),
            64,
            64,
            [0.0, 4.0],
        ),
    ]
}
