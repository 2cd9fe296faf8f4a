//! Hashes of maps, visibility and pictures of the built-in scenes, for every method.
//!
//! The same table must come out at every SIMD level, with any number of threads, on every target.
#![deny(unsafe_code)]

use std::fmt::Write;

use renderer::builtin;
use renderer::camera::{CameraOptions, choose, view};
use renderer::frame::{Frame, Goal, Shot};
use renderer::lighting::{LightJob, LightOptions};
use renderer::method::{Method, light_kind};
use renderer::prepared::Prepared;
use renderer::scene::{Scene, SceneLight};
use shadowmap_core::{Level, Threads};
use tiny_render::hash;

pub mod golden;
#[cfg(target_family = "wasm")]
mod wasm;

/// Camera pixels and map texels: small, so that emulators are done in seconds.
const CAMERA: [u32; 2] = [128, 96];
const MAP: u32 = 256;

/// Scenes whose hashes are taken.
const SCENES: [&str; 4] = ["torus", "blocker", "crowded", "grille"];

/// One line `item<TAB>hash` per map, mask and picture.
///
/// # Panics
///
/// If a built-in scene is missing.
#[must_use]
pub fn table(level: Level, threads: Threads) -> String {
    let mut lines = String::new();
    let mut line = |item: &str, bytes: &[u8]| {
        writeln!(lines, "{item}\t{:016x}", hash(bytes)).expect("strings take all that is written");
    };
    line("tiny mask", &tiny_render::mask(level));
    let mut frame = Frame::new(level, threads);
    for name in SCENES {
        let scene = builtin::scene(name).expect("a built-in scene");
        for light in &scene.lights {
            for method in Method::ALL {
                if method != Method::RayTraced && method.fits(&light.light) {
                    let item = format!("{name} {} {method}", light_kind(&light.light));
                    render(&mut frame, &scene, light, method);
                    line(&format!("{item} map"), &bits(&frame.maps()[0].nearness));
                    line(&format!("{item} visibility"), &bits(&frame.visibility()[0]));
                    line(&format!("{item} picture"), frame.srgb());
                }
            }
        }
    }
    lines
}

fn render(frame: &mut Frame, scene: &Scene, light: &SceneLight, method: Method) {
    let prepared = Prepared::new(scene);
    let options = LightOptions { method: Some(method), map_size: MAP, ..Default::default() };
    let camera = choose(scene, &CameraOptions::default()).expect("built-in scenes have cameras");
    let camera = view(&camera, CAMERA, prepared.bounds());
    let job = LightJob::new(light, &options, &prepared, &camera);
    let job = job.expect("the method knows the light");
    frame.render(&Shot {
        prepared: &prepared,
        camera: &camera,
        aa: 1,
        lights: &[job],
        tracer: None,
        goal: Goal::Srgb,
    });
}

fn bits(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_bits().to_le_bytes()).collect()
}
