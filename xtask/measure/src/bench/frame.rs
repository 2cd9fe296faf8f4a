//! Whole frames of the papers' set-ups: camera pass, light maps, shadows and shading, everything
//! anew, on one thread and on two.

use renderer::builtin;
use renderer::camera::{CameraOptions, choose, view};
use renderer::frame::{Frame, Goal, Shot};
use renderer::lighting::{LightJob, LightOptions};
use renderer::method::Method;
use renderer::prepared::Prepared;
use shadowmap_core::{Level, Light, Threads};

use super::{Bench, Case, Group, Variant, count, on};

/// Scene, method, side of the map, samples.
type Setup = (&'static str, Method, u32, u32);

/// A camera of 512 x 512 pixels, as in both papers.
const SETUPS: [Setup; 6] = [
    ("torus", Method::Search, 256, 1),
    ("torus", Method::Search, 1024, 1),
    ("crowded", Method::Search, 256, 1),
    ("torus", Method::Skins, 512, 3),
    ("torus", Method::Intervals, 1024, 2),
    ("crowded", Method::Intervals, 1024, 2),
];

/// The cases of this part.
pub fn cases(quick: bool) -> Vec<Case> {
    let mut cases = Vec::new();
    for setup in SETUPS {
        let (name, method, map, _) = setup;
        let group = format!("{name}, {method}, camera 512², map {map}²");
        cases.push(Case::new(1, move |bench| frame(bench, setup, 512, group, None)));
    }
    let sides: &[u32] = if quick { &[256, 1024] } else { &[256, 512, 1024, 2048, 4096] };
    for (name, method, samples) in [
        ("torus", Method::Search, 1),
        ("torus", Method::Intervals, 2),
        ("crowded", Method::Search, 1),
    ] {
        for &side in sides {
            let x = Some(("map side, texels", f64::from(side)));
            let group = format!("{name}, {method}, camera 512², map {side}");
            let setup = (name, method, side, samples);
            cases.push(Case::new(1, move |bench| frame(bench, setup, 512, group, x)));
            let x = Some(("camera side, pixels", f64::from(side)));
            let group = format!("{name}, {method}, map 1024², camera {side}");
            let setup = (name, method, 1024, samples);
            cases.push(Case::new(1, move |bench| frame(bench, setup, side, group, x)));
        }
    }
    cases
}

fn frame(
    bench: &mut Bench,
    (name, method, map_size, samples): Setup,
    side: u32,
    group: String,
    x: Option<(&'static str, f64)>,
) {
    let scene = builtin::scene(name).expect("a built-in scene");
    let prepared = Prepared::new(&scene);
    let linear = matches!(method, Method::Skins | Method::Intervals);
    let suits = |light: &Light| matches!(light, Light::Linear { .. }) == linear;
    let light = scene.lights.iter().find(|light| suits(&light.light)).expect("both kinds");
    let samples = (samples > 1).then_some(samples);
    let options =
        LightOptions { method: Some(method), samples, map_size, ..LightOptions::default() };
    let camera = choose(&scene, &CameraOptions::default()).expect("built-in scenes have cameras");
    let camera = view(&camera, [side, side], prepared.bounds());
    let job = LightJob::new(light, &options, &prepared, &camera);
    let jobs = [job.expect("the method knows the light")];
    let shot = Shot {
        prepared: &prepared,
        camera: &camera,
        aa: 1,
        lights: &jobs,
        tracer: None,
        goal: Goal::Srgb,
    };
    let mut plain = Frame::new(Level::SCALAR, Threads::One);
    plain.render(&shot);
    let variants = [Threads::One, Threads::Pool].map(|threads| {
        let mut frame = Frame::new(Level::detect(), threads);
        on(threads, || frame.render(&shot));
        assert!(frame.srgb() == plain.srgb(), "{group}: differs from plain Rust");
        let shot = &shot;
        Variant::on(threads, count(threads), move || frame.render(shot))
    });
    bench.compare(Group { name: group, x, work: Some((1.0, "frames")), variants: variants.into() });
}
