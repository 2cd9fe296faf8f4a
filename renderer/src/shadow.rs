//! The visibility of one light from every pixel.

use glam::Vec3;
use raster::DepthBuffer;
use reference::{Pcf, Pcss, Samples, Tracer};
use shadowmap_core::{Bias, Camera, DepthMap, HardShadow, Level, Threads, View, hard_shadow};
use single_sample::{LightMap, Texels, paper};

use crate::faces;
use crate::lighting::LightJob;
use crate::method::Method;
use crate::receivers;
use crate::stats::Counters;

/// The size of a map made by a [`DepthBuffer`] is its view's.
const SIZES_AGREE: &str = "maps are drawn in the size of their view";

/// The visibility stage, and memory that is kept between lights and frames.
#[derive(Debug)]
pub(crate) struct ShadowStage {
    level: Level,
    threads: Threads,
    /// The camera's nearness where a receiver belongs to one of several faces.
    of_face: Vec<f32>,
    /// Visibility from one of several faces.
    part: Vec<f32>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

impl ShadowStage {
    pub fn new(level: Level, threads: Threads) -> ShadowStage {
        ShadowStage {
            level,
            threads,
            of_face: Vec::new(),
            part: Vec::new(),
            positions: Vec::new(),
            normals: Vec::new(),
        }
    }

    /// Writes the visibility of `light` as its method finds it in one map per face.
    pub fn by_maps(
        &mut self,
        camera: &Camera<'_>,
        light: &LightJob,
        views: &[View],
        maps: &[DepthBuffer],
        counters: &mut Counters,
        out: &mut [f32],
    ) {
        let (level, threads) = (self.level, self.threads);
        if let ([view], [map]) = (views, maps) {
            return by_map(camera, light, view, &map.as_depth_map(), level, threads, counters, out);
        }
        out.fill(0.0);
        self.of_face.resize(out.len(), 0.0);
        self.part.resize(out.len(), 0.0);
        let (width, height) = (camera.map().width(), camera.map().height());
        for (face, (view, map)) in views.iter().zip(maps).enumerate() {
            faces::receivers_of(camera, views, face, threads, &mut self.of_face);
            let masked = DepthMap::new(width, height, &self.of_face, camera.map().ids());
            let masked = masked.expect(SIZES_AGREE);
            let of_face = Camera::new(camera.view(), masked, camera.surfaces()).expect(SIZES_AGREE);
            let map = map.as_depth_map();
            by_map(&of_face, light, view, &map, level, threads, counters, &mut self.part);
            // Each receiver belongs to one face; the other faces say 0.
            for (out, part) in out.iter_mut().zip(&self.part) {
                *out += *part;
            }
        }
    }

    /// Writes the visibility of `light` by rays.
    pub fn by_rays(
        &mut self,
        camera: &Camera<'_>,
        light: &LightJob,
        tracer: &Tracer<'_>,
        counters: &mut Counters,
        out: &mut [f32],
    ) {
        self.positions.resize(out.len(), Vec3::ZERO);
        self.normals.resize(out.len(), Vec3::ZERO);
        let (positions, normals) = (&mut self.positions, &mut self.normals);
        receivers::world(camera, self.threads, positions, normals);
        let samples = Samples::Fixed(light.samples);
        tracer.visibility(&light.light.light, positions, normals, samples, self.threads, out);
        let seen = normals.iter().filter(|normal| **normal != Vec3::ZERO).count();
        counters.add("receivers", seen as u64);
        counters.add("rays", seen as u64 * u64::from(samples.count()));
    }
}

/// Writes the visibility of `light` as its method finds it in one map.
fn by_map(
    camera: &Camera<'_>,
    light: &LightJob,
    view: &View,
    map: &DepthMap<'_>,
    level: Level,
    threads: Threads,
    counters: &mut Counters,
    out: &mut [f32],
) {
    let bias = Bias::default();
    let found = match light.method {
        Method::Hard | Method::PointSamples => {
            receivers::visibility(camera, view, level, threads, out, |point, _| {
                f32::from(u8::from(hard_shadow(map, point, bias) != HardShadow::Blocked))
            })
        }
        Method::Pcf => {
            let pcf = Pcf::default();
            receivers::visibility(camera, view, level, threads, out, |point, pixel| {
                pcf.visibility(map, point, bias, pixel)
            })
        }
        Method::Pcss => match Pcss::new(&light.light.light, view, map) {
            Some(pcss) => {
                receivers::visibility(camera, view, level, threads, out, |point, pixel| {
                    pcss.visibility(view, map, point, bias, pixel)
                })
            }
            None => return,
        },
        Method::SearchPaper => {
            let map = LightMap::new(view, Texels::Plain(*map)).expect(SIZES_AGREE);
            let found = paper::visibility(camera, &map, &light.paper, threads, out);
            counters.add("receivers", found.receivers.into());
            counters.add("outside the light's map", found.outside.into());
            counters.add("searches", found.searches.into());
            counters.add("searches cut by the map's border", found.cut_by_border.into());
            return;
        }
        Method::RayTraced => return,
    };
    counters.add("receivers", found.receivers);
    counters.add("outside the light's map", found.outside);
}
