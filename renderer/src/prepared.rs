//! A scene with the tables that every frame looks things up in.

use std::fmt;

use glam::{DVec3, Vec2, Vec3, Vec4};
use raster::AlphaMask;
use shadowmap_core::{Surface, View};

use crate::backdrops::Backdrops;
use crate::drawing::HIDDEN;
use crate::facet::is_smooth;
use crate::scene::{AlphaMode, Bounds, Material, Scene};
use crate::solids::Solids;

/// Alpha at which a blended material counts as solid: shadow maps know no half transparency.
const BLEND_CUTOFF: f32 = 0.5;

/// A scene and its tables, made once per scene.
pub struct Prepared<'a> {
    scene: &'a Scene,
    bounds: Option<Bounds>,
    backdrops: Backdrops,
    solids: Solids,
    /// Geometric normal and object ID of each triangle, at its index + 1.
    surfaces: Vec<Surface>,
    /// Which triangles have holes; empty if none has.
    masked: Vec<bool>,
    /// Which triangles have a normal that changes from corner to corner.
    smooth: Vec<bool>,
    /// Whether some material is seen from its front only.
    single_sided: bool,
}

impl fmt::Debug for Prepared<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Prepared").field("scene", &self.scene.name).finish_non_exhaustive()
    }
}

impl<'a> Prepared<'a> {
    /// The tables of a scene.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Prepared<'a> {
        let mesh = scene.mesh.as_mesh();
        let normal = |&triangle: &[u32; 3]| {
            let Some([a, b, c]) = corners(scene, triangle) else { return Vec3::ZERO };
            let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
            (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::ZERO).as_vec3()
        };
        let known = mesh.triangles.iter().zip(mesh.ids);
        let surfaces: Vec<Surface> = std::iter::once(Surface::UNKNOWN)
            .chain(known.map(|(triangle, &id)| Surface { normal: normal(triangle), id }))
            .collect();
        let is_smooth = |(&triangle, surface): (&[u32; 3], &Surface)| {
            is_smooth(&scene.normals, triangle, surface.normal)
        };
        let smooth = mesh.triangles.iter().zip(&surfaces[1..]).map(is_smooth).collect();
        let material = |&index: &u32| scene.materials.get(index as usize);
        let has_holes = |index| material(index).is_some_and(|m| cutoff(m).is_some());
        let masked: Vec<bool> = scene.triangle_materials.iter().map(has_holes).collect();
        let any_masked = masked.contains(&true);
        let single = |index| material(index).is_some_and(|m| !m.double_sided);
        Prepared {
            scene,
            bounds: scene.bounds(),
            backdrops: Backdrops::new(scene),
            solids: Solids::new(scene, &masked),
            surfaces,
            smooth,
            masked: if any_masked { masked } else { Vec::new() },
            single_sided: scene.triangle_materials.iter().any(single),
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }
    /// The box around all triangles.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }
    /// The planes that hide nothing from a light on the scene's side of them.
    #[must_use]
    pub(crate) fn backdrops(&self) -> &Backdrops {
        &self.backdrops
    }
    /// The closed surfaces.
    #[must_use]
    pub(crate) fn solids(&self) -> &Solids {
        &self.solids
    }
    /// Geometric normal and object ID of each triangle, at its index + 1: what a camera pass with
    /// [`raster::Payload::TriangleIndex`] points to.
    #[must_use]
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }
    /// Which triangles have holes; empty if none has.
    #[must_use]
    pub fn masked(&self) -> &[bool] {
        &self.masked
    }

    /// Whether the normal of a triangle changes from corner to corner.
    #[inline(always)]
    #[must_use]
    pub fn is_smooth(&self, triangle: usize) -> bool {
        self.smooth.get(triangle) == Some(&true)
    }

    /// Whether the colour of the material with this index changes from place to place.
    #[inline(always)]
    #[must_use]
    pub fn is_colored(&self, material: u32) -> bool {
        let material = self.scene.materials.get(material as usize);
        material.is_some_and(|m| m.texture.is_some() || !self.scene.colors.is_empty())
    }

    /// Whether the material of a triangle is there, at the place with the given weights of its
    /// second and third corner.
    #[must_use]
    pub fn is_solid(&self, triangle: usize, b1: f32, b2: f32) -> bool {
        let Some(material) = self.material(triangle) else { return true };
        let Some(cutoff) = cutoff(material) else { return true };
        let Some(&corners) = self.scene.mesh.triangles.get(triangle) else { return true };
        self.base_color(material, corners, [b1, b2]).w >= cutoff
    }

    /// The alpha test as the rasterizer takes it, around [`Prepared::is_solid`].
    pub fn with_alpha_mask<R>(&self, work: impl FnOnce(Option<&AlphaMask<'_>>) -> R) -> R {
        if self.masked.is_empty() {
            return work(None);
        }
        let keep = |triangle: usize, b1: f32, b2: f32| self.is_solid(triangle, b1, b2);
        work(Some(&AlphaMask { masked: &self.masked, keep: &keep }))
    }

    /// The material of a triangle.
    #[must_use]
    pub fn material(&self, triangle: usize) -> Option<&'a Material> {
        let index = *self.scene.triangle_materials.get(triangle)?;
        self.scene.materials.get(index as usize)
    }

    /// Albedo and emission of the material with this index, linear RGB; white where there is none.
    #[inline(always)]
    #[must_use]
    pub fn look(&self, material: u32) -> (Vec3, Vec3) {
        let material = self.scene.materials.get(material as usize);
        material.map_or((Vec3::ONE, Vec3::ZERO), |m| (m.base_color.truncate(), m.emissive))
    }

    /// Linear RGBA of a material at the place with the given weights of the second and third of
    /// the vertices `corners`.
    #[must_use]
    pub fn base_color(&self, material: &Material, corners: [u32; 3], weights: [f32; 2]) -> Vec4 {
        let mut color = material.base_color;
        if let Some(vertex) = interpolated(&self.scene.colors, corners, weights) {
            color *= vertex;
        }
        let texture = material.texture.and_then(|index| self.scene.textures.get(index));
        if let Some(texture) = texture {
            let uv = interpolated(&self.scene.uvs, corners, weights).unwrap_or(Vec2::ZERO);
            color *= texture.sample(uv);
        }
        color
    }

    /// Moves each position into the plane of its triangle, given by index + 1, as closely as single
    /// precision allows: rays start at a fixed distance from it, also in scenes of hundreds of
    /// metres, where a position derived from depth can be farther off than that.
    ///
    /// # Panics
    ///
    /// If there is not one triangle per position.
    pub fn snap_to_planes(&self, triangles: &[u32], positions: &mut [Vec3]) {
        assert_eq!(triangles.len(), positions.len(), "one triangle per position");
        for (&index, position) in triangles.iter().zip(positions) {
            let triangle = self.scene.mesh.triangles.get((index as usize).wrapping_sub(1));
            let Some([a, b, c]) = triangle.and_then(|&t| corners(self.scene, t)) else { continue };
            let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let p = position.as_dvec3();
            *position = (p - normal * normal.dot(p - a)).as_vec3();
        }
    }

    /// Writes to `triangles` those that one of `cameras` sees from a side that their material
    /// shows. The others keep their place and get indices that no vertex has. `None` if all are
    /// shown anyway.
    pub fn front_faces<'t>(
        &self,
        cameras: &[View],
        triangles: &'t mut Vec<[u32; 3]>,
    ) -> Option<&'t [[u32; 3]]> {
        if !self.single_sided {
            return None;
        }
        triangles.clear();
        let all = self.scene.mesh.triangles.iter().zip(&self.surfaces[1..]).enumerate();
        triangles.extend(all.map(|(index, (&triangle, surface))| {
            let shown = self.material(index).is_none_or(|material| material.double_sided);
            let Some([a, _, _]) = corners(self.scene, triangle) else { return triangle };
            let faces = |camera: &View| {
                let [x, y, z, w] = camera.eye();
                surface.normal.dot(Vec3::new(x, y, z) - a * w) >= 0.0
            };
            if shown || cameras.iter().any(faces) { triangle } else { HIDDEN }
        }));
        Some(triangles)
    }
}

/// Alpha below which a material has a hole; `None` for one without holes.
fn cutoff(material: &Material) -> Option<f32> {
    match material.alpha_mode {
        AlphaMode::Opaque => None,
        AlphaMode::Mask(cutoff) => Some(cutoff),
        AlphaMode::Blend => Some(BLEND_CUTOFF),
    }
}

/// The positions of a triangle's vertices; `None` if one is missing.
#[inline]
pub(crate) fn corners(scene: &Scene, [a, b, c]: [u32; 3]) -> Option<[Vec3; 3]> {
    let corner = |index: u32| scene.mesh.positions.get(index as usize).copied();
    Some([corner(a)?, corner(b)?, corner(c)?])
}

/// A vertex attribute inside a triangle; `None` if a vertex has none.
pub(crate) fn interpolated<T>(attribute: &[T], corners: [u32; 3], [b1, b2]: [f32; 2]) -> Option<T>
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let [a, b, c] = corners.map(|index| attribute.get(index as usize).copied());
    Some(a? * (1.0 - b1 - b2) + b? * b1 + c? * b2)
}
