//! How many samples a linear light needs, and where: the question that the paper leaves open.
//!
//! No truth is needed to answer it. What the maps at both ends of a segment say about the light's
//! point in the segment's middle is compared with a map that is drawn from there. Where the two
//! disagree about too many receivers, something stands between that neither end sees, and the
//! middle becomes a sample. Long segments come first: where samples run out, they are spread over
//! the light.

use alloc::{vec, vec::Vec};

use shadowmap_core::{Camera, DepthMap};

use super::frame::{Facing, Frame, Frustum, FrustumMaps, UNKNOWN};
use super::run::{Probe, Vertex};
use super::scan::REACH;
use super::search::{MapSearch, Tilt};
use super::{INTERVAL_BIAS, check};
use crate::MAX_FRUSTA;
use crate::views::{SampleViews, choose};

/// When a segment is split, and when no more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveOptions {
    /// The part of the receivers that may disagree, in \[0, 1\].
    pub tolerance: f32,
    /// The most samples of a frustum, at least 2.
    pub most_samples: usize,
    /// Of the camera's pixels, every `stride`-th of every `stride`-th row is a receiver to ask; at
    /// least 1.
    pub stride: u32,
}

impl Default for AdaptiveOptions {
    fn default() -> Self {
        AdaptiveOptions { tolerance: 0.001, most_samples: 9, stride: 8 }
    }
}

/// What a trial found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disagreement {
    /// Receivers about which both sides know something.
    pub receivers: u32,
    /// Those about which they disagree.
    pub disagreeing: u32,
}

/// The samples of one frustum, from two at the light's ends to as many as it takes.
///
/// Draw the maps of both ends, then one map for each [`AdaptiveSamples::trial`], and ask
/// [`disagreement`]; [`AdaptiveSamples::answer`] says whether the trial becomes a sample. No map of
/// a sample is ever drawn twice.
///
/// ```
/// use linear_light::{AdaptiveOptions, AdaptiveSamples, Disagreement};
/// let mut samples = AdaptiveSamples::new(AdaptiveOptions::default());
/// assert_eq!(samples.trial(), Some((0, 0.5)));
/// assert!(samples.answer(Disagreement { receivers: 100, disagreeing: 50 }));
/// assert_eq!(samples.parameters(), [0.0, 0.5, 1.0]);
/// while samples.trial().is_some() {
///     assert!(!samples.answer(Disagreement { receivers: 100, disagreeing: 0 }));
/// }
/// assert_eq!(samples.parameters().len(), 3);
/// ```
#[derive(Clone, Debug)]
pub struct AdaptiveSamples {
    options: AdaptiveOptions,
    parameters: Vec<f32>,
    /// How many trials of each segment have found nothing.
    asked: Vec<usize>,
    /// How many have to, of a segment longer than half the light.
    places: usize,
}

/// Where a segment is asked about, as parts of the way along it.
const PLACES: [f32; 3] = [0.5, 0.25, 0.75];

impl AdaptiveSamples {
    /// Samples at both ends, and nothing known yet.
    #[must_use]
    pub fn new(options: AdaptiveOptions) -> AdaptiveSamples {
        AdaptiveSamples { options, parameters: vec![0.0, 1.0], asked: vec![0], places: 1 }
    }

    /// The same for maps with such windows. Where those are cut ([`crate::SampleViews::is_cut`]),
    /// maps from both ends know little of what lies close to the light between them: long segments
    /// are then asked about at their quarters too.
    #[must_use]
    pub fn through_windows_of(self, views: &SampleViews) -> AdaptiveSamples {
        AdaptiveSamples { places: if views.is_cut() { PLACES.len() } else { 1 }, ..self }
    }

    /// Where on the light the samples are, from 0 to 1.
    #[must_use]
    pub fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    /// The next segment to ask about, the longest that is not settled, and the parameter of a place
    /// in it, its middle first; `None` if all are settled or there are as many samples as there may
    /// be.
    #[must_use]
    pub fn trial(&self) -> Option<(usize, f32)> {
        if self.parameters.len() >= self.options.most_samples {
            return None;
        }
        let mut longest = None;
        for (segment, (ends, &asked)) in self.parameters.windows(2).zip(&self.asked).enumerate() {
            let [from, to] = [ends[0], ends[1]];
            let length = to - from;
            let places = if length > 0.5 { self.places } else { 1 };
            if asked < places && longest.is_none_or(|(_, _, most)| length > most) {
                longest = Some((segment, from + length * PLACES[asked], length));
            }
        }
        longest.map(|(segment, t, _)| (segment, t))
    }

