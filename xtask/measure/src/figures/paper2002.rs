//! The figures of the 2002 paper.

use maud::html;
use renderer::method::Method;
use renderer::scene::SceneLight;
use shadowmap_core::Light;
use single_sample::paper::{self, InnerWidth, Penumbra};

use super::Effort;
use super::gallery::{Gallery, section};
use super::scenes::{built_in, torus_at, wide_spot};
use super::stage::Stage;
use super::way::Way;
use crate::page::{Section, Tiles};
use crate::plot::{Axes, Curve, Scale, Stroke, plot};

/// Side of the light's map in the paper.
const MAP: u32 = 256;

pub fn is_sphere(light: &Light) -> bool {
    matches!(light, Light::Sphere { .. })
}

fn search_paper() -> Way {
    Way::new(Method::SearchPaper).map_size(MAP)
}

fn search() -> Way {
    Way::new(Method::Search).map_size(MAP)
}

/// How far the ground in the middle of the torus scenes is from the light, in metres.
const RECEIVER_DEPTH: f32 = 6.4;

/// Frames per second against the search radius.
pub fn figure_6(effort: &Effort) -> Section {
    let scene = torus_at(1.3, 25.0);
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_sphere);
    let radii: &[f32] =
        if effort.quick { &[5.0, 20.0, 40.0] } else { &[2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0] };
    // A light of radius 1 m has so many texels of penumbra on the ground, below the highest
    // blocker.
    let (view, map) = stage.light_map(light, &search());
    let nearest = map.nearness.iter().copied().fold(0.0, f32::max);
    let per_metre = view.focal().x * (nearest - 1.0 / RECEIVER_DEPTH);
    let mut rate =
        |light: &SceneLight, way: Way| 1e3 / stage.frame_milliseconds(light, &way, effort.repeats);
    let hard = rate(light, Way::new(Method::Hard).map_size(MAP));
    let (mut by_paper, mut by_radius) = (Vec::new(), Vec::new());
    for &texels in radii {
        let r_scale = texels / RECEIVER_DEPTH;
        let parameters = paper::Parameters { r_scale, ..paper::Parameters::default() };
        let way = Way { paper: parameters, ..search_paper() };
        if texels <= 20.0 {
            by_paper.push((f64::from(texels), rate(light, way)));
        }
        let (center, radius) = (light.light.center().unwrap_or_default(), texels / per_metre);
        let light = SceneLight { light: Light::Sphere { center, radius }, ..light.clone() };
        by_radius.push((f64::from(texels), rate(&light, search())));
    }
    let curves = [
        Curve::new(
            "the 2002 paper, on its machine (text of section 5)",
            Stroke::Marked,
            vec![(0.0, 30.0), (20.0, 12.5)],
        ),
        Curve::new("hard shadows here", Stroke::Dashed, vec![(0.0, hard), (40.0, hard)]),
        Curve::new("search with the light’s radius, here", Stroke::Marked, by_radius),
        Curve::new("the paper’s search, every texel, every pixel, here", Stroke::Marked, by_paper),
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
                "GeForce 3 at 512 by 512 pixels. For the search that knows the light’s radius, that "
                "radius is chosen so that the ground below the top of the torus has as many texels "
                "of penumbra. "
                @if effort.quick { "This quick report draws " (effort.size) " by " (effort.size) "." }
            }
            (plot(axes, &curves))
        },
        pictures: Vec::new(),
    }
}

/// A torus at three heights.
pub fn figure_7(effort: &Effort) -> Section {
    let mut tiles = Tiles::new("2002-7", 4);
    let inner_width = InnerWidth::LitTexel;
    let printed = paper::Parameters { inner_width, ..paper::Parameters::default() };
    let printed = Way { paper: printed, ..search_paper() };
    for (height, tilt) in [(0.4, 0.0), (1.3, 25.0), (2.4, 50.0)] {
        let scene = torus_at(height, tilt);
        let mut stage = Stage::new(&scene, effort.size);
        let light = stage.light(is_sphere);
        let prefix = format!("{height}-");
        let mut gallery = Gallery::new(&mut stage, light, effort, &prefix, &mut tiles);
        gallery.compare(&[printed, search_paper(), search()]);
    }
    let text = html! {
        "A torus at 0.4, 1.3 and 2.4 m over a plane, under a sphere light of radius 0.4 m, maps of 256 "
        "by 256 texels as in the paper. The inner width that section 3.3 prints is 0 on a flat "
        "receiver and draws the ring of the paper’s figure; with the blocker’s depth on both sides "
        "the halves meet. The paper’s constants are chosen by hand and know no light; "
        "the search beside them has the light’s radius as its only parameter."
    };
    section("2002-7", "2002, figure 7: one torus at three heights", text, tiles)
}

/// Objects at many heights.
pub fn figure_8(effort: &Effort) -> Section {
    let scene = built_in("crowded");
    let mut tiles = Tiles::new("2002-8", 4);
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_sphere);
    let mut gallery = Gallery::new(&mut stage, light, effort, "", &mut tiles);
    let hard = Way::new(Method::Hard).map_size(MAP);
    let outer = paper::Parameters { penumbra: Penumbra::Outer, ..paper::Parameters::default() };
    gallery.compare(&[hard, Way { paper: outer, ..search_paper() }, search()]);
    let text = html! {
        "Hard shadows, hard shadows with the paper’s outer penumbra alone, and soft shadows from the "
        "search. Shadows are sharp where the blocker is near its receiver."
    };
    section("2002-8", "2002, figure 8: objects at many heights", text, tiles)
}

/// A low light with a very wide frustum, and a small map.
pub fn figure_9(effort: &Effort) -> Section {
    let scene = wide_spot();
    let mut tiles = Tiles::new("2002-9", 4);
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(|_| true);
    let mut gallery = Gallery::new(&mut stage, light, effort, "", &mut tiles);
    gallery.compare(&[Way::new(Method::Hard).map_size(MAP), search_paper(), search()]);
    let text = html! {
        "A low light has to see nearly a half-space in one map of 256 by 256 texels. Hard shadows show "
        "every texel; the distance that the search measures is finer than a texel and smooths them."
    };
    section("2002-9", "2002, figure 9: a very wide light, a small map", text, tiles)
}
