//! The hierarchy, the shafts and the masks against the plainest ray tracer there is.

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use reference::{RAY_OFFSET, Samples, Tracer, point_lights};
use shadowmap_core::{Light, Threads};

use crate::scenes::{Scene, blocker, camera, torus};

/// Whether the ray from `eye` meets the triangle before parameter `end` (Möller and Trumbore
/// 1997).
fn blocks([a, b, c]: [DVec3; 3], eye: DVec3, ray: DVec3, end: f64) -> bool {
    let (ab, ac) = (b - a, c - a);
    let across = ray.cross(ac);
    let scale = 1.0 / ab.dot(across);
    let from = eye - a;
    let u = from.dot(across) * scale;
    let over = from.cross(ab);
    let (v, t) = (ray.dot(over) * scale, ac.dot(over) * scale);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t <= end
}

/// Samples seen of `count`, every ray against every triangle.
fn brute(scene: &Scene, light: &Light, position: Vec3, normal: Vec3, count: u32) -> usize {
    let eye = position.as_dvec3() + normal.as_dvec3() * f64::from(RAY_OFFSET);
    // The samples on a disc that faces the receiver are those of the point lights towards it.
    let seen = |sample: &Light| {
        let (ray, end) = match *sample {
            Light::Point { position } => (position.as_dvec3() - eye, 1.0),
            Light::Sun { direction, .. } => (-direction.as_dvec3(), f64::INFINITY),
            _ => unreachable!(),
        };
        let corners = |t: &[u32; 3]| t.map(|i| scene.positions[i as usize].as_dvec3());
        normal.as_dvec3().dot(ray) > 0.0
            && !scene.triangles.iter().any(|t| blocks(corners(t), eye, ray, end))
    };
    point_lights(light, count, eye.as_vec3()).iter().filter(|sample| seen(sample)).count()
}

fn lights() -> Vec<Light> {
    let center = Vec3::new(1.5, 6.0, 1.5);
    vec![
        Light::Point { position: center },
        Light::Linear { a: Vec3::new(0.5, 6.0, 1.5), b: Vec3::new(2.5, 6.0, 1.5) },
        Light::Sphere { center, radius: 0.5 },
        Light::Sun { direction: -center, angle: 0.15 },
        Light::Triangle { a: center, b: center + Vec3::X, c: center + Vec3::new(0.3, 0.1, 1.0) },
        Light::Rectangle { corner: center, edge_u: Vec3::X * 0.7, edge_v: Vec3::Z },
        // In the middle of things.
        Light::Linear { a: Vec3::new(-1.5, 1.5, 0.1), b: Vec3::new(0.2, 1.6, 0.0) },
        Light::Sphere { center: Vec3::new(0.1, 1.6, 0.0), radius: 0.3 },
    ]
}

#[test]
fn every_light_equals_brute_force() {
    let scene = torus();
    let tracer = Tracer::new(&scene.mesh());
    let view = camera(Vec3::new(0.0, 5.0, 8.0), Vec3::new(0.0, 0.8, 0.0), 20);
    let seen = tracer.receivers(&view, Threads::Pool);
    for light in lights() {
        for count in [1, 3, 40] {
            let mut found = vec![0.0; seen.positions.len()];
            let samples = Samples::Fixed(count);
            tracer.visibility(
                &light,
                &seen.positions,
                &seen.normals,
                samples,
                Threads::Pool,
                &mut found,
            );
            let total = if matches!(light, Light::Point { .. }) { 1 } else { count };
            let (mut mixed, mut wrong) = (0, 0);
            for (i, &found) in found.iter().enumerate() {
                if seen.triangles[i] == u32::MAX {
                    continue;
                }
                let exact = brute(&scene, &light, seen.positions[i], seen.normals[i], count);
                let found = (found * total as f32).round() as usize;
                // A sample exactly on an edge may fall on either side of it.
                assert!(found.abs_diff(exact) <= 1, "{light:?} {count}: {found}, not {exact}");
                wrong += found.abs_diff(exact);
                mixed += usize::from(exact > 0 && exact < total as usize);
            }
            assert!(wrong <= 2, "{light:?} {count}: {wrong} samples differ");
            assert!(total == 1 || mixed > 0, "{light:?} has a penumbra");
        }
    }
}

