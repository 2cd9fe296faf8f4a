//! Pictures of one light's shadows made in several ways, each with its error.

use renderer::compare::Comparison;
use renderer::scene::SceneLight;

use super::Effort;
use super::page::{Section, Tiles};
use super::picture::Picture;
use super::stage::Stage;
use super::way::Way;

/// What a gallery shows of a way of making shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The picture that the renderer draws.
    Scene,
    /// Visibility in grey.
    Visibility,
    /// The signed error of visibility.
    Error,
}

/// Draws one light of one stage.
pub struct Gallery<'g, 'a> {
    stage: &'g mut Stage<'a>,
    light: &'a SceneLight,
    truth: Vec<f32>,
    repeats: usize,
    tiles: &'g mut Tiles,
}

impl<'g, 'a> Gallery<'g, 'a> {
    pub fn new(
        stage: &'g mut Stage<'a>,
        light: &'a SceneLight,
        effort: &Effort,
        tiles: &'g mut Tiles,
    ) -> Gallery<'g, 'a> {
        let truth = stage.truth(light);
        Gallery { stage, light, truth, repeats: effort.repeats, tiles }
    }

    /// Appends the pictures of one way; the first has a caption with its name, error and time.
    pub fn show(&mut self, way: &Way, what: &[Of]) -> Comparison {
        let shadow = self.stage.shadow(self.light, way, self.repeats);
        let error = self.stage.compare(&shadow.values, &self.truth);
        let caption = format!(
            "{}: RMSE {:.4} in the penumbra, largest error {:.2}, {}",
            way.name(),
            error.penumbra_rmse,
            error.max,
            milliseconds(shadow.milliseconds),
        );
        for (i, what) in what.iter().enumerate() {
            let width = self.stage.width();
            let (suffix, picture) = match what {
                Of::Scene => ("", self.stage.picture(self.light, way)),
                Of::Visibility => ("-visibility", Picture::gray(width, &shadow.values)),
                Of::Error => ("-error", Picture::error(width, &shadow.values, &self.truth)),
            };
            let name = format!("{}{suffix}", way.file_name());
            let caption = if i == 0 { caption.clone() } else { format!("{}: error", way.name()) };
            self.tiles.push(&name, picture, &caption);
        }
        error
    }

    /// Appends the truth.
    pub fn show_truth(&mut self, what: Of) {
        let picture = match what {
            Of::Scene => self.stage.picture(self.light, &Way::truth()),
            _ => Picture::gray(self.stage.width(), &self.truth),
        };
        self.tiles.push("truth", picture, "truth: 4096 rays per pixel");
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

/// A section whose pictures are those of `tiles`.
pub fn section(
    id: &'static str,
    title: &str,
    before: maud::Markup,
    tiles: Tiles,
    after: maud::Markup,
) -> Section {
    let (row, pictures) = tiles.finish();
    let body = maud::html! { (before) (row) (after) };
    Section { id, title: title.to_owned(), body, pictures }
}
