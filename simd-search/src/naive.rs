//! The search as one would write it first: the specification, and what speed is measured against.

use core::ops::Range;

use crate::{Hit, Map, Query};

/// The answer to `query`, by asking every texel of the box around the receiver.
///
/// [`crate::nearest`] and [`crate::Pyramid`] give the same answer, to the last bit, sooner.
#[must_use]
pub fn nearest<'a>(map: impl Into<Map<'a>>, query: &Query) -> Option<Hit> {
    let map = map.into();
    let mut best: Option<Hit> = None;
    let radius = query.radius + query.jitter_amplitude();
    for y in reach(query.point.v, radius, map.height()) {
        for x in reach(query.point.u, radius, map.width()) {
            if let Some(hit) = query.candidate(&map, x, y)
                && best.is_none_or(|best| hit.precedes(&best))
            {
                best = Some(hit);
            }
        }
    }
    best
}

/// The columns (or rows) of a map with `size` of them that can hold a texel within `radius` of
/// `center`: no fewer, hardly more. Empty if either is NaN.
#[inline(always)]
pub(crate) fn reach(center: f32, radius: f32, size: u32) -> Range<u32> {
    // Room for rounding, however large the numbers.
    let radius = radius + (center.abs() + radius) * (1.0 / 1048576.0);
    // Texel x lies at x + 0.5. These casts saturate, and round down what is positive.
    let (first, last) = (center - radius - 0.5, center + radius - 0.5);
    if first.is_nan() || last.is_nan() || last < 0.0 {
        return 0..0;
    }
    (first as u32).min(size)..(last as u32).saturating_add(1).min(size)
}
