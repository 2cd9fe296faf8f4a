//! Interval visibility against ray-traced truth, for linear lights and for lights with an area.

use glam::Vec3;
use linear_light::{
    FrustumMaps, INTERVAL_BIAS, IntervalVisibility, RectifiedLight, SampleMap, lines,
};
use raster::{DepthBuffer, Payload, Rasterizer, Target};
use reference::{Receivers, Samples, Tracer, truth};
use renderer::prepared::Prepared;
use renderer::scene::Scene;
use renderer::{builtin, camera};
use shadowmap_core::{Camera, Level, Light, Surfaces, Threads, View};

const PENUMBRA: std::ops::Range<f32> = 0.002..0.998;

/// A built-in scene and what its camera sees.
struct Shot {
    scene: Scene,
    view: View,
    image: DepthBuffer,
    receivers: Receivers,
}

impl Shot {
    fn new(name: &str, size: u32) -> Shot {
        let scene = builtin::scene(name).unwrap();
        let view = camera::view(&scene.camera.unwrap(), [size; 2], scene.bounds());
        let mut image = DepthBuffer::new(size, size);
        let mesh = scene.mesh.as_mesh();
        let mut rasterizer = Rasterizer::new(Level::detect(), Threads::Pool);
        rasterizer.draw(&view, &mesh, Payload::TriangleIndex, image.target());
        let receivers = Tracer::new(&mesh).receivers(&view, Threads::Pool);
        Shot { view, image, receivers, scene }
    }

    fn linear(&self) -> Light {
        let linear = |light: &&Light| matches!(light, Light::Linear { .. });
        *self.scene.lights.iter().map(|light| &light.light).find(linear).unwrap()
    }

    fn truth(&self, light: &Light) -> Vec<f32> {
        let Receivers { positions, normals, .. } = &self.receivers;
        truth::cached(&self.scene.mesh.as_mesh(), positions, normals, light, Samples::TRUTH)
    }

    /// Visibility with `samples` maps on each of `count` lines.
    fn intervals(&self, light: &Light, count: usize, samples: usize, map: u32) -> Vec<f32> {
        self.at(Level::detect(), Threads::Pool, light, count, samples, map)
    }

    fn at(
        &self,
        level: Level,
        threads: Threads,
        light: &Light,
        count: usize,
        samples: usize,
        map: u32,
    ) -> Vec<f32> {
        let mesh = self.scene.mesh.as_mesh();
        let prepared = Prepared::new(&self.scene);
        let surfaces = Surfaces::Table(prepared.surfaces());
        let camera = Camera::new(&self.view, self.image.as_depth_map(), surfaces).unwrap();
        let mut rasterizer = Rasterizer::new(level, threads);
        let mut intervals = IntervalVisibility::new(level, threads);
        let mut sum = vec![0.0; self.image.nearness.len()];
        let mut out = sum.clone();
        for line in lines(light, count).unwrap() {
            let points = self.scene.mesh.positions.iter().copied();
            let light = RectifiedLight::fit(line.a, line.b, samples, [map; 2], points);
            let drawn: Vec<Vec<DepthBuffer>> = light
                .frusta()
                .iter()
                .map(|views| {
                    let mut maps = vec![DepthBuffer::new(map, map); samples];
                    let mut targets: Vec<Target<'_>> =
                        maps.iter_mut().map(DepthBuffer::target).collect();
                    let views = views.views();
                    rasterizer.draw_many(views, &mesh, Payload::ObjectId, &mut targets);
                    maps
                })
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
}

/// Root of the mean squared error over the penumbra.
fn penumbra_rmse(found: &[f32], truth: &[f32]) -> f64 {
    rmse(found.iter().zip(truth).filter(|(_, truth)| PENUMBRA.contains(truth)))
}

fn rmse<'a>(pairs: impl Iterator<Item = (&'a f32, &'a f32)>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (found, truth) in pairs {
        sum += f64::from(found - truth).powi(2);
        count += 1;
    }
    assert!(count > 500, "only {count} pixels to compare");
    (sum / f64::from(count)).sqrt()
}

/// A rectangle of 1 x 1 m around the middle of the torus scene's linear light.
fn panel() -> Light {
    Light::Rectangle { corner: Vec3::new(1.0, 6.0, 1.0), edge_u: Vec3::X, edge_v: Vec3::Z }
}

#[test]
fn two_samples_are_near_the_truth() {
    for (name, size, map, limit) in [
        ("torus", 512, 512, 0.013),
        ("torus", 512, 1024, 0.0085),
        ("crowded", 256, 1024, 0.021),
        ("grille", 256, 1024, 0.0025),
    ] {
        let shot = Shot::new(name, size);
        let light = shot.linear();
        let error = penumbra_rmse(&shot.intervals(&light, 1, 2, map), &shot.truth(&light));
        println!("{name} at {map}: {error:.4}");
        assert!(error <= limit, "{name} at {map}: {error} exceeds {limit}");
    }
}

#[test]
fn one_straight_edge_is_exact_to_a_texel() {
    let shot = Shot::new("blocker", 256);
    let light = shot.linear();
    let (found, truth) = (shot.intervals(&light, 1, 2, 1024), shot.truth(&light));
    // The edges of the shadow along the light are as sharp as a row of the map.
    let away = |(i, _): &(usize, _)| (shot.receivers.positions[*i].z.abs() - 0.8).abs() > 0.03;
    let pairs = found.iter().zip(&truth).enumerate().filter(away).map(|(_, pair)| pair);
    let error = rmse(pairs.filter(|(_, truth)| PENUMBRA.contains(truth)));
    println!("blocker: {error:.4}");
    assert!(error <= 0.0025, "{error}");
}

#[test]
fn more_lines_are_nearer_to_a_rectangle() {
    let shot = Shot::new("torus", 512);
    let truth = shot.truth(&panel());
    let limits = [(2, 0.045), (4, 0.018), (8, 0.009)];
    for (count, limit) in limits {
        let error = penumbra_rmse(&shot.intervals(&panel(), count, 2, 1024), &truth);
        println!("{count} lines: {error:.4}");
        assert!(error <= limit, "{count} lines: {error} exceeds {limit}");
    }
}

#[test]
fn a_light_inside_its_scene_casts_shadows_all_around() {
    // A tube in the middle of the crowded scene, which has several frusta.
    let shot = Shot::new("crowded", 192);
    let light = Light::Linear { a: Vec3::new(-0.8, 1.3, 0.3), b: Vec3::new(0.4, 1.6, 0.5) };
    let (found, truth) = (shot.intervals(&light, 1, 2, 1024), shot.truth(&light));
    let error = rmse(found.iter().zip(&truth));
    println!("light inside: {error:.4}");
    assert!(error <= 0.09, "{error}");
}

#[test]
fn levels_and_threads_give_the_same_bytes() {
    let shot = Shot::new("crowded", 128);
    let light = shot.linear();
    let expected = shot.at(Level::SCALAR, Threads::One, &light, 1, 3, 256);
    for level in Level::available() {
        for threads in [Threads::One, Threads::Pool] {
            let found = shot.at(level, threads, &light, 1, 3, 256);
            assert!(found == expected, "{level:?} on {threads:?} differs");
        }
    }
}
