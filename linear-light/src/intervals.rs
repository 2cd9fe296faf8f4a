//! Interval visibility: from two depth maps, the part of a linear light that each receiver sees.
//!
//! The paper knows what lies between a blocker's edge and the receiver behind it (its skins) and
//! fails where no sample sees a receiver. The maps say more: in rectified views
//! ([`SampleViews`]) every plane through the light is one row in every map, and along
//! a row the blockers are piecewise known. For a receiver at column u_p with nearness w_p in the
//! map from parameter t_0 of the light, the point of a blocker at column u with nearness w > w_p
//! hides exactly the parameter
//!
//! ```text
//! t = t_0 + (u - u_p) / (disparity (w - w_p))
//! ```
//!
//! of the light: from there both fall on the same column. It is division-free but for this one,
//! and linear in nearness.
//!
//! # The method
//!
//! 1. A texel blocks only if it lies in front of the receiver's own plane, on the side that the
//!    camera sees, by more than the [`Bias`]; so no receiver shadows itself.
//! 2. Texels that follow each other without a step in nearness are one piece of blocker, a *run*.
//!    It hides the parameters from the least to the greatest that one of its texels hides. Beyond
//!    the centres of its outermost texels a run goes on as it has come, by about a third of a
//!    texel, or until it meets the receiver's plane.
//! 3. Each part of the light between two samples is judged by both their maps: what one cannot see
//!    behind a blocker, the other often can. Hidden is the union of all runs' intervals.
//! 4. What lies below the receiver's horizon is hidden too, analytically. Visibility is what is
//!    left of the light.
//! 5. The receiver is moved along its plane into the middles of the two rows around it, and their
//!    visibilities are blended by its distance to them: so rows leave no stairs. A row does not
//!    count where that would move the receiver into a blocker that stands on its plane.
//!
//! # What is fast
//!
//! Receivers are taken in groups: those that share a plane in a block of 16 x 8 pixels.
//!
//! * Every 16 x 8 texels of a map are bounded by a plane and the least and greatest distance from
//!   it. Where no bound reaches above the group's plane, the group is lit: a ground that the light
//!   sees at an angle is decided without looking at a texel.
//! * Groups of neighbouring blocks that share a plane are judged together. Of each row only the
//!   bounded parts that can block are read, once for the whole group, since the same texels are in
//!   front of its plane. For each run, the texels that hide the most and the least for the two
//!   outermost receivers, and for two between them where those differ, stand for the whole run (for
//!   the other receivers the extreme texel lies between theirs: what this neglects is far below a
//!   texel).

mod adaptive;
mod block;
mod border;
mod bounds;
mod contact;
mod frame;
mod group;
#[cfg(test)]
mod naive;
mod receivers;
mod rows;
mod run;
mod scan;
mod search;
#[cfg(test)]
mod tests;
mod union;

use alloc::vec::Vec;

use shadowmap_core::{BandSlice, Bias, Camera, Level, Threads, for_each_band};

pub use adaptive::{AdaptiveOptions, AdaptiveSamples, Disagreement, disagreement};
pub use block::Counters as IntervalCounters;
pub use frame::{FrustumMaps, SampleMap};

pub(crate) use block::judge_band;
pub(crate) use bounds::{Nodes, build};
pub(crate) use frame::Frame;
pub(crate) use group::Scratch;

use crate::MAX_FRUSTA;
use crate::kernels::{Job, run};
use bounds::{BAND, Bounds};
use frame::Frustum;

/// The bias of interval visibility.
///
/// Less than [`Bias::default`] along the slope, since what a receiver's own plane hides is not
/// looked for in the maps.
pub const INTERVAL_BIAS: Bias = Bias { constant: 1.0 / 8192.0, slope: 0.35 };

/// Computes interval visibility. Keep one and reuse it: it owns the bounds of the maps and the
/// scratch memory, and allocates nothing once they have grown to the size of a frame.
#[derive(Debug)]
pub struct IntervalVisibility {
    level: Level,
    threads: Threads,
    /// The bounds of the maps, frustum after frustum.
    bounds: Vec<Bounds>,
    bands: Vec<(Scratch, IntervalCounters)>,
}

impl IntervalVisibility {
    /// A workspace that uses the instructions of `level` and runs on `threads`. Its results do not
    /// depend on either.
    #[must_use]
    pub fn new(level: Level, threads: Threads) -> IntervalVisibility {
        IntervalVisibility { level, threads, bounds: Vec::new(), bands: Vec::new() }
    }

