//! The receivers that take part of their visibility from one row of the maps.

use alloc::vec::Vec;
use core::ops::Range;

use super::bounds::BAND;
use super::frame::{Facing, Frustum};
use super::lanes::{LANES, Lanes, Ops, lanes, max, min};
use super::receivers::{Pixels, Receivers, in_row};
use super::scan::{Probe, Run, Vertex};
use super::search::{MapSearch, Tilt};
use super::union::{Interval, union_length};

/// The most receivers in a group: a block of the camera's image.
const MOST: usize = LANES * BAND;

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
    /// What is hidden from each.
    hidden: [f32; ROOM],
    /// How many rows below the first the upper row of each pixel of the block is.
    rank: [u32; MOST],
    /// Which pixel of the block each is.
    pixel: [u8; MOST],
    /// The first row.
    first: usize,
    /// How many receivers have the upper of their rows before `first + k`, for each k.
    before: Vec<u8>,
}

impl RowReceivers {
    pub const NONE: RowReceivers = RowReceivers {
        column: [0.0; ROOM],
        row: [0.0; ROOM],
        nearness: [0.0; ROOM],
        hidden: [0.0; ROOM],
        rank: [0; MOST],
        pixel: [0; MOST],
        first: 0,
        before: Vec::new(),
    };

    /// Takes in the receivers of a group between rows `first` and `last`.
    #[inline(always)]
    pub fn sort(
        &mut self,
        receivers: &Receivers,
        group: Pixels,
        [first, last]: [usize; 2],
        last_row: f32,
    ) {
        self.first = first;
        // While receivers are put in their places, element k + 1 is the place of the next one
        // whose upper row is `first + k`.
        self.before.clear();
        self.before.resize(last - first + 3, 0);
        for_each_pixel(group, |pixel| {
            let row = receivers.row[pixel / LANES][pixel % LANES];
            // Rows that are numbers lie between the first and the last.
            let upper = (center(row, last_row) as usize).max(first).min(last);
            self.rank[pixel] = (upper - first) as u32;
            self.before[upper - first + 2] += 1;
        });
        let mut sum = 0;
        for before in &mut self.before {
            sum += *before;
            *before = sum;
        }
        for_each_pixel(group, |pixel| {
            let next = &mut self.before[self.rank[pixel] as usize + 1];
            let place = usize::from(*next) % MOST;
            *next += 1;
            let (line, lane) = (pixel / LANES, pixel % LANES);
            self.column[place] = receivers.column[line][lane];
            self.row[place] = receivers.row[line][lane];
            self.nearness[place] = receivers.nearness[line][lane];
            self.pixel[place] = pixel as u8;
        });
        self.hidden = [0.0; ROOM];
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
        intervals: &mut Vec<Interval>,
    ) {
        let last_row = frustum.size[1] as f32 - 1.0;
        for at in of.clone().step_by(LANES) {
            let [column, row, nearness] = self.moved(at, tilt, y);
            let rest = within(of.end - at);
            intervals.clear();
            for (map, runs_of) in maps.iter().zip(runs_of) {
                let from = max(map.span[0], facing.horizon[0]);
                let to = min(map.span[1], facing.horizon[1]);
                let u = lanes(|i| column[i] + map.shift * nearness[i]);
                for run in &runs[runs_of.clone()] {
                    let [p, q] = run.first;
                    let mut first = hidden(p, &u, &nearness, frustum.disparity);
                    if p != q {
                        let other = hidden(q, &u, &nearness, frustum.disparity);
                        first = ops.min(&first, &other);
                    }
                    let [p, q] = run.last;
                    let mut last = hidden(p, &u, &nearness, frustum.disparity);
                    if p != q {
                        let other = hidden(q, &u, &nearness, frustum.disparity);
                        last = ops.max(&last, &other);
                    }
                    let first = lanes(|i| max(map.t + first[i], from));
                    let last = lanes(|i| min(map.t + last[i], to));
                    if ops.greater(&last, &first) & rest != 0 {
                        intervals.push(Interval { from: first, to: last });
                    }
                }
            }
            if intervals.is_empty() {
                continue;
            }
            let hidden = union_length(ops, intervals, facing.horizon[0]);
            let middle = y as f32;
            let weight = lanes(|i| max(1.0 - (center(row[i], last_row) - middle).abs(), 0.0));
            let mut sum = at_lanes(&self.hidden, at);
            for i in 0..LANES {
                sum[i] += weight[i] * hidden[i];
            }
            self.hidden[at..at + LANES].copy_from_slice(&sum);
        }
    }

    /// Takes what is hidden from the visibility of the receivers' pixels.
    #[inline(always)]
    pub fn take_from(&self, visibility: &mut [f32; MOST]) {
        let count = usize::from(self.before.last().copied().unwrap_or(0));
        for (pixel, hidden) in self.pixel.iter().zip(&self.hidden).take(count) {
            visibility[usize::from(*pixel) % MOST] -= hidden;
        }
    }
}

/// Where a receiver lies between the middles of rows, counted from that of the first.
#[inline(always)]
fn center(row: f32, last_row: f32) -> f32 {
    max(0.0, min(row - 0.5, last_row))
}

#[inline(always)]
fn for_each_pixel(pixels: Pixels, mut f: impl FnMut(usize)) {
    for line in 0..BAND {
        let mut left = in_row(pixels, line);
        while left != 0 {
            f(line * LANES + left.trailing_zeros() as usize % LANES);
            left &= left - 1;
        }
    }
}

/// What a vertex hides from sixteen receivers.
#[inline(always)]
fn hidden(vertex: Vertex, u: &Lanes, nearness: &Lanes, disparity: f32) -> Lanes {
    lanes(|i| Probe { u: u[i], nearness: nearness[i] }.hidden(vertex, disparity))
}

/// A bit for each of the first `count` lanes.
#[inline(always)]
pub(super) fn within(count: usize) -> u32 {
    (1 << count.min(LANES)) - 1
}

#[inline(always)]
fn at_lanes(of: &[f32; ROOM], at: usize) -> Lanes {
    *of[at..].first_chunk().expect("there is room behind the last receiver")
}
