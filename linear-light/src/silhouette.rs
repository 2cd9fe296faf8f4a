//! Where between two texels a silhouette lies.
//!
//! Two texels that straddle a silhouette know it to lie between their centres, and no better: half
//! a texel of error either way, which shows as stripes in wide penumbrae. Two more witnesses are
//! at hand. The rows above and below see the same silhouette go on; and the destination's map sees
//! the same edge, rounded to texels of its own.

use crate::discontinuity::{Rows, Side};

/// The texels x - 1 to x + 2 of a row, NaN beyond its ends.
#[inline(always)]
fn around(row: &[f32], x: usize) -> [f32; 4] {
    let whole = x.checked_sub(1).and_then(|start| row.get(start..)?.first_chunk());
    let texel = |i: usize| row.get((x + i).wrapping_sub(1)).copied().unwrap_or(f32::NAN);
    whole.copied().unwrap_or_else(|| core::array::from_fn(texel))
}

/// Where a row crosses the nearness `level` the way a silhouette of that side does, relative to
/// the middle of its four texels: -1, 0 or 1. `None` if it does not.
#[inline(always)]
fn crossing([a, b, c, d]: [f32; 4], level: f32, side: Side) -> Option<f32> {
    let crosses = |left: f32, right: f32| match side {
        Side::Left => left > level && right <= level,
        Side::Right => left <= level && right > level,
    };
    if crosses(b, c) {
        Some(0.0)
    } else if crosses(a, b) {
        Some(-1.0)
    } else {
        crosses(c, d).then_some(1.0)
    }
}

/// How far from the middle of texels `b` and `c` the silhouette between them lies, in texels,
/// given the four texels around the same place of the two neighbouring rows: the mean of the
/// three rows' midpoints, where all three have it.
#[inline(always)]
pub(crate) fn mean_of_rows([b, c]: [f32; 2], neighbours: [[f32; 4]; 2], side: Side) -> f32 {
    let level = (b + c) * 0.5;
    match neighbours.map(|row| crossing(row, level, side)) {
        [Some(above), Some(below)] => (above + below) * (1.0 / 3.0),
        _ => 0.0,
    }
}

/// The column at which the silhouette between columns `x` and `x + 1` cuts the middle row.
#[inline(always)]
pub(crate) fn across_rows(rows: &Rows<'_>, x: usize, side: Side) -> f32 {
    let pair = [rows.middle[x], rows.middle[x + 1]];
    let neighbours = [around(rows.above, x), around(rows.below, x)];
    (x + 1) as f32 + mean_of_rows(pair, neighbours, side)
}

/// Of two rounded positions of one edge the better guess: each is off by half a texel at most, so
/// the truth lies around their mean. If they differ by more, they are not of one edge.
#[inline(always)]
pub(crate) fn of_both(here: f32, there: f32) -> f32 {
    let offset = there - here;
    if offset.abs() < 1.0 { here + 0.5 * offset } else { here }
}

/// The column of a blocker's edge in the destination's row `to`, which the source's map puts at
/// `column`. `disparity` is positive.
#[inline(always)]
pub(crate) fn in_both(to: &[f32], column: f32, blocker: f32, side: Side, disparity: f32) -> f32 {
    // Whether there is an edge between texels i and i + 1.
    let shows = |i: usize| {
        let texel = |i: usize| to.get(i).copied().unwrap_or(f32::NAN);
        let (near, far) = match side {
            Side::Left => (texel(i), texel(i.wrapping_add(1))),
            Side::Right => (texel(i.wrapping_add(1)), texel(i)),
        };
        (near - blocker).abs() * disparity < 1.0 && (blocker - far) * disparity > 1.0
    };
    let first = (column - 1.0) as usize;
    let second = first.saturating_add(1);
    if shows(first) {
        of_both(column, second as f32)
    } else if shows(second) {
        of_both(column, second as f32 + 1.0)
    } else {
        column
    }
}
