//! Whole frames of the papers' set-ups: camera pass, light maps, shadows and shading, everything
//! anew, on one thread and on two.

use renderer::frame::Frame;
use renderer::method::Method;
use shadowmap_core::{Level, Threads};

use super::setup::Setup;
use super::{Bench, Case, Group, Variant, count, on};

/// Pixels along either axis, as in both papers.
const CAMERA: u32 = 512;

/// Scene, method, side of the map, samples.
const SETUPS: [(&str, Method, u32, Option<u32>); 6] = [
    ("torus", Method::Search, 256, None),
    ("torus", Method::Search, 1024, None),
    ("crowded", Method::Search, 256, None),
    ("torus", Method::Skins, 512, Some(3)),
    ("torus", Method::Intervals, 1024, Some(2)),
    ("crowded", Method::Intervals, 1024, Some(2)),
];

/// The cases of this part.
pub fn cases(quick: bool) -> Vec<Case> {
    let mut cases = Vec::new();
    for (scene, method, map, samples) in SETUPS {
        let setup = Setup { scene, method, camera: CAMERA, map, samples };
        let group = format!("{scene}, {method}, camera 512², map {map}²");
        cases.push(Case::new(1, move |bench| frame(bench, setup, group, None)));
    }
    let sides: &[u32] = if quick { &[256, 1024] } else { &[256, 512, 1024, 2048, 4096] };
    for (scene, method, samples) in [
        ("torus", Method::Search, None),
        ("torus", Method::Intervals, Some(2)),
        ("crowded", Method::Search, None),
    ] {
        for &side in sides {
            let setup = Setup { scene, method, camera: CAMERA, map: side, samples };
            let group = format!("{scene}, {method}, camera 512², map {side}");
            let x = Some(("map side, texels", f64::from(side)));
            cases.push(Case::new(1, move |bench| frame(bench, setup, group, x)));
            let setup = Setup { camera: side, map: 1024, ..setup };
            let group = format!("{scene}, {method}, map 1024², camera {side}");
            let x = Some(("camera side, pixels", f64::from(side)));
            cases.push(Case::new(1, move |bench| frame(bench, setup, group, x)));
        }
    }
    cases
}

fn frame(bench: &mut Bench, setup: Setup, group: String, x: Option<(&'static str, f64)>) {
    setup.with_shot(|shot| {
        let mut plain = Frame::new(Level::SCALAR, Threads::One);
        plain.render(shot);
        let variants = [Threads::One, Threads::Pool].map(|threads| {
            let mut frame = Frame::new(Level::detect(), threads);
            on(threads, || frame.render(shot));
            assert!(frame.srgb() == plain.srgb(), "{group}: differs from plain Rust");
            Variant::on(threads, count(threads), move || frame.render(shot))
        });
        let work = Some((1.0, "frames"));
        bench.compare(Group { name: group, x, work, variants: variants.into() });
    });
}
