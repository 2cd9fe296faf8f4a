//! The scenes that need no file.
//!
//! `torus`, `blocker`, `crowded` and `grille` are made to measure: a ground and a few solids whose
//! numbers are round, each with a sphere light and a linear light to choose from. `show` is the
//! picture of a README. Object IDs follow the order of the tables, from 1, the ground.

use glam::{DVec3, Vec3, Vec4};
use shadowmap_core::Light;

use crate::scene::{CameraProjection, Material, Scene, SceneCamera, SceneLight};
use crate::shapes::{Solid, cuboid, ground, rectangle, sphere, torus};
use crate::show;

/// The names that [`scene`] knows.
pub const NAMES: [&str; 5] = ["torus", "blocker", "crowded", "grille", "show"];

/// Whether the lights of the built-in scene of that name are alternatives (the first that suits
/// the method is meant) rather than lights that shine at once.
#[must_use]
pub fn lights_are_alternatives(name: &str) -> bool {
    name != "show"
}

/// The built-in scene of that name.
#[must_use]
pub fn scene(name: &str) -> Option<Scene> {
    let mut scene = match name {
        "torus" => torus_scene(),
        "blocker" => blocker_scene(),
        "crowded" => crowded_scene(),
        "grille" => grille_scene(),
        "show" => show::scene(),
        _ => return None,
    };
    scene.name = name.to_owned();
    Some(scene)
}

/// The camera and the lights of a loaded mesh after [`Scene::fit`]; like those of the built-in
/// scenes, the lights are alternatives.
pub fn set_up_fitted(scene: &mut Scene) {
    scene.camera = Some(camera([0.0, 5.0, 9.0], [0.0, 1.5, 0.0]));
    scene.lights =
        vec![disc_light([2.0, 8.0, 3.0], 0.5), linear_light([1.0, 8.0, 3.0], [3.0, 8.0, 3.0])];
}

fn torus_scene() -> Scene {
    let mut scene = on_ground();
    let solid = torus(DVec3::new(0.0, 1.5, 0.0), [1.0, 0.35], [30.0, 0.0], [64, 32]);
    add(&mut scene, "torus", WARM, &solid);
    scene.camera = Some(camera([0.0, 5.0, 8.0], [0.0, 0.8, 0.0]));
    scene.lights =
        vec![disc_light([1.5, 6.0, 1.5], 0.5), linear_light([0.5, 6.0, 1.5], [2.5, 6.0, 1.5])];
    scene
}

fn blocker_scene() -> Scene {
    let mut scene = on_ground();
    add(&mut scene, "blocker", WARM, &rectangle(DVec3::new(0.0, 1.5, 0.0), 1.0, 0.5));
    scene.camera = Some(camera([0.0, 6.0, 7.0], [0.0, 0.0, 0.0]));
    scene.lights =
        vec![linear_light([-1.0, 4.0, 0.0], [1.0, 4.0, 0.0]), disc_light([0.0, 4.0, 0.0], 0.5)];
    scene
}

fn crowded_scene() -> Scene {
    // Centre, radii, tilt and yaw in degrees.
    const TORI: [([f64; 3], [f64; 2], [f64; 2]); 3] = [
        ([-2.2, 1.6, -0.8], [0.9, 0.28], [35.0, 20.0]),
        ([2.0, 2.2, -1.2], [0.8, 0.25], [60.0, -40.0]),
        ([0.1, 0.95, 1.4], [0.7, 0.22], [15.0, 75.0]),
    ];
    // Centre, half extents, yaw in degrees.
    const BOXES: [([f64; 3], [f64; 3], f64); 12] = [
        ([-3.5, 0.75, 1.5], [0.25, 0.75, 0.25], 0.0),
        ([-1.5, 0.5, 2.6], [0.4, 0.5, 0.3], 30.0),
        ([3.4, 1.0, 1.2], [0.2, 1.0, 0.2], 15.0),
        ([1.8, 0.35, 2.4], [0.5, 0.35, 0.35], -20.0),
        ([0.0, 2.8, -1.8], [0.9, 0.05, 0.4], 10.0),
        ([-3.0, 2.4, -2.4], [0.5, 0.06, 0.5], 45.0),
        ([3.2, 0.6, -3.0], [0.6, 0.6, 0.4], 5.0),
        ([-0.6, 1.5, -3.2], [0.15, 1.5, 0.15], 0.0),
        ([0.9, 0.25, 0.2], [0.25, 0.25, 0.25], 33.0),
        ([-1.2, 0.2, 0.6], [0.3, 0.2, 0.2], -15.0),
        ([0.6, 3.4, 0.6], [0.35, 0.04, 0.2], 60.0),
        ([-4.0, 0.3, -0.6], [0.3, 0.3, 0.6], 0.0),
    ];
    const SPHERES: [([f64; 3], f64); 6] = [
        ([-0.4, 0.5, -0.6], 0.5),
        ([2.9, 1.9, 0.2], 0.35),
        ([-2.4, 0.3, 0.6], 0.3),
        ([1.0, 1.7, -0.2], 0.3),
        ([-1.6, 3.0, 0.8], 0.25),
        ([3.8, 0.4, -1.2], 0.4),
    ];
    let mut scene = on_ground();
    for (i, (center, radii, angles)) in TORI.into_iter().enumerate() {
        let solid = torus(center.into(), radii, angles, [96, 48]);
        add(&mut scene, &format!("torus {}", i + 1), PALETTE[i], &solid);
    }
    for (i, (center, half, yaw)) in BOXES.into_iter().enumerate() {
        let solid = cuboid(center.into(), half.into(), yaw);
        add(&mut scene, &format!("box {}", i + 1), PALETTE[(i + 3) % PALETTE.len()], &solid);
    }
    for (i, (center, radius)) in SPHERES.into_iter().enumerate() {
        let solid = sphere(center.into(), radius);
        add(&mut scene, &format!("sphere {}", i + 1), PALETTE[(i + 1) % PALETTE.len()], &solid);
    }
    scene.camera = Some(camera([0.0, 6.0, 9.0], [0.0, 0.7, 0.0]));
    scene.lights =
        vec![disc_light([1.5, 8.0, 1.5], 0.5), linear_light([0.5, 8.0, 1.5], [2.5, 8.0, 1.5])];
    scene
}

