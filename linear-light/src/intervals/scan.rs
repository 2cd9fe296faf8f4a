//! One row of one map: the runs of texels in front of a plane, and what each of them hides.

use alloc::vec::Vec;
use core::ops::Range;

use shadowmap_core::DepthMap;

use super::bounds::BandSearch;
use super::frame::Frustum;
use super::lanes::{
    INDEX, LANES, Lanes, Ops, lanes, least_lane, left_neighbours, max, min, texels,
};
use super::rows::within;
use super::search::MapSearch;

/// How far, in texels, a surface reaches beyond the centre of its last texel before a depth
/// discontinuity. Anything from 0 to 1 is possible and 1/2 is right on average for one map; but of
/// the two maps of a segment the union takes the one that reaches farther, which on average is
/// 2/3. 1/3 makes the average right.
pub(super) const REACH: f32 = 1.0 / 3.0;

/// Neighbouring texels belong to one surface if their nearness differs by at most this many times
/// the footprint of a texel: the surface is inclined to the image by less than 83 degrees.
pub(super) const STEEPEST: f32 = 8.0;

/// Texels of disparity that stand for none: so few that a vertex hides no parameter of the light,
/// but products with them are far from subnormal numbers, which are slow.
const LEAST_DISPARITY: f32 = 1e-20;

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
        (vertex.column - self.u) / max(by, LEAST_DISPARITY)
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

/// Whether anything is in front of the plane in columns `16 * number` to `16 * number + 15` of the
/// given rows.
#[inline(always)]
pub(super) fn any_in_front(
    ops: impl Ops,
    map: &DepthMap<'_>,
    number: u32,
    mut rows: Range<usize>,
    search: &BandSearch,
) -> bool {
    let start = number as usize * LANES;
    let width = map.width() as usize;
    let [a, b, c, d] = search.plane;
    let along = lanes(|i| a * (start as f32 + (INDEX[i] + 0.5)) + d);
    rows.any(|y| {
        let across = b * (y as f32 + 0.5);
        let w = texels(&map.nearness()[y * width..(y + 1) * width], start);
        let above = lanes(|i| (along[i] + across) + c * w[i]);
        let front = ops.greater(&above, &[search.bias; LANES]);
        front & ops.greater(&w, &[search.nearness; LANES]) != 0
    })
}

/// Appends the runs of row `y` of a map, which lie in the segments `found`; those ascend.
#[inline(always)]
pub(super) fn scan(
    ops: impl Ops,
    map: &DepthMap<'_>,
    found: &[u32],
    y: usize,
    front: &MapSearch,
    search: &RowSearch,
    runs: &mut Vec<Run>,
) {
    let width = map.width() as usize;
    let row = &map.nearness()[y * width..(y + 1) * width];
    let [a, b, c, d] = front.plane;
    let across = b * (y as f32 + 0.5);
    let [p, q] = search.probes;
    let behind = max(min(p.nearness, q.nearness), 0.0);
    // The run that is being followed.
    let mut run = 0..0;
    for &number in found {
        let start = number as usize * LANES;
        let w = texels(row, start);
        let column = lanes(|i| start as f32 + (INDEX[i] + 0.5));
        let above = lanes(|i| ((a * column[i] + d) + across) + c * w[i]);
        let mut mask =
            ops.greater(&above, &[front.bias; LANES]) & ops.greater(&w, &[behind; LANES]);
        if mask == 0 {
            continue;
        }
        let left = left_neighbours(row, start);
        let step = lanes(|i| (w[i] - left[i]).abs());
        let steepest = lanes(|i| search.steepest * max(w[i], left[i]));
        let linked = ops.greater(&steepest, &step);
        while mask != 0 {
            let first = mask.trailing_zeros() as usize;
            // The texels that follow without a gap and without a step.
            let more = (!((mask & linked) >> (first + 1))).trailing_zeros() as usize;
            mask &= !(((2_u32 << more) - 1) << first);
            if !(first == 0 && run.end == start && linked & 1 != 0) {
                if run.end > 0 {
                    runs.push(Run::new(ops, row, run.clone(), search));
                }
                run.start = start + first;
            }
            run.end = start + first + more + 1;
        }
    }
    if run.end > 0 {
        runs.push(Run::new(ops, row, run, search));
    }
}

/// The vertices of a run that hide the least and the most from a receiver, and how much.
struct Extremes {
    first: Vertex,
    least: f32,
    last: Vertex,
    most: f32,
}

impl Run {
    /// What the texels `run` of a row hide.
    #[inline(always)]
    fn new(ops: impl Ops, row: &[f32], run: Range<usize>, search: &RowSearch) -> Run {
        let [p, q] = &search.probes;
        let (mut by_p, mut by_q) =
            (Extremes::new(row, &run, p, search), Extremes::new(row, &run, q, search));
        for start in run.clone().step_by(LANES) {
            let w = texels(row, start);
            let column = lanes(|i| start as f32 + (INDEX[i] + 0.5));
            let inside = within(run.end - start);
            by_p.take_in(ops, p, &column, &w, inside, search.disparity);
            by_q.take_in(ops, q, &column, &w, inside, search.disparity);
        }
        Run { first: [by_p.first, by_q.first], last: [by_p.last, by_q.last] }
    }
}

impl Extremes {
    /// Of the ends of a run: most runs hide the most and the least by them.
    #[inline(always)]
    fn new(row: &[f32], run: &Range<usize>, probe: &Probe, search: &RowSearch) -> Extremes {
        let left = Vertex { column: run.start as f32 + (0.5 - REACH), nearness: row[run.start] };
        let right = Vertex { column: run.end as f32 + (REACH - 0.5), nearness: row[run.end - 1] };
        let by_left = probe.hidden(left, search.disparity);
        let by_right = probe.hidden(right, search.disparity);
        if by_right > by_left {
            Extremes { first: left, least: by_left, last: right, most: by_right }
        } else {
            Extremes { first: right, least: by_right, last: left, most: by_left }
        }
    }

    /// Takes in those of sixteen texels that lie `inside` the run.
    #[inline(always)]
    fn take_in(
        &mut self,
        ops: impl Ops,
        probe: &Probe,
        column: &Lanes,
        w: &Lanes,
        inside: u32,
        disparity: f32,
    ) {
        // Without a division, whether there is one at all.
        let away = lanes(|i| column[i] - probe.u);
        let by = lanes(|i| max(disparity * (w[i] - probe.nearness), LEAST_DISPARITY));
        let less = ops.greater(&lanes(|i| self.least * by[i]), &away) & inside;
        let more = ops.greater(&away, &lanes(|i| self.most * by[i])) & inside;
        if less | more == 0 {
            return;
        }
        let hidden = lanes(|i| away[i] / by[i]);
        if less != 0 {
            let keys = ops.select(less, &hidden, &[f32::INFINITY; LANES]);
            let (least, lane) = least_lane(ops, &keys);
            if least < self.least {
                self.least = least;
                self.first = Vertex { column: column[lane], nearness: w[lane] };
            }
        }
        if more != 0 {
            let keys = ops.select(more, &lanes(|i| -hidden[i]), &[f32::INFINITY; LANES]);
            let (most, lane) = least_lane(ops, &keys);
            if -most > self.most {
                self.most = -most;
                self.last = Vertex { column: column[lane], nearness: w[lane] };
            }
        }
    }
}
