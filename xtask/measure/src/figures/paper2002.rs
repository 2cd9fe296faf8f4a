//! The figures of the 2002 paper.

use maud::html;
use renderer::method::Method;
use shadowmap_core::Light;
use single_sample::paper;

use super::Effort;
use super::gallery::{Gallery, Of, section};
use super::page::{Section, Tiles};
use super::plot::{Axes, Curve, Scale, Stroke, plot};
use super::scenes::{built_in, torus_at, wide_spot};
use super::stage::Stage;
use super::way::Way;

/// Side of the light's map in the paper.
const MAP: u32 = 256;

/// How far the ground in the middle of the torus scenes is from the light, in metres.
const RECEIVER_DEPTH: f32 = 6.4;

/// Frames per second against the search radius.
pub fn figure_6(effort: &Effort) -> Section {
    let scene = torus_at(1.3, 25.0);
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(|light| matches!(light, Light::Sphere { .. }));
    let radii: &[f32] =
        if effort.quick { &[5.0, 20.0, 40.0] } else { &[2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0] };
    let mut rate = |way: Way| 1e3 / stage.frame_milliseconds(light, &way, effort.repeats);
    let hard = rate(Way::new(Method::Hard).map_size(MAP));
    let paper = |&radius: &f32| {
        let r_scale = radius / RECEIVER_DEPTH;
        let parameters = paper::Parameters { r_scale, ..paper::Parameters::default() };
        let way = Way { paper: parameters, ..Way::new(Method::SearchPaper).map_size(MAP) };
        (f64::from(radius), rate(way))
    };
    let curves = [
        Curve::new("the 2002 paper, on its machine (text of section 5)", Stroke::Marked, vec![
            (0.0, 30.0),
            (20.0, 12.5),
        ]),
        Curve::new("hard shadows here", Stroke::Dashed, vec![(0.0, hard), (40.0, hard)]),
        Curve::new("every texel of the box, here", Stroke::Marked, radii.iter().map(paper).collect()),
    ];
    let axes = Axes {
        x: "search radius on the ground, r_max (texels of a 256² map)",
        y: "frames per second",
        scale: Scale::LogarithmicY,
    };
    Section {
        id: "2002-6",
        title: "2002, figure 6: frame rate against the search radius".to_owned(),
        body: html! {
            p {
                "The whole frame: camera pass, map, shadows and shading. The paper’s own curve is "
                "lost in the scan; its text gives 30 frames per second for hard shadows and 10 to "
                "15 for a radius of 20 texels, drawn here as 12.5, on a 1.7 GHz Pentium 4 with a "
                "GeForce 3 at 512 by 512 pixels. " 
                @if effort.quick { "This quick report draws " (effort.size) " by " (effort.size) "." }
            }
            (plot(axes, &curves))
        },
        pictures: Vec::new(),
    }
}

/// A torus at three heights.
pub fn figure_7(effort: &Effort) -> Section {
    let mut tiles = Tiles::new("2002-7");
    for (height, tilt) in [(0.4, 0.0), (1.3, 25.0), (2.4, 50.0)] {
        let scene = torus_at(height, tilt);
        let mut stage = Stage::new(&scene, effort.size);
        let light = stage.light(|light| matches!(light, Light::Sphere { .. }));
        let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
        gallery.show(&Way::new(Method::SearchPaper).map_size(MAP), &[Of::Scene, Of::Error]);
        gallery.show_truth(Of::Scene);
    }
    section("2002-7", "2002, figure 7: one torus at three heights", html! {}, tiles, html! {})
}

/// Objects at many heights.
pub fn figure_8(effort: &Effort) -> Section {
    let scene = built_in("crowded");
    let mut tiles = Tiles::new("2002-8");
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(|light| matches!(light, Light::Sphere { .. }));
    let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
    gallery.show(&Way::new(Method::SearchPaper).map_size(MAP), &[Of::Scene, Of::Error]);
    gallery.show(&Way::new(Method::Hard).map_size(MAP), &[Of::Scene, Of::Error]);
    gallery.show_truth(Of::Scene);
    section("2002-8", "2002, figure 8: objects at many heights", html! {}, tiles, html! {})
}

/// A low light with a very wide frustum, and a small map.
pub fn figure_9(effort: &Effort) -> Section {
    let scene = wide_spot();
    let mut tiles = Tiles::new("2002-9");
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(|_| true);
    let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
    gallery.show(&Way::new(Method::SearchPaper).map_size(MAP), &[Of::Scene, Of::Error]);
    gallery.show(&Way::new(Method::Hard).map_size(MAP), &[Of::Scene, Of::Error]);
    gallery.show_truth(Of::Scene);
    section("2002-9", "2002, figure 9: a very wide light, a small map", html! {}, tiles, html! {})
}
