//! Adaptive sampling: figure 5 of the 2002 paper, on a whole picture.

use std::time::Instant;

use maud::{Markup, html};
use raster::DepthBuffer;
use renderer::method::Method;
use renderer::scene::SceneLight;
use shadowmap_core::{Level, Threads, View};
use simd_search::{NodeGroup, Pyramid};
use single_sample::search::{Parameters, visibility};
use single_sample::{Counters, Found, LightMap, Texels};

use super::Effort;
use super::gallery::milliseconds;
use super::paper2002::is_sphere;
use super::scenes::built_in;
use super::stage::Stage;
use super::way::Way;
use crate::page::{Section, Tiles, table};
use crate::picture::Picture;

/// Searched, interpolated, decided without a look.
const COLORS: [[u8; 3]; 3] = [[0xe6, 0x9f, 0x00], [0x56, 0xb4, 0xe9], [0x6b, 0x72, 0x80]];

/// Which pixels were searched, and what the interpolation of the others costs.
pub fn figure_5(effort: &Effort) -> Section {
    let scene = built_in("torus");
    let mut stage = Stage::new(&scene, effort.size);
    let light = stage.light(is_sphere);
    let map = stage.light_map(light, &Way::new(Method::Search).map_size(256));
    let every = Searched::new(&stage, light, &map, [1, 1], effort);
    let mut tiles = Tiles::new("2002-5", 3);
    let mut rows = vec![every.row("every pixel", &every)];
    let cases = [
        ("groups of 5, the paper’s criterion", "paper", [4, 1]),
        ("groups of 5, and ends within 0.1", "within", [4, 10]),
        ("groups of 9, the paper’s criterion", "paper-9", [8, 1]),
    ];
    for (name, file, setting) in cases {
        let searched = Searched::new(&stage, light, &map, setting, effort);
        tiles.push(file, searched.picture(stage.width()), name);
        rows.push(searched.row(name, &every));
    }
    let (pictures, files) = tiles.finish();
    let head = ["", "pixels searched", "RMSE to every pixel searched", "largest change", "time"];
    Section {
        id: "2002-5",
        title: "2002, figure 5: which pixels are searched and which interpolated".to_owned(),
        body: html! { (text()) (pictures) (table(&head, &rows)) },
        pictures: files,
    }
}

fn text() -> Markup {
    let legend = ["searched", "interpolated", "decided without a search"];
    html! {
        p {
            "Section 4.3 searches the ends of groups of pixels and interpolates between them where "
            "all pixels of a group show one object and agree in the hard shadow test. The search "
            "here adds a condition, that the ends do not differ by more than 0.1, and decides tiles "
            "that no blocker can reach as a whole. Times are for the shadows alone, the map given."
        }
        ul.legend { @for (name, [r, g, b]) in legend.iter().zip(COLORS) {
            li { span style={ "color: rgb(" (r) " " (g) " " (b) ")" } { "■" } " " (name) }
        } }
    }
}

/// The search of a whole picture, and how each pixel was found.
struct Searched {
    pixels: Vec<(f32, Found)>,
    counters: Counters,
    milliseconds: f64,
}

impl Searched {
    /// With groups of `group + 1` pixels whose ends differ by at most 1 / `inverse`.
    fn new(
        stage: &Stage<'_>,
        light: &SceneLight,
        (view, map): &(View, DepthBuffer),
        [group, inverse]: [u32; 2],
        effort: &Effort,
    ) -> Searched {
        let level = Level::detect();
        let map = map.as_depth_map();
        let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(map.width(), map.height())];
        let pyramid = Pyramid::build(level, map, &mut nodes, &mut []);
        let pyramid = pyramid.expect("the storage is as long as asked");
        let light_map = LightMap::new(view, Texels::Plain(map)).expect("drawn in the view's size");
        let of_light = Parameters::of(&light.light).expect("a sphere light");
        let parameters = Parameters { group, tolerance: 1.0 / inverse as f32, ..of_light };
        let mut pixels = vec![(0.0, Found::Decided); stage.positions().len()];
        let (mut counters, mut best) = (Counters::default(), f64::INFINITY);
        for _ in 0..effort.repeats {
            let start = Instant::now();
            counters = visibility(
                level,
                Threads::Pool,
                &stage.camera(),
                &light_map,
                &pyramid,
                &parameters,
                &mut pixels,
            );
            best = best.min(start.elapsed().as_secs_f64() * 1e3);
        }
        Searched { pixels, counters, milliseconds: best }
    }

    fn picture(&self, width: usize) -> Picture {
        let color = |&(_, found): &(f32, Found)| match found {
            Found::Searched => COLORS[0],
            Found::Interpolated => COLORS[1],
            Found::Decided => COLORS[2],
        };
        let bytes: Vec<u8> = self.pixels.iter().flat_map(color).collect();
        Picture::srgb(width, &bytes)
    }

    fn row(&self, name: &str, every: &Searched) -> Vec<String> {
        let differences = self.pixels.iter().zip(&every.pixels);
        let differences = differences.map(|(a, b)| f64::from((a.0 - b.0).abs()));
        let squares: f64 = differences.clone().map(|d| d * d).sum();
        let share = f64::from(self.counters.searches) / f64::from(self.counters.receivers.max(1));
        vec![
            name.to_owned(),
            format!("{:.1} %", share * 100.0),
            format!("{:.4}", (squares / self.pixels.len() as f64).sqrt()),
            format!("{:.3}", differences.fold(0.0, f64::max)),
            milliseconds(self.milliseconds),
        ]
    }
}
