//! The figures of the 2000 paper that compare pictures.

use maud::html;
use renderer::method::Method;
use renderer::scene::Scene;
use shadowmap_core::Light;

use super::Effort;
use super::gallery::{Gallery, Of, section};
use super::line::Line;
use super::page::{Section, Tiles};
use super::plot::{Axes, Curve, Scale, Stroke, plot};
use super::samples::Samples;
use super::scenes::{built_in, pair, slope, under_a_triangle};
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

/// Visibility along a line on the receiver.
pub fn figure_2(effort: &Effort) -> Section {
    let count = if effort.quick { 400 } else { 1600 };
    let axes = Axes {
        x: "position along the receiver, x (m)",
        y: "visibility",
        scale: Scale::Linear([0.0, 1.05]),
    };
    let draw = |scene: &Scene, ends: [f32; 2], height: f32| {
        let mut line = Line::new(scene, ends, 0.0, height, count);
        let curves = [
            Curve::new("truth", Stroke::Truth, line.truth()),
            Curve::new("two point lights", Stroke::Dashed, line.visibility(&points(2))),
            Curve::new("ten point lights", Stroke::Line, line.visibility(&points(10))),
        ];
        plot(axes, &curves)
    };
    let parallel = draw(&built_in("blocker"), [-3.5, 3.5], 1.0);
    let leaning = draw(&slope(25.0), [-5.0, 2.5], 1.7);
    Section {
        id: "2000-2",
        title: "2000, figure 2: visibility along the receiver".to_owned(),
        body: html! {
            div.plots {
                div { h3 { "Light and receiver are parallel" } (parallel) }
                div { h3 { "The receiver leans by 25 degrees" } (leaning) }
            }
        },
        pictures: Vec::new(),
    }
}

/// Skins, and what each sample contributes.
pub fn figure_4(effort: &Effort) -> Section {
    let scene = built_in("blocker");
    let samples = Samples::new(&scene, 2, if effort.quick { 256 } else { 512 });
    let Light::Linear { a, b } = scene.lights[0].light else { unreachable!("a linear light") };
    let [left, right] = [0, 1].map(|k| samples.cut(k, 0.0, 3.5));
    let ends = [a, b].map(|p| (f64::from(p.x), f64::from(p.y)));
    let curves = [
        Curve::new("light", Stroke::Truth, ends.to_vec()),
        Curve::new("surfaces in the left map", Stroke::Line, left.surfaces),
        Curve::new("skins in the right map", Stroke::Dashed, right.skins),
        Curve::new("skins in the left map", Stroke::Dashed, left.skins),
    ];
    let axes = Axes { x: "x (m)", y: "height (m)", scale: Scale::Linear([0.0, 4.5]) };
    Section {
        id: "2000-4",
        title: "2000, figure 4: skins between the maps of two samples".to_owned(),
        body: plot(axes, &curves),
        pictures: Vec::new(),
    }
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
