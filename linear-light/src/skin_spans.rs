//! Skins between rectified maps: spans along a row (section 3.2).
//!
//! A skin hangs from a blocker's edge along the source sample's ray, so its column e in the
//! source's row is the same at every nearness. In the destination's, whose sample is one step
//! further, it is `e - disparity * n`: a span of texels from the blocker to the receiver. Of two
//! skins over one texel the one with the greater e is nearer, so drawing the edges of a row in
//! order leaves the nearest on top, and no depth buffer of skins is needed.

use core::ops::Range;

use shadowmap_core::Level;

use crate::discontinuity::{BLOCK, Discontinuity, Rows, Side, steps};
use crate::kernels::{Job, run};
use crate::lanes::Ops;
use crate::silhouette::{across_rows, in_both};
use crate::skins::Transition;

/// One row of one directed segment.
#[derive(Clone, Copy)]
pub(crate) struct SpanRow<'a> {
    /// The source's map, around the row.
    pub from: Rows<'a>,
    /// Nearness of the destination's row.
    pub to: &'a [f32],
    /// Columns that nearness 1 moves by between the two maps, positive.
    pub disparity: f32,
    /// `Left` if the destination is the next sample, `Right` if it is the previous one.
    pub side: Side,
    pub discontinuity: Discontinuity,
    pub transition: Transition,
}

impl SpanRow<'_> {
    /// Draws into the destination's row of the channel, which is all 1: the fraction of the
    /// segment, from its end of it on, up to the nearest skin. Adds to `touched` the columns that
    /// may no longer be 1.
    pub fn draw(&self, level: Level, out: &mut [f32], touched: &mut Range<usize>) {
        assert!(out.len() == self.to.len() && out.len() == self.from.middle.len());
        run(level, Job::Skins { row: self, out, touched });
    }

    #[inline(always)]
    pub(crate) fn draw_with(&self, ops: impl Ops, out: &mut [f32], touched: &mut Range<usize>) {
        let least = self.discontinuity.threshold / self.disparity;
        let blocks = out.len().saturating_sub(1).div_ceil(BLOCK);
        for block in 0..blocks {
            // From the farthest skin to the nearest.
            let first = BLOCK * in_order(self.side, block, blocks);
            let mut steps = steps(ops, self.from.middle, self.side, least, first);
            while steps != 0 {
                let pair = match self.side {
                    Side::Left => steps.trailing_zeros(),
                    Side::Right => steps.ilog2(),
                };
                steps &= !(1 << pair);
                let x = first + pair as usize;
                if self.discontinuity.is_between(&self.from, x, self.side, least) {
                    let span = self.draw_skin(x, out);
                    let before =
                        if touched.start < touched.end { touched.clone() } else { span.clone() };
                    *touched = before.start.min(span.start)..before.end.max(span.end);
                }
            }
        }
    }

    /// Draws the skin between columns `x` and `x + 1` of the source, and returns its columns.
    #[inline(always)]
    fn draw_skin(&self, x: usize, out: &mut [f32]) -> Range<usize> {
        let sign = self.side.sign();
        let shift = self.disparity * sign;
        let (left, right) = (self.from.middle[x], self.from.middle[x + 1]);
        let (blocker, receiver, blocker_column) = match self.side {
            Side::Left => (left, right, x as f32 + 0.5),
            Side::Right => (right, left, x as f32 + 1.5),
        };
        let edge = across_rows(&self.from, x, self.side);
        let seen_at = edge - shift * blocker;
        let start = in_both(self.to, seen_at, blocker, self.side, self.disparity);
        let edge = edge + (start - seen_at);
        let end = edge - shift * receiver;
        // A texel of the destination is behind the skin if, in the source's map, it lies past the
        // centre of the blocker's last texel. Up to there, skin and surface may be the same thing.
        let known = match self.side {
            Side::Left => edge.min(blocker_column),
            Side::Right => edge.max(blocker_column),
        };

        // Texels whose centres lie between start and end. Casts saturate, and NaN becomes 0.
        let (low, high) = if start < end { (start, end) } else { (end, start) };
        let past = ((high + 0.5) as usize).min(out.len());
        let first = ((low + 0.5) as usize).min(past);
        let span = out[first..past].iter_mut().zip(&self.to[first..past]).enumerate();
        let column = |i: usize| (first as u32 + i as u32) as f32 + 0.5;
        let hidden = |u: f32, n: f32| ((u + shift * n) - known) * sign < 0.0;
        match self.transition {
            Transition::Linear => {
                let per_texel = 1.0 / (end - start);
                for (i, (out, &n)) in span {
                    let u = column(i);
                    *out = if hidden(u, n) { unit((u - start) * per_texel) } else { *out };
                }
            }
            Transition::Rational => {
                for (i, (out, &n)) in span {
                    let u = column(i);
                    let seen = unit((u - start) / (shift * (blocker - n)));
                    *out = if hidden(u, n) { seen } else { *out };
                }
            }
        }
        first..past
    }
}

/// Clamped to \[0, 1\], NaN to 0, as compares and selects.
#[inline(always)]
fn unit(t: f32) -> f32 {
    let t = if t > 0.0 { t } else { 0.0 };
    if t < 1.0 { t } else { 1.0 }
}

/// The `index`-th of `len` things from the farthest skin to the nearest.
#[inline(always)]
fn in_order(side: Side, index: usize, len: usize) -> usize {
    match side {
        Side::Left => index,
        Side::Right => len - 1 - index,
    }
}
