//! One row of one map: the runs of texels in front of a plane, and what each of them hides.

use alloc::vec::Vec;

use super::lanes::{Greater, INDEX, LANES, Lanes, lanes, least_by, left_neighbours, max, texels};

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
    /// A texel at column s with nearness w is in front of the receivers' plane if
    /// `(a s + d) + c w` exceeds `bias`.
    pub plane: [f32; 3],
    pub bias: f32,
    /// The two outermost receivers.
    pub probes: [Probe; 2],
    /// Texels of disparity per nearness over the whole light.
    pub disparity: f32,
    /// [`STEEPEST`] footprints, as a fraction of the nearness.
    pub steepest: f32,
}

/// The vertices of one run that hide the least and the most so far.
struct Extremes {
    least: Lanes,
    least_column: Lanes,
    most: Lanes,
    most_column: Lanes,
}

const NONE: Extremes = Extremes {
    least: [f32::INFINITY; LANES],
    least_column: [0.0; LANES],
    most: [f32::INFINITY; LANES],
    most_column: [0.0; LANES],
};

struct Open {
    start: usize,
    end: usize,
    extremes: [Extremes; 2],
}

/// Appends the runs of the given segments (16 columns from 16 times each number, ascending).
#[inline(always)]
pub(super) fn scan(
    greater: impl Greater,
    row: &[f32],
    segments: &[u32],
    search: &RowSearch,
    runs: &mut Vec<Run>,
) {
    let [a, c, d] = search.plane;
    let [p, q] = search.probes;
    let behind = [super::lanes::min(p.nearness, q.nearness); LANES];
    let mut open: Option<Open> = None;
    for &segment in segments {
        let start = segment as usize * LANES;
        let w = texels(row, start);
        let column = lanes(|i| start as f32 + (INDEX[i] + 0.5));
        let front = lanes(|i| (a * column[i] + d) + c * w[i]);
        let mut mask = greater(&front, &[search.bias; LANES]) & greater(&w, &behind);
        if mask == 0 {
            continue;
        }
        let left = left_neighbours(row, start);
        let step = lanes(|i| (w[i] - left[i]).abs());
        let steepest = lanes(|i| search.steepest * max(w[i], left[i]));
        let linked = greater(&steepest, &step);
        let hidden = search.probes.map(|probe| {
            lanes(|i| probe.hidden(Vertex { column: column[i], nearness: w[i] }, search.disparity))
        });
        while mask != 0 {
            let first = mask.trailing_zeros() as usize;
            // The texels that follow without a gap and without a step.
            let more = (!((mask & linked) >> (first + 1))).trailing_zeros() as usize;
            let end = start + first + more + 1;
            mask &= !(((2_u32 << more) - 1) << first);
            let continues = open
                .as_ref()
                .is_some_and(|open| first == 0 && open.end == start && linked & 1 != 0);
            if !continues && let Some(done) = open.take() {
                runs.push(done.close(row, search));
            }
            let run =
                open.get_or_insert_with(|| Open { start: start + first, end, extremes: [NONE; 2] });
            run.end = end;
            let within = [(start + first) as f32, end as f32];
            for (extremes, hidden) in run.extremes.iter_mut().zip(&hidden) {
                extremes.add(hidden, &column, within);
            }
        }
    }
    if let Some(done) = open {
        runs.push(done.close(row, search));
    }
}

impl Extremes {
    /// Takes in the texels whose centres lie within two columns. `most` is held negated.
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

impl Open {
    /// The run, its ends included.
    #[inline(always)]
    fn close(&self, row: &[f32], search: &RowSearch) -> Run {
        let at = |column: f32| row[(column as usize).min(row.len() - 1)];
        let left = Vertex {
            column: self.start as f32 + (0.5 - REACH),
            nearness: row[self.start.min(row.len() - 1)],
        };
        let right = Vertex {
            column: self.end as f32 + (REACH - 0.5),
            nearness: row[(self.end - 1).min(row.len() - 1)],
        };
        let mut run = Run::default();
        for (side, (extremes, probe)) in self.extremes.iter().zip(&search.probes).enumerate() {
            let ends = [left, right].map(|end| (probe.hidden(end, search.disparity), end));
            let inside = |(key, column): (f32, f32), sign: f32| {
                (key * sign, Vertex { column, nearness: at(column) })
            };
            let (mut least, mut most) = (ends[0], ends[0]);
            let others = [
                ends[1],
                inside(least_by(&extremes.least, &extremes.least_column), 1.0),
                inside(least_by(&extremes.most, &extremes.most_column), -1.0),
            ];
            for other in others {
                least = if other.0 < least.0 { other } else { least };
                most = if other.0 > most.0 { other } else { most };
            }
            run.first[side] = least.1;
            run.last[side] = most.1;
        }
        run
    }
}
