//! Pictures of one light's shadows made in several ways, each with its error.

use maud::{Markup, html};
use renderer::scene::SceneLight;
use shadowmap_core::Light;

use super::Effort;
use super::stage::{Shadow, Stage};
use super::way::Way;
use crate::page::{Section, Tiles};
use crate::picture::Picture;

/// Draws one light of one stage.
pub struct Gallery<'g, 'a> {
    stage: &'g mut Stage<'a>,
    light: &'a SceneLight,
    truth: Vec<f32>,
    repeats: usize,
    tiles: &'g mut Tiles,
    /// Tells the files of this gallery from those of others in the section.
    prefix: String,
}

/// One way's shadows, and what is said of them.
struct Shown {
    shadow: Shadow,
    picture: Picture,
    file: String,
    name: String,
    caption: String,
}

impl<'g, 'a> Gallery<'g, 'a> {
    /// `prefix` tells the files of this gallery from those of others in the section.
    pub fn new(
        stage: &'g mut Stage<'a>,
        light: &'a SceneLight,
        effort: &Effort,
        prefix: &str,
        tiles: &'g mut Tiles,
    ) -> Gallery<'g, 'a> {
        let truth = stage.truth(light);
        Gallery { stage, light, truth, repeats: effort.repeats, tiles, prefix: prefix.to_owned() }
    }

    /// A row of pictures, the truth first, and a row of errors, true visibility first.
    pub fn compare(&mut self, ways: &[Way]) {
        let shown: Vec<Shown> = ways.iter().map(|way| self.draw(way)).collect();
        self.rows(shown);
    }

    /// [`Gallery::compare`] for a triangle light, `edges` being drawn on its three edges, linear
    /// lights all of them.
    pub fn compare_edges(&mut self, ways: &[Way], edges: &[Way]) {
        let mut shown: Vec<Shown> = ways.iter().map(|way| self.draw(way)).collect();
        shown.extend(edges.iter().map(|way| self.draw_edges(way)));
        self.rows(shown);
    }

    /// Pictures alone, the truth last.
    pub fn pictures(&mut self, ways: &[Way]) {
        for way in ways {
            let shown = self.draw(way);
            self.push(&shown.file, shown.picture, &shown.caption);
        }
        self.push_truth();
    }

    /// Errors alone, after the true visibility.
    pub fn errors(&mut self, ways: &[Way]) {
        let width = self.stage.width();
        let truth = Picture::gray(width, &self.truth);
        self.push("truth-visibility", truth, "true visibility of the light");
        for way in ways {
            let shown = self.draw(way);
            let error = Picture::error(width, &shown.shadow.values, &self.truth);
            let caption = format!("error of {}", shown.name);
            self.push(&format!("{}-error", shown.file), error, &caption);
        }
    }

    fn rows(&mut self, all: Vec<Shown>) {
        self.push_truth();
        let width = self.stage.width();
        let error = |shown: &Shown| Picture::error(width, &shown.shadow.values, &self.truth);
        let errors: Vec<Picture> = all.iter().map(error).collect();
        for shown in &all {
            self.push(&shown.file, shown.picture.clone(), &shown.caption);
        }
        let truth = Picture::gray(width, &self.truth);
        self.push("truth-visibility", truth, "true visibility of the light");
        for (shown, error) in all.iter().zip(errors) {
            let caption = format!("error of {}", shown.name);
            self.push(&format!("{}-error", shown.file), error, &caption);
        }
    }

    fn push(&mut self, file: &str, picture: Picture, caption: &str) {
        self.tiles.push(&format!("{}{file}", self.prefix), picture, caption);
    }

    fn push_truth(&mut self) {
        let picture = self.stage.picture(std::slice::from_ref(self.light), &Way::truth());
        self.push("truth", picture, "truth: 4096 rays per pixel");
    }

    fn draw(&mut self, way: &Way) -> Shown {
        let light = std::slice::from_ref(self.light);
        self.draw_lights(light, way, way.name(), way.file_name())
    }

    fn draw_edges(&mut self, way: &Way) -> Shown {
        let Light::Triangle { a, b, c } = self.light.light else {
            panic!("edges are those of a triangle");
        };
        let edge = |(a, b)| SceneLight {
            light: Light::Linear { a, b },
            intensity: self.light.intensity / 3.0,
            ..self.light.clone()
        };
        let edges = [(a, b), (b, c), (c, a)].map(edge);
        let name = format!("three edges, each with {}", way.name());
        self.draw_lights(&edges, way, name, format!("edges-{}", way.file_name()))
    }

    fn draw_lights(
        &mut self,
        lights: &[SceneLight],
        way: &Way,
        name: String,
        file: String,
    ) -> Shown {
        let shadow = self.stage.shadow(lights, way, self.repeats);
        let error = self.stage.compare(&shadow.values, &self.truth);
        let caption = format!(
            "{name}: RMSE {:.4} in the penumbra, largest error {:.2}, {}",
            error.penumbra_rmse,
            error.max,
            milliseconds(shadow.milliseconds),
        );
        let picture = self.stage.picture(lights, way);
        Shown { shadow, picture, file, name, caption }
    }
}

/// Milliseconds with two digits, or seconds.
pub fn milliseconds(value: f64) -> String {
    match value {
        v if v >= 1000.0 => format!("{:.1} s", v / 1000.0),
        v if v >= 10.0 => format!("{v:.0} ms"),
        v if v >= 1.0 => format!("{v:.1} ms"),
        v => format!("{v:.2} ms"),
    }
}

/// A section of a text and pictures.
pub fn section(id: &'static str, title: &str, text: Markup, tiles: Tiles) -> Section {
    let (rows, pictures) = tiles.finish();
    Section { id, title: title.to_owned(), body: html! { p { (text) } (rows) }, pictures }
}
