//! One triangle as the shading sees it.

use std::ops::Range;

use glam::Vec3;

use crate::light_block::{BLOCK, Block, Lane, PADDING};
use crate::prepared::{Prepared, corners};

/// What the pixels on one triangle share.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    index: u32,
    /// Index into the scene's materials; one past the last where there is none.
    material: u32,
    /// Whether `normal[0]` says it all.
    is_flat: bool,
    /// Whether the albedo is looked up for each pixel.
    is_colored: bool,
    /// Towards the viewer; at a point `normal[0] + b1 normal[1] + b2 normal[2]`, not of unit
    /// length.
    normal: [Vec3; 3],
    /// The weights `b1` of the second and `b2` of the third corner at P are
    /// `weights . (P - origin)`.
    origin: Vec3,
    weights: [Vec3; 2],
}

impl Facet {
    /// What no triangle is.
    pub const NONE: Facet = Facet {
        index: 0,
        material: u32::MAX,
        is_flat: true,
        is_colored: false,
        normal: [Vec3::Y, Vec3::ZERO, Vec3::ZERO],
        origin: Vec3::ZERO,
        weights: [Vec3::ZERO; 2],
    };

    /// The triangle `index - 1`, seen from `eye`, a homogeneous point.
    #[must_use]
    #[inline(always)]
    pub fn new(prepared: &Prepared<'_>, index: u32, eye: [f32; 4]) -> Facet {
        let triangle = index as usize - 1;
        let scene = prepared.scene();
        let material = scene.triangle_materials.get(triangle).copied();
        let material = material.unwrap_or(scene.materials.len() as u32);
        let normal = prepared.surfaces()[index as usize].normal;
        let mut facet = Facet { index, material, ..Facet::NONE };
        facet.normal[0] = normal;
        let vertices = scene.mesh.triangles[triangle];
        let Some([a, b, c]) = corners(scene, vertices) else { return facet };
        let [x, y, z, w] = eye;
        if normal.dot(Vec3::new(x, y, z) - a * w) < 0.0 {
            facet.normal[0] = -normal;
        }
        let is_smooth = prepared.is_smooth(triangle);
        let is_colored = prepared.is_colored(material);
        if !is_smooth && !is_colored {
            return facet;
        }
        let (u, v) = (b - a, c - a);
        let [uu, uv, vv] = [u.dot(u), u.dot(v), v.dot(v)];
        let scale = 1.0 / (uu * vv - uv * uv);
        if scale.is_finite() {
            facet.is_flat = false;
            facet.is_colored = is_colored;
            facet.origin = a;
            facet.weights = [(u * vv - v * uv) * scale, (v * uu - u * uv) * scale];
            if let Some(normals) = vertex_normals(&scene.normals, vertices).filter(|_| is_smooth) {
                facet.normal = on_side_of(facet.normal[0], normals);
            }
        }
        facet
    }

    /// The index it was made with.
    #[must_use]
    pub fn index(&self) -> u32 {
        self.index
    }

    /// The index of its material.
    #[must_use]
    pub fn material(&self) -> u32 {
        self.material
    }

    /// Whether its pixels differ in nothing but the light that they get.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.is_flat
    }

    /// Sets the normals (not of unit length) of the pixels in `run`, which see the triangle, and
    /// arbitrarily those of less than [`PADDING`] pixels after them; where the pixels differ in it,
    /// also the albedo.
    #[inline(always)]
    pub fn fill(&self, prepared: &Prepared<'_>, block: &mut Block, run: Range<usize>) {
        for start in run.clone().step_by(PADDING) {
            if self.is_flat {
                put(&mut block.normal, start, &same(self.normal[0]));
                continue;
            }
            let [b1, b2] = self.weights_at(&block.position, start);
            let [normal, d1, d2] = self.normal;
            let mut normals = [[0.0; PADDING]; 3];
            for i in 0..PADDING {
                let normal = normal + d1 * b1[i] + d2 * b2[i];
                (normals[0][i], normals[1][i], normals[2][i]) = (normal.x, normal.y, normal.z);
            }
            put(&mut block.normal, start, &normals);
            if self.is_colored {
                let run = start..run.end.min(start + PADDING);
                self.color(prepared, block, run, [b1, b2]);
            }
        }
    }

    /// Looks up the albedo of each pixel in `run`, no more than [`PADDING`] of them.
    #[inline(never)]
    fn color(
        &self,
        prepared: &Prepared<'_>,
        block: &mut Block,
        run: Range<usize>,
        [b1, b2]: [Piece; 2],
    ) {
        let triangle = self.index as usize - 1;
        let Some(material) = prepared.material(triangle) else { return };
        let vertices = prepared.scene().mesh.triangles[triangle];
        for (i, pixel) in run.enumerate() {
            let color = prepared.base_color(material, vertices, [b1[i], b2[i]]);
            for (albedo, value) in block.albedo.iter_mut().zip(color.to_array()) {
                albedo[pixel] = value;
            }
        }
    }

    /// The weights of the second and of the third corner at the pixels from `start` on.
    #[inline(always)]
    fn weights_at(&self, position: &[Lane; 3], start: usize) -> [Piece; 2] {
        let [mut b1, mut b2] = [[0.0; PADDING]; 2];
        let [x, y, z] = position.each_ref().map(|lane| &lane[start..][..PADDING]);
        for i in 0..PADDING {
            let offset = Vec3::new(x[i], y[i], z[i]) - self.origin;
            b1[i] = self.weights[0].dot(offset).clamp(0.0, 1.0);
            b2[i] = self.weights[1].dot(offset).clamp(0.0, 1.0);
        }
        [b1, b2]
    }
}

/// As many pixels as are looked up together.
type Piece = [f32; PADDING];

#[inline(always)]
fn same(value: Vec3) -> [Piece; 3] {
    [[value.x; PADDING], [value.y; PADDING], [value.z; PADDING]]
}

#[inline(always)]
fn put(lanes: &mut [Lane; 3], start: usize, pieces: &[Piece; 3]) {
    for (lane, piece) in lanes.iter_mut().zip(pieces) {
        lane[start..][..PADDING].copy_from_slice(piece);
    }
}

/// Sets albedo and emission of the pixels from `start` to the end of the block.
#[inline(always)]
pub fn set_look(block: &mut Block, start: usize, albedo: Vec3, emission: Vec3) {
    for start in (start..BLOCK).step_by(PADDING) {
        put(&mut block.albedo, start, &same(albedo));
        put(&mut block.emission, start, &same(emission));
    }
}

/// Whether the normals of the vertices say more than that of the triangle, `flat`.
#[must_use]
pub fn is_smooth(normals: &[Vec3], vertices: [u32; 3], flat: Vec3) -> bool {
    let Some([a, b, c]) = vertex_normals(normals, vertices) else { return false };
    let known = [a, b, c].iter().all(|n| n.is_finite() && *n != Vec3::ZERO);
    known && !(a == b && b == c && a.dot(flat).abs() > 0.9999)
}

#[inline(always)]
fn vertex_normals(normals: &[Vec3], [a, b, c]: [u32; 3]) -> Option<[Vec3; 3]> {
    let normal = |index: u32| normals.get(index as usize).copied();
    Some([normal(a)?, normal(b)?, normal(c)?])
}

/// The first of three normals and the differences of the others to it, on the side of `flat`.
#[inline(always)]
fn on_side_of(flat: Vec3, [a, b, c]: [Vec3; 3]) -> [Vec3; 3] {
    let side = if (a + b + c).dot(flat) < 0.0 { -1.0 } else { 1.0 };
    [a * side, (b - a) * side, (c - a) * side]
}
