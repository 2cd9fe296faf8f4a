//! What the passes draw: triangles in world space, their materials, lights and a camera.
//!
//! A scene comes from a file ([`crate::load`]) or from code. Its mesh is flat: instances are
//! repeated and node transforms applied, so that every pass sees one list of triangles.

mod texture;

use glam::{DVec3, Vec2, Vec3, Vec4};
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

    /// Scales the scene so that the largest extent of its bounding box is 4, centred on
    /// x = z = 0 and resting on y = 0. The camera and the lights move along; lights keep the
    /// brightness they had on the surfaces. Does nothing to a scene without extent.
    pub fn fit(&mut self) {
        let Some(bounds) = self.bounds() else { return };
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let largest = (max - min).max_element();
        if largest <= 0.0 {
            return;
        }
        let scale = 4.0 / largest;
        let center = (min + max) * 0.5;
        let origin = DVec3::new(center.x, min.y, center.z);
        let place = |p: Vec3| ((p.as_dvec3() - origin) * scale).as_vec3();
        let size = scale as f32;

        self.mesh.positions.iter_mut().for_each(|p| *p = place(*p));
        if let Some(camera) = &mut self.camera {
            camera.eye = place(camera.eye);
            camera.target = place(camera.target);
            if let CameraProjection::Orthographic { height } = &mut camera.projection {
                *height *= size;
            }
        }
        for SceneLight { light, intensity, .. } in &mut self.lights {
            if light.center().is_some() {
                *intensity *= size * size;
            }
            match light {
                Light::Point { position } => *position = place(*position),
                Light::Sphere { center, radius } => {
                    *center = place(*center);
                    *radius *= size;
                }
                Light::Linear { a, b } => [*a, *b] = [*a, *b].map(place),
                Light::Triangle { a, b, c } => [*a, *b, *c] = [*a, *b, *c].map(place),
                Light::Rectangle { corner, edge_u, edge_v } => {
                    *corner = place(*corner);
                    *edge_u *= size;
                    *edge_v *= size;
                }
                // A sun has no place; other shapes do not come from files.
                _ => {}
            }
        }
    }

    /// Puts a square ground of two triangles under the scene, the centre of its bounding box over
    /// the ground's middle and the edge 2.5 times the largest extent: after [`Scene::fit`], x and
    /// z in \[-5, 5\] at y = 0. The ground becomes the first object: it has ID 1 and the first
    /// two triangles, and every other ID grows by one. A scene with nothing in it gets the ground
    /// around the origin.
    ///
    /// # Panics
    ///
    /// When the scene would exceed 2^32 vertices.
    pub fn add_ground(&mut self) {
        let bounds = self.bounds().unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO });
        let extent = bounds.extent().max_element();
        let half = if extent > 0.0 { 1.25 * extent } else { 5.0 };
        let center = bounds.center();
        let corner =
            |x: f32, z: f32| Vec3::new(center.x + x * half, bounds.min.y, center.z + z * half);
        let corners = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
        let material = index_u32(self.materials.len());
        self.materials.push(Material { name: "ground".into(), ..Material::default() });

        self.add_object("ground", material, &corners, &[[0, 1, 2], [0, 2, 3]]);
        self.mesh.triangles.rotate_right(2);
        self.triangle_materials.rotate_right(2);
        self.object_names.rotate_right(1);
        self.mesh.ids.rotate_right(2);
        for (triangle, id) in self.mesh.ids.iter_mut().enumerate() {
            *id = if triangle < 2 { 1 } else { *id + 1 };
        }
    }

    /// Adds a warning unless the same was said before.
    pub fn warn(&mut self, warning: impl Into<String>) {
        let warning = warning.into();
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(scale: f32, offset: Vec3) -> Scene {
        let mut scene = Scene { materials: vec![Material::default()], ..Scene::default() };
        let corners = [Vec3::ZERO, Vec3::X, Vec3::new(0.3, 0.5, 0.7)];
        let id = scene.add_object("a", 0, &corners.map(|p| p * scale + offset), &[[0, 1, 2]]);
        assert_eq!(id, 1);
        scene
    }

    #[test]
    fn fitted_scene_is_four_wide_and_rests_on_the_ground() {
        for (scale, offset) in
            [(1.0, Vec3::ZERO), (0.013, Vec3::splat(7.3)), (1e4, Vec3::new(-3e3, 1e3, 17.0))]
        {
            let mut scene = triangle(scale, offset);
            scene.fit();
            let bounds = scene.bounds().unwrap();
            assert_eq!(bounds.min.y, 0.0);
            assert!((bounds.extent().max_element() - 4.0).abs() < 1e-6);
            assert!(bounds.center().x.abs() < 1e-6 && bounds.center().z.abs() < 1e-6);
            scene.add_ground();
            let ground = scene.mesh.triangles[0].map(|i| scene.mesh.positions[i as usize]);
            assert_eq!(ground[0], Vec3::new(-5.0, 0.0, -5.0));
            assert_eq!(ground[2], Vec3::new(5.0, 0.0, 5.0));
            let normal = (ground[1] - ground[0]).cross(ground[2] - ground[0]);
            assert!(normal.y > 0.0);
        }
    }

    #[test]
    fn fit_moves_lights_and_keeps_their_brightness() {
        let mut scene = triangle(2.0, Vec3::X);
        let light = Light::Sphere { center: Vec3::new(2.0, 3.0, 0.7), radius: 0.5 };
        let sphere = SceneLight {
            name: String::new(),
            light,
            color: Vec3::ONE,
            intensity: 10.0,
            spot: None,
        };
        scene.lights.push(sphere);
        scene.fit();
        let Light::Sphere { center, radius } = scene.lights[0].light else { panic!() };
        assert_eq!((center, radius), (Vec3::new(0.0, 6.0, 0.0), 1.0));
        assert_eq!(scene.lights[0].intensity, 40.0);
    }

    #[test]
    fn ground_is_the_first_object() {
        let mut scene = triangle(1.0, Vec3::ZERO);
        scene.add_ground();
        assert_eq!(scene.mesh.ids, [1, 1, 2]);
        assert_eq!(scene.mesh.triangles[2], [0, 1, 2]);
        assert_eq!(scene.triangle_materials, [1, 1, 0]);
        assert_eq!(scene.object_names, ["ground", "a"]);
        assert_eq!(scene.materials[1].name, "ground");
    }

    #[test]
    fn attributes_cover_objects_without_them() {
        let mut scene = triangle(1.0, Vec3::ZERO);
        scene.uvs = vec![Vec2::ONE; 3];
        scene.add_ground();
        assert_eq!(scene.uvs.len(), scene.mesh.positions.len());
        assert!(scene.normals.is_empty() && scene.colors.is_empty());
    }

    #[test]
    fn nothing_to_bound() {
        let mut scene = Scene::default();
        assert_eq!(scene.bounds(), None);
        scene.fit();
        scene.add_ground();
        assert_eq!(scene.bounds().unwrap().extent(), Vec3::new(10.0, 0.0, 10.0));
    }
}
