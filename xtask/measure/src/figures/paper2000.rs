//! The figures of the 2000 paper that compare pictures.

use maud::html;
use renderer::method::Method;
use shadowmap_core::Light;

use super::Effort;
use super::gallery::{Gallery, Of, section};
use super::page::{Section, Tiles};
use super::scenes::{built_in, pair, under_a_triangle};
use super::stage::Stage;
use super::way::Way;

fn is_linear(light: &Light) -> bool {
    matches!(light, Light::Linear { .. })
}

fn rays(count: u32) -> Way {
    Way::new(Method::RayTraced).samples(count)
}

fn points(count: u32) -> Way {
    Way::new(Method::PointSamples).samples(count)
}

/// Two point lights against the method with two samples.
pub fn figure_1(effort: &Effort) -> Section {
    let scene = built_in("torus");
    let mut tiles = Tiles::new("2000-1");
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_linear);
    let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
    gallery.show(&points(2), &[Of::Scene, Of::Error]);
    gallery.show_truth(Of::Scene);
    section(
        "2000-1",
        "2000, figure 1: a linear light as two point lights, and by this method",
        html! {},
        tiles,
        html! {},
    )
}

/// Undersampling and its cure; a triangle light.
pub fn figure_8(effort: &Effort) -> Section {
    let mut tiles = Tiles::new("2000-8");
    let scene = pair();
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_linear);
    let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
    gallery.show(&points(2), &[Of::Scene]);
    gallery.show(&points(3), &[Of::Scene]);
    gallery.show_truth(Of::Scene);
    let scene = under_a_triangle();
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(|_| true);
    let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
    gallery.show(&points(3), &[Of::Scene]);
    gallery.show_truth(Of::Scene);
    section("2000-8", "2000, figures 6 and 8: too few samples", html! {}, tiles, html! {})
}

/// One blocker, one linear light: 200 rays, the method with two samples, 10 rays.
pub fn figure_9(effort: &Effort) -> Section {
    let scene = built_in("blocker");
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_linear);
    let mut tiles = Tiles::new("2000-9");
    let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
    for way in [rays(200), rays(10)] {
        gallery.show(&way, &[Of::Scene, Of::Error]);
    }
    section("2000-9", "2000, figure 9: one blocker, one linear light", html! {}, tiles, html! {})
}

/// More complex scenes.
pub fn figure_10(effort: &Effort) -> Section {
    let mut tiles = Tiles::new("2000-10");
    for name in ["crowded", "grille"] {
        let scene = built_in(name);
        let mut stage = Stage::new(&scene, effort.size);
        let light = stage.light(is_linear);
        let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
        gallery.show(&points(2), &[Of::Scene, Of::Error]);
        gallery.show_truth(Of::Scene);
    }
    section("2000-10", "2000, figure 10: more complex scenes", html! {}, tiles, html! {})
}
