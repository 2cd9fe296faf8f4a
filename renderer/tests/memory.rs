//! Long runs hold their memory, and what is too large is refused before any of it is taken.

use std::alloc::{GlobalAlloc, Layout, System};
use std::fs;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use renderer::builtin;
use renderer::camera::{CameraOptions, choose, view};
use renderer::frame::{Frame, Goal, Shot};
use renderer::lighting::{LightJob, LightOptions};
use renderer::method::Method;
use renderer::prepared::Prepared;
use shadowmap_core::{Level, Threads};

/// Counts the bytes that are in use.
struct Counting;

static IN_USE: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        IN_USE.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        IN_USE.fetch_add(size, Ordering::Relaxed);
        IN_USE.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Frames of one round, each with another scene, light, method or size.
const ROUND: [(&str, Method, u32); 10] = [
    ("torus", Method::Search, 40),
    ("blocker", Method::Intervals, 32),
    ("grille", Method::Search, 24),
    ("torus", Method::Skins, 40),
    ("crowded", Method::SearchPaper, 32),
    ("torus", Method::PointSamples, 24),
    ("blocker", Method::Pcss, 40),
    ("torus", Method::Intervals, 48),
    ("crowded", Method::Hard, 32),
    ("torus", Method::Pcf, 40),
];

/// Draws all frames of a round, its objects moved by `shift`.
fn round(frame: &mut Frame, shift: f32) {
    for (name, method, size) in ROUND {
        let mut scene = builtin::scene(name).unwrap();
        let half = scene.mesh.positions.len() / 2;
        scene.mesh.positions[half..].iter_mut().for_each(|p| *p += Vec3::X * shift);
        let prepared = Prepared::new(&scene);
        let light = scene.lights.iter().find(|light| method.fits(&light.light)).unwrap();
        let camera = choose(&scene, &CameraOptions::default()).unwrap();
        let camera = view(&camera, [size, 24], prepared.bounds());
        let options = LightOptions {
            method: Some(method),
            map_size: 2 * size,
            samples: (method == Method::PointSamples).then_some(3),
            ..Default::default()
        };
        let job = LightJob::new(light, &options, &prepared, &camera).unwrap();
        frame.render(&Shot {
            prepared: &prepared,
            camera: &camera,
            aa: 1,
            lights: &[job],
            tracer: None,
            goal: Goal::Srgb,
        });
    }
}

#[test]
fn a_thousand_frames_of_changing_scenes_hold_memory_flat() {
    let mut frame = Frame::new(Level::detect(), Threads::One);
    let mut most = 0;
    for i in 0..100 {
        round(&mut frame, (i % 7) as f32 * 0.02);
        let in_use = IN_USE.load(Ordering::Relaxed);
        if i < 7 {
            // Until every scene was seen once, memory grows to what the largest needs.
            most = in_use.max(most);
        }
        assert!(in_use <= most + (1 << 16), "round {i}: {in_use} bytes in use, before {most}");
    }
}

/// What is refused, and the option that the message names.
#[test]
fn what_is_too_large_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut square = String::from("v 0 0 0\nv 1 0 0\nv 1 1 0\n");
    square.push_str(&"f 1 2 3\n".repeat(1000));
    fs::write(folder.path().join("many.obj"), square).unwrap();
    for (arguments, words) in [
        (&["torus", "--size", "16384x16384", "--max-memory", "4000"][..], "--max-memory"),
        (
            &["torus", "--size", "8x8", "--map-size", "16384", "--max-memory", "1000"],
            "--max-memory",
        ),
        (
            &["torus", "--light", "linear:0,5,0:1,5,0", "--method", "skins", "--samples", "65536"],
            "--samples 65536",
        ),
        (&["many.obj", "--max-triangles", "999"], "--max-triangles"),
        (&["torus", "--max-triangles", "0"], "--max-triangles 0: "),
        (&["torus", "--max-memory", "0"], "--max-memory 0: "),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
        let output = command.current_dir(&folder).arg("render").args(arguments).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert!(message.contains(words), "{arguments:?}: {message}");
        assert_eq!(message.matches('\n').count(), 1, "{arguments:?}: {message}");
    }
    // One more than is refused.
    let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
    let small =
        ["render", "many.obj", "--max-triangles", "1000", "--size", "8x8", "--map-size", "8"];
    assert!(command.current_dir(&folder).args(small).status().unwrap().success());
}
