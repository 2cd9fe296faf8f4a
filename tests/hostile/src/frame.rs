//! Whole frames: any scene of a few triangles under any light, by every method.

use glam::Vec3;
use reference::Tracer;
use renderer::camera::view;
use renderer::frame::{Frame, Goal, Shot};
use renderer::light_views::ByHand;
use renderer::lighting::{LightJob, LightOptions};
use renderer::method::Method;
use renderer::prepared::Prepared;
use renderer::scene::{CameraProjection, Material, Scene, SceneCamera, SceneLight, SpotCone};
use shadowmap_core::{Level, Light, Threads};

use crate::any::{Bytes, assert_same, assert_unit};

pub fn check(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let scene = scene(bytes);
    let prepared = Prepared::new(&scene);
    let light = light(bytes);
    let fitting: Vec<Method> =
        Method::ALL.into_iter().filter(|method| method.fits(&light.light)).collect();
    let default = LightOptions::default();
    let options = LightOptions {
        method: Some(fitting[usize::from(bytes.byte()) % fitting.len()]),
        samples: Some(2 + bytes.up_to(2)),
        map_size: 1 + bytes.up_to(23),
        by_hand: (bytes.byte() < 64)
            .then(|| ByHand { target: bytes.vector(), fov: bytes.number() }),
        ..default
    };
    let camera = view(&camera(bytes), [14, 12], prepared.bounds());
    let Ok(job) = LightJob::new(&light, &options, &prepared, &camera) else { return };
    let tracer = Tracer::new(&scene.mesh.as_mesh());
    let shot = Shot {
        prepared: &prepared,
        camera: &camera,
        aa: 2,
        lights: std::slice::from_ref(&job),
        tracer: Some(&tracer),
        goal: if bytes.flag() { Goal::Srgb } else { Goal::Linear },
    };
    let [one, other] = [Level::SCALAR, bytes.level()].map(|level| {
        let mut frame = Frame::new(level, Threads::One);
        frame.render(&shot);
        frame
    });
    assert_unit(&one.visibility()[0]);
    assert_same("levels", &other.visibility()[0], &one.visibility()[0]);
    assert_eq!(other.srgb(), one.srgb());
    assert!(one.linear().iter().all(|value| *value >= 0.0), "{:?}", one.linear());
}

/// A ground, and a few triangles above it or anywhere.
fn scene(bytes: &mut Bytes<'_>) -> Scene {
    let mut scene = Scene { materials: vec![Material::default()], ..Scene::default() };
    let mut corners = vec![
        [Vec3::new(-4.0, 0.0, -4.0), Vec3::new(-4.0, 0.0, 4.0), Vec3::new(4.0, 0.0, 4.0)],
        [Vec3::new(-4.0, 0.0, -4.0), Vec3::new(4.0, 0.0, 4.0), Vec3::new(4.0, 0.0, -4.0)],
    ];
    for _ in 0..bytes.up_to(4) {
        let sound = bytes.byte() < 128;
        corners.push([0; 3].map(|_| match sound {
            true => Vec3::from_array([0; 3].map(|_| f32::from(bytes.byte()) / 64.0 - 2.0)),
            false => bytes.vector(),
        }));
    }
    for (i, corners) in corners.into_iter().enumerate() {
        // As a loader would: only what is finite and not too far out.
        if corners.iter().all(|p| p.is_finite() && p.abs().max_element() <= 1e18) {
            let first = scene.mesh.positions.len() as u32;
            scene.mesh.positions.extend(corners);
            scene.mesh.triangles.push([first, first + 1, first + 2]);
            scene.mesh.ids.push(i as u32 / 2 + 1);
            scene.triangle_materials.push(0);
        }
    }
    scene
}

fn light(bytes: &mut Bytes<'_>) -> SceneLight {
    let sound = bytes.flag();
    let mut point = |sound_point: Vec3| if sound { sound_point } else { bytes.vector() };
    let (a, b) = (point(Vec3::new(-1.0, 5.0, 0.0)), point(Vec3::new(1.0, 5.0, 0.5)));
    let c = point(Vec3::new(0.0, 5.5, 1.0));
    let size = if sound { 0.5 } else { bytes.number() };
    let light = match bytes.byte() % 6 {
        0 => Light::Point { position: a },
        1 => Light::Sphere { center: a, radius: size },
        2 => Light::Sun { direction: -a, angle: size },
        3 => Light::Linear { a, b },
        4 => Light::Triangle { a, b, c },
        _ => Light::Rectangle { corner: a, edge_u: b, edge_v: c },
    };
    let spot = (bytes.byte() < 32).then(|| SpotCone {
        direction: bytes.normal(),
        inner: bytes.number(),
        outer: bytes.number(),
    });
    SceneLight { name: String::new(), light, color: Vec3::ONE, intensity: 1.0, spot }
}

fn camera(bytes: &mut Bytes<'_>) -> SceneCamera {
    if bytes.byte() < 128 {
        return SceneCamera {
            eye: Vec3::new(0.0, 5.0, 7.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: CameraProjection::Perspective { vertical_fov: 0.8 },
        };
    }
    let projection = match bytes.flag() {
        true => CameraProjection::Perspective { vertical_fov: bytes.number() },
        false => CameraProjection::Orthographic { height: bytes.number() },
    };
    SceneCamera { eye: bytes.vector(), target: bytes.vector(), up: bytes.vector(), projection }
}
