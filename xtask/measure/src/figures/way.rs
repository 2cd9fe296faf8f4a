//! One way of making soft shadows: a method and its settings.

use renderer::light_views::ByHand;
use renderer::lighting::LightOptions;
use renderer::method::Method;
use single_sample::paper::{InnerWidth, Parameters, Penumbra};

/// A method and its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    pub method: Method,
    /// Point lights, samples or rays, where the method takes any.
    pub samples: u32,
    /// Side of the light's maps, in texels.
    pub map_size: u32,
    pub by_hand: Option<ByHand>,
    pub paper: Parameters,
}

impl Way {
    /// A method with one sample and maps of 512 by 512 texels.
    pub fn new(method: Method) -> Way {
        let paper = Parameters::default();
        Way { method, samples: 1, map_size: 512, by_hand: None, paper }
    }

    /// The truth as a picture: 4096 rays per pixel.
    pub fn truth() -> Way {
        Way::new(Method::RayTraced).samples(4096)
    }

    pub fn samples(self, samples: u32) -> Way {
        Way { samples, ..self }
    }

    pub fn map_size(self, map_size: u32) -> Way {
        Way { map_size, ..self }
    }

    pub fn options(&self) -> LightOptions {
        LightOptions {
            method: Some(self.method),
            samples: Some(self.samples),
            adaptive: false,
            map_size: self.map_size,
            by_hand: self.by_hand,
            paper: self.paper,
        }
    }

    /// Name and settings, as captions and tables have them.
    pub fn name(&self) -> String {
        let Way { samples, map_size, .. } = self;
        match self.method {
            Method::RayTraced if *samples == 1 => "1 ray per pixel".to_owned(),
            Method::RayTraced => format!("{samples} rays per pixel"),
            Method::Hard => format!("hard shadow map, {map_size}²"),
            Method::PointSamples => format!("{samples} point lights, {map_size}²"),
            Method::Search => format!("search, {map_size}²"),
            Method::Skins => format!("skins between {samples} samples, {map_size}²"),
            Method::Intervals => format!("intervals from {samples} samples, {map_size}²"),
            Method::SearchPaper => match self.paper {
                Parameters { penumbra: Penumbra::Outer, .. } => {
                    format!("outer penumbra as in the 2002 paper, {map_size}²")
                }
                Parameters { inner_width: InnerWidth::LitTexel, .. } => {
                    format!("the 2002 paper as printed, {map_size}²")
                }
                _ => format!("the 2002 paper, {map_size}²"),
            },
            Method::Pcf => format!("percentage-closer filtering, {map_size}²"),
            Method::Pcss => format!("percentage-closer soft shadows, {map_size}²"),
        }
    }

    /// A name for files.
    pub fn file_name(&self) -> String {
        match self.method {
            Method::RayTraced => format!("rays-{}", self.samples),
            Method::PointSamples | Method::Skins | Method::Intervals => {
                format!("{}-{}-{}", self.method, self.samples, self.map_size)
            }
            Method::SearchPaper => {
                let Parameters { penumbra, inner_width, .. } = self.paper;
                format!("paper-{penumbra:?}-{inner_width:?}-{}", self.map_size).to_lowercase()
            }
            method => format!("{method}-{}", self.map_size),
        }
    }
}
