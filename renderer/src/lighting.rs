//! The lights of a frame: which method draws each, and from where its maps are taken.

use glam::Vec3;
use linear_light::{RectifiedLight, SampleViews, lines};
use reference::point_lights;
use shadowmap_core::{Light, View};
use single_sample::paper;

use crate::Error;
use crate::cover::Cover;
use crate::light_views::{ByHand, by_hand_line, fit};
use crate::method::{Method, light_kind};
use crate::prepared::Prepared;
use crate::scene::SceneLight;

/// Samples of a linear light, unless told otherwise.
const LINE_SAMPLES: u32 = 3;

/// Samples of a linear light before it is known whether they suffice.
const LEAST_SAMPLES: u32 = 2;

/// Lines of a light with an area, unless told otherwise.
const LINES: u32 = 8;

/// Samples of each of those lines: intervals need no more.
const SAMPLES_PER_LINE: usize = 2;

/// Samples of the methods that take point samples, unless told otherwise.
const POINT_SAMPLES: u32 = 16;

/// Rays per pixel, unless told otherwise.
const RAYS: u32 = 256;

/// How lights are to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct LightOptions {
    /// The method; by default each light has its own.
    pub method: Option<Method>,
    /// Number of samples; by default that of the method.
    pub samples: Option<u32>,
    /// Whether [`Method::Intervals`] finds out how many samples a line needs; that is so by default
    /// where `samples` says nothing and the light is linear.
    pub adaptive: bool,
    /// Side of the maps in texels, from 1 to [`raster::MAX_SIZE`]; 1024 by default.
    pub map_size: u32,
    /// A frustum by hand.
    pub by_hand: Option<ByHand>,
    /// Of [`Method::SearchPaper`].
    pub paper: paper::Parameters,
}

impl Default for LightOptions {
    fn default() -> LightOptions {
        LightOptions {
            method: None,
            samples: None,
            adaptive: false,
            map_size: 1024,
            by_hand: None,
            paper: paper::Parameters::default(),
        }
    }
}

/// Where a light's maps are taken from.
#[derive(Clone, Debug)]
pub enum Plan {
    /// The views from its middle, one or several.
    Middle(Vec<View>),
    /// For each of its points, the views from there.
    Points(Vec<Vec<View>>),
    /// The rectified views along each of the lines that stand for it, and the line's weight.
    Lines(Vec<(f32, RectifiedLight)>),
    /// It needs none.
    Rays,
}

impl Plan {
    fn new(
        light: &SceneLight,
        method: Method,
        samples: u32,
        options: &LightOptions,
        prepared: &Prepared<'_>,
        camera: &View,
    ) -> Plan {
        if method == Method::RayTraced {
            return Plan::Rays;
        }
        let (shape, size) = (&light.light, options.map_size);
        let cover = Cover::new(prepared, shape, camera);
        let views = |point: &Light| fit(point, light.spot, options.by_hand, size, &cover);
        match method {
            Method::PointSamples => {
                let middle = prepared.bounds().map_or(Vec3::ZERO, |bounds| bounds.center());
                let points = point_lights(shape, samples, middle);
                Plan::Points(points.iter().map(views).collect())
            }
            Method::Skins | Method::Intervals => {
                let count = if has_area(shape) { SAMPLES_PER_LINE } else { samples as usize };
                let rectified = |a, b| match options.by_hand {
                    Some(by_hand) => RectifiedLight::from_frustum(by_hand_line(
                        a, b, count, by_hand, size, &cover,
                    )),
                    None => {
                        let blockers = cover.blockers.iter().copied();
                        let receivers = cover.receivers.iter().copied();
                        RectifiedLight::fit_around(a, b, count, [size; 2], blockers, receivers)
                    }
                };
                let lines = lines(shape, samples as usize).unwrap_or_default();
                let weighted = lines.iter().map(|line| (line.weight, rectified(line.a, line.b)));
                Plan::Lines(weighted.collect())
            }
            _ => Plan::Middle(views(shape)),
        }
    }

    /// Whether a single window holds all that matters, rather than several around the light or
    /// one that had to end somewhere.
    fn has_one_window(&self) -> bool {
        match self {
            Plan::Middle(views) => views.len() == 1,
            Plan::Points(samples) => samples.iter().all(|views| views.len() == 1),
            Plan::Lines(lines) => lines.iter().all(|(_, line)| line.is_complete()),
            Plan::Rays => true,
        }
    }

    /// The views of the maps that are held at the same time and drawn before any others, group
    /// after group.
    #[must_use]
    pub fn first_maps(&self) -> Vec<&[View]> {
        match self {
            Plan::Middle(_) | Plan::Points(_) => vec![self.first_views()],
            Plan::Lines(lines) => lines.first().map_or_else(Vec::new, |(_, line)| views_of(line)),
            Plan::Rays => Vec::new(),
        }
    }

    /// The views of the maps that are shown as the light's: of its first point or frustum.
    #[must_use]
    pub fn first_views(&self) -> &[View] {
        match self {
            Plan::Middle(views) => views,
            Plan::Points(samples) => samples.first().map_or(&[], Vec::as_slice),
            Plan::Lines(lines) => lines.first().map_or(&[], |(_, line)| line.frusta()[0].views()),
            Plan::Rays => &[],
        }
    }
}

/// In which frusta of a line more samples are taken where those that it has do not suffice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adapts {
    /// In none: their number is given.
    Nowhere,
    /// In those whose windows are cut. Of the many lines of a panel two samples each are enough,
    /// unless it stands in what blocks it or right behind.
    WhereCut,
    /// In all.
    Everywhere,
}

