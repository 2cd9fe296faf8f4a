//! Scenes of the same kind as those of the papers' figures.

use glam::{DVec3, Vec3};
use renderer::builtin;
use renderer::scene::{CameraProjection, Scene, SceneCamera, SceneLight};
use renderer::shapes::{Solid, cuboid, rectangle, torus};
use shadowmap_core::Light;

const ORANGE: [f32; 3] = [0.72, 0.36, 0.16];
const BLUE: [f32; 3] = [0.16, 0.38, 0.52];

/// A built-in scene.
pub fn built_in(name: &str) -> Scene {
    builtin::scene(name).expect("the names in this crate are those of built-in scenes")
}

/// Two plates side by side under a linear light: below the gap their penumbrae overlap, and there
/// the light's middle is seen but neither of its ends.
pub fn pair() -> Scene {
    let mut scene = empty();
    for (x, color) in [(-0.81, ORANGE), (0.81, BLUE)] {
        let plate = rectangle(DVec3::new(x, 1.5, 0.0), 0.6, 0.6);
        add(&mut scene, "plate", color, &plate);
    }
    look(&mut scene, [0.0, 5.0, 6.5], [0.0, 0.2, 0.0]);
    scene.lights = vec![linear([-1.0, 4.0, 0.0], [1.0, 4.0, 0.0])];
    scene
}

/// A torus over a plane, at a height and a tilt.
pub fn torus_at(height: f64, tilt: f64) -> Scene {
    let mut scene = empty();
    let solid = torus(DVec3::new(0.0, height, 0.0), [1.0, 0.35], [tilt, 0.0], [96, 48]);
    add(&mut scene, "torus", ORANGE, &solid);
    look(&mut scene, [0.0, 5.0, 8.0], [0.0, 0.8, 0.0]);
    scene.lights = vec![sphere([1.5, 6.0, 1.5], 0.4)];
    scene
}

/// A box and a torus under a triangle light, as the right of figure 8 of the 2000 paper.
pub fn under_a_triangle() -> Scene {
    let mut scene = empty();
    let block = cuboid(DVec3::new(-1.0, 0.9, 0.2), DVec3::new(0.35, 0.35, 0.35), 25.0);
    add(&mut scene, "box", BLUE, &block);
    let ring = torus(DVec3::new(0.9, 1.0, 0.0), [0.6, 0.2], [25.0, 0.0], [96, 48]);
    add(&mut scene, "torus", ORANGE, &ring);
    look(&mut scene, [0.0, 5.0, 6.5], [0.0, 0.3, 0.0]);
    let [a, b, c] = [[-0.6, 4.5, -0.5], [0.6, 4.5, -0.5], [0.0, 4.5, 0.6]].map(Vec3::from);
    scene.lights = vec![light("triangle", Light::Triangle { a, b, c })];
    scene
}

/// The crowded scene under a light so low that it needs a very wide frustum.
pub fn wide_spot() -> Scene {
    let mut scene = built_in("crowded");
    scene.lights = vec![sphere([0.4, 4.4, 0.8], 0.25)];
    scene
}

/// A bar near the ground, hidden from the middle of a sphere light by a bar higher up.
pub fn hidden_from_the_middle() -> Scene {
    let mut scene = bars(&[0.0]);
    scene.lights = vec![sphere([0.0, 4.0, 0.0], 0.5)];
    scene
}

/// A bar near the ground, hidden from both ends of a linear light by two bars higher up.
pub fn hidden_from_both_ends() -> Scene {
    let mut scene = bars(&[-2.0 / 3.0, 2.0 / 3.0]);
    scene.lights = vec![linear([-1.0, 4.0, 0.0], [1.0, 4.0, 0.0])];
    scene
}

/// A bar at 1 m, and others at 3 m.
fn bars(upper: &[f64]) -> Scene {
    let mut scene = empty();
    let low = cuboid(DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.08, 0.02, 1.2), 0.0);
    add(&mut scene, "lower bar", BLUE, &low);
    for &x in upper {
        let high = cuboid(DVec3::new(x, 3.0, 0.0), DVec3::new(0.1, 0.02, 1.2), 0.0);
        add(&mut scene, "upper bar", ORANGE, &high);
    }
    look(&mut scene, [0.0, 5.0, 7.5], [0.0, 0.8, 0.0]);
    scene
}

/// A tube along a receiver that leans away from it: visibility is no longer linear across the
/// penumbra.
pub fn slope(degrees: f64) -> Scene {
    let mut scene = Scene::default();
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let lean = |p: Vec3| {
        let p = p.as_dvec3();
        DVec3::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos, p.z).as_vec3()
    };
    let mut plane = rectangle(DVec3::ZERO, 6.0, 5.0);
    plane.positions.iter_mut().for_each(|p| *p = lean(*p));
    add(&mut scene, "ground", [0.62, 0.60, 0.57], &plane);
    let plate = rectangle(DVec3::new(0.0, 2.0, 0.0), 0.7, 0.6);
    add(&mut scene, "plate", ORANGE, &plate);
    look(&mut scene, [0.0, 6.0, 7.0], [0.0, 0.0, 0.0]);
    scene.lights = vec![linear([-1.0, 4.0, 0.0], [1.0, 4.0, 0.0])];
    scene
}

/// A ground and nothing else.
fn empty() -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, "ground", [0.62, 0.60, 0.57], &rectangle(DVec3::ZERO, 5.0, 5.0));
    scene
}

fn add(scene: &mut Scene, name: &str, color: [f32; 3], solid: &Solid) {
    let material = scene.materials.len() as u32;
    scene.materials.push(renderer::scene::Material {
        base_color: Vec3::from(color).extend(1.0),
        ..renderer::scene::Material::default()
    });
    scene.add_object(name, material, &solid.positions, &solid.triangles);
    scene.normals.extend_from_slice(&solid.normals);
    // A zero normal stands for the flat one.
    scene.normals.resize(scene.mesh.positions.len(), Vec3::ZERO);
}

fn look(scene: &mut Scene, eye: [f32; 3], target: [f32; 3]) {
    let vertical_fov = 40.0_f32.to_radians();
    scene.camera = Some(SceneCamera {
        eye: eye.into(),
        target: target.into(),
        up: Vec3::Y,
        projection: CameraProjection::Perspective { vertical_fov },
    });
}

fn linear(a: [f32; 3], b: [f32; 3]) -> SceneLight {
    light("tube", Light::Linear { a: a.into(), b: b.into() })
}

fn sphere(center: [f32; 3], radius: f32) -> SceneLight {
    light("sphere", Light::Sphere { center: center.into(), radius })
}

/// A white light of one candela; pictures are exposed for it.
fn light(name: &str, light: Light) -> SceneLight {
    SceneLight { name: name.to_owned(), light, color: Vec3::ONE, intensity: 1.0, spot: None }
}
