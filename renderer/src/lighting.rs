//! The lights of a frame: which method draws each, and from where its maps are taken.

use glam::Vec3;
use reference::point_lights;
use shadowmap_core::View;
use single_sample::paper;

use crate::Error;
use crate::light_views::{ByHand, fit};
use crate::method::{Method, light_kind};
use crate::prepared::Prepared;
use crate::scene::SceneLight;

/// Samples of the methods that take point samples, unless told otherwise.
const POINT_SAMPLES: u32 = 16;

/// Rays per pixel, unless told otherwise.
const RAYS: u32 = 256;

/// How lights are to be drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightOptions {
    /// The method; by default each light has its own.
    pub method: Option<Method>,
    /// Number of samples; by default that of the method.
    pub samples: Option<u32>,
    /// Side of the maps in texels.
    pub map_size: u32,
    /// A frustum by hand.
    pub by_hand: Option<ByHand>,
    /// Of [`Method::SearchPaper`].
    pub paper: paper::Parameters,
}

/// A light and how it is drawn.
#[derive(Clone, Debug)]
pub struct LightJob {
    /// The light.
    pub light: SceneLight,
    /// How it is drawn.
    pub method: Method,
    /// How many samples it takes; 1 for the methods that take one.
    pub samples: u32,
    /// For each sample that needs maps, the views from it, one or several.
    pub views: Vec<Vec<View>>,
    /// Of [`Method::SearchPaper`].
    pub paper: paper::Parameters,
}

impl LightJob {
    /// Chooses method and views for a light.
    ///
    /// # Errors
    ///
    /// If the method does not know such lights.
    pub fn new(
        light: &SceneLight,
        options: &LightOptions,
        prepared: &Prepared<'_>,
    ) -> Result<LightJob, Error> {
        let shape = &light.light;
        let method = options.method.unwrap_or_else(|| Method::default_for(shape));
        if !method.fits(shape) {
            let fitting = Method::ALL.into_iter().filter(|method| method.fits(shape));
            let names: Vec<_> = fitting.map(Method::name).collect();
            return Err(Error::new(format_args!(
                "--method {method}: it cannot draw a {} light; those that can: {}",
                light_kind(shape),
                names.join(", ")
            )));
        }
        let samples = match method {
            Method::PointSamples => options.samples.unwrap_or(POINT_SAMPLES),
            Method::RayTraced => options.samples.unwrap_or(RAYS),
            Method::Hard | Method::SearchPaper | Method::Pcf | Method::Pcss => 1,
        };
        let middle = prepared.bounds().map_or(Vec3::ZERO, |bounds| bounds.center());
        let points = prepared.hull();
        let views = |point| {
            fit(point, light.spot, options.by_hand, options.map_size, points.iter().copied())
        };
        let views = match method {
            Method::RayTraced => Vec::new(),
            Method::PointSamples => {
                point_lights(shape, samples, middle).iter().map(views).collect()
            }
            Method::Hard | Method::SearchPaper | Method::Pcf | Method::Pcss => vec![views(shape)],
        };
        Ok(LightJob { light: light.clone(), method, samples, views, paper: options.paper })
    }
}
