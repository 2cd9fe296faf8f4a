//! One triangle as the shading sees it.

use glam::Vec3;

use crate::prepared::{Prepared, corners};
use crate::scene::Material;

/// What the pixels on one triangle share.
#[derive(Clone, Copy, Debug)]
pub struct Facet<'a> {
    index: u32,
    /// Towards the viewer.
    normal: Vec3,
    albedo: Vec3,
    emission: Vec3,
    /// The rest differs from pixel to pixel, and is there only if it does.
    varying: Option<Varying<'a>>,
}

#[derive(Clone, Copy, Debug)]
struct Varying<'a> {
    corners: [u32; 3],
    /// The weight of the second and of the third corner at P is `weights . (P - origin)`.
    origin: Vec3,
    weights: [Vec3; 2],
    /// The normal is `smooth[0] + b1 smooth[1] + b2 smooth[2]`, without unit length.
    smooth: Option<[Vec3; 3]>,
    /// The colour is looked up.
    material: Option<&'a Material>,
}

impl<'a> Facet<'a> {
    /// The triangle `index - 1`, seen from `eye`, a homogeneous point.
    #[must_use]
    pub fn new(prepared: &Prepared<'a>, index: u32, eye: [f32; 4]) -> Facet<'a> {
        let triangle = index as usize - 1;
        let scene = prepared.scene();
        let material = prepared.material(triangle);
        let normal = prepared.surfaces()[index as usize].normal;
        let mut facet = Facet {
            index,
            normal,
            albedo: material.map_or(Vec3::ONE, |m| m.base_color.truncate()),
            emission: material.map_or(Vec3::ZERO, |m| m.emissive),
            varying: None,
        };
        let vertices = scene.mesh.triangles[triangle];
        let Some([a, b, c]) = corners(scene, vertices) else { return facet };
        let [x, y, z, w] = eye;
        if normal.dot(Vec3::new(x, y, z) - a * w) < 0.0 {
            facet.normal = -normal;
        }
        let smooth = smooth_normals(&scene.normals, vertices, facet.normal);
        let colored = !scene.colors.is_empty() || material.is_some_and(|m| m.texture.is_some());
        let (u, v) = (b - a, c - a);
        let [uu, uv, vv] = [u.dot(u), u.dot(v), v.dot(v)];
        let scale = 1.0 / (uu * vv - uv * uv);
        if (smooth.is_some() || colored) && scale.is_finite() {
            let weights = [(u * vv - v * uv) * scale, (v * uu - u * uv) * scale];
            let material = material.filter(|_| colored);
            facet.varying =
                Some(Varying { corners: vertices, origin: a, weights, smooth, material });
        }
        facet
    }

    /// The index it was made with.
    #[must_use]
    pub fn index(&self) -> u32 {
        self.index
    }

    /// Normal, albedo and emission, if they are the same everywhere on the triangle.
    #[must_use]
    pub fn uniform(&self) -> Option<[Vec3; 3]> {
        self.varying.is_none().then_some([self.normal, self.albedo, self.emission])
    }

    /// Normal (not of unit length), albedo and emission at a point of the triangle.
    #[inline]
    #[must_use]
    pub fn at(&self, prepared: &Prepared<'_>, position: Vec3) -> [Vec3; 3] {
        let Some(varying) = &self.varying else { return [self.normal, self.albedo, self.emission] };
        let offset = position - varying.origin;
        let b1 = varying.weights[0].dot(offset).clamp(0.0, 1.0);
        let b2 = varying.weights[1].dot(offset).clamp(0.0, 1.0);
        let normal = match varying.smooth {
            Some([start, d1, d2]) => start + d1 * b1 + d2 * b2,
            None => self.normal,
        };
        let albedo = match varying.material {
            Some(material) => prepared.base_color(material, varying.corners, [b1, b2]).truncate(),
            None => self.albedo,
        };
        [normal, albedo, self.emission]
    }
}

/// The first corner's normal and the differences of the others to it, on the side of `flat`;
/// `None` for a triangle that is flat.
fn smooth_normals(normals: &[Vec3], vertices: [u32; 3], flat: Vec3) -> Option<[Vec3; 3]> {
    let [a, b, c] = vertices.map(|index| normals.get(index as usize).copied());
    let (a, b, c) = (a?, b?, c?);
    let known = [a, b, c].iter().all(|n| n.is_finite() && *n != Vec3::ZERO);
    if !known || (a == b && b == c && a.dot(flat).abs() > 0.9999) {
        return None;
    }
    let side = if (a + b + c).dot(flat) < 0.0 { -1.0 } else { 1.0 };
    Some([a * side, (b - a) * side, (c - a) * side])
}
