//! The stages of one light: its depth maps, and its visibility from every pixel.

mod intervals;

use glam::Vec3;
use linear_light::{
    IntervalVisibility, RectifiedLight, SkinOptions, SkinShadow, VisibilityChannels,
};
use raster::{DepthBuffer, Payload};
use reference::{Pcf, Pcss, Samples, Tracer};
use shadowmap_core::{
    Bias, Camera, DepthMap, HardShadow, Level, Light, Threads, View, hard_shadow,
};
use simd_search::{NodeGroup, Pyramid};
use single_sample::{LightMap, Texels, paper, search};

use crate::drawing::{Drawing, Viewer};
use crate::faces;
use crate::lighting::{LightJob, Plan, views_of};
use crate::method::Method;
use crate::prepared::Prepared;
use crate::receivers;
use crate::stats::{Counters, StageTimes, timed};

/// Why sizes need no check.
const SIZES_AGREE: &str = "maps are drawn in the size of their view";

/// The stages of lights, and their memory, which is kept between lights and frames.
#[derive(Debug)]
pub(crate) struct ShadowStage {
    level: Level,
    threads: Threads,
    maps: Vec<DepthBuffer>,
    /// At most one map that only tells whether a sample is missing.
    trial: Vec<DepthBuffer>,
    /// The pyramids of the maps, where they are searched.
    pyramids: Vec<Vec<NodeGroup>>,
    intervals: IntervalVisibility,
    channels: Vec<VisibilityChannels>,
    /// The camera's nearness where a receiver belongs to one of several faces.
    of_face: Vec<f32>,
    /// Visibility from one of several faces, and of one of several samples.
    face: Vec<f32>,
    sample: Vec<f32>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// What a light is drawn for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene<'a> {
    pub prepared: &'a Prepared<'a>,
    /// What the camera sees.
    pub camera: Camera<'a>,
    /// For ray-traced lights.
    pub tracer: Option<&'a Tracer<'a>>,
}

/// Whether the maps that a light needs first, [`Plan::first_maps`], were the last to be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FirstMaps {
    Drawn,
    Missing,
}

/// What is told of the work.
#[derive(Debug)]
pub(crate) struct Log<'a> {
    pub times: &'a mut StageTimes,
    pub counters: &'a mut Counters,
    /// [`LightJob::holds_all`] of the light at work.
    pub holds_all: bool,
}

impl ShadowStage {
    pub fn new(level: Level, threads: Threads) -> ShadowStage {
        ShadowStage {
            level,
            threads,
            maps: Vec::new(),
            trial: Vec::new(),
            pyramids: Vec::new(),
            intervals: IntervalVisibility::new(level, threads),
            channels: Vec::new(),
            of_face: Vec::new(),
            face: Vec::new(),
            sample: Vec::new(),
            positions: Vec::new(),
            normals: Vec::new(),
        }
    }

    /// The maps that were drawn last.
    pub fn maps(&self) -> &[DepthBuffer] {
        &self.maps
    }

    /// The visibility channels that were drawn last, one per frustum.
    pub fn channels(&self) -> &[VisibilityChannels] {
        &self.channels
    }

    /// Draws the maps of `groups` of views, one group after another: all frusta of a light, or the
    /// faces of one of its samples. If they are to be searched, with the leaves of their pyramids.
    pub fn draw_maps(
        &mut self,
        drawing: &mut Drawing,
        prepared: &Prepared<'_>,
        groups: &[&[View]],
        searched: bool,
        log: &mut Log<'_>,
    ) {
        if groups.is_empty() {
            return;
        }
        let count = groups.iter().map(|views| views.len()).sum();
        self.maps.resize_with(count, || DepthBuffer::new(0, 0));
        self.pyramids.resize_with(count.max(self.pyramids.len()), Vec::new);
        let (mut maps, mut pyramids) = (&mut self.maps[..], &mut self.pyramids[..]);
        timed(&mut log.times.light_maps, || {
            for views in groups {
                let (these, others) = std::mem::take(&mut maps).split_at_mut(views.len());
                maps = others;
                let (leaves, others) = std::mem::take(&mut pyramids).split_at_mut(views.len());
                pyramids = others;
                let drawn = if searched {
                    drawing.draw_with_leaves(prepared, views, these, leaves)
                } else {
                    drawing.draw(prepared, Viewer::Light, views, Payload::ObjectId, these)
                };
                log.counters.add("triangles drawn for lights", drawn);
            }
        });
        log.counters.add("light maps", count as u64);
    }

