//! The receivers that take part of their visibility from one row of the maps.

use alloc::vec::Vec;
use core::ops::Range;

use super::bounds::BAND;
use super::contact::Contact;
use super::frame::{Facing, Frustum};
use super::group::{Blocks, Part, WIDEST};
use super::receivers::{Pixels, in_row};
use super::run::{Probe, Run, Vertex};
use super::search::{MapSearch, Tilt};
use super::union::{Interval, union_length};
use crate::lanes::{LANES, Lanes, Ops, lanes, max, min, within};

/// The receivers of a block of the camera's image.
const BLOCK: usize = LANES * BAND;

/// The most receivers in a group.
const MOST: usize = BLOCK * WIDEST;

/// How much a row counts for a receiver that was moved through a blocker to get there: what it sees
/// there is asked for only if the other row is no better.
pub(super) const LITTLE: f32 = 1.0 / 1024.0;

/// Vectors are read from any receiver on.
const ROOM: usize = MOST + LANES;

/// The receivers of a group in the order of the rows that they fall on. Each lies between the
/// middles of two rows, and takes its visibility from both: the receivers of one row follow each
/// other.
#[derive(Clone, Debug)]
pub(super) struct RowReceivers {
    /// In the map from the middle of the light.
    column: [f32; ROOM],
    row: [f32; ROOM],
    nearness: [f32; ROOM],
    /// What is hidden from each, row by row, times the row's part.
    hidden: [f32; ROOM],
    /// The parts of the rows that do not count.
    discounted: [f32; ROOM],
    /// How many rows below the first the upper row of each pixel of the group's blocks is.
    rank: [u32; MOST],
    /// Which pixel of the band each is.
    pixel: [u32; MOST],
    /// The first row.
    first: usize,
    /// How many receivers have the upper of their rows before `first + k`, for each k.
    before: Vec<u16>,
}

impl RowReceivers {
    pub const NONE: RowReceivers = RowReceivers {
        column: [0.0; ROOM],
        row: [0.0; ROOM],
        nearness: [0.0; ROOM],
        hidden: [0.0; ROOM],
        discounted: [0.0; ROOM],
        rank: [0; MOST],
        pixel: [0; MOST],
        first: 0,
        before: Vec::new(),
    };

    /// Takes in the receivers of a group, between rows `first` and `last`, of a band of `width`
    /// pixels.
    #[inline(always)]
    pub fn sort(
        &mut self,
        receivers: &Blocks,
        parts: &[Part],
        [first, last]: [usize; 2],
        last_row: f32,
        width: usize,
    ) {
        self.first = first;
        // While receivers are put in their places, element k + 1 is the place of the next one
        // whose upper row is `first + k`.
        self.before.clear();
        self.before.resize(last - first + 3, 0);
        for (ranks, part) in self.rank.as_chunks_mut::<BLOCK>().0.iter_mut().zip(parts) {
            let rows = &receivers[part.block % receivers.len()].row;
            for_each_pixel(part.pixels, |line, lane| {
                // Rows that are numbers lie between the first and the last.
                let upper = (center(rows[line][lane], last_row) as usize).max(first).min(last);
                ranks[line * LANES + lane] = (upper - first) as u32;
                self.before[upper - first + 2] += 1;
            });
        }
        let mut sum = 0;
        for before in &mut self.before {
            sum += *before;
            *before = sum;
        }
        for (ranks, part) in self.rank.as_chunks::<BLOCK>().0.iter().zip(parts) {
            let from = &receivers[part.block % receivers.len()];
            for_each_pixel(part.pixels, |line, lane| {
                let next = &mut self.before[ranks[line * LANES + lane] as usize + 1];
                let place = usize::from(*next) % MOST;
                *next += 1;
                self.column[place] = from.column[line][lane];
                self.row[place] = from.row[line][lane];
                self.nearness[place] = from.nearness[line][lane];
                self.pixel[place] = (line * width + part.block * LANES + lane) as u32;
            });
        }
        self.hidden[..usize::from(sum) + LANES].fill(0.0);
        self.discounted[..usize::from(sum) + LANES].fill(0.0);
    }

    /// The receivers for which row `y` counts: those within one row of its middle.
    #[inline(always)]
    pub fn of_row(&self, y: usize) -> Range<usize> {
        let k = y - self.first;
        usize::from(self.before[k.saturating_sub(1)])..usize::from(self.before[k + 1])
    }

    /// Sixteen receivers, moved along their plane into the middle of row `y`.
    #[inline(always)]
    fn moved(&self, at: usize, tilt: &Tilt, y: usize) -> [Lanes; 3] {
        let [column, row, nearness] =
            [&self.column, &self.row, &self.nearness].map(|of| at_lanes(of, at));
        let middle = y as f32 + 0.5;
        let nearness = lanes(|i| nearness[i] + tilt.per_row * (middle - row[i]));
        [column, row, nearness]
    }

    /// The leftmost and the rightmost of some receivers in row `y`.
    #[inline(always)]
    pub fn outermost(&self, ops: impl Ops, of: Range<usize>, tilt: &Tilt, y: usize) -> [Probe; 2] {
        let (mut left, mut right) = (Probe::default(), Probe::default());
        for at in of.clone().step_by(LANES) {
            let [column, _, nearness] = self.moved(at, tilt, y);
            let rest = within(of.end - at);
            let from_left = ops.select(rest, &column, &[f32::INFINITY; LANES]);
            let from_right = ops.select(rest, &column, &[f32::NEG_INFINITY; LANES]);
            let (low, high) = (ops.least(&from_left), ops.greatest(&from_right));
            if at == of.start || low < left.u {
                let lane = (!ops.greater(&from_left, &[low; LANES])).trailing_zeros() as usize;
                left = Probe { u: low, nearness: nearness[lane % LANES] };
            }
            if at == of.start || high > right.u {
                let lane = (!ops.greater(&[high; LANES], &from_right)).trailing_zeros() as usize;
                right = Probe { u: high, nearness: nearness[lane % LANES] };
            }
        }
        [left, right]
    }

