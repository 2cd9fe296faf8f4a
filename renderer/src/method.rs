//! The ways to find out what a receiver sees of a light.

use std::fmt;

use shadowmap_core::Light;

use crate::Error;

/// A shadow method, as `--method` names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// One hard shadow map from the light's middle (Williams 1978).
    Hard,
    /// Many hard shadow maps, averaged: the baseline of both papers.
    PointSamples,
    /// Brabec and Seidel 2002 with one physical parameter, the size of the light.
    Search,
    /// Brabec and Seidel 2002 with the paper's own parameters.
    SearchPaper,
    /// Heidrich, Brabec and Seidel 2000: skins between the samples of a linear light.
    Skins,
    /// All that the same maps know: intervals of the light that they show hidden.
    Intervals,
    /// Percentage-closer filtering (Reeves et al. 1987).
    Pcf,
    /// Percentage-closer soft shadows (Fernando 2005).
    Pcss,
    /// Rays: the truth.
    RayTraced,
}

impl Method {
    /// All methods, in the order in which `--help` lists them.
    pub const ALL: [Method; 9] = [
        Method::Search,
        Method::SearchPaper,
        Method::Intervals,
        Method::Skins,
        Method::Hard,
        Method::PointSamples,
        Method::Pcf,
        Method::Pcss,
        Method::RayTraced,
    ];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Method::Hard => "hard",
            Method::PointSamples => "point-samples",
            Method::Search => "search",
            Method::SearchPaper => "search-paper",
            Method::Intervals => "intervals",
            Method::Skins => "skins",
            Method::Pcf => "pcf",
            Method::Pcss => "pcss",
            Method::RayTraced => "ray-traced",
        }
    }

    /// The method of that name.
    ///
    /// # Errors
    ///
    /// If there is none; the text lists those that there are.
    pub fn parse(name: &str) -> Result<Method, Error> {
        Method::ALL.into_iter().find(|method| method.name() == name).ok_or_else(|| {
            let names = Method::ALL.map(Method::name).join(", ");
            Error::new(format_args!("--method {name}: no such method; there are {names}"))
        })
    }

    /// Whether the method knows this shape of light.
    #[must_use]
    pub fn fits(self, light: &Light) -> bool {
        let round = matches!(light, Light::Point { .. } | Light::Sphere { .. } | Light::Sun { .. });
        match self {
            Method::Hard | Method::PointSamples | Method::RayTraced => true,
            Method::Search | Method::SearchPaper | Method::Pcf => round,
            Method::Skins => matches!(light, Light::Linear { .. }),
            Method::Intervals => matches!(
                light,
                Light::Linear { .. } | Light::Triangle { .. } | Light::Rectangle { .. }
            ),
            Method::Pcss => round && !matches!(light, Light::Point { .. }),
        }
    }

    /// The method that a light is drawn with unless another is asked for.
    #[must_use]
    pub fn default_for(light: &Light) -> Method {
        match light {
            Light::Point { .. } | Light::Sphere { .. } | Light::Sun { .. } => Method::Search,
            Light::Linear { .. } | Light::Triangle { .. } | Light::Rectangle { .. } => {
                Method::Intervals
            }
            _ => Method::PointSamples,
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a light is called in messages and in `--light`.
#[must_use]
pub fn light_kind(light: &Light) -> &'static str {
    match light {
        Light::Point { .. } => "point",
        Light::Sphere { .. } => "sphere",
        Light::Sun { .. } => "sun",
        Light::Linear { .. } => "linear",
        Light::Triangle { .. } => "triangle",
        Light::Rectangle { .. } => "rect",
        _ => "unknown",
    }
}
