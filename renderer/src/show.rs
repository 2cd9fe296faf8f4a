//! The scene for the front page: a knot on a plinth between a warm globe and a cool tube.

use core::f64::consts::TAU;

use glam::{DVec3, Vec3};
use shadowmap_core::Light;

use crate::builtin::add;
use crate::scene::{CameraProjection, Scene, SceneCamera, SceneLight};
use crate::shapes::{Solid, cuboid, ground, sphere, tube};

/// The scene, lit by a sphere light from the left and a linear light from the right.
pub(crate) fn scene() -> Scene {
    let mut scene = Scene::default();
    add(&mut scene, "ground", [0.60, 0.58, 0.55], &ground(6.0));
    let plinth = cuboid(DVec3::new(0.0, 0.2, 0.0), DVec3::new(0.95, 0.2, 0.95), 20.0);
    add(&mut scene, "plinth", [0.50, 0.48, 0.46], &plinth);
    add(&mut scene, "knot", [0.78, 0.33, 0.13], &knot(DVec3::new(0.0, 1.45, 0.0)));
    for i in 0..9 {
        let center = DVec3::new(-3.0 + 0.28 * f64::from(i), 0.9, 0.75 - 0.22 * f64::from(i));
        let slat = cuboid(center, DVec3::new(0.035, 0.9, 0.09), 52.0);
        add(&mut scene, &format!("slat {}", i + 1), [0.22, 0.36, 0.44], &slat);
    }
    for (i, &(x, z, radius, color)) in BALLS.iter().enumerate() {
        let ball = sphere(DVec3::new(x, radius, z), radius);
        add(&mut scene, &format!("ball {}", i + 1), color, &ball);
    }
    scene.camera = Some(SceneCamera {
        eye: Vec3::new(0.4, 4.6, 7.6),
        target: Vec3::new(0.05, 0.75, 0.15),
        up: Vec3::Y,
        projection: CameraProjection::Perspective { vertical_fov: 36f64.to_radians() as f32 },
    });
    scene.lights = vec![
        SceneLight {
            name: "globe".into(),
            light: Light::Sphere { center: Vec3::new(-3.6, 4.8, 2.8), radius: 0.4 },
            color: Vec3::new(1.0, 0.80, 0.58),
            intensity: 30.0,
            spot: None,
        },
        SceneLight {
            name: "tube".into(),
            light: Light::Linear { a: Vec3::new(0.6, 4.6, -3.4), b: Vec3::new(4.6, 4.6, -2.2) },
            color: Vec3::new(0.55, 0.76, 1.0),
            intensity: 26.0,
            spot: None,
        },
    ];
    scene
}

/// Place on the ground, radius and colour of the balls.
const BALLS: [(f64, f64, f64, [f32; 3]); 5] = [
    (1.75, 1.15, 0.36, [0.20, 0.42, 0.55]),
    (2.35, 0.25, 0.22, [0.74, 0.58, 0.20]),
    (1.15, 1.95, 0.18, [0.66, 0.24, 0.22]),
    (-1.05, 1.75, 0.27, [0.36, 0.48, 0.26]),
    (2.75, 1.55, 0.14, [0.62, 0.60, 0.57]),
];

/// A (2, 3) torus knot around `center`.
fn knot(center: DVec3) -> Solid {
    const ALONG: u32 = 320;
    const AROUND: u32 = 28;
    let curve = |t: f64| {
        let (sin3, cos3) = libm::sincos(3.0 * t);
        let (sin2, cos2) = libm::sincos(2.0 * t);
        let ring = 0.62 + 0.25 * cos3;
        center + DVec3::new(ring * cos2, ring * sin2 * 1.1, 0.34 * sin3)
    };
    tube(ALONG, AROUND, |i, j| {
        let t = TAU * f64::from(i) / f64::from(ALONG);
        let forward = (curve(t + 1e-4) - curve(t - 1e-4)).normalize();
        // A frame that needs no transport: outwards from the knot's centre.
        let out = (curve(t) - center).reject_from(forward).normalize();
        let side = out.cross(forward);
        let (sin, cos) = libm::sincos(TAU * f64::from(j) / f64::from(AROUND));
        let normal = out * cos + side * sin;
        [curve(t) + 0.155 * normal, normal]
    })
}
