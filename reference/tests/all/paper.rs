//! Answers known on paper.

use std::f64::consts::PI;

use glam::Vec3;
use reference::{Samples, Tracer};
use shadowmap_core::{Light, Threads, View};

use crate::scenes::{Scene, blocker, camera};

/// The exact visibility of the linear light of `blocker` from (x, 0, z).
fn blocker_visibility(x: f64, z: f64) -> f64 {
    if (0.625 * z).abs() >= 0.5 {
        return 1.0;
    }
    let a = ((-1.0 - 0.625 * x) / 0.375).max(-1.0);
    let b = ((1.0 - 0.625 * x) / 0.375).min(1.0);
    1.0 - (b - a).max(0.0) / 2.0
}

#[test]
fn blocker_equals_the_closed_form() {
    let scene = blocker();
    let tracer = Tracer::new(&scene.mesh());
    let view = camera(Vec3::new(0.0, 6.0, 7.0), Vec3::ZERO, 256);
    let seen = tracer.receivers(&view, Threads::Pool);
    let light = Light::Linear { a: Vec3::new(-1.0, 4.0, 0.0), b: Vec3::new(1.0, 4.0, 0.0) };
    let mut found = vec![0.0; seen.positions.len()];
    let samples = Samples::TRUTH;
    tracer.visibility(&light, &seen.positions, &seen.normals, samples, Threads::Pool, &mut found);
    let (mut worst, mut penumbra) = (0.0_f64, 0);
    for ((&position, &triangle), &found) in seen.positions.iter().zip(&seen.triangles).zip(&found) {
        match triangle {
            0 | 1 => {
                assert_eq!(position.y, 0.0);
                let exact = blocker_visibility(f64::from(position.x), f64::from(position.z));
                // The rays start 1e-4 m above the ground: a receiver on the hard side of the
                // shadow may fall on the other one.
                let edge = ((0.625 * f64::from(position.z)).abs() - 0.5).abs() < 1e-4;
                if !edge {
                    worst = worst.max((exact - f64::from(found)).abs());
                }
                penumbra += usize::from(exact > 0.002 && exact < 0.998);
            }
            u32::MAX => assert_eq!(found, 0.0),
            _ => assert_eq!(found, 1.0, "the blocker's upper side sees the whole light"),
        }
    }
    assert!(penumbra > 2000, "{penumbra} receivers in the penumbra");
    assert!(worst < 1e-3, "largest error {worst}");
}

/// A half-plane above a receiver that hides the part `y > s` of a disc light's radius.
#[test]
fn a_straight_edge_under_a_disc() {
    for s in [-1.2, -0.9, -0.5, -0.1, 0.0, 0.3, 0.7, 0.95, 1.1_f32] {
        // Half way between receiver and light, the edge appears twice as far out.
        let mut scene = Scene::default();
        scene.add_rectangle([s * 0.25, 100.0], [-100.0, 100.0], 2.0, 1);
        let tracer = Tracer::new(&scene.mesh());
        let light = Light::Sphere { center: Vec3::new(0.0, 4.0, 0.0), radius: 0.5 };
        let found = tracer.visibility_at(&light, Vec3::ZERO, Vec3::Y, Samples::TRUTH);
        let s = f64::from(s).clamp(-1.0, 1.0);
        let exact = 0.5 + (s.asin() + s * (1.0 - s * s).sqrt()) / PI;
        assert!((f64::from(found) - exact).abs() < 1e-3, "s {s}: {found}, not {exact}");
    }
}

/// A receiver whose plane cuts the light sees the part above the plane.
#[test]
fn the_horizon_cuts_the_light() {
    let tracer = Tracer::new(&Scene::default().mesh());
    let normal = Vec3::Y;
    let see =
        |light: Light| f64::from(tracer.visibility_at(&light, Vec3::ZERO, normal, Samples::TRUTH));
    let linear = Light::Linear { a: Vec3::new(1.0, -1.0, 0.0), b: Vec3::new(1.0, 3.0, 0.0) };
    assert!((see(linear) - 0.75).abs() < 1e-3);
    let disc = Light::Sphere { center: Vec3::new(3.0, 0.0, 0.0), radius: 1.0 };
    assert!((see(disc) - 0.5).abs() < 1e-3);
    let sun = Light::Sun { direction: Vec3::new(1.0, 0.0, 2.0), angle: 0.01 };
    assert!((see(sun) - 0.5).abs() < 1e-3);
    // The part of a triangle above the height h of its own height 1 has the area (1 - h)^2.
    let triangle = Light::Triangle {
        a: Vec3::new(2.0, 0.7, 1.0),
        b: Vec3::new(2.0, -0.3, 0.0),
        c: Vec3::new(2.0, -0.3, 2.0),
    };
    assert!((see(triangle) - 0.49).abs() < 2e-3);
    let rectangle = Light::Rectangle {
        corner: Vec3::new(2.0, -0.25, 0.0),
        edge_u: Vec3::new(0.5, 1.0, 0.0),
        edge_v: Vec3::Z,
    };
    assert!((see(rectangle) - 0.75).abs() < 1e-3);
    for y in [-0.5, 0.5] {
        let point = Light::Point { position: Vec3::new(1.0, y, 0.0) };
        assert_eq!(see(point), if y > 0.0 { 1.0 } else { 0.0 });
    }
}