    /// Adds what the runs of row `y` hide from some receivers. The runs of map i are
    /// `runs[runs_of[i]]`.
    #[inline(always)]
    pub fn judge(
        &mut self,
        ops: impl Ops,
        of: Range<usize>,
        y: usize,
        frustum: &Frustum<'_>,
        facing: &Facing,
        tilt: &Tilt,
        maps: &[MapSearch],
        runs: &[Run],
        runs_of: &[Range<usize>],
        contacts: &[Contact],
        intervals: &mut Vec<Interval>,
    ) {
        let last_row = frustum.size[1] as f32 - 1.0;
        for at in of.clone().step_by(LANES) {
            let [column, row, nearness] = self.moved(at, tilt, y);
            let rest = within(of.end - at);
            intervals.clear();
            for (map, runs_of) in maps.iter().zip(runs_of) {
                let sixteen =
                    Sixteen { u: lanes(|i| column[i] + map.shift * nearness[i]), nearness };
                for run in &runs[runs_of.clone()] {
                    let [first, last] = sixteen.hidden(ops, run, frustum.disparity);
                    let from = max(map.span[0], facing.horizon[0]);
                    let to = min(map.span[1], facing.horizon[1]);
                    let from = lanes(|i| max(map.t + first[i], from));
                    let to = lanes(|i| min(map.t + last[i], to));
                    if ops.greater(&to, &from) & rest != 0 {
                        intervals.push(Interval { from, to });
                    }
                }
            }
            if intervals.is_empty() {
                continue;
            }
            let hidden = union_length(ops, intervals, facing.horizon[0]);
            let mut part = lanes(|i| max(1.0 - (center(row[i], last_row) - y as f32).abs(), 0.0));
            let mut moved_through = 0;
            for contact in contacts {
                let away = |at: usize| {
                    lanes(|i| {
                        let rows = row[i] - (y as f32 + 0.5);
                        contact.away(column[i], nearness[i], tilt.per_row, rows)[at]
                    })
                };
                let sides = [0, 1].map(|at| ops.greater(&away(at), &[0.0; LANES]));
                moved_through |= sides[0] ^ sides[1];
            }
            if moved_through != 0 {
                let less = ops.select(moved_through, &[1.0 - LITTLE; LANES], &[0.0; LANES]);
                add(&mut self.discounted, at, &lanes(|i| less[i] * part[i]));
                part = lanes(|i| part[i] - less[i] * part[i]);
            }
            add(&mut self.hidden, at, &lanes(|i| part[i] * hidden[i]));
        }
    }

    /// Writes what is hidden from each receiver to its pixel of the band.
    #[inline(always)]
    pub fn write(&self, out: &mut [f32]) {
        let count = usize::from(self.before.last().copied().unwrap_or(0));
        let each = self.pixel.iter().zip(&self.hidden).zip(&self.discounted);
        for ((pixel, hidden), discounted) in each.take(count) {
            out[*pixel as usize] = hidden / (1.0 - discounted);
        }
    }
}

/// Where a receiver lies between the middles of rows, counted from that of the first.
#[inline(always)]
fn center(row: f32, last_row: f32) -> f32 {
    max(0.0, min(row - 0.5, last_row))
}

/// Calls `f` with line and lane of each pixel.
#[inline(always)]
fn for_each_pixel(pixels: Pixels, mut f: impl FnMut(usize, usize)) {
    for line in 0..BAND {
        let mut left = in_row(pixels, line);
        while left != 0 {
            f(line, left.trailing_zeros() as usize % LANES);
            left &= left - 1;
        }
    }
}

/// Sixteen receivers as a map sees them.
struct Sixteen {
    u: Lanes,
    nearness: Lanes,
}

impl Sixteen {
    /// The least and the greatest parameter that a run hides from each, from the map's own on.
    #[inline(always)]
    fn hidden(&self, ops: impl Ops, run: &Run, disparity: f32) -> [Lanes; 2] {
        let by = |vertex: Vertex| {
            lanes(|i| Probe { u: self.u[i], nearness: self.nearness[i] }.hidden(vertex, disparity))
        };
        let mut first = [f32::INFINITY; LANES];
        for vertex in run.first.as_slice() {
            first = ops.min(&by(*vertex), &first);
        }
        let mut last = [f32::NEG_INFINITY; LANES];
        for vertex in run.last.as_slice() {
            last = ops.max(&by(*vertex), &last);
        }
        [first, last]
    }
}

/// Adds to sixteen receivers.
#[inline(always)]
fn add(to: &mut [f32; ROOM], at: usize, what: &Lanes) {
    let old = at_lanes(to, at);
    to[at..at + LANES].copy_from_slice(&lanes(|i| old[i] + what[i]));
}

#[inline(always)]
fn at_lanes(of: &[f32; ROOM], at: usize) -> Lanes {
    *of[at..].first_chunk().expect("there is room behind the last receiver")
}
