//! The visibility of a group of receivers that share a plane.

use alloc::vec::Vec;
use core::ops::Range;

use super::bounds::BAND;
use super::frame::{Facing, Frame, Frustum};
use super::lanes::{LANES, Ops, max, min};
use super::receivers::{Extent, Pixels, Receivers};
use super::rows::RowReceivers;
use super::scan::{RowSearch, Run, Segment, fronts, scan};
use super::search::{MapSearch, Tilt};
use super::union::Interval;

/// Scratch memory of one band. It grows to what a band needs and is then kept.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    pub receivers: Receivers,
    row: RowReceivers,
    found: Vec<u32>,
    maps: Vec<MapSearch>,
    segments: Vec<Segment>,
    segments_of: Vec<Range<usize>>,
    runs: Vec<Run>,
    runs_of: Vec<Range<usize>>,
    intervals: Vec<Interval>,
}

impl Scratch {
    pub fn new() -> Scratch {
        Scratch {
            receivers: Receivers::NONE,
            row: RowReceivers::NONE,
            found: Vec::new(),
            maps: Vec::new(),
            segments: Vec::new(),
            segments_of: Vec::new(),
            runs: Vec::new(),
            runs_of: Vec::new(),
            intervals: Vec::new(),
        }
    }
}

/// A group, and the rows of the maps that it takes part of its visibility from.
pub(super) struct Group {
    pub pixels: Pixels,
    pub facing: Facing,
    pub tilt: Tilt,
    extent: Extent,
    reference: [f32; 3],
    /// The first and the last row.
    rows: [usize; 2],
}

impl Group {
    /// `pixels` must not be empty.
    #[inline(always)]
    pub fn new(
        ops: impl Ops,
        pixels: Pixels,
        facing: Facing,
        frustum: &Frustum<'_>,
        receivers: &Receivers,
    ) -> Group {
        let reference = receivers.at(pixels.trailing_zeros() as usize);
        let tilt = Tilt::new(&facing, frustum, reference[2]);
        let extent = receivers.extent(ops, pixels);
        let last = frustum.size[1] as f32 - 1.0;
        let first_row = max(0.0, min(extent.rows[0] - 0.5, last)) as usize;
        let last_row = max(0.0, min(extent.rows[1] - 0.5, last)) as usize + 1;
        let rows = [first_row, last_row.min(last as usize)];
        Group { pixels, facing, tilt, extent, reference, rows }
    }

    /// The rows of the group in a band, counted from the band's first.
    #[inline(always)]
    fn rows_in(&self, band: usize) -> [usize; 2] {
        let first = self.rows[0].max(band * BAND);
        [first - band * BAND, self.rows[1].min(band * BAND + BAND - 1) - band * BAND]
    }

    #[inline(always)]
    fn map_search(
        &self,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        t: f32,
        span: [f32; 2],
    ) -> MapSearch {
        MapSearch::new(frustum, &self.tilt, frame.bias, self.reference, t, span)
    }

    /// Whether nothing blocks: then the map of one end of the light, which must be above the
    /// horizon, shows nothing in front of the plane in any direction from which light comes. What
    /// that map does not show lies behind what it shows, and so behind the plane too.
    #[inline(always)]
    pub fn is_lit(
        &self,
        ops: impl Ops,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        scratch: &mut Scratch,
    ) -> bool {
        let [a, b] = self.facing.ends;
        let sample = if a >= b { 0 } else { frustum.samples.len() - 1 };
        let map = self.map_search(frame, frustum, frustum.samples[sample].t, [0.0, 1.0]);
        let search = map.among_bounds(frustum, &self.extent, &self.tilt);
        for band in self.rows[0] / BAND..=self.rows[1] / BAND {
            scratch.found.clear();
            frustum.bounds[sample].search(ops, band, &search, &mut scratch.found);
            for &found in &scratch.found {
                let texels = &frustum.samples[sample].map;
                let segment = fronts(ops, texels, found, band, self.rows_in(band), &search);
                if segment.any() {
                    return false;
                }
            }
        }
        true
    }

    /// Takes from `visibility`, which holds what is above the horizon, all that is hidden.
    #[inline(always)]
    pub fn judge(
        &self,
        ops: impl Ops,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        scratch: &mut Scratch,
        visibility: &mut [f32; LANES * BAND],
    ) {
        let Scratch {
            receivers,
            row,
            found,
            maps,
            segments,
            segments_of,
            runs,
            runs_of,
            intervals,
        } = scratch;
        maps.clear();
        for (index, sample) in frustum.samples.iter().enumerate() {
            maps.push(self.map_search(frame, frustum, sample.t, frustum.span(index)));
        }
        let last_row = frustum.size[1] as f32 - 1.0;
        for band in self.rows[0] / BAND..=self.rows[1] / BAND {
            let rows = self.rows_in(band);
            segments.clear();
            segments_of.clear();
            for (sample, map) in maps.iter().enumerate() {
                let before = segments.len();
                found.clear();
                let search = map.among_bounds(frustum, &self.extent, &self.tilt);
                frustum.bounds[sample].search(ops, band, &search, found);
                for &found in &*found {
                    let texels = &frustum.samples[sample].map;
                    let segment = fronts(ops, texels, found, band, rows, &search);
                    if segment.any() {
                        segments.push(segment);
                    }
                }
                segments_of.push(before..segments.len());
            }
            if segments.is_empty() {
                continue;
            }
            for in_band in rows[0]..=rows[1] {
                if segments.iter().all(|segment| segment.front[in_band] == 0) {
                    continue;
                }
                let y = band * BAND + in_band;
                row.gather(ops, receivers, self.pixels, &self.tilt, y, last_row);
                if row.count == 0 {
                    continue;
                }
                runs.clear();
                runs_of.clear();
                let probes = row.outermost(ops);
                for (sample, segments_of) in segments_of.iter().enumerate() {
                    let before = runs.len();
                    let map = &frustum.samples[sample].map;
                    let width = map.width() as usize;
                    let texels = &map.nearness()[y * width..(y + 1) * width];
                    let here = &segments[segments_of.clone()];
                    let search = RowSearch::new(frustum, &maps[sample], &probes);
                    scan(ops, texels, here, in_band, &search, runs);
                    runs_of.push(before..runs.len());
                }
                if !runs.is_empty() {
                    let facing = &self.facing;
                    row.judge(ops, frustum, facing, maps, runs, runs_of, intervals, visibility);
                }
            }
        }
    }
}