fn grille_scene() -> Scene {
    let mut scene = on_ground();
    for i in 0..9 {
        let center = DVec3::new(-1.6 + 0.4 * f64::from(i), 2.0, 0.0);
        let bar = cuboid(center, DVec3::new(0.06, 0.06, 1.5), 0.0);
        add(&mut scene, &format!("bar {}", i + 1), WARM, &bar);
    }
    scene.camera = Some(camera([0.0, 6.0, 7.0], [0.0, 0.0, 0.0]));
    scene.lights =
        vec![linear_light([-1.0, 4.0, 0.0], [1.0, 4.0, 0.0]), disc_light([0.0, 4.0, 0.0], 0.3)];
    scene
}

/// Linear RGB of the ground.
const PALE: [f32; 3] = [0.62, 0.60, 0.57];
/// The colour of a ground that is added to a scene, linear RGBA.
pub const GROUND: Vec4 = Vec4::new(PALE[0], PALE[1], PALE[2], 1.0);
/// Linear RGB of the only object of a scene.
const WARM: [f32; 3] = [0.72, 0.36, 0.16];
/// Linear RGB of the objects of `crowded`.
const PALETTE: [[f32; 3]; 6] = [
    WARM,
    [0.16, 0.38, 0.52],
    [0.70, 0.58, 0.22],
    [0.30, 0.46, 0.24],
    [0.58, 0.22, 0.24],
    [0.52, 0.50, 0.48],
];

/// An empty scene with the ground as object 1.
fn on_ground() -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, "ground", PALE, &ground(5.0));
    scene
}

/// Appends `solid` as an object of one colour (linear RGB).
pub(crate) fn add(scene: &mut Scene, name: &str, color: [f32; 3], solid: &Solid) {
    let base_color = Vec4::new(color[0], color[1], color[2], 1.0);
    let known = scene.materials.iter().position(|m| m.base_color == base_color);
    let material = known.unwrap_or_else(|| {
        scene.materials.push(Material { base_color, ..Material::default() });
        scene.materials.len() - 1
    });
    let first = scene.mesh.positions.len();
    scene.add_object(name, material as u32, &solid.positions, &solid.triangles);
    // A zero normal stands for the flat one.
    scene.normals.resize(first, Vec3::ZERO);
    scene.normals.extend_from_slice(&solid.normals);
    scene.normals.resize(scene.mesh.positions.len(), Vec3::ZERO);
}

fn camera(eye: [f32; 3], target: [f32; 3]) -> SceneCamera {
    let vertical_fov = 40f64.to_radians() as f32;
    SceneCamera {
        eye: eye.into(),
        target: target.into(),
        up: Vec3::Y,
        projection: CameraProjection::Perspective { vertical_fov },
    }
}

/// A white light of one candela; the picture is exposed for it.
fn white(name: &str, light: Light) -> SceneLight {
    SceneLight { name: name.to_owned(), light, color: Vec3::ONE, intensity: 1.0, spot: None }
}

fn disc_light(center: [f32; 3], radius: f32) -> SceneLight {
    white("sphere", Light::Sphere { center: center.into(), radius })
}

fn linear_light(a: [f32; 3], b: [f32; 3]) -> SceneLight {
    white("tube", Light::Linear { a: a.into(), b: b.into() })
}
