//! Connected pieces of blockers in a row of a map, and what each of them hides.

use alloc::vec::Vec;
use core::ops::Range;

use super::contact::{Contact, Ground};
use super::scan::{RowSearch, row_of};
use crate::lanes::{INDEX, LANES, Lanes, Ops, lanes, least_lane, max, texels, within};

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

/// A connected piece of blocker in a row. From a receiver between two others it hides the
/// parameters from the least that a vertex of `first` hides to the greatest of `last`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Run {
    pub first: Vertices,
    pub last: Vertices,
}

/// A few vertices, at least one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertices {
    all: [Vertex; MOST],
    count: usize,
}

/// Pairs of receivers that a run is seen from, as parts of the way from one outermost receiver to
/// the other. The second, for groups of several blocks, is asked if the first see different
/// vertices: what receivers next to these four see of a round blocker is well told by theirs.
pub(super) const PAIRS: [[f32; 2]; 2] = [[0.0, 1.0], [1.0 / 3.0, 2.0 / 3.0]];

/// Vertices of one run.
const MOST: usize = 2 * PAIRS.len();

impl Vertices {
    #[inline(always)]
    pub fn as_slice(&self) -> &[Vertex] {
        &self.all[..self.count.min(MOST)]
    }

    #[inline(always)]
    fn add(&mut self, vertex: Vertex) {
        if !self.as_slice().contains(&vertex) && self.count < MOST {
            self.all[self.count] = vertex;
            self.count += 1;
        }
    }
}

impl Run {
    /// What the texels in some columns of a row hide; if they stand on the receivers' plane, that
    /// is added to `contacts`.
    #[inline(always)]
    pub fn new(
        ops: impl Ops,
        ground: &Ground<'_>,
        columns: Range<usize>,
        search: &RowSearch,
        contacts: &mut Vec<Contact>,
    ) -> Run {
        let row = row_of(ground.map, ground.y);
        let [p, q] = search.probes;
        let (start, last) = (columns.start, columns.end - 1);
        let ends = [
            ground.end(row, start, (start + 1).min(last), -1.0),
            ground.end(row, last, last.saturating_sub(1).max(start), 1.0),
        ];
        contacts.extend(ends.iter().filter_map(|end| end.contact));
        let ends = ends.map(|end| end.vertex);
        let mut run = Run::default();
        for parts in &PAIRS[..search.pairs] {
            let [p, q] = parts.map(|part| Probe {
                u: p.u + (q.u - p.u) * part,
                nearness: p.nearness + (q.nearness - p.nearness) * part,
            });
            let mut by_p = Extremes::of_ends(ends, &p, search.disparity);
            let mut by_q = Extremes::of_ends(ends, &q, search.disparity);
            for start in columns.clone().step_by(LANES) {
                let w = texels(row, start);
                let column = lanes(|i| start as f32 + (INDEX[i] + 0.5));
                let inside = within(columns.end - start);
                by_p.take_in(ops, &p, &column, &w, inside, search.disparity);
                by_q.take_in(ops, &q, &column, &w, inside, search.disparity);
            }
            run.first.add(by_p.first);
            run.first.add(by_q.first);
            run.last.add(by_p.last);
            run.last.add(by_q.last);
            if run.first.count + run.last.count == 2 {
                // All that is between the two sees the same vertices.
                break;
            }
        }
        run
    }
}

/// The vertices of a run that hide the least and the most from a receiver, and how much.
struct Extremes {
    first: Vertex,
    least: f32,
    last: Vertex,
    most: f32,
}

impl Extremes {
    /// Most runs hide the most and the least by their ends.
    #[inline(always)]
    fn of_ends([left, right]: [Vertex; 2], probe: &Probe, disparity: f32) -> Extremes {
        let (by_left, by_right) = (probe.hidden(left, disparity), probe.hidden(right, disparity));
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
