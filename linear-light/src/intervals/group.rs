//! The visibility of a group of receivers that share a plane.

use alloc::vec::Vec;
use core::ops::Range;

use super::bounds::{BAND, Search};
use super::frame::{Facing, Frame, Frustum};
use super::lanes::{Greater, LANES, Lanes, greatest, lanes, least, max, min};
use super::scan::{Probe, REACH, RowSearch, Run, scan};
use super::union::{Interval, union_length};

/// The most receivers in a group: a block of the camera's image.
pub(super) const MOST: usize = LANES * BAND;

/// Receivers as the map from the middle of the light sees them, packed.
#[derive(Clone, Debug)]
pub(super) struct Receivers {
    pub count: usize,
    pub column: [f32; MOST],
    pub row: [f32; MOST],
    pub nearness: [f32; MOST],
    /// Where each receiver is in its block.
    pub pixel: [u8; MOST],
    /// The answer: the fraction of the light that each sees.
    pub visibility: [f32; MOST],
}

impl Receivers {
    const NONE: Receivers = Receivers {
        count: 0,
        column: [0.0; MOST],
        row: [0.0; MOST],
        nearness: [0.0; MOST],
        pixel: [0; MOST],
        visibility: [0.0; MOST],
    };

    pub fn push(&mut self, [column, row, nearness]: [f32; 3], pixel: usize) {
        self.column[self.count] = column;
        self.row[self.count] = row;
        self.nearness[self.count] = nearness;
        self.pixel[self.count] = pixel as u8;
        self.count += 1;
    }

    /// Repeats the last receiver until its vector is full, and says how many vectors there are.
    fn pad(&mut self) -> usize {
        let vectors = self.count.div_ceil(LANES);
        for i in self.count..vectors * LANES {
            self.column[i] = self.column[self.count - 1];
            self.row[i] = self.row[self.count - 1];
            self.nearness[i] = self.nearness[self.count - 1];
        }
        vectors
    }
}

#[inline(always)]
fn vector(of: &[f32; MOST], index: usize) -> Lanes {
    let start = index * LANES;
    lanes(|i| of[start + i])
}

/// Scratch memory of one band. It grows to what a band needs and is then kept.
#[derive(Clone, Debug)]
pub(super) struct Scratch {
    pub receivers: Receivers,
    /// Receivers that are to be judged one by one.
    pub waiting: Receivers,
    row: RowReceivers,
    segments: Vec<u32>,
    segments_of: Vec<Range<usize>>,
    runs: Vec<Run>,
    runs_of: Vec<Range<usize>>,
    intervals: Vec<Interval>,
}

impl Scratch {
    pub fn new() -> Scratch {
        Scratch {
            receivers: Receivers::NONE,
            waiting: Receivers::NONE,
            row: RowReceivers::NONE,
            segments: Vec::new(),
            segments_of: Vec::new(),
            runs: Vec::new(),
            runs_of: Vec::new(),
            intervals: Vec::new(),
        }
    }
}

/// The receivers that take part of their visibility from one row of the maps, moved along their
/// plane into the middle of that row.
#[derive(Clone, Debug)]
struct RowReceivers {
    count: usize,
    column: [f32; MOST],
    nearness: [f32; MOST],
    /// How much of each receiver's visibility the row decides.
    weight: [f32; MOST],
    /// Which of the receivers each is.
    index: [u8; MOST],
}

impl RowReceivers {
    const NONE: RowReceivers = RowReceivers {
        count: 0,
        column: [0.0; MOST],
        nearness: [0.0; MOST],
        weight: [0.0; MOST],
        index: [0; MOST],
    };
}

/// A plane as the maps see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tilt {
    /// A texel at column s, row t with nearness w is `a s + b t + c w + d` in front of the plane
    /// (times positive factors); a and b are the same for all maps.
    a: f32,
    b: f32,
    /// c for the two ends of the light, and linear in between.
    ends: [f32; 2],
    /// Change of the plane's nearness per row, as the middle of the light sees it.
    pub per_row: f32,
    /// Whether `per_row` had to be limited: then the receivers have to be judged one by one.
    pub steep: bool,
}

/// A plane is followed at most this many texel footprints towards the light within one row. One
/// seen more edge-on than that has no extent across the rows that a map could tell.
const STEEPEST: f32 = 8.0;

impl Tilt {
    pub fn new(facing: &Facing, frustum: &Frustum<'_>, nearness: f32) -> Tilt {
        let [a, b] = frustum.across.map(|direction| facing.plane.side_of(direction));
        let middle = 0.5 * (facing.ends[0] + facing.ends[1]);
        let limit = STEEPEST * frustum.footprint[1] * nearness;
        let slope = -b / middle;
        let per_row = if slope.is_nan() { 0.0 } else { max(-limit, min(limit, slope)) };
        Tilt { a, b, ends: facing.ends, per_row, steep: per_row != slope }
    }