    /// Writes the visibility of `light` from every pixel.
    pub fn visibility(
        &mut self,
        drawing: &mut Drawing,
        scene: &Scene<'_>,
        light: &LightJob,
        first: FirstMaps,
        log: &mut Log<'_>,
        out: &mut [f32],
    ) {
        log.holds_all = light.holds_all;
        if first == FirstMaps::Missing {
            let (maps, searched) = (light.plan.first_maps(), light.method == Method::Search);
            self.draw_maps(drawing, scene.prepared, &maps, searched, log);
        }
        match &light.plan {
            Plan::Middle(views) => {
                self.by_faces(&scene.camera, light, views, log, out);
            }
            Plan::Points(samples) => {
                out.fill(0.0);
                let weight = 1.0 / samples.len() as f32;
                let mut sample = std::mem::take(&mut self.sample);
                sample.resize(out.len(), 0.0);
                for (index, views) in samples.iter().enumerate() {
                    if index > 0 {
                        self.draw_maps(drawing, scene.prepared, &[views], false, log);
                    }
                    self.by_faces(&scene.camera, light, views, log, &mut sample);
                    timed(&mut log.times.shadow, || {
                        for (out, sample) in out.iter_mut().zip(&sample) {
                            *out += weight * *sample;
                        }
                    });
                }
                self.sample = sample;
            }
            Plan::Lines(lines) => {
                let mut sum = std::mem::take(&mut self.sample);
                sum.clear();
                sum.resize(out.len(), 0.0);
                for (index, (weight, line)) in lines.iter().enumerate() {
                    if index > 0 {
                        self.draw_maps(drawing, scene.prepared, &views_of(line), false, log);
                    }
                    match light.method {
                        Method::Skins => self.by_skins(&scene.camera, line, log, out),
                        _ => self.by_intervals(drawing, scene, line, light.adapts, log, out),
                    }
                    if lines.len() > 1 {
                        timed(&mut log.times.shadow, || {
                            for (sum, out) in sum.iter_mut().zip(&*out) {
                                *sum += weight * *out;
                            }
                        });
                    }
                }
                if lines.len() > 1 {
                    // The weights add up to 1 only as far as rounding lets them.
                    for (out, sum) in out.iter_mut().zip(&sum) {
                        *out = sum.min(1.0);
                    }
                }
                self.sample = sum;
            }
            Plan::Rays => self.by_rays(scene, light, log, out),
        }
    }

    /// Shares the pixels out among the maps of a light's faces.
    fn by_faces(
        &mut self,
        camera: &Camera<'_>,
        light: &LightJob,
        views: &[View],
        log: &mut Log<'_>,
        out: &mut [f32],
    ) {
        let maps = std::mem::take(&mut self.maps);
        if let ([view], [map]) = (views, &maps[..]) {
            self.by_map(camera, light, 0, view, &map.as_depth_map(), log, out);
        } else {
            out.fill(0.0);
            let mut of_face = std::mem::take(&mut self.of_face);
            let mut part = std::mem::take(&mut self.face);
            of_face.resize(out.len(), 0.0);
            part.resize(out.len(), 0.0);
            let (width, height) = (camera.map().width(), camera.map().height());
            for (face, (view, map)) in views.iter().zip(&maps).enumerate() {
                timed(&mut log.times.shadow, || {
                    faces::receivers_of(camera, views, face, self.threads, &mut of_face);
                });
                let masked = DepthMap::new(width, height, &of_face, camera.map().ids());
                let masked = masked.expect(SIZES_AGREE);
                let masked = Camera::new(camera.view(), masked, camera.surfaces());
                let masked = masked.expect(SIZES_AGREE);
                self.by_map(&masked, light, face, view, &map.as_depth_map(), log, &mut part);
                // Each receiver belongs to one face; the other faces say 0.
                timed(&mut log.times.shadow, || {
                    for (out, part) in out.iter_mut().zip(&part) {
                        *out += *part;
                    }
                });
            }
            (self.of_face, self.face) = (of_face, part);
        }
        self.maps = maps;
    }

    /// The visibility as the methods find it that look into one map, that of a `face`.
    fn by_map(
        &mut self,
        camera: &Camera<'_>,
        light: &LightJob,
        face: usize,
        view: &View,
        map: &DepthMap<'_>,
        log: &mut Log<'_>,
        out: &mut [f32],
    ) {
        if light.method == Method::Search {
            return self.by_search(camera, &light.light.light, face, view, map, log, out);
        }
        let StageTimes { shadow, .. } = log.times;
        timed(shadow, || match light.method {
            Method::SearchPaper => {
                let map = LightMap::new(view, Texels::Plain(*map)).expect(SIZES_AGREE);
                let found = paper::visibility(camera, &map, &light.paper, self.threads, out);
                log.counters.add_searches(&found, log.holds_all);
            }
            _ => self.by_tests(camera, light, view, map, log.counters, out),
        });
    }