    /// Takes what [`disagreement`] said of the trial. If `true`, the trial's map is now that of the
    /// sample behind the segment's first, and both parts will be asked about.
    pub fn answer(&mut self, found: Disagreement) -> bool {
        let Some((segment, t)) = self.trial() else { return false };
        let limit = self.options.tolerance * found.receivers as f32;
        let splits = found.disagreeing as f32 > limit;
        if splits {
            self.parameters.insert(segment + 1, t);
            self.asked[segment] = 0;
            self.asked.insert(segment + 1, 0);
        } else {
            self.asked[segment] += 1;
        }
        splits
    }
}

/// Asks every `options.stride`-th receiver of `camera` in the frustum `index` of `frusta` whether
/// it sees the light at parameter `t`: the maps at both ends of a `segment` of the frustum, and
/// `map`, which is taken from there ([`crate::SampleViews::trial_view`]) and may be smaller than
/// they are. Receivers at an edge of the hard shadow, where that small map is not sure, are not
/// asked.
///
/// # Panics
///
/// As [`super::IntervalVisibility::visibility`]; and if there is no such segment or frustum.
#[must_use]
pub fn disagreement(
    camera: &Camera<'_>,
    frusta: &[FrustumMaps<'_>],
    index: usize,
    segment: usize,
    t: f32,
    map: &DepthMap<'_>,
    options: &AdaptiveOptions,
) -> Disagreement {
    check(frusta);
    let maps = &frusta[index];
    let frustum = Frustum::new(camera.view(), maps, &[]);
    let frame = Frame::new(camera, [None; MAX_FRUSTA], maps.views.ends(), INTERVAL_BIAS);
    let nearest = map.nearness().iter().fold(0.0_f32, |most, &n| most.max(n));
    let trial = Trial { frame: &frame, frustum: &frustum, segment, t, map, nearest };
    let stride = options.stride.max(1) as usize;
    let [width, height] = [camera.map().width(), camera.map().height()];
    let mut found = Disagreement::default();
    for y in (stride as u32 / 2..height).step_by(stride) {
        for x in (stride as u32 / 2..width).step_by(stride) {
            let nearness = camera.map().nearness()[y as usize * width as usize + x as usize];
            let own = nearness > 0.0
                && (frusta.len() == 1 || {
                    let (u, v) = (x as f32 + 0.5, y as f32 + 0.5);
                    let position = camera.view().world_from_texel(u, v, nearness);
                    choose(frusta.iter().map(|maps| maps.views.rank(position))) == index
                });
            if own && let Some([predicted, hard]) = trial.ask(x, y, nearness) {
                found.receivers += 1;
                found.disagreeing += u32::from(predicted != hard);
            }
        }
    }
    found
}

/// What one segment and the map from its middle are asked about.
struct Trial<'a> {
    frame: &'a Frame<'a>,
    frustum: &'a Frustum<'a>,
    segment: usize,
    t: f32,
    map: &'a DepthMap<'a>,
    /// The greatest nearness in the map.
    nearest: f32,
}

