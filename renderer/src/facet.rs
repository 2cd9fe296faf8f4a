//! One triangle as the shading sees it.

use std::ops::Range;

use glam::Vec3;

use crate::light_block::{Block, Lane, PADDING};
use crate::prepared::{Prepared, corners};
use crate::scene::Material;

/// What the pixels on one triangle share.
#[derive(Clone, Copy, Debug)]
pub struct Facet<'a> {
    index: u32,
    /// Whether `normal` says it all.
    is_flat: bool,
    /// Towards the viewer; at a point `normal[0] + b1 normal[1] + b2 normal[2]`, not of unit length.
    normal: [Vec3; 3],
    /// The weights `b1` of the second and `b2` of the third corner at P are `weights . (P - origin)`.
    origin: Vec3,
    weights: [Vec3; 2],
    albedo: Vec3,
    emission: Vec3,
    /// The albedo is looked up instead: of this material, between these vertices.
    colored: Option<(&'a Material, [u32; 3])>,
}

impl<'a> Facet<'a> {
    /// What no triangle is: nothing but light of this colour.
    pub const fn glowing(emission: Vec3) -> Facet<'a> {
        Facet {
            index: 0,
            is_flat: true,
            normal: [Vec3::Y, Vec3::ZERO, Vec3::ZERO],
            origin: Vec3::ZERO,
            weights: [Vec3::ZERO; 2],
            albedo: Vec3::ZERO,
            emission,
            colored: None,
        }
    }

    /// The triangle `index - 1`, seen from `eye`, a homogeneous point.
    #[must_use]
    #[inline(always)]
    pub fn new(prepared: &Prepared<'a>, index: u32, eye: [f32; 4]) -> Facet<'a> {
        let triangle = index as usize - 1;
        let scene = prepared.scene();
        let material = prepared.material(triangle);
        let normal = prepared.surfaces()[index as usize].normal;
        let mut facet = Facet {
            index,
            albedo: material.map_or(Vec3::ONE, |m| m.base_color.truncate()),
            ..Facet::glowing(material.map_or(Vec3::ZERO, |m| m.emissive))
        };
        facet.normal[0] = normal;
        let vertices = scene.mesh.triangles[triangle];
        let Some([a, b, c]) = corners(scene, vertices) else { return facet };
        let [x, y, z, w] = eye;
        if normal.dot(Vec3::new(x, y, z) - a * w) < 0.0 {
            facet.normal[0] = -normal;
        }
        let smooth = smooth_normals(&scene.normals, vertices, facet.normal[0]);
        let colored = !scene.colors.is_empty() || material.is_some_and(|m| m.texture.is_some());
        let (u, v) = (b - a, c - a);
        let [uu, uv, vv] = [u.dot(u), u.dot(v), v.dot(v)];
        let scale = 1.0 / (uu * vv - uv * uv);
        if (smooth.is_some() || colored) && scale.is_finite() {
            facet.is_flat = false;
            facet.normal = smooth.unwrap_or(facet.normal);
            facet.origin = a;
            facet.weights = [(u * vv - v * uv) * scale, (v * uu - u * uv) * scale];
            facet.colored = material.filter(|_| colored).map(|material| (material, vertices));
        }
        facet
    }

    /// The index it was made with.
    #[must_use]
    pub fn index(&self) -> u32 {
        self.index
    }

    /// Whether its pixels differ in nothing but the light that they get.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.is_flat
    }

    /// Sets normal (not of unit length), albedo and emission of the pixels in `run`, which see the
    /// triangle, and arbitrarily those of less than [`PADDING`] pixels after them.
    #[inline(always)]
    pub fn fill(&self, prepared: &Prepared<'_>, block: &mut Block, run: Range<usize>) {
        for start in run.clone().step_by(PADDING) {
            put(&mut block.emission, start, &same(self.emission));
            put(&mut block.albedo, start, &same(self.albedo));
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
            let Some((material, vertices)) = self.colored else { continue };
            for (i, pixel) in (start..run.end.min(start + PADDING)).enumerate() {
                let color = prepared.base_color(material, vertices, [b1[i], b2[i]]);
                for (albedo, value) in block.albedo.iter_mut().zip(color.to_array()) {
                    albedo[pixel] = value;
                }
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

/// The first corner's normal and the differences of the others to it, on the side of `flat`;
/// `None` for a triangle that is flat.
fn smooth_normals(normals: &[Vec3], vertices: [u32; 3], flat: Vec3) -> Option<[Vec3; 3]> {
    let normal = |index: u32| normals.get(index as usize).copied();
    let [a, b, c] = [normal(vertices[0])?, normal(vertices[1])?, normal(vertices[2])?];
    let known = [a, b, c].iter().all(|n| n.is_finite() && *n != Vec3::ZERO);
    if !known || (a == b && b == c && a.dot(flat).abs() > 0.9999) {
        return None;
    }
    let side = if (a + b + c).dot(flat) < 0.0 { -1.0 } else { 1.0 };
    Some([a * side, (b - a) * side, (c - a) * side])
}
