//! The receivers that take part of their visibility from one row of the maps.

use alloc::vec::Vec;
use core::ops::Range;

use super::bounds::BAND;
use super::frame::{Facing, Frustum};
use super::lanes::{LANES, Lanes, Ops, greatest, lanes, least, max, min};
use super::receivers::{Pixels, Receivers, in_row};
use super::scan::{Probe, Run, Vertex};
use super::search::{MapSearch, Tilt};
use super::union::{Interval, union_length};

/// The most receivers in a group: a block of the camera's image.
const MOST: usize = LANES * BAND;

/// Receivers moved along their plane into the middle of a row, packed. The last is repeated until
/// its vector is full.
#[derive(Clone, Debug)]
pub(super) struct RowReceivers {
    pub count: usize,
    /// In the map from the middle of the light.
    column: [f32; MOST],
    nearness: [f32; MOST],
    /// How much of each receiver's visibility the row decides.
    weight: [f32; MOST],
    /// Which pixel of the block each is.
    pixel: [u8; MOST],
}

impl RowReceivers {
    pub const NONE: RowReceivers = RowReceivers {
        count: 0,
        column: [0.0; MOST],
        nearness: [0.0; MOST],
        weight: [0.0; MOST],
        pixel: [0; MOST],
    };

    /// The receivers of a group for which row `y` counts: those within one row of its middle.
    #[inline(always)]
    pub fn gather(
        &mut self,
        ops: impl Ops,
        receivers: &Receivers,
        group: Pixels,
        tilt: &Tilt,
        y: usize,
        last_row: f32,
    ) {
        let middle = y as f32;
        self.count = 0;
        for line in 0..BAND {
            let members = in_row(group, line);
            if members == 0 {
                continue;
            }
            let row = &receivers.row[line];
            let weight = lanes(|i| 1.0 - (max(0.0, min(row[i] - 0.5, last_row)) - middle).abs());
            let mut members = members & ops.greater(&weight, &[0.0; LANES]);
            let nearness = &receivers.nearness[line];
            let moved = lanes(|i| nearness[i] + tilt.per_row * (middle + 0.5 - row[i]));
            while members != 0 {
                let i = members.trailing_zeros() as usize;
                members &= members - 1;
                self.column[self.count] = receivers.column[line][i];
                self.nearness[self.count] = moved[i];
                self.weight[self.count] = weight[i];
                self.pixel[self.count] = (line * LANES + i) as u8;
                self.count += 1;
            }
        }
        if self.count > 0 {
            let last = self.count - 1;
            let full = self.count.next_multiple_of(LANES);
            let (column, nearness) = (self.column[last], self.nearness[last]);
            self.column[self.count..full].fill(column);
            self.nearness[self.count..full].fill(nearness);
        }
    }

    /// The leftmost and the rightmost receiver.
    #[inline(always)]
    pub fn outermost(&self, ops: impl Ops) -> [Probe; 2] {
        let (mut left, mut right) = (Probe::default(), Probe::default());
        for index in 0..self.count.div_ceil(LANES) {
            let (column, nearness) = (vector(&self.column, index), vector(&self.nearness, index));
            let (low, high) = (least(&column), greatest(&column));
            if index == 0 || low < left.u {
                let lane = (!ops.greater(&column, &[low; LANES])).trailing_zeros() as usize % LANES;
                left = Probe { u: low, nearness: nearness[lane] };
            }
            if index == 0 || high > right.u {
                let lane =
                    (!ops.greater(&[high; LANES], &column)).trailing_zeros() as usize % LANES;
                right = Probe { u: high, nearness: nearness[lane] };
            }
        }
        [left, right]
    }

    /// Takes what the runs of the row hide from the visibility of the receivers' pixels. The
    /// runs of map i are `runs[runs_of[i]]`.
    #[inline(always)]
    pub fn judge(
        &self,
        ops: impl Ops,
        frustum: &Frustum<'_>,
        facing: &Facing,
        maps: &[MapSearch],
        runs: &[Run],
        runs_of: &[Range<usize>],
        intervals: &mut Vec<Interval>,
        visibility: &mut [f32; MOST],
    ) {
        for index in 0..self.count.div_ceil(LANES) {
            let column = vector(&self.column, index);
            let nearness = vector(&self.nearness, index);
            intervals.clear();
            for (map, runs_of) in maps.iter().zip(runs_of) {
                let from = max(map.span[0], facing.horizon[0]);
                let to = min(map.span[1], facing.horizon[1]);
                let u = lanes(|i| column[i] + map.shift * nearness[i]);
                for run in &runs[runs_of.clone()] {
                    let [p, q] = run.first;
                    let (a, b) = (
                        hidden(p, &u, &nearness, frustum.disparity),
                        hidden(q, &u, &nearness, frustum.disparity),
                    );
                    let first = lanes(|i| max(map.t + min(a[i], b[i]), from));
                    let [p, q] = run.last;
                    let (a, b) = (
                        hidden(p, &u, &nearness, frustum.disparity),
                        hidden(q, &u, &nearness, frustum.disparity),
                    );
                    let last = lanes(|i| min(map.t + max(a[i], b[i]), to));
                    if ops.greater(&last, &first) != 0 {
                        intervals.push(Interval { from: first, to: last });
                    }
                }
            }
            let hidden = union_length(intervals, facing.horizon[0]);
            let start = index * LANES;
            let end = self.count.min(start + LANES);
            for (i, hidden) in (start..end).zip(hidden) {
                visibility[usize::from(self.pixel[i])] -= self.weight[i] * hidden;
            }
        }
    }
}

/// What a vertex hides from sixteen receivers.
#[inline(always)]
fn hidden(vertex: Vertex, u: &Lanes, nearness: &Lanes, disparity: f32) -> Lanes {
    lanes(|i| Probe { u: u[i], nearness: nearness[i] }.hidden(vertex, disparity))
}

#[inline(always)]
fn vector(of: &[f32; MOST], index: usize) -> Lanes {
    of.as_chunks().0[index]
}