/// Ten thousand rays through a closed ball of triangles, along its edges and into its corners.
#[test]
fn no_ray_slips_through_a_closed_surface() {
    let mut scene = Scene::default();
    scene.add_torus(Vec3::ZERO, [1.0, 0.5], 10.0, [24, 12], 1);
    let tracer = Tracer::new(&scene.mesh());
    // Receivers inside the tube.
    let inside = Vec3::new(1.0, 0.0, 0.01);
    let mut targets = scene.positions.clone();
    for t in &scene.triangles {
        let [a, b, c] = t.map(|i| scene.positions[i as usize]);
        targets.extend([(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5]);
    }
    for target in targets {
        let beyond = inside + (target - inside) * 9.0;
        let normal = (target - inside).normalize();
        let lights = [
            Light::Point { position: beyond },
            Light::Linear { a: beyond, b: beyond + Vec3::new(0.5, 0.2, 0.3) },
            Light::Sphere { center: beyond, radius: 0.5 },
        ];
        for light in lights {
            assert_eq!(tracer.visibility_at(&light, inside, normal, Samples::Fixed(64)), 0.0);
        }
    }
}

#[test]
fn threads_and_neighbours_do_not_change_a_bit() {
    let scene = blocker();
    let tracer = Tracer::new(&scene.mesh());
    let view = camera(Vec3::new(0.0, 6.0, 7.0), Vec3::ZERO, 64);
    let seen = tracer.receivers(&view, Threads::Pool);
    assert_eq!(seen, tracer.receivers(&view, Threads::One));
    let light = Light::Sphere { center: Vec3::new(0.0, 4.0, 0.0), radius: 0.5 };
    for samples in [Samples::Fixed(64), Samples::Jittered { count: 32, seed: 7 }] {
        let run = |threads| {
            let mut out = vec![0.0; seen.positions.len()];
            tracer.visibility(&light, &seen.positions, &seen.normals, samples, threads, &mut out);
            out
        };
        assert_eq!(run(Threads::One), run(Threads::Pool));
    }
    // Other seeds and other receivers get other samples.
    let jittered = |seed| {
        let (positions, normals) = (vec![Vec3::new(1.6, 0.0, 0.2); 64], vec![Vec3::Y; 64]);
        let mut out = vec![0.0; 64];
        let samples = Samples::Jittered { count: 4, seed };
        tracer.visibility(&light, &positions, &normals, samples, Threads::One, &mut out);
        out
    };
    assert!(jittered(1).iter().any(|&v| v != jittered(1)[0]));
    assert_ne!(jittered(1), jittered(2));
}

fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -3.0f32..3.0,
        1 => prop::sample::select(vec![0.0, -0.0, 1e-30, 1e11, 1e30, f32::NAN, f32::INFINITY, f32::MAX]),
    ]
}

fn any_vec() -> impl Strategy<Value = Vec3> {
    [any_float(), any_float(), any_float()].prop_map(Vec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Whatever the numbers, the answer is a fraction.
    #[test]
    fn any_input_gives_a_fraction(
        positions in prop::collection::vec(any_vec(), 12),
        triangles in prop::collection::vec([0u32..14, 0u32..14, 0u32..14], 0..12),
        [a, b, c, p, n] in [any_vec(), any_vec(), any_vec(), any_vec(), any_vec()],
        r in any_float(),
    ) {
        let ids = vec![1; triangles.len()];
        let scene = Scene { positions, triangles, ids };
        let tracer = Tracer::new(&scene.mesh());
        let lights = [
            Light::Point { position: a },
            Light::Linear { a, b },
            Light::Sphere { center: a, radius: r },
            Light::Sun { direction: a, angle: r },
            Light::Triangle { a, b, c },
            Light::Rectangle { corner: a, edge_u: b, edge_v: c },
        ];
        for light in lights {
            for samples in [Samples::Fixed(3), Samples::Fixed(65), Samples::Jittered { count: 17, seed: 1 }] {
                let v = tracer.visibility_at(&light, p, n, samples);
                prop_assert!((0.0..=1.0).contains(&v));
            }
        }
    }
}
