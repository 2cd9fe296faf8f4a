//! The figures of the 2000 paper that compare pictures.

use maud::html;
use renderer::method::Method;
use shadowmap_core::Light;

use super::Effort;
use super::gallery::{Gallery, section};
use super::scenes::{built_in, pair, under_a_triangle};
use super::stage::Stage;
use super::way::Way;
use crate::page::{Section, Tiles};

pub fn is_linear(light: &Light) -> bool {
    matches!(light, Light::Linear { .. })
}

fn rays(count: u32) -> Way {
    Way::new(Method::RayTraced).samples(count)
}

fn points(count: u32) -> Way {
    Way::new(Method::PointSamples).samples(count)
}

fn skins(count: u32) -> Way {
    Way::new(Method::Skins).samples(count)
}

fn intervals(count: u32) -> Way {
    Way::new(Method::Intervals).samples(count)
}

/// Two point lights against the method with two samples.
pub fn figure_1(effort: &Effort) -> Section {
    let scene = built_in("torus");
    let mut tiles = Tiles::new("2000-1", 4);
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_linear);
    let mut gallery = Gallery::new(&mut stage, light, effort, "", &mut tiles);
    gallery.compare(&[points(2), skins(2), intervals(2)]);
    let text = html! {
        "The same number of maps used in three ways: as two point lights; with skins, the method of "
        "the paper, from the ends of the light; and with intervals, which ask the same maps along "
        "a whole row what they hide of the light."
    };
    section(
        "2000-1",
        "2000, figure 1: a linear light as two point lights, and by this method",
        text,
        tiles,
    )
}

/// Undersampling and its cure; a triangle light.
pub fn figure_8(effort: &Effort) -> Section {
    let mut tiles = Tiles::new("2000-8", 3);
    let scene = pair();
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_linear);
    let mut gallery = Gallery::new(&mut stage, light, effort, "", &mut tiles);
    gallery.pictures(&[points(2), points(3), intervals(2), skins(2), skins(3)]);
    let (plates, mut pictures) = tiles.finish();
    let scene = under_a_triangle();
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(|_| true);
    let mut tiles = Tiles::new("2000-8", 4);
    let mut gallery = Gallery::new(&mut stage, light, effort, "triangle-", &mut tiles);
    gallery.compare_edges(&[points(3), points(9)], &[skins(2)]);
    let (triangle, more) = tiles.finish();
    pictures.extend(more);
    Section {
        id: "2000-8",
        title: "2000, figures 6 and 8: point lights, this method, too few samples".to_owned(),
        body: html! {
            p {
                "Two plates under a linear light. Below the gap neither end of the light is seen, so "
                "skins between two samples leave a dark stripe (figure 6). A third sample cures it. "
                "Intervals see it with two."
            }
            (plates)
            p {
                "A triangle light as three linear lights along its edges, two samples each, as the "
                "paper proposes, against point lights. The paper calls it a really crude "
                "approximation, and so it is: a triangle is not its outline."
            }
            (triangle)
        },
        pictures,
    }
}

/// One blocker, one linear light: 200 rays, the method with two samples, 10 rays.
pub fn figure_9(effort: &Effort) -> Section {
    let scene = built_in("blocker");
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_linear);
    let mut tiles = Tiles::new("2000-9", 4);
    let mut gallery = Gallery::new(&mut stage, light, effort, "", &mut tiles);
    gallery.compare(&[rays(200), skins(2), rays(10)]);
    let text = html! {
        "As in the paper: ray tracing with 200 rays per pixel, skins between two samples, and ray "
        "tracing with 10 rays, all uniformly along the light."
    };
    section("2000-9", "2000, figure 9: one blocker, one linear light", text, tiles)
}

/// More complex scenes.
pub fn figure_10(effort: &Effort) -> Section {
    let mut tiles = Tiles::new("2000-10", 3);
    for name in ["crowded", "show"] {
        let scene = built_in(name);
        let mut stage = Stage::new(&scene, effort.size);
        let light = stage.light(is_linear);
        let prefix = format!("{name}-");
        let mut gallery = Gallery::new(&mut stage, light, effort, &prefix, &mut tiles);
        gallery.compare(&[skins(2).map_size(1024), intervals(2).map_size(1024)]);
    }
    let text = html! {
        "Scenes of many objects, two samples of the light. Where several blockers share a penumbra, "
        "skins show only the nearest."
    };
    section("2000-10", "2000, figure 10: more complex scenes", text, tiles)
}
