//! A shadow mask from depth maps of your own: here both are a few lines of arithmetic.
//!
//! `cargo run -p single-sample --example mask` prints the shadow of a square plate on the ground,
//! seen from above, under a light of 20 cm radius.

use glam::Vec3;
use shadowmap_core::{Camera, DepthMap, Level, Surfaces, Threads, View, Window};
use simd_search::{NodeGroup, Pyramid};
use single_sample::{LightMap, Texels, search};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A light 3 m above the ground looks down. Nearness, for a perspective view, is 1 / depth.
    let light = View::perspective(Vec3::Y * 3.0, Vec3::ZERO, Vec3::NEG_Z, 1.0, 256, 256, 0.1);
    let plate = |u: f32, v: f32| (u - 128.0).abs() < 40.0 && (v - 128.0).abs() < 40.0;
    let texels: Vec<f32> = (0..256 * 256)
        .map(|i| if plate((i % 256) as f32, (i / 256) as f32) { 1.0 / 2.0 } else { 1.0 / 3.0 })
        .collect();
    let map = DepthMap::new(256, 256, &texels, &[])?;

    // The camera looks straight down, too, and sees the ground everywhere (it is below the plate).
    // For a parallel view, nearness is the distance from its far plane.
    let axes = View::axes_towards(Vec3::NEG_Y, Vec3::NEG_Z);
    let window = Window::centered(1.6, 1.6);
    let eye = Vec3::Y * 0.5;
    let camera = View::orthographic_window(eye, axes, window, 64, 32, [0.0, 1.0]);
    let pixels = [0.5; 64 * 32];
    let pixels = DepthMap::new(64, 32, &pixels, &[])?;

    // No normals at hand: planes come from the depths of neighbouring pixels.
    let camera = Camera::new(&camera, pixels, Surfaces::FromDepth)?;
    let light = LightMap::new(&light, Texels::Plain(map))?;
    let level = Level::detect();
    let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(256, 256)];
    let pyramid = Pyramid::build(level, map, &mut nodes, &mut [])?;
    let parameters = search::Parameters { radius: 0.2, ..Default::default() };
    let mut mask = [0_u8; 64 * 32];
    let counters =
        search::visibility(level, Threads::One, &camera, &light, &pyramid, &parameters, &mut mask);

    for row in mask.chunks(64) {
        let line: String =
            row.iter().map(|&v| char::from(b" .:-=+*#%@"[usize::from(v) * 9 / 255])).collect();
        println!("{line}");
    }
    println!("{counters:?}");
    Ok(())
}