impl Trial<'_> {
    /// Whether a receiver sees the middle, as predicted and as the map shows; `None` if the map is
    /// not sure, or the middle is below the receiver's horizon.
    fn ask(&self, x: u32, y: u32, nearness: f32) -> Option<[bool; 2]> {
        let Trial { frame, frustum, t, .. } = *self;
        let (_, plane) = frame.camera.plane(x, y, nearness);
        let known = plane.0.iter().all(|p| p.is_finite()) && plane.0[..3] != [0.0; 3];
        let facing = Facing::new(frame, if known { plane } else { UNKNOWN })?;
        let row = |r: [f32; 4]| {
            ((r[0] * (x as f32 + 0.5) + r[1] * (y as f32 + 0.5)) + r[2] * nearness) + r[3]
        };
        let [u, v, n, q] = frustum.warp.map(row);
        let receiver = [u / q, v / q, n / q];
        let [_, v, _] = receiver;
        let inside = q > 0.0 && v > 0.0 && v < frustum.size[1] as f32;
        let above = facing.horizon[0] <= t && t <= facing.horizon[1];
        if !(inside && above && receiver.iter().all(|r| r.is_finite())) {
            return None;
        }
        let tilt = Tilt::new(&facing, frustum, receiver[2]);
        let hard = self.hard(&tilt, receiver)?;
        let seen = [self.segment, self.segment + 1]
            .iter()
            .all(|&sample| !self.hides(&tilt, receiver, sample));
        Some([seen, hard])
    }

    /// What the map from the middle shows, if the texels around the receiver's agree.
    fn hard(&self, tilt: &Tilt, receiver: [f32; 3]) -> Option<bool> {
        let (map, [u, v, nearness]) = (self.map, receiver);
        let search =
            MapSearch::new(self.frustum, tilt, self.frame.bias, receiver, self.t, [0.0, 1.0]);
        let texels = [0, 1]
            .map(|axis| self.frustum.size[axis] as f32 / [map.width(), map.height()][axis] as f32);
        let [a, b, c, d] = search.plane;
        let bias = search.bias * texels[0].max(texels[1]);
        let at = [(u + search.shift * nearness) / texels[0], v / texels[1]];
        let lit = |dx: f32, dy: f32| {
            let [x, y] = [at[0] + dx, at[1] + dy];
            let inside = x >= 0.0 && y >= 0.0 && x < map.width() as f32 && y < map.height() as f32;
            let (x, y) = (x as usize, y as usize);
            inside.then(|| {
                let w = map.nearness()[y * map.width() as usize + x];
                let [s, t] = [(x as f32 + 0.5) * texels[0], (y as f32 + 0.5) * texels[1]];
                let front = ((a * s + b * t) + c * w) + d;
                !(front > bias && w > nearness)
            })
        };
        let own = lit(0.0, 0.0)?;
        let around = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)];
        around.iter().all(|&(dx, dy)| lit(dx, dy) == Some(own)).then_some(own)
    }

    /// Whether the map of a sample hides the middle from the receiver.
    fn hides(&self, tilt: &Tilt, [u, v, nearness]: [f32; 3], sample: usize) -> bool {
        let Trial { frame, frustum, t, .. } = *self;
        let (map, own) = (&frustum.samples[sample].map, frustum.samples[sample].t);
        let search = MapSearch::new(frustum, tilt, frame.bias, [u, v, nearness], own, [0.0, 1.0]);
        let [a, b, c, d] = search.plane;
        let y = (v as usize).min(map.height() as usize - 1);
        let width = map.width() as usize;
        let row = &map.nearness()[y * width..(y + 1) * width];
        let probe = Probe {
            u: u + search.shift * nearness,
            nearness: nearness + tilt.per_row * (y as f32 + 0.5 - v),
        };
        // From the receiver's column to where the nearest blocker would stand.
        let reach = frustum.disparity * (t - own) * (self.nearest - probe.nearness).max(0.0);
        let [from, to] = [probe.u + reach.min(0.0) - 2.0, probe.u + reach.max(0.0) + 3.0];
        let mut before: Option<f32> = None;
        for x in from.max(0.0) as usize..(to.max(0.0) as usize).min(width) {
            let column = x as f32 + 0.5;
            let front = ((a * column + b * (y as f32 + 0.5)) + c * row[x]) + d;
            if !(front > search.bias && row[x] > probe.nearness) {
                before = None;
                continue;
            }
            let at = |column| {
                let vertex = Vertex { column, nearness: row[x] };
                own + probe.hidden(vertex, frustum.disparity) - t
            };
            let ends = [at(column - (0.5 - REACH)), at(column + (0.5 - REACH))];
            let linked = x > 0 && {
                let step = (row[x] - row[x - 1]).abs();
                step < frustum.steepest() * row[x].max(row[x - 1])
            };
            let crosses = |a: f32, b: f32| (a <= 0.0) != (b <= 0.0);
            if crosses(ends[0], ends[1])
                || before.is_some_and(|before| linked && crosses(before, ends[0]))
            {
                return true;
            }
            before = Some(ends[1]);
        }
        false
    }
}
