//! Where between two texels a silhouette lies.
//!
//! Two texels that straddle a silhouette know it to lie between their centres, and no better: half
//! a texel of error either way, which shows as stripes in wide penumbrae. Two more witnesses are
//! at hand. The rows above and below see the same silhouette go on; and the destination's map sees
//! the same edge, rounded to texels of its own.

use crate::discontinuity::{Rows, Side};

/// The column at which the silhouette between columns `x` and `x + 1` cuts the middle row: the
/// mean of the three rows' midpoints, where all three have it.
#[inline(always)]
pub(crate) fn across_rows(rows: &Rows<'_>, x: usize, side: Side) -> f32 {
    let (b, c) = (rows.middle[x], rows.middle[x + 1]);
    let level = (b + c) * 0.5;
    // How many columns the silhouette moves by from this row to another.
    let step = |row: &[f32]| {
        let crosses = |x: usize| match (row.get(x), row.get(x.wrapping_add(1))) {
            (Some(&b), Some(&c)) => match side {
                Side::Left => b > level && c <= level,
                Side::Right => b <= level && c > level,
            },
            _ => false,
        };
        if crosses(x) {
            Some(0.0)
        } else if crosses(x.wrapping_sub(1)) {
            Some(-1.0)
        } else {
            crosses(x + 1).then_some(1.0)
        }
    };
    let shift = match (step(rows.above), step(rows.below)) {
        (Some(above), Some(below)) => (above + below) * (1.0 / 3.0),
        _ => 0.0,
    };
    (x + 1) as f32 + shift
}

/// The column of a blocker's edge in the destination's row `to`, which the source's map puts at
/// `column`. Where the destination shows the edge, within a texel, the truth lies within half a
/// texel of both, and so around their mean. `disparity` is positive.
#[inline(always)]
pub(crate) fn in_both(to: &[f32], column: f32, blocker: f32, side: Side, disparity: f32) -> f32 {
    // The texels left and right of an edge at column i + 1.
    let shows = |i: usize| {
        let [left, right] =
            [to.get(i), to.get(i.wrapping_add(1))].map(|n| n.copied().unwrap_or(f32::NAN));
        let (near, far) = match side {
            Side::Left => (left, right),
            Side::Right => (right, left),
        };
        (near - blocker).abs() * disparity < 1.0 && (blocker - far) * disparity > 1.0
    };
    let first = (column - 1.0) as usize;
    let seen = if shows(first) {
        first
    } else if shows(first.saturating_add(1)) {
        first.saturating_add(1)
    } else {
        return column;
    };
    let offset = (seen as f32 + 1.0) - column;
    if offset.abs() < 1.0 { column + 0.5 * offset } else { column }
}
