//! Seats a loaded model: size, place and the ground under it.

use glam::{DVec3, Vec3};
use shadowmap_core::Light;

use super::{Bounds, CameraProjection, Material, Scene, SceneLight, index_u32};
use crate::prepared::corners;

impl Scene {
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
    /// around the origin. One with a floor of its own, all the way down, stands on that: the ground
    /// lies below it, by a two thousandth of the largest extent.
    ///
    /// # Panics
    ///
    /// When the scene would exceed 2^32 vertices.
    pub fn add_ground(&mut self) {
        let bounds = self.bounds().unwrap_or(Bounds { min: Vec3::ZERO, max: Vec3::ZERO });
        let extent = bounds.extent().max_element();
        let half = if extent > 0.0 { 1.25 * extent } else { 5.0 };
        let center = bounds.center();
        let below = if self.has_floor(bounds.min.y) { extent / 2000.0 } else { 0.0 };
        let level = bounds.min.y - below;
        let corner = |x: f32, z: f32| Vec3::new(center.x + x * half, level, center.z + z * half);
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

    /// Whether some triangle lies at that height and faces up: it would be seen in one place with
    /// the ground.
    fn has_floor(&self, height: f32) -> bool {
        self.mesh
            .triangles
            .iter()
            .filter_map(|&triangle| corners(self, triangle))
            .any(|[a, b, c]| [a.y, b.y, c.y] == [height; 3] && (b - a).cross(c - a).y > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

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
    fn ground_lies_below_a_floor() {
        let mut scene = triangle(1.0, Vec3::ZERO);
        let corners = [Vec3::ZERO, Vec3::Z * 4.0, Vec3::X];
        for (floor, level) in [([0, 2, 1], 0.0), ([0, 1, 2], -0.002)] {
            scene.add_object("floor", 0, &corners, &[floor]);
            let mut grounded = scene.clone();
            grounded.add_ground();
            assert_eq!(grounded.bounds().unwrap().min.y, level);
        }
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
