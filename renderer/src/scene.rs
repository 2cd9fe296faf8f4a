//! What the passes draw: triangles in world space, their materials, lights and a camera.
//!
//! A scene comes from a file ([`crate::load`]) or from code. Its mesh is flat: instances are
//! repeated and node transforms applied, so that every pass sees one list of triangles.

mod fit;
mod texture;

use glam::{Vec2, Vec3, Vec4};
use shadowmap_core::{Light, Mesh};

pub use texture::{Texture, Wrap};

/// Triangles that own their memory. See [`Mesh`], which borrows them.
#[derive(Clone, Debug, Default)]
pub struct TriangleMesh {
    /// Vertex positions in metres, world space.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` per triangle.
    pub triangles: Vec<[u32; 3]>,
    /// The object ID of each triangle, from 1.
    pub ids: Vec<u32>,
}

impl TriangleMesh {
    /// The triangles as the rasterizer and the ray tracer take them.
    #[must_use]
    pub fn as_mesh(&self) -> Mesh<'_> {
        Mesh { positions: &self.positions, triangles: &self.triangles, ids: &self.ids }
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The middle of the box.
    #[must_use]
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// The lengths of the box's edges.
    #[must_use]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }
}

/// What the alpha of a material means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// Points with alpha below the cutoff are holes, for the camera and for every light.
    Mask(f32),
    /// Alpha blends with what lies behind.
    Blend,
}

/// How a surface looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file; may be empty.
    pub name: String,
    /// Linear RGBA. Multiplies the texture and the vertex colours.
    pub base_color: Vec4,
    /// Index into [`Scene::textures`].
    pub texture: Option<usize>,
    /// What its alpha means.
    pub alpha_mode: AlphaMode,
    /// Whether the camera sees its back faces. Both sides always block light.
    pub double_sided: bool,
    /// Linear RGB that the surface emits by itself, in the unit of the shaded picture.
    pub emissive: Vec3,
}

impl Default for Material {
    /// Opaque, white, visible from both sides.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            emissive: Vec3::ZERO,
        }
    }
}

/// How a [`SceneCamera`] projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraProjection {
    /// A pin-hole camera with this vertical field of view in radians, in (0, pi).
    Perspective {
        /// Vertical field of view in radians.
        vertical_fov: f32,
    },
    /// A parallel projection.
    Orthographic {
        /// The height of the picture in metres.
        height: f32,
    },
}

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneCamera {
    /// Where it stands.
    pub eye: Vec3,
    /// A point it looks at, distinct from `eye`.
    pub target: Vec3,
    /// A direction that is up in the picture; need not be of unit length.
    pub up: Vec3,
    /// How it projects.
    pub projection: CameraProjection,
}

/// The cone that a spot light shines into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCone {
    /// The way the light travels, of unit length.
    pub direction: Vec3,
    /// Half angle in radians within which the light is at its full brightness.
    pub inner: f32,
    /// Half angle in radians beyond which there is no light, in (inner, pi/2].
    pub outer: f32,
}

/// A light with its colour.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLight {
    /// Its name in the file; may be empty.
    pub name: String,
    /// Shape, place and size.
    pub light: Light,
    /// Linear RGB.
    pub color: Vec3,
    /// Luminous intensity in candela; for a sun, illuminance in lux.
    pub intensity: f32,
    /// The cone of a spot light.
    pub spot: Option<SpotCone>,
}

/// Everything that a render needs.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Its name: the file's stem or the built-in's.
    pub name: String,
    /// All triangles, in world space.
    pub mesh: TriangleMesh,
    /// A unit shading normal per vertex, or empty. Zero where the file has none: use the flat
    /// normal of the triangle there.
    pub normals: Vec<Vec3>,
    /// Coordinates in the material's texture per vertex, (0, 0) at its top left; or empty.
    pub uvs: Vec<Vec2>,
    /// Linear RGBA per vertex, or empty.
    pub colors: Vec<Vec4>,
    /// Index into `materials` per triangle.
    pub triangle_materials: Vec<u32>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The textures.
    pub textures: Vec<Texture>,
    /// The name of the object with ID i at i - 1.
    pub object_names: Vec<String>,
    /// The camera, if the file has one.
    pub camera: Option<SceneCamera>,
    /// The lights, if the file has any.
    pub lights: Vec<SceneLight>,
    /// What was left out while loading, each said once.
    pub warnings: Vec<String>,
}

impl Scene {
    /// Appends triangles as a new object and returns its ID. `triangles` index `positions`. The
    /// object has flat normals.
    ///
    /// # Panics
    ///
    /// When the scene would exceed 2^32 vertices.
    pub fn add_object(
        &mut self,
        name: &str,
        material: u32,
        positions: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> u32 {
        self.object_names.push(name.to_owned());
        let id = index_u32(self.object_names.len());
        let base = index_u32(self.mesh.positions.len());
        index_u32(self.mesh.positions.len() + positions.len());
        self.mesh.positions.extend_from_slice(positions);
        self.mesh.triangles.extend(triangles.iter().map(|t| t.map(|i| base + i)));
        self.mesh.ids.resize(self.mesh.triangles.len(), id);
        self.triangle_materials.resize(self.mesh.triangles.len(), material);
        let vertices = self.mesh.positions.len();
        pad(&mut self.normals, vertices, Vec3::ZERO);
        pad(&mut self.uvs, vertices, Vec2::ZERO);
        pad(&mut self.colors, vertices, Vec4::ONE);
        id
    }

    /// The smallest box around all triangles; `None` when there is nothing to draw.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let corners = self.mesh.triangles.iter().flatten();
        let mut points = corners
            .filter_map(|&i| self.mesh.positions.get(i as usize).copied())
            .filter(|p| p.is_finite());
        let first = points.next()?;
        let (min, max) =
            points.fold((first, first), |(min, max), p| (Vec3::min(min, p), Vec3::max(max, p)));
        Some(Bounds { min, max })
    }

    /// Adds a warning unless the same was said before. After 50, no more are taken.
    pub fn warn(&mut self, warning: impl Into<String>) {
        const MOST: usize = 50;
        let warning = warning.into();
        if self.warnings.len() < MOST && !self.warnings.contains(&warning) {
            self.warnings.push(warning);
            if self.warnings.len() == MOST {
                self.warnings.push("further warnings are left out".into());
            }
        }
    }
}

fn index_u32(index: usize) -> u32 {
    u32::try_from(index).expect("a scene holds fewer than 2^32 vertices")
}

/// Fills an attribute that some object has, for an object that has none.
fn pad<T: Clone>(attribute: &mut Vec<T>, vertices: usize, fill: T) {
    if !attribute.is_empty() {
        attribute.resize(vertices, fill);
    }
}
