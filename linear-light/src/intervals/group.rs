//! The visibility of a group of receivers that share a plane.

use alloc::vec::Vec;
use core::ops::Range;

use super::border::Neighbour;
use super::bounds::BAND;
use super::contact::Contact;
use super::frame::{Facing, Frame, Frustum};
use super::receivers::{Extent, Pixels, Receivers};
use super::rows::RowReceivers;
use super::run::Run;
use super::scan::{RowSearch, any_in_front, scan};
use super::search::{MapSearch, Tilt};
use super::union::Interval;
use crate::lanes::{Ops, max, min};

/// The most blocks of a group, side by side.
pub(super) const WIDEST: usize = 4;

/// From so many receivers in one block on, a group waits for the next block.
const WORTH_WAITING: u32 = 64;

/// Receivers of a few blocks: those that a group may hold, and those at hand.
pub(super) type Blocks = [Receivers; WIDEST + 1];

/// Scratch memory of one band. It grows to what a band needs and is then kept.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    /// Those of block i of the band are element i of them, round and round.
    pub(super) receivers: Blocks,
    /// What is hidden from each pixel of the band.
    pub hidden: Vec<f32>,
    /// Groups to be judged.
    pub(super) ready: Vec<Group>,
    /// A group that the next block may have more receivers of.
    waiting: Option<Group>,
    row: RowReceivers,
    found: Vec<u32>,
    found_of: Vec<Range<usize>>,
    maps: Vec<MapSearch>,
    ranges: Vec<Range<usize>>,
    runs: Vec<Run>,
    runs_of: Vec<Range<usize>>,
    contacts: Vec<Contact>,
    intervals: Vec<Interval>,
}

impl Scratch {
    pub fn new() -> Scratch {
        Scratch {
            receivers: [const { Receivers::NONE }; WIDEST + 1],
            hidden: Vec::new(),
            ready: Vec::new(),
            waiting: None,
            row: RowReceivers::NONE,
            found: Vec::new(),
            found_of: Vec::new(),
            maps: Vec::new(),
            ranges: Vec::new(),
            runs: Vec::new(),
            runs_of: Vec::new(),
            contacts: Vec::new(),
            intervals: Vec::new(),
        }
    }
}

impl Scratch {
    /// Takes a group that is to be judged, together with that of the block before if their planes
    /// are the same.
    #[inline(always)]
    pub(super) fn add(&mut self, group: Group) {
        match &mut self.waiting {
            Some(waiting) if waiting.may_join(&group) => waiting.join(&group),
            waiting if group.parts[0].pixels.count_ones() >= WORTH_WAITING => {
                self.ready.extend(waiting.replace(group));
            }
            _ => self.ready.push(group),
        }
    }

    /// Lets no group wait that has no receivers in `block`, and none at all if nothing follows.
    #[inline(always)]
    pub fn end_block(&mut self, block: usize, nothing_follows: bool) {
        let goes_on = |group: &Group| group.parts[group.count - 1].block == block;
        if nothing_follows || !self.waiting.as_ref().is_some_and(goes_on) {
            self.ready.extend(self.waiting.take());
        }
    }
}

/// The receivers of a group in one block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// The number of the block in its band.
    pub block: usize,
    pub pixels: Pixels,
}

/// A group, and the rows of the maps that it takes part of its visibility from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    parts: [Part; WIDEST],
    count: usize,
    pub facing: Facing,
    pub tilt: Tilt,
    extent: Extent,
    reference: [f32; 3],
    /// The first and the last row.
    rows: [usize; 2],
}

impl Group {
    /// The pixels of `part` must not be none.
    #[inline(always)]
    pub fn new(
        ops: impl Ops,
        part: Part,
        facing: Facing,
        frustum: &Frustum<'_>,
        receivers: &Blocks,
    ) -> Group {
        let receivers = &receivers[part.block % receivers.len()];
        let reference = receivers.at(part.pixels.trailing_zeros() as usize);
        let tilt = Tilt::new(&facing, frustum, reference[2]);
        let extent = receivers.extent(ops, part.pixels);
        let last = frustum.size[1] as f32 - 1.0;
        let first_row = max(0.0, min(extent.rows[0] - 0.5, last)) as usize;
        let last_row = max(0.0, min(extent.rows[1] - 0.5, last)) as usize + 1;
        let rows = [first_row, last_row.min(last as usize)];
        Group { parts: [part; WIDEST], count: 1, facing, tilt, extent, reference, rows }
    }

    /// The receivers, block by block.
    pub fn parts(&self) -> &[Part] {
        &self.parts[..self.count]
    }

    /// Whether `other`, of the block at hand, may join: its receivers lie on the same plane, and
    /// there is room.
    #[inline(always)]
    pub fn may_join(&self, other: &Group) -> bool {
        self.count < WIDEST && self.facing.plane == other.facing.plane && !other.tilt.steep
    }

    /// Takes in the receivers of another group.
    #[inline(always)]
    pub fn join(&mut self, other: &Group) {
        self.parts[self.count] = other.parts[0];
        self.count += 1;
        self.extent = self.extent.with(&other.extent);
        self.rows = [self.rows[0].min(other.rows[0]), self.rows[1].max(other.rows[1])];
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
    /// that map does not show lies behind what it shows, and so behind the plane too. If the window
    /// is cut, it may also lie beside it: then every map is asked about its part of the light.
    #[inline(always)]
    pub fn is_lit(
        &self,
        ops: impl Ops,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        scratch: &mut Scratch,
    ) -> bool {
        let [a, b] = self.facing.ends;
        let end = if a >= b { 0 } else { frustum.samples.len() - 1 };
        let samples = if frustum.is_cut { 0..frustum.samples.len() } else { end..end + 1 };
        for sample in samples {
            let span = if frustum.is_cut { frustum.span(sample) } else { [0.0, 1.0] };
            let map = self.map_search(frame, frustum, frustum.samples[sample].t, span);
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
        }
        true
    }

    /// Writes what is hidden from each receiver to its pixel of the band, which is `width` pixels
    /// wide.
    #[inline(always)]
    pub fn judge(
        &self,
        ops: impl Ops,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        scratch: &mut Scratch,
        width: usize,
    ) {
        let Scratch {
            receivers,
            hidden,
            row,
            found,
            found_of,
            maps,
            ranges,
            runs,
            runs_of,
            contacts,
            intervals,
            ..
        } = scratch;
        let Group { facing, tilt, .. } = self;
        maps.clear();
        for (index, sample) in frustum.samples.iter().enumerate() {
            maps.push(self.map_search(frame, frustum, sample.t, frustum.span(index)));
        }
        let last_row = frustum.size[1] as f32 - 1.0;
        row.sort(receivers, self.parts(), self.rows, last_row, width);
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
                contacts.clear();
                let probes = row.outermost(ops, of.clone(), tilt, y);
                for (index, (map, found_of)) in maps.iter().zip(&*found_of).enumerate() {
                    let before = runs.len();
                    let neighbours = Neighbour::both(frustum, index, y);
                    let search = RowSearch::new(frustum, map, &probes, self.count, neighbours);
                    scan(
                        ops,
                        &frustum.samples[index].map,
                        &found[found_of.clone()],
                        y,
                        map,
                        &search,
                        ranges,
                        runs,
                        contacts,
                    );
                    runs_of.push(before..runs.len());
                }
                if !runs.is_empty() {
                    row.judge(
                        ops, of, y, frustum, facing, tilt, maps, runs, runs_of, contacts, intervals,
                    );
                }
            }
        }
        row.write(hidden);
    }
}