impl Adapts {
    /// Whether a frustum is one of them.
    #[must_use]
    pub fn in_frustum(self, views: &SampleViews) -> bool {
        match self {
            Adapts::Nowhere => false,
            Adapts::WhereCut => views.is_cut(),
            Adapts::Everywhere => true,
        }
    }
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
    /// Where more samples are taken if that many do not suffice.
    pub adapts: Adapts,
    /// Where its maps are taken from.
    pub plan: Plan,
    /// Whether its maps were fitted to hold all that can block it: receivers outside them are lit
    /// as far as their own horizon lets them, and no search is cut by their border.
    pub holds_all: bool,
    /// Of [`Method::SearchPaper`].
    pub paper: paper::Parameters,
}

impl LightJob {
    /// Chooses method and views for a light, fitted to what `camera` sees of the scene.
    ///
    /// # Errors
    ///
    /// If the method does not know such lights, or a light cannot look at its target by hand.
    pub fn new(
        light: &SceneLight,
        options: &LightOptions,
        prepared: &Prepared<'_>,
        camera: &View,
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
        let has_area = has_area(shape);
        if options.adaptive && method != Method::Intervals {
            return Err(Error::new(format_args!(
                "--samples adaptive: --method {method} takes a number; only intervals adapts it"
            )));
        }
        let adapts = match method {
            Method::Intervals if options.adaptive => Adapts::Everywhere,
            Method::Intervals if has_area => Adapts::WhereCut,
            Method::Intervals if options.samples.is_none() => Adapts::Everywhere,
            _ => Adapts::Nowhere,
        };
        let samples = match (method, options.samples) {
            (Method::Intervals, samples) if has_area => samples.unwrap_or(LINES),
            (Method::Skins | Method::Intervals, Some(1)) => {
                return Err(Error::new(format_args!(
                    "--samples 1: --method {method} needs one at either end of the light, 2 at least"
                )));
            }
            (Method::Intervals, samples) => samples.unwrap_or(LEAST_SAMPLES),
            (Method::Skins, samples) => samples.unwrap_or(LINE_SAMPLES),
            (Method::PointSamples, samples) => samples.unwrap_or(POINT_SAMPLES),
            (Method::RayTraced, samples) => samples.unwrap_or(RAYS),
            _ => 1,
        };
        if let Some(ByHand { target, .. }) = options.by_hand
            && is_on(shape, target)
        {
            let [x, y, z] = target.to_array();
            let text = format_args!("--light-target {x},{y},{z}: a light is there or points there");
            return Err(Error::new(text));
        }
        let plan = Plan::new(light, method, samples, options, prepared, camera);
        let holds_all = options.by_hand.is_none() && plan.has_one_window();
        Ok(LightJob {
            light: light.clone(),
            method,
            samples,
            adapts,
            plan,
            holds_all,
            paper: options.paper,
        })
    }
}

/// The views of each frustum of a line.
#[must_use]
pub fn views_of(line: &RectifiedLight) -> Vec<&[View]> {
    line.frusta().iter().map(|frustum| frustum.views()).collect()
}

/// Whether a light has no direction towards `target`: it is there, or its line leads there.
fn is_on(light: &Light, target: Vec3) -> bool {
    let Some(from) = light.center() else { return false };
    let along = match *light {
        Light::Linear { a, b } => (b - a).normalize_or_zero(),
        _ => Vec3::ZERO,
    };
    let way = target - from;
    let across = way - along * way.dot(along);
    across.length() <= 1e-6 * target.length().max(from.length())
}

/// Whether a light is drawn as several lines.
fn has_area(light: &Light) -> bool {
    matches!(light, Light::Triangle { .. } | Light::Rectangle { .. })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::camera::{CameraOptions, choose, view};

    #[test]
    fn a_panel_adapts_where_it_stands_in_what_blocks_it() {
        let scene = builtin::scene("torus").unwrap();
        let prepared = Prepared::new(&scene);
        let camera = choose(&scene, &CameraOptions::default()).unwrap();
        let camera = view(&camera, [64, 64], prepared.bounds());
        for (height, expected) in [(4.5, false), (0.5, true)] {
            let shape = Light::Rectangle {
                corner: Vec3::new(-1.0, height, 0.0),
                edge_u: Vec3::X * 2.0,
                edge_v: Vec3::Z,
            };
            let light = SceneLight { light: shape, ..scene.lights[0].clone() };
            let job = LightJob::new(&light, &LightOptions::default(), &prepared, &camera).unwrap();
            let Plan::Lines(lines) = &job.plan else { panic!("a panel is drawn as lines") };
            let mut frusta = lines.iter().flat_map(|(_, line)| line.frusta());
            assert_eq!(frusta.any(|views| job.adapts.in_frustum(views)), expected, "at {height} m");
        }
    }

    #[test]
    fn maps_have_a_size_by_default() {
        let scene = builtin::scene("torus").unwrap();
        let prepared = Prepared::new(&scene);
        let camera = choose(&scene, &CameraOptions::default()).unwrap();
        let camera = view(&camera, [64, 64], prepared.bounds());
        for light in &scene.lights {
            let job = LightJob::new(light, &LightOptions::default(), &prepared, &camera).unwrap();
            assert!(job.plan.first_views().iter().all(|view| view.width() == 1024));
        }
    }
}
