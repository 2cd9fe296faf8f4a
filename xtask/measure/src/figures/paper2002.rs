//! The figures of the 2002 paper.

use maud::html;
use renderer::method::Method;
use shadowmap_core::Light;

use super::Effort;
use super::gallery::{Gallery, Of, section};
use super::page::{Section, Tiles};
use super::scenes::{built_in, torus_at, wide_spot};
use super::stage::Stage;
use super::way::Way;

/// A torus at three heights.
pub fn figure_7(effort: &Effort) -> Section {
    let mut tiles = Tiles::new("2002-7");
    for (height, tilt) in [(0.4, 0.0), (1.3, 25.0), (2.4, 50.0)] {
        let scene = torus_at(height, tilt);
        let mut stage = Stage::new(&scene, effort.size);
        let light = stage.light(|light| matches!(light, Light::Sphere { .. }));
        let mut gallery = Gallery::new(&mut stage, light, effort, &mut tiles);
        gallery.show(&Way::new(Method::SearchPaper).map_size(256), &[Of::Scene, Of::Error]);
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
    gallery.show(&Way::new(Method::SearchPaper).map_size(256), &[Of::Scene, Of::Error]);
    gallery.show(&Way::new(Method::Hard).map_size(256), &[Of::Scene, Of::Error]);
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
    gallery.show(&Way::new(Method::SearchPaper).map_size(256), &[Of::Scene, Of::Error]);
    gallery.show(&Way::new(Method::Hard).map_size(256), &[Of::Scene, Of::Error]);
    gallery.show_truth(Of::Scene);
    section("2002-9", "2002, figure 9: a very wide light, a small map", html! {}, tiles, html! {})
}
