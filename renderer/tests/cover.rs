//! Maps that are fitted to what matters leave nothing out that does.

use glam::Vec3;
use linear_light::RectifiedLight;
use reference::{Samples, Tracer};
use renderer::builtin;
use renderer::camera::{CameraOptions, choose, view};
use renderer::cover::Cover;
use renderer::light_views::fit;
use renderer::prepared::Prepared;
use shadowmap_core::{Light, Threads, View};

const SIDE: u32 = 96;

/// The cameras of a scene: its own, and a close look at a part of it.
fn cameras(name: &str) -> [CameraOptions; 2] {
    let close = CameraOptions {
        target: Some(if name == "torus" { Vec3::new(-0.8, 0.0, -0.6) } else { Vec3::ZERO }),
        vertical_fov: Some(0.15),
        ..CameraOptions::default()
    };
    [CameraOptions::default(), close]
}

/// Asserts that no receiver outside `map` is in any shadow, and returns how many lie inside and
/// outside.
fn check(name: &str, light: &Light, camera: &View, tracer: &Tracer<'_>, map: &View) -> [usize; 2] {
    let rays = tracer.receivers(camera, Threads::Pool);
    let mut visibility = vec![0.0; rays.positions.len()];
    let samples = Samples::Fixed(64);
    let (positions, normals) = (&rays.positions, &rays.normals);
    tracer.visibility(light, positions, normals, samples, Threads::Pool, &mut visibility);
    let mut count = [0, 0];
    for ((&p, &normal), &visibility) in positions.iter().zip(normals).zip(&visibility) {
        if normal == Vec3::ZERO {
            continue;
        }
        let seen = map.texel_from_world(p).is_some_and(|t| {
            t.x >= 0.0 && t.y >= 0.0 && t.x <= map.width() as f32 && t.y <= map.height() as f32
        });
        count[usize::from(!seen)] += 1;
        assert!(seen || visibility == 1.0, "{name} {light:?}: {p} sees {visibility}");
    }
    count
}

#[test]
fn what_lies_outside_fitted_maps_is_lit() {
    let mut outside = 0;
    for name in ["torus", "blocker", "crowded", "grille"] {
        let scene = builtin::scene(name).unwrap();
        let prepared = Prepared::new(&scene);
        let tracer = Tracer::new(&scene.mesh.as_mesh());
        let sun = Light::Sun { direction: Vec3::new(-0.4, -1.0, -0.3), angle: 0.2 };
        let low = Light::Sphere { center: Vec3::new(4.0, 1.2, 0.5), radius: 0.3 };
        for options in cameras(name) {
            let camera = choose(&scene, &options).unwrap();
            let camera = view(&camera, [SIDE, SIDE], prepared.bounds());
            for light in scene.lights.iter().map(|light| light.light).chain([sun, low]) {
                let cover = Cover::new(&prepared, &light, &camera);
                let maps = if let Light::Linear { a, b } = light {
                    let [blockers, receivers] =
                        [&cover.blockers, &cover.receivers].map(|points| points.iter().copied());
                    let fitted = RectifiedLight::fit_around(a, b, 2, [64; 2], blockers, receivers);
                    fitted.frusta()[0].views().to_vec()
                } else {
                    fit(&light, None, None, 64, &cover)
                };
                if maps.len() > 2 {
                    // Several windows all around leave nothing out.
                    continue;
                }
                for map in &maps {
                    let [_, out] = check(name, &light, &camera, &tracer, map);
                    outside += out;
                }
            }
        }
    }
    assert!(outside > 10_000, "windows are tight: {outside}");
}

#[test]
fn a_close_look_gets_the_whole_map() {
    let scene = builtin::scene("crowded").unwrap();
    let prepared = Prepared::new(&scene);
    let light = scene.lights[0].light;
    let focal = cameras("crowded").map(|options| {
        let camera = choose(&scene, &options).unwrap();
        let camera = view(&camera, [SIDE, SIDE], prepared.bounds());
        fit(&light, None, None, 256, &Cover::new(&prepared, &light, &camera))[0].focal().x
    });
    assert!(focal[1] > 2.0 * focal[0], "{focal:?} texels");
}