    /// Bounds the maps of a light's frusta. Needed once after the maps were drawn; what casts no
    /// shadows may move without it.
    ///
    /// # Panics
    ///
    /// As [`IntervalVisibility::visibility`].
    pub fn prepare(&mut self, frusta: &[FrustumMaps<'_>]) {
        check(frusta);
        let maps = frusta.iter().map(|frustum| frustum.samples.len()).sum();
        self.bounds.resize_with(maps, Bounds::default);
        let samples = frusta.iter().flat_map(|frustum| frustum.samples);
        for (bounds, sample) in self.bounds.iter_mut().zip(samples) {
            let (level, map) = (self.level, sample.map);
            let width = map.width() as usize;
            bounds.resize(map.width(), map.height());
            for_each_band(self.threads, bounds.bands(), &|band, (nodes, most)| {
                let end = ((band + 1) * BAND * width).min(map.nearness().len());
                let rows = &map.nearness()[band * BAND * width..end];
                let (nodes, most) = (nodes.data, &mut most.data[0]);
                run(level, Job::Bound { nodes, most, rows, width });
            });
        }
    }

    /// Writes the visibility of every pixel of `camera` to `out`: the fraction of the light that it
    /// sees, in \[0, 1\]; 0 where the camera sees nothing and on surfaces that face away from the
    /// whole light. `frusta` are those of the last [`IntervalVisibility::prepare`].
    ///
    /// # Panics
    ///
    /// If there are no frusta or more than [`MAX_FRUSTA`], if they are not those that were
    /// prepared, if a frustum has less than two maps, maps of another size than its views or with
    /// `t` not ascending from 0 to 1, or if `out` does not have one element per pixel.
    pub fn visibility(
        &mut self,
        camera: &Camera<'_>,
        frusta: &[FrustumMaps<'_>],
        bias: Bias,
        out: &mut [f32],
    ) -> IntervalCounters {
        check(frusta);
        assert_eq!(out.len(), camera.map().nearness().len(), "one visibility per pixel");
        let maps: usize = frusta.iter().map(|frustum| frustum.samples.len()).sum();
        assert_eq!(maps, self.bounds.len(), "the maps have not been prepared");
        let frame = frame(&self.bounds, camera, frusta, bias);
        let level = self.level;
        let width = camera.map().width() as usize;
        let bands = (camera.map().height() as usize).div_ceil(BAND);
        self.bands.resize_with(bands, || (Scratch::new(), IntervalCounters::default()));
        let work = (
            BandSlice { data: out, len: (width * BAND).max(1) },
            BandSlice { data: &mut self.bands[..], len: 1 },
        );
        for_each_band(self.threads, work, &|band, (out, scratch)| {
            let (scratch, counters) = &mut scratch.data[0];
            *counters = IntervalCounters::default();
            let (frame, out, first_row) = (&frame, out.data, band * BAND);
            run(level, Job::Judge { frame, first_row, out, scratch, counters });
        });
        self.bands.iter().fold(IntervalCounters::default(), |sum, (_, band)| IntervalCounters {
            receivers: sum.receivers + band.receivers,
            outside: sum.outside + band.outside,
            searched: sum.searched + band.searched,
        })
    }
}

/// What the kernels read.
fn frame<'a>(
    mut bounds: &'a [Bounds],
    camera: &Camera<'a>,
    frusta: &[FrustumMaps<'a>],
    bias: Bias,
) -> Frame<'a> {
    let mut of_frusta = [None; MAX_FRUSTA];
    for (slot, maps) in of_frusta.iter_mut().zip(frusta) {
        let (own, rest) = bounds.split_at(maps.samples.len());
        *slot = Some(Frustum::new(camera.view(), maps, own));
        bounds = rest;
    }
    Frame::new(camera, of_frusta, frusta[0].views.ends(), bias)
}

/// Panics unless the maps fit their views.
fn check(frusta: &[FrustumMaps<'_>]) {
    assert!((1..=MAX_FRUSTA).contains(&frusta.len()), "a light has from 1 to {MAX_FRUSTA} frusta");
    for frustum in frusta {
        let view = frustum.views.views()[0];
        let samples = frustum.samples;
        assert!(samples.len() >= 2, "a linear light needs a map at either end");
        let ts = [samples[0].t, samples[samples.len() - 1].t];
        assert_eq!(ts, [0.0, 1.0], "the first and the last map are those of the light's ends");
        assert!(samples.is_sorted_by(|a, b| a.t < b.t), "samples ascend along the light");
        for sample in samples {
            let size = [sample.map.width(), sample.map.height()];
            assert_eq!(size, [view.width(), view.height()], "a map is not of its view's size");
        }
    }
}
