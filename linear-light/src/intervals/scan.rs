//! One row of one map: the runs of texels in front of a plane, and what each of them hides.

use alloc::vec::Vec;

use shadowmap_core::DepthMap;

use super::bounds::{BAND, BandSearch};
use super::frame::Frustum;
use super::lanes::{
    INDEX, LANES, Lanes, Ops, lanes, least_lane, left_neighbours, max, min, texels,
};
use super::search::MapSearch;

/// How far, in texels, a surface reaches beyond the centre of its last texel before a depth
/// discontinuity. Anything from 0 to 1 is possible and 1/2 is right on average for one map; but of
/// the two maps of a segment the union takes the one that reaches farther, which on average is
/// 2/3. 1/3 makes the average right.
pub(super) const REACH: f32 = 1.0 / 3.0;

/// Neighbouring texels belong to one surface if their nearness differs by at most this many times
/// the footprint of a texel: the surface is inclined to the image by less than 83 degrees.
pub(super) const STEEPEST: f32 = 8.0;

/// A receiver as one map sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Probe {
    /// Column.
    pub u: f32,
    /// Nearness.
    pub nearness: f32,
}

impl Probe {
    /// The parameter of the light that `vertex` hides from the receiver, from the map's own one on:
    /// the receiver and the blocker fall on the same column seen from there.
    #[inline(always)]
    pub fn hidden(&self, vertex: Vertex, disparity: f32) -> f32 {
        let by = disparity * (vertex.nearness - self.nearness);
        (vertex.column - self.u) / max(by, f32::MIN_POSITIVE)
    }
}

/// A point of a blocker in a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vertex {
    pub column: f32,
    pub nearness: f32,
}

/// A connected piece of blocker in a row. From a receiver between the two probes it hides the
/// parameters from the least that a vertex of `first` hides to the greatest of `last`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Run {
    pub first: [Vertex; 2],
    pub last: [Vertex; 2],
}

/// What to look for in a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowSearch {
    /// The two outermost receivers.
    pub probes: [Probe; 2],
    /// Texels of disparity per nearness over the whole light.
    pub disparity: f32,
    /// [`STEEPEST`] footprints, as a fraction of the nearness.
    pub steepest: f32,
}

impl RowSearch {
    /// The probes are given in the map from the middle of the light.
    #[inline(always)]
    pub fn new(frustum: &Frustum<'_>, map: &MapSearch, [p, q]: &[Probe; 2]) -> RowSearch {
        let probes = [
            Probe { u: p.u + map.shift * p.nearness, ..*p },
            Probe { u: q.u + map.shift * q.nearness, ..*q },
        ];
        RowSearch { probes, disparity: frustum.disparity, steepest: frustum.steepest() }
    }
}

/// Sixteen columns of a band of a map, and which of their texels lie in front of a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    start: usize,
    /// One bit per texel, row after row.
    pub front: [u16; BAND],
}

impl Segment {
    pub fn any(&self) -> bool {
        self.front != [0; BAND]
    }
}

/// What is in front of the plane in columns `16 * number` to `16 * number + 15` of the given rows
/// (the first and the last, counted within the band).
#[inline(always)]
pub(super) fn fronts(
    ops: impl Ops,
    map: &DepthMap<'_>,
    number: u32,
    band: usize,
    rows: [usize; 2],
    search: &BandSearch,
) -> Segment {
    let start = number as usize * LANES;
    let width = map.width() as usize;
    let [a, b, c, d] = search.plane;
    let along = lanes(|i| a * (start as f32 + (INDEX[i] + 0.5)) + d);
    let mut front = [0; BAND];
    for (y, front) in front.iter_mut().enumerate().take(rows[1] + 1).skip(rows[0]) {
        let y = band * BAND + y;
        let across = b * (y as f32 + 0.5);
        let w = texels(&map.nearness()[y * width..(y + 1) * width], start);
        let above = lanes(|i| (along[i] + across) + c * w[i]);
        *front = (ops.greater(&above, &[search.bias; LANES])
            & ops.greater(&w, &[search.nearness; LANES])) as u16;
    }
    Segment { start, front }
}

/// The texels of one run that hide the least and the most so far, lane by lane. `most` is held
/// negated.
#[derive(Clone, Copy)]
struct Extremes {
    least: Lanes,
    least_column: Lanes,
    most: Lanes,
    most_column: Lanes,
}

/// The run that is being followed: none if `end` is 0.
struct Following {
    start: usize,
    end: usize,
    extremes: [Extremes; 2],
}

