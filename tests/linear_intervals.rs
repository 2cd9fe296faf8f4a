//! Interval visibility against ray-traced truth, for linear lights and for lights with an area.

use glam::Vec3;
use linear_light::{
    FrustumMaps, INTERVAL_BIAS, IntervalVisibility, RectifiedLight, SampleMap, lines,
};
use raster::{DepthBuffer, Rasterizer};
use renderer::builtin;
use renderer::prepared::Prepared;
use shadowmap_core::{Camera, Level, Light, Surfaces, Threads};
use workspace_tests::{PENUMBRA, Stage, draw, rmse};

fn stage(name: &str, size: u32) -> Stage {
    Stage::of(builtin::scene(name).unwrap(), size)
}

/// Visibility with `samples` maps on each of `count` lines.
fn intervals(stage: &Stage, light: &Light, count: usize, samples: usize, map: u32) -> Vec<f32> {
    at(stage, Level::detect(), Threads::Pool, light, count, samples, map)
}

fn at(
    stage: &Stage,
    level: Level,
    threads: Threads,
    light: &Light,
    count: usize,
    samples: usize,
    map: u32,
) -> Vec<f32> {
    let mesh = stage.scene.mesh.as_mesh();
    let prepared = Prepared::new(&stage.scene);
    let surfaces = Surfaces::Table(prepared.surfaces());
    let camera = Camera::new(&stage.view, stage.image.as_depth_map(), surfaces).unwrap();
    let mut rasterizer = Rasterizer::new(level, threads);
    let mut intervals = IntervalVisibility::new(level, threads);
    let mut sum = vec![0.0; stage.image.nearness.len()];
    let mut out = sum.clone();
    for line in lines(light, count).unwrap() {
        let points = stage.scene.mesh.positions.iter().copied();
        let light = RectifiedLight::fit(line.a, line.b, samples, [map; 2], points);
        let drawn: Vec<Vec<DepthBuffer>> = light
            .frusta()
            .iter()
            .map(|frustum| draw(&mut rasterizer, frustum.views(), &mesh))
            .collect();
        let at = |k: usize| k as f32 / (samples - 1) as f32;
        let maps: Vec<Vec<SampleMap<'_>>> = drawn
            .iter()
            .map(|maps| {
                let maps = maps.iter().enumerate();
                maps.map(|(k, map)| SampleMap { t: at(k), map: map.as_depth_map() }).collect()
            })
            .collect();
        let frusta: Vec<FrustumMaps<'_>> = light
            .frusta()
            .iter()
            .zip(&maps)
            .map(|(views, samples)| FrustumMaps { views, samples })
            .collect();
        intervals.prepare(&frusta);
        intervals.visibility(&camera, &frusta, INTERVAL_BIAS, &mut out);
        for (sum, out) in sum.iter_mut().zip(&out) {
            *sum += line.weight * out;
        }
    }
    sum
}

/// Root of the mean squared error over the penumbra.
fn penumbra_rmse(found: &[f32], truth: &[f32]) -> f64 {
    rmse(found.iter().zip(truth).filter(|(_, truth)| PENUMBRA.contains(truth)))
}

/// A rectangle of 1 x 1 m around the middle of the torus scene's linear light.
fn panel() -> Light {
    Light::Rectangle { corner: Vec3::new(1.0, 6.0, 1.0), edge_u: Vec3::X, edge_v: Vec3::Z }
}

#[test]
fn two_samples_are_near_the_truth() {
    for (name, size, map, limit) in [
        ("torus", 512, 512, 0.011),
        ("torus", 512, 1024, 0.0082),
        ("crowded", 256, 1024, 0.0167),
        ("grille", 256, 1024, 0.0029),
    ] {
        let seen = stage(name, size);
        let light = seen.linear();
        let error = penumbra_rmse(&intervals(&seen, &light, 1, 2, map), &seen.truth(&light));
        println!("{name} at {map}: {error:.4}");
        assert!(error <= limit, "{name} at {map}: {error} exceeds {limit}");
    }
}

#[test]
fn one_straight_edge_is_exact_to_a_texel() {
    let seen = stage("blocker", 256);
    let light = seen.linear();
    let (found, truth) = (intervals(&seen, &light, 1, 2, 1024), seen.truth(&light));
    // The edges of the shadow along the light are as sharp as a row of the map.
    let away = |(i, _): &(usize, _)| (seen.receivers.positions[*i].z.abs() - 0.8).abs() > 0.03;
    let pairs = found.iter().zip(&truth).enumerate().filter(away).map(|(_, pair)| pair);
    let error = rmse(pairs.filter(|(_, truth)| PENUMBRA.contains(truth)));
    println!("blocker: {error:.4}");
    assert!(error <= 0.0014, "{error}");
}

#[test]
fn more_lines_are_nearer_to_a_rectangle() {
    // The edges of the blocker are parallel to the panel's, those of the torus to nothing.
    for (name, limits) in [
        ("torus", [(2, 0.045), (4, 0.030), (8, 0.0115)]),
        ("blocker", [(2, 0.12), (4, 0.0115), (8, 0.0037)]),
    ] {
        let seen = stage(name, 512);
        let truth = seen.truth(&panel());
        for (count, limit) in limits {
            let error = penumbra_rmse(&intervals(&seen, &panel(), count, 2, 1024), &truth);
            println!("{name}, {count} lines: {error:.4}");
            assert!(error <= limit, "{name}, {count} lines: {error} exceeds {limit}");
        }
    }
}

#[test]
fn a_light_that_points_at_its_scene_casts_shadows_where_it_points() {
    // The line through both ends meets the blocker, and the ground in its shadow.
    let light = Light::Linear { a: Vec3::new(0.4, 4.5, 0.3), b: Vec3::new(0.1, 3.0, 0.1) };
    let seen = stage("blocker", 256);
    let (found, truth) = (intervals(&seen, &light, 1, 2, 1024), seen.truth(&light));
    let error = rmse(found.iter().zip(&truth));
    println!("blocker from above: {error:.4}");
    assert!(error <= 0.0012, "{error}");
}

#[test]
fn a_light_inside_its_scene_casts_shadows_all_around() {
    // A tube in the middle of the crowded scene, which has several frusta.
    let seen = stage("crowded", 192);
    let light = Light::Linear { a: Vec3::new(-0.8, 1.3, 0.3), b: Vec3::new(0.4, 1.6, 0.5) };
    let (found, truth) = (intervals(&seen, &light, 1, 2, 1024), seen.truth(&light));
    let error = rmse(found.iter().zip(&truth));
    println!("light inside: {error:.4}");
    assert!(error <= 0.0145, "{error}");
}

#[test]
fn levels_and_threads_give_the_same_bytes() {
    let seen = stage("crowded", 128);
    let light = seen.linear();
    let expected = at(&seen, Level::SCALAR, Threads::One, &light, 1, 3, 256);
    for level in Level::available() {
        for threads in [Threads::One, Threads::Pool] {
            let found = at(&seen, level, threads, &light, 1, 3, 256);
            assert!(found == expected, "{level:?} on {threads:?} differs");
        }
    }
}