    /// a, b, c and d for the map from parameter `t` of the light; the plane goes through a receiver.
    pub fn plane(&self, t: f32, [column, row, nearness]: [f32; 3]) -> [f32; 4] {
        let c = self.ends[0] + (self.ends[1] - self.ends[0]) * t;
        let d = -((self.a * column + self.b * row) + c * nearness);
        [self.a, self.b, c, d]
    }
}

/// Fills in the visibility of `scratch.receivers`, which lie on one plane and in the frustum.
/// Returns whether anything had to be looked for in the maps.
#[inline(always)]
pub(super) fn judge(
    greater: impl Greater,
    frame: &Frame<'_>,
    frustum: &Frustum<'_>,
    facing: &Facing,
    tilt: &Tilt,
    scratch: &mut Scratch,
) -> bool {
    let Scratch { receivers, row, segments, segments_of, runs, runs_of, intervals, .. } = scratch;
    let open = facing.open();
    receivers.visibility[..receivers.count].fill(open);
    let vectors = receivers.pad();
    let extent = Extent::of(receivers, vectors, tilt);
    let last_row = frustum.size[1] as f32 - 1.0;
    let rows = [extent.rows[0] - 0.5, extent.rows[1] - 0.5].map(|r| max(0.0, min(r, last_row)));
    let (first, last) = (rows[0] as usize, (rows[1] as usize + 1).min(last_row as usize));
    let mut searched = false;
    for band in first / BAND..=last / BAND {
        segments.clear();
        segments_of.clear();
        for sample in 0..frustum.samples.len() {
            let search = extent.search(frame, frustum, tilt, sample);
            let before = segments.len();
            frustum.bounds[sample].search(greater, band, &search, segments);
            segments_of.push(before..segments.len());
        }
        if segments.is_empty() {
            continue;
        }
        searched = true;
        for y in first.max(band * BAND)..=last.min(band * BAND + BAND - 1) {
            row.gather(greater, receivers, vectors, tilt, y, last_row);
            if row.count == 0 {
                continue;
            }
            runs.clear();
            runs_of.clear();
            let (left, right) = row.outermost();
            for (sample, segments_of) in segments_of.iter().enumerate() {
                let before = runs.len();
                let here = &segments[segments_of.clone()];
                if !here.is_empty() {
                    let search = extent.row_search(frame, frustum, tilt, sample, y, [left, right]);
                    let map = &frustum.samples[sample].map;
                    let width = map.width() as usize;
                    let texels = &map.nearness()[y * width..(y + 1) * width];
                    scan(greater, texels, here, &search, runs);
                }
                runs_of.push(before..runs.len());
            }
            if !runs.is_empty() {
                row.judge(greater, frustum, facing, runs, runs_of, intervals, receivers);
            }
        }
    }
    searched
}

impl RowReceivers {
    /// The receivers for which row `y` counts: those within one row of its middle.
    #[inline(always)]
    fn gather(
        &mut self,
        greater: impl Greater,
        receivers: &Receivers,
        vectors: usize,
        tilt: &Tilt,
        y: usize,
        last_row: f32,
    ) {
        let middle = y as f32;
        self.count = 0;
        for index in 0..vectors {
            let row = vector(&receivers.row, index);
            let weight = lanes(|i| 1.0 - (max(0.0, min(row[i] - 0.5, last_row)) - middle).abs());
            let mut mask = greater(&weight, &[0.0; LANES]);
            if index + 1 == vectors {
                mask &= u32::MAX >> (32 - (receivers.count - index * LANES));
            }
            let nearness = vector(&receivers.nearness, index);
            let moved = lanes(|i| nearness[i] + tilt.per_row * (middle + 0.5 - row[i]));
            while mask != 0 {
                let i = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                self.column[self.count] = receivers.column[index * LANES + i];
                self.nearness[self.count] = moved[i];
                self.weight[self.count] = weight[i];
                self.index[self.count] = (index * LANES + i) as u8;
                self.count += 1;
            }
        }
        for i in self.count..self.count.div_ceil(LANES) * LANES {
            self.column[i] = self.column[self.count - 1];
            self.nearness[i] = self.nearness[self.count - 1];
        }
    }

    /// The leftmost and the rightmost receiver.
    #[inline(always)]
    fn outermost(&self) -> (Probe, Probe) {
        let (mut left, mut right) = (0, 0);
        for i in 1..self.count {
            left = if self.column[i] < self.column[left] { i } else { left };
            right = if self.column[i] > self.column[right] { i } else { right };
        }
        let probe = |i: usize| Probe { u: self.column[i], nearness: self.nearness[i] };
        (probe(left), probe(right))
    }