/// A blocker half way to a sun of diameter `angle` hides what its size says.
#[test]
fn a_sun_behind_an_edge() {
    let mut scene = Scene::default();
    scene.add_rectangle([0.0, 1000.0], [-1000.0, 1000.0], 10.0, 1);
    let tracer = Tracer::new(&scene.mesh());
    let sun = Light::Sun { direction: Vec3::NEG_Y, angle: 0.2 };
    let radius = 10.0 * (0.1_f64).tan();
    for s in [-0.8, -0.2, 0.0, 0.6_f64] {
        let position = Vec3::new((-s * radius) as f32, 0.0, 0.0);
        let found = f64::from(tracer.visibility_at(&sun, position, Vec3::Y, Samples::TRUTH));
        let exact = 0.5 + (s.asin() + s * (1.0 - s * s).sqrt()) / PI;
        assert!((found - exact).abs() < 1e-3, "s {s}: {found}, not {exact}");
    }
}

/// Blockers behind the light do not block it, and those in front do.
#[test]
fn rays_end_on_the_light() {
    for (y, exact) in [(4.5, 1.0), (3.5, 0.0), (-0.5, 1.0)] {
        let mut scene = Scene::default();
        scene.add_rectangle([-9.0, 9.0], [-9.0, 9.0], y, 1);
        let tracer = Tracer::new(&scene.mesh());
        let ends = [Vec3::new(-1.0, 4.0, 0.0), Vec3::new(1.0, 4.0, 0.0)];
        let lights = [
            Light::Point { position: ends[0] },
            Light::Linear { a: ends[0], b: ends[1] },
            Light::Sphere { center: ends[1], radius: 0.4 },
        ];
        for light in lights {
            for count in [1, 16, 4096] {
                let found =
                    tracer.visibility_at(&light, Vec3::ZERO, Vec3::Y, Samples::Fixed(count));
                assert_eq!(found, exact, "{light:?} {count}, blocker at {y}");
            }
        }
    }
}

/// The upper half of a panel is cut out.
#[test]
fn holes_let_light_through() {
    let mut scene = Scene::default();
    scene.add_rectangle([-9.0, 9.0], [-9.0, 9.0], 2.0, 1);
    let has_holes = [true, true];
    let (positions, triangles) = (scene.positions.clone(), scene.triangles.clone());
    let is_opaque = |triangle: u32, weights: [f32; 3]| {
        let corners = triangles[triangle as usize].map(|i| positions[i as usize]);
        let place: Vec3 = corners.iter().zip(weights).map(|(&c, w)| c * w).sum();
        place.x > 0.0
    };
    let cutouts = reference::Cutouts { has_holes: &has_holes, is_opaque: &is_opaque };
    let tracer = Tracer::with_cutouts(&scene.mesh(), cutouts);
    let light = Light::Linear { a: Vec3::new(-1.0, 4.0, 0.0), b: Vec3::new(3.0, 4.0, 0.0) };
    for count in [4, 8, 4096] {
        let found = tracer.visibility_at(&light, Vec3::ZERO, Vec3::Y, Samples::Fixed(count));
        assert_eq!(found, 0.25, "{count} samples");
    }
}

/// A millimetre or a thousand kilometres: a low plate hides the light, and a slope does not hide it
/// from itself.
#[test]
fn scenes_of_every_size() {
    for scale in [1e-4, 1e-3, 1.0, 1e2, 1e4, 1e6_f32] {
        let light = Light::Sphere { center: Vec3::Y * (4.0 * scale), radius: 0.5 * scale };
        let samples = Samples::TRUTH;
        let mut scene = Scene::default();
        scene.add_rectangle([-scale, scale], [-scale, scale], 0.02 * scale, 1);
        let plate = scene.positions.len();
        scene.add_rectangle([-5.0 * scale, 5.0 * scale], [-5.0 * scale, 5.0 * scale], 0.0, 2);
        let below = Tracer::new(&scene.mesh());
        assert_eq!(below.visibility_at(&light, Vec3::ZERO, Vec3::Y, samples), 0.0, "{scale}");
        for position in &mut scene.positions[plate..] {
            position.y = 0.3 * position.x + 0.2 * position.z - 2.0 * scale;
        }
        let slope = Tracer::new(&scene.mesh());
        let view = View::perspective(
            Vec3::new(3.1, 1.7, 3.3) * scale,
            Vec3::new(2.9, -0.5, 2.7) * scale,
            Vec3::Y,
            0.6,
            64,
            64,
            1e-3 * scale,
        );
        let seen = slope.receivers(&view, Threads::One);
        let mut found = vec![0.0; seen.positions.len()];
        let (threads, samples) = (Threads::One, Samples::Fixed(8));
        slope.visibility(&light, &seen.positions, &seen.normals, samples, threads, &mut found);
        for (position, found) in seen.positions.iter().zip(&found) {
            assert_eq!(*found, 1.0, "{scale}: {position}");
        }
    }
}
