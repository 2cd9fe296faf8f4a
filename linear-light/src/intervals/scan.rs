//! One row of one map: the runs of texels in front of a plane, and what each of them hides.

use alloc::vec::Vec;
use core::ops::Range;

use shadowmap_core::DepthMap;

use super::border::Neighbour;
use super::bounds::BandSearch;
use super::contact::{Contact, Ground};
use super::frame::Frustum;
use super::run::{PAIRS, Probe, Run};
use super::search::MapSearch;
use crate::lanes::{INDEX, LANES, Ops, lanes, left_neighbours, max, min, texels};

/// How far, in texels, a surface reaches beyond the centre of its last texel before a depth
/// discontinuity. Anything from 0 to 1 is possible and 1/2 is right on average for an edge that one
/// map shows; of two maps the union takes the one that reaches farther, and 1/3 is right. Most
/// edges are shown by two.
pub(super) const REACH: f32 = 0.36;

/// Neighbouring texels belong to one surface if their nearness differs by at most this many times
/// the footprint of a texel: the surface is inclined to the image by less than 83 degrees.
pub(super) const STEEPEST: f32 = 8.0;

/// What to look for in a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowSearch {
    /// The two outermost receivers.
    pub probes: [Probe; 2],
    /// How many pairs of receivers runs are looked at from.
    pub pairs: usize,
    /// Texels of disparity per nearness over the whole light.
    pub disparity: f32,
    /// [`STEEPEST`] footprints, as a fraction of the nearness.
    pub steepest: f32,
    /// Those of the map, in the row.
    pub neighbours: [Neighbour; 2],
}

impl RowSearch {
    /// The probes, the outermost receivers of `blocks` blocks, are given in the map from the middle
    /// of the light.
    #[inline(always)]
    pub fn new(
        frustum: &Frustum<'_>,
        map: &MapSearch,
        [p, q]: &[Probe; 2],
        blocks: usize,
        neighbours: [Neighbour; 2],
    ) -> RowSearch {
        let probes = [
            Probe { u: p.u + map.shift * p.nearness, ..*p },
            Probe { u: q.u + map.shift * q.nearness, ..*q },
        ];
        let pairs = if blocks > 1 { PAIRS.len() } else { 1 };
        let (disparity, steepest) = (frustum.disparity, frustum.steepest());
        RowSearch { probes, pairs, disparity, steepest, neighbours }
    }
}

/// The texels of row `y`.
#[inline(always)]
pub(super) fn row_of<'a>(map: &DepthMap<'a>, y: usize) -> &'a [f32] {
    let width = map.width() as usize;
    &map.nearness()[y * width..(y + 1) * width]
}

/// Whether anything in columns `16 * number` to `16 * number + 15` of the given rows is in front of
/// the plane and close enough to the receivers to hide some of the light.
#[inline(always)]
pub(super) fn any_in_front(
    ops: impl Ops,
    map: &DepthMap<'_>,
    number: u32,
    mut rows: Range<usize>,
    search: &BandSearch,
) -> bool {
    let start = number as usize * LANES;
    let [a, b, c, d] = search.plane;
    let column = lanes(|i| start as f32 + (INDEX[i] + 0.5));
    let along = lanes(|i| a * column[i] + d);
    // One texel more than a texel reaches: two that are linked hide what lies between them.
    let [left, right] = [search.columns[0] - 1.0, search.columns[1] + 1.0];
    rows.any(|y| {
        let across = b * (y as f32 + 0.5);
        let w = texels(row_of(map, y), start);
        let above = lanes(|i| (along[i] + across) + c * w[i]);
        let nearer = lanes(|i| w[i] - search.nearness);
        let front = ops.greater(&above, &[search.bias; LANES])
            & ops.greater(&nearer, &[0.0; LANES])
            & ops.greater(&lanes(|i| column[i] + search.reach[0] * nearer[i]), &[left; LANES])
            & ops.greater(&[right; LANES], &lanes(|i| column[i] - search.reach[1] * nearer[i]));
        front != 0
    })
}

/// Appends the runs of row `y` of a map, which lie in the segments `found`; those ascend. Where
/// runs stand on the receivers' plane is appended to `contacts`.
#[inline(always)]
pub(super) fn scan(
    ops: impl Ops,
    map: &DepthMap<'_>,
    found: &[u32],
    y: usize,
    front: &MapSearch,
    search: &RowSearch,
    ranges: &mut Vec<Range<usize>>,
    runs: &mut Vec<Run>,
    contacts: &mut Vec<Contact>,
) {
    ranges.clear();
    let row = row_of(map, y);
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
                    ranges.push(run.clone());
                }
                run.start = start + first;
            }
            run.end = start + first + more + 1;
        }
    }
    if run.end > 0 {
        ranges.push(run);
    }
    let (plane, bias, steepest) = (front.plane, front.bias, search.steepest);
    let (shift, neighbours) = (front.shift, search.neighbours);
    let ground = Ground { map, y, plane, bias, behind, steepest, shift, neighbours };
    for columns in ranges {
        runs.push(Run::new(ops, &ground, columns.clone(), search, contacts));
    }
}
