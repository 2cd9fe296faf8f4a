//! The visibility of a group of receivers that share a plane.

use alloc::vec::Vec;
use core::ops::Range;

use super::bounds::BAND;
use super::frame::{Facing, Frame, Frustum};
use super::lanes::{LANES, Ops, max, min};
use super::receivers::{Extent, Pixels, Receivers};
use super::rows::RowReceivers;
use super::scan::{RowSearch, Run, any_in_front, scan};
use super::search::{MapSearch, Tilt};
use super::union::Interval;

/// Scratch memory of one band. It grows to what a band needs and is then kept.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    pub receivers: Receivers,
    row: RowReceivers,
    found: Vec<u32>,
    found_of: Vec<Range<usize>>,
    maps: Vec<MapSearch>,
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
            found_of: Vec::new(),
            maps: Vec::new(),
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

    /// The rows of the group in a band.
    #[inline(always)]
    fn rows_in(&self, band: usize) -> Range<usize> {
        self.rows[0].max(band * BAND)..(self.rows[1] + 1).min((band + 1) * BAND)
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
            let map = &frustum.samples[sample].map;
            let rows = self.rows_in(band);
            if scratch
                .found
                .iter()
                .any(|&found| any_in_front(ops, map, found, rows.clone(), &search))
            {
                return false;
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
        let Scratch { receivers, row, found, found_of, maps, runs, runs_of, intervals } = scratch;
        let Group { facing, tilt, .. } = self;
        maps.clear();
        for (index, sample) in frustum.samples.iter().enumerate() {
            maps.push(self.map_search(frame, frustum, sample.t, frustum.span(index)));
        }
        row.sort(receivers, self.pixels, self.rows, frustum.size[1] as f32 - 1.0);
        for band in self.rows[0] / BAND..=self.rows[1] / BAND {
            let rows = self.rows_in(band);
            if rows.clone().all(|y| row.of_row(y).is_empty()) {
                continue;
            }
            found.clear();
            found_of.clear();
            for (bounds, map) in frustum.bounds.iter().zip(&*maps) {
                let before = found.len();
                let search = map.among_bounds(frustum, &self.extent, tilt);
                bounds.search(ops, band, &search, found);
                found_of.push(before..found.len());
            }
            if found.is_empty() {
                continue;
            }
            for y in rows {
                let of = row.of_row(y);
                if of.is_empty() {
                    continue;
                }
                runs.clear();
                runs_of.clear();
                let probes = row.outermost(ops, of.clone(), tilt, y);
                for ((sample, map), found_of) in frustum.samples.iter().zip(&*maps).zip(&*found_of)
                {
                    let before = runs.len();
                    let search = RowSearch::new(frustum, map, &probes);
                    scan(ops, &sample.map, &found[found_of.clone()], y, map, &search, runs);
                    runs_of.push(before..runs.len());
                }
                if !runs.is_empty() {
                    row.judge(ops, of, y, frustum, facing, tilt, maps, runs, runs_of, intervals);
                }
            }
        }
        row.take_from(visibility);
    }
}