    /// The methods that ask about each receiver on its own.
    fn by_tests(
        &self,
        camera: &Camera<'_>,
        light: &LightJob,
        view: &View,
        map: &DepthMap<'_>,
        counters: &mut Counters,
        out: &mut [f32],
    ) {
        let (level, threads, bias) = (self.level, self.threads, Bias::default());
        let pcf = Pcf::default();
        let pcss = match light.method {
            Method::Pcss => Pcss::new(&light.light.light, view, map),
            _ => None,
        };
        let found = match (light.method, pcss) {
            (_, Some(pcss)) => {
                receivers::visibility(camera, view, level, threads, out, |point, pixel| {
                    pcss.visibility(view, map, point, bias, pixel)
                })
            }
            (Method::Pcf, _) => {
                receivers::visibility(camera, view, level, threads, out, |point, pixel| {
                    pcf.visibility(map, point, bias, pixel)
                })
            }
            _ => receivers::visibility(camera, view, level, threads, out, |point, _| {
                f32::from(u8::from(hard_shadow(map, point, bias) != HardShadow::Blocked))
            }),
        };
        counters.add_receivers(found.receivers, found.outside, light.holds_all);
    }

    fn by_search(
        &mut self,
        camera: &Camera<'_>,
        light: &Light,
        face: usize,
        view: &View,
        map: &DepthMap<'_>,
        log: &mut Log<'_>,
        out: &mut [f32],
    ) {
        let (level, nodes) = (self.level, &mut self.pyramids[face]);
        let pyramid = timed(&mut log.times.light_maps, || {
            Pyramid::finish(level, *map, nodes, &mut []).expect("the leaves are of this map")
        });
        let map = LightMap::new(view, Texels::Plain(*map)).expect(SIZES_AGREE);
        let parameters = search::Parameters::of(light).unwrap_or_default();
        let found = timed(&mut log.times.shadow, || {
            search::visibility(level, self.threads, camera, &map, &pyramid, &parameters, out)
        });
        log.counters.add_searches(&found, log.holds_all);
    }

    fn by_skins(
        &mut self,
        camera: &Camera<'_>,
        light: &RectifiedLight,
        log: &mut Log<'_>,
        out: &mut [f32],
    ) {
        let frusta = light.frusta();
        let options =
            SkinOptions { level: self.level, threads: self.threads, ..SkinOptions::default() };
        let maps: Vec<DepthMap<'_>> = self.maps.iter().map(DepthBuffer::as_depth_map).collect();
        self.channels.resize_with(frusta.len(), VisibilityChannels::new);
        let mut rest = &maps[..];
        let mut maps_of_frusta = Vec::with_capacity(frusta.len());
        for (frustum, channels) in frusta.iter().zip(&mut self.channels) {
            let (maps, others) = rest.split_at(frustum.views().len());
            rest = others;
            timed(&mut log.times.visibility_channel, || {
                channels.draw_rectified(frustum, maps, &options);
            });
            maps_of_frusta.push(maps);
        }
        let bias = Bias::default();
        let shadows: Vec<SkinShadow<'_>> = frusta
            .iter()
            .zip(maps_of_frusta)
            .zip(&self.channels)
            .map(|((views, maps), channels)| SkinShadow::rectified(views, maps, channels, bias))
            .collect();
        let found = timed(&mut log.times.shadow, || {
            linear_light::visibility(camera, &shadows, self.threads, out)
        });
        let (receivers, outside) = (found.receivers.into(), found.outside.into());
        log.counters.add_receivers(receivers, outside, log.holds_all);
    }

    fn by_rays(&mut self, scene: &Scene<'_>, light: &LightJob, log: &mut Log<'_>, out: &mut [f32]) {
        let Some(tracer) = scene.tracer else { return out.fill(0.0) };
        self.positions.resize(out.len(), Vec3::ZERO);
        self.normals.resize(out.len(), Vec3::ZERO);
        let (positions, normals) = (&mut self.positions, &mut self.normals);
        let (threads, samples) = (self.threads, Samples::Fixed(light.samples));
        timed(&mut log.times.shadow, || {
            receivers::world(&scene.camera, threads, positions, normals);
            scene.prepared.snap_to_planes(scene.camera.map().ids(), positions);
            tracer.visibility(&light.light.light, positions, normals, samples, threads, out);
        });
        let seen = normals.iter().filter(|normal| **normal != Vec3::ZERO).count() as u64;
        log.counters.add("receivers", seen);
        log.counters.add("rays", seen * u64::from(samples.count()));
    }
}