/// Appends the runs of a row, the `in_band`-th of its band; `segments` ascend.
#[inline(always)]
pub(super) fn scan(
    ops: impl Ops,
    row: &[f32],
    segments: &[Segment],
    in_band: usize,
    search: &RowSearch,
    runs: &mut Vec<Run>,
) {
    let [p, q] = search.probes;
    let behind = [min(p.nearness, q.nearness); LANES];
    let nothing = Extremes {
        least: [f32::INFINITY; LANES],
        least_column: [0.0; LANES],
        most: [f32::INFINITY; LANES],
        most_column: [0.0; LANES],
    };
    let mut run = Following { start: 0, end: 0, extremes: [nothing; 2] };
    for segment in segments {
        let mut mask = u32::from(segment.front[in_band]);
        if mask == 0 {
            continue;
        }
        let start = segment.start;
        let w = texels(row, start);
        mask &= ops.greater(&w, &behind);
        if mask == 0 {
            continue;
        }
        let column = lanes(|i| start as f32 + (INDEX[i] + 0.5));
        let left = left_neighbours(row, start);
        let step = lanes(|i| (w[i] - left[i]).abs());
        let steepest = lanes(|i| search.steepest * max(w[i], left[i]));
        let linked = ops.greater(&steepest, &step);
        let hidden = [hidden(&p, &column, &w, search), hidden(&q, &column, &w, search)];
        while mask != 0 {
            let first = mask.trailing_zeros() as usize;
            // The texels that follow without a gap and without a step.
            let more = (!((mask & linked) >> (first + 1))).trailing_zeros() as usize;
            mask &= !(((2_u32 << more) - 1) << first);
            if !(first == 0 && run.end == start && linked & 1 != 0) {
                if run.end > 0 {
                    runs.push(run.close(ops, row, search));
                }
                run.start = start + first;
                for extremes in &mut run.extremes {
                    extremes.least = nothing.least;
                    extremes.most = nothing.most;
                }
            }
            run.end = start + first + more + 1;
            let within = [(start + first) as f32, run.end as f32];
            run.extremes[0].add(&hidden[0], &column, within);
            run.extremes[1].add(&hidden[1], &column, within);
        }
    }
    if run.end > 0 {
        runs.push(run.close(ops, row, search));
    }
}

/// What sixteen texels hide from a receiver.
#[inline(always)]
fn hidden(probe: &Probe, column: &Lanes, w: &Lanes, search: &RowSearch) -> Lanes {
    lanes(|i| probe.hidden(Vertex { column: column[i], nearness: w[i] }, search.disparity))
}

impl Extremes {
    /// Takes in the texels whose centres lie between two columns.
    #[inline(always)]
    fn add(&mut self, hidden: &Lanes, column: &Lanes, [from, to]: [f32; 2]) {
        for i in 0..LANES {
            let inside = column[i] > from && column[i] < to;
            let less = inside && hidden[i] < self.least[i];
            self.least[i] = if less { hidden[i] } else { self.least[i] };
            self.least_column[i] = if less { column[i] } else { self.least_column[i] };
            let more = inside && -hidden[i] < self.most[i];
            self.most[i] = if more { -hidden[i] } else { self.most[i] };
            self.most_column[i] = if more { column[i] } else { self.most_column[i] };
        }
    }
}

impl Following {
    /// The run, its ends included.
    #[inline(always)]
    fn close(&self, ops: impl Ops, row: &[f32], search: &RowSearch) -> Run {
        let left = Vertex { column: self.start as f32 + (0.5 - REACH), nearness: row[self.start] };
        let right = Vertex { column: self.end as f32 + (REACH - 0.5), nearness: row[self.end - 1] };
        let mut run = Run::default();
        for side in 0..2 {
            let (extremes, probe) = (&self.extremes[side], &search.probes[side]);
            let by_left = probe.hidden(left, search.disparity);
            let by_right = probe.hidden(right, search.disparity);
            let (least, mut first) =
                if by_right < by_left { (by_right, right) } else { (by_left, left) };
            let (most, mut last) =
                if by_right > by_left { (by_right, right) } else { (by_left, left) };
            let (inner, lane) = least_lane(ops, &extremes.least);
            if inner < least {
                first = at(row, extremes.least_column[lane]);
            }
            let (inner, lane) = least_lane(ops, &extremes.most);
            if -inner > most {
                last = at(row, extremes.most_column[lane]);
            }
            run.first[side] = first;
            run.last[side] = last;
        }
        run
    }
}

/// The surface at a texel's centre.
#[inline(always)]
fn at(row: &[f32], column: f32) -> Vertex {
    Vertex { column, nearness: row[column as usize] }
}
