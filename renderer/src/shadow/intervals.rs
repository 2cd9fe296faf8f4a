//! Interval visibility: the maps of a line, more of them where two do not suffice, and what they
//! say.

use linear_light::{
    AdaptiveOptions, AdaptiveSamples, FrustumMaps, INTERVAL_BIAS, RectifiedLight, SampleMap,
    disagreement,
};
use raster::{DepthBuffer, Payload};
use shadowmap_core::View;

use super::{Log, Scene, ShadowStage};
use crate::drawing::{Drawing, Viewer};
use crate::lighting::Adapts;
use crate::stats::timed;

/// How much smaller along each axis the maps are that only ask whether a sample is missing.
const TRIAL_REDUCTION: u32 = 2;

impl ShadowStage {
    /// Writes the visibility of a line whose maps have been drawn; draws more for the frusta that
    /// it `adapts` in.
    pub(super) fn by_intervals(
        &mut self,
        drawing: &mut Drawing,
        scene: &Scene<'_>,
        line: &RectifiedLight,
        adapts: Adapts,
        log: &mut Log<'_>,
        out: &mut [f32],
    ) {
        let mut parameters: Vec<Vec<f32>> = line
            .frusta()
            .iter()
            .map(|frustum| {
                let last = frustum.views().len() - 1;
                (0..=last).map(|k| k as f32 / last as f32).collect()
            })
            .collect();
        for (frustum, views) in line.frusta().iter().enumerate() {
            if adapts.in_frustum(views) {
                self.adapt(drawing, scene, line, frustum, &mut parameters, log);
            }
        }
        let samples = samples_of(&self.maps, &parameters);
        let frusta = frusta_of(line, &samples);
        let intervals = &mut self.intervals;
        timed(&mut log.times.light_maps, || intervals.prepare(&frusta));
        let found = timed(&mut log.times.shadow, || {
            intervals.visibility(&scene.camera, &frusta, INTERVAL_BIAS, out)
        });
        log.counters.add("light samples", self.maps.len() as u64);
        log.counters.add_receivers(found.receivers, found.outside, log.holds_all);
        log.counters.add("searched receivers", found.searched);
    }

    /// Draws as many more maps of a frustum as it takes, and inserts their places on the light into
    /// `parameters`.
    fn adapt(
        &mut self,
        drawing: &mut Drawing,
        scene: &Scene<'_>,
        line: &RectifiedLight,
        frustum: usize,
        parameters: &mut [Vec<f32>],
        log: &mut Log<'_>,
    ) {
        let views = &line.frusta()[frustum];
        let first: usize = parameters[..frustum].iter().map(Vec::len).sum();
        let options = AdaptiveOptions::default();
        let mut samples = AdaptiveSamples::new(options).through_windows_of(views);
        let [width, height] = [views.views()[0].width(), views.views()[0].height()];
        let size = [width, height].map(|side| (side / TRIAL_REDUCTION).max(1));
        while let Some((segment, t)) = samples.trial() {
            let mut trial = std::mem::take(&mut self.trial);
            self.draw_one(drawing, scene, &views.trial_view(t, size), &mut trial, log);
            let found = timed(&mut log.times.light_maps, || {
                let samples = samples_of(&self.maps, parameters);
                let frusta = frusta_of(line, &samples);
                let map = trial[0].as_depth_map();
                disagreement(&scene.camera, &frusta, frustum, segment, t, &map, &options)
            });
            self.trial = trial;
            log.counters.add("receivers asked for a sample between", found.receivers.into());
            log.counters.add("receivers that miss a sample between", found.disagreeing.into());
            if samples.answer(found) {
                let mut map = vec![DepthBuffer::new(0, 0)];
                self.draw_one(drawing, scene, &views.view_at(t), &mut map, log);
                self.maps.splice(first + segment + 1..first + segment + 1, map);
                parameters[frustum].insert(segment + 1, t);
            }
        }
    }

    fn draw_one(
        &self,
        drawing: &mut Drawing,
        scene: &Scene<'_>,
        view: &View,
        map: &mut Vec<DepthBuffer>,
        log: &mut Log<'_>,
    ) {
        map.resize_with(1, || DepthBuffer::new(0, 0));
        let views = std::slice::from_ref(view);
        let drawn = timed(&mut log.times.light_maps, || {
            drawing.draw(scene.prepared, Viewer::Light, views, Payload::ObjectId, map)
        });
        log.counters.add("triangles drawn for lights", drawn);
        log.counters.add("light maps", 1);
    }
}

/// The maps of each frustum, which follow each other, with their places on the light.
fn samples_of<'a>(maps: &'a [DepthBuffer], parameters: &[Vec<f32>]) -> Vec<Vec<SampleMap<'a>>> {
    let mut maps = maps.iter().map(DepthBuffer::as_depth_map);
    let of_frustum = |parameters: &Vec<f32>| {
        parameters.iter().zip(maps.by_ref()).map(|(&t, map)| SampleMap { t, map }).collect()
    };
    parameters.iter().map(of_frustum).collect()
}

fn frusta_of<'a>(
    line: &'a RectifiedLight,
    samples: &'a [Vec<SampleMap<'a>>],
) -> Vec<FrustumMaps<'a>> {
    let frusta = line.frusta().iter().zip(samples);
    frusta.map(|(views, samples)| FrustumMaps { views, samples }).collect()
}