    /// Takes what the runs of the row hide from the visibility of the receivers.
    #[inline(always)]
    fn judge(
        &self,
        greater: impl Greater,
        frustum: &Frustum<'_>,
        facing: &Facing,
        runs: &[Run],
        runs_of: &[Range<usize>],
        intervals: &mut Vec<Interval>,
        receivers: &mut Receivers,
    ) {
        for index in 0..self.count.div_ceil(LANES) {
            let column = vector(&self.column, index);
            let nearness = vector(&self.nearness, index);
            intervals.clear();
            for (sample, runs_of) in runs_of.iter().enumerate() {
                let t = frustum.samples[sample].t;
                let shift = frustum.disparity * (0.5 - t);
                let span = frustum.span(sample);
                let from = max(span[0], facing.horizon[0]);
                let to = min(span[1], facing.horizon[1]);
                let u = lanes(|i| column[i] + shift * nearness[i]);
                for run in &runs[runs_of.clone()] {
                    let hidden = |vertex, i: usize| {
                        Probe { u: u[i], nearness: nearness[i] }.hidden(vertex, frustum.disparity)
                    };
                    let interval = Interval {
                        from: lanes(|i| {
                            let least = min(hidden(run.first[0], i), hidden(run.first[1], i));
                            max(t + least, from)
                        }),
                        to: lanes(|i| {
                            let most = max(hidden(run.last[0], i), hidden(run.last[1], i));
                            min(t + most, to)
                        }),
                    };
                    if greater(&interval.to, &interval.from) != 0 {
                        intervals.push(interval);
                    }
                }
            }
            let hidden = union_length(intervals, facing.horizon[0]);
            let start = index * LANES;
            let end = self.count.min(start + LANES);
            for (i, hidden) in (start..end).zip(hidden) {
                receivers.visibility[self.index[i] as usize] -= self.weight[i] * hidden;
            }
        }
    }
}

/// The least and the greatest number in the first vectors of `of`.
#[inline(always)]
fn range(of: &[f32; MOST], vectors: usize) -> [f32; 2] {
    let (mut lo, mut hi) = (vector(of, 0), vector(of, 0));
    for index in 1..vectors {
        let v = vector(of, index);
        lo = lanes(|i| min(v[i], lo[i]));
        hi = lanes(|i| max(v[i], hi[i]));
    }
    [least(&lo), greatest(&hi)]
}

/// Where the receivers are.
struct Extent {
    columns: [f32; 2],
    rows: [f32; 2],
    nearness: [f32; 2],
    /// One of them, that the plane goes through.
    reference: [f32; 3],
}

impl Extent {
    #[inline(always)]
    fn of(receivers: &Receivers, vectors: usize, tilt: &Tilt) -> Extent {
        let nearness = range(&receivers.nearness, vectors);
        // Receivers move along their plane by up to a row.
        let moved = tilt.per_row.abs();
        Extent {
            columns: range(&receivers.column, vectors),
            rows: range(&receivers.row, vectors),
            nearness: [nearness[0] - moved, nearness[1] + moved],
            reference: [receivers.column[0], receivers.row[0], receivers.nearness[0]],
        }
    }

    /// The plane and the bias for the map of a sample.
    fn plane(
        &self,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        tilt: &Tilt,
        t: f32,
    ) -> ([f32; 4], f32) {
        let [column, row, nearness] = self.reference;
        let shift = frustum.disparity * (0.5 - t);
        let plane = tilt.plane(t, [column + shift * nearness, row, nearness]);
        let [a, b, c, _] = plane;
        let bias =
            frame.bias.constant * (nearness * c.abs()) + frame.bias.slope * (a.abs() + b.abs());
        (plane, bias)
    }

    #[inline(always)]
    fn search(
        &self,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        tilt: &Tilt,
        sample: usize,
    ) -> Search {
        let t = frustum.samples[sample].t;
        let (plane, bias) = self.plane(frame, frustum, tilt, t);
        let shift = frustum.disparity * (0.5 - t);
        let shifts = self.nearness.map(|nearness| shift * nearness);
        let span = frustum.span(sample);
        Search {
            plane,
            bias,
            columns: [
                self.columns[0] + min(shifts[0], shifts[1]) - REACH,
                self.columns[1] + max(shifts[0], shifts[1]) + REACH,
            ],
            nearness: self.nearness[0],
            reach: [(t - span[0]) * frustum.disparity, (span[1] - t) * frustum.disparity],
        }
    }

    #[inline(always)]
    fn row_search(
        &self,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        tilt: &Tilt,
        sample: usize,
        y: usize,
        probes: [Probe; 2],
    ) -> RowSearch {
        let t = frustum.samples[sample].t;
        let ([a, b, c, d], bias) = self.plane(frame, frustum, tilt, t);
        let shift = frustum.disparity * (0.5 - t);
        RowSearch {
            plane: [a, c, d + b * (y as f32 + 0.5)],
            bias,
            probes: probes.map(|p| Probe { u: p.u + shift * p.nearness, ..p }),
            disparity: frustum.disparity,
            steepest: frustum.steepest(),
        }
    }
}
