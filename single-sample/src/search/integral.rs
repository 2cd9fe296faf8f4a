//! What the outline hides of the light's disc.
//!
//! Seen from the receiver, the light is a disc of radius 1. Along the direction `phi` from its
//! centre, let the outline be crossed at the distances rho. What lies between two crossings has the
//! area `(rho_1² - rho_0²) / 2` per angle. Summed over all directions, each piece of the outline
//! contributes, whatever the others do,
//!
//! ```text
//!     integral of (1 - rho²) / 2 over the angle that the piece spans, where rho < 1
//! ```
//!
//! with the sign of the step (towards a blocker as rho grows: plus), and the whole disc is added
//! if its centre is blocked. For a straight piece the integral of rho² is the cross product of its
//! ends, so a piece within the disc contributes `(angle - cross) / 2`. One straight edge across
//! the whole disc gives the circular segment, the falloff of [`crate::disc::disc_fraction`].

use super::receiver::Receiver;
use super::segments::{LANES, Segments};
use crate::disc::angle;

/// Numbers in \[8, 16) have a unit of 2^-20 in the last place. Contributions are rounded to it by
/// adding this, and summed as integers: the sum is the same in any order.
const ROUND: f32 = 12.0;

/// Twice pi, in that unit.
const TURN: f32 = core::f32::consts::TAU * 1_048_576.0;

/// What one piece of the outline contributes to twice the blocked area, with the middle (x, y).
#[inline(always)]
pub(crate) fn contribution(
    r: &Receiver,
    x: f32,
    y: f32,
    half_x: f32,
    half_y: f32,
    nearness: f32,
) -> i32 {
    let (x, y) = (x - r.u, y - r.v);
    let cross = r.area * (x * half_y - y * half_x);
    let middle = (r.qxx * (x * x) + r.qxy * (x * y)) + r.qyy * (y * y);
    let half = (r.qxx * (half_x * half_x) + r.qxy * (half_x * half_y)) + r.qyy * (half_y * half_y);
    let size = cross.abs();
    let w = nearness - r.nearness;
    let within = angle(size, middle - half) - size / (w * w);
    // False for NaN.
    let counts = (w > 0.0) & (within > 0.0);
    let part = if counts { within } else { 0.0 };
    let signed = if cross < 0.0 { -part } else { part };
    (signed + ROUND).to_bits().wrapping_sub(ROUND.to_bits()) as i32
}

/// The sum over all pieces.
#[inline(always)]
pub(crate) fn sum(r: &Receiver, segments: &Segments) -> i32 {
    let groups = segments.len.div_ceil(LANES);
    let [x, y, half_x, half_y, nearness] = segments.groups(groups);
    let mut sums = [0_i32; LANES];
    for group in 0..groups {
        let (x, y, nearness) = (&x[group], &y[group], &nearness[group]);
        let (half_x, half_y) = (&half_x[group], &half_y[group]);
        for i in 0..LANES {
            let part = contribution(r, x[i], y[i], half_x[i], half_y[i], nearness[i]);
            sums[i] = sums[i].wrapping_add(part);
        }
    }
    sums.iter().fold(0, |sum, part| sum.wrapping_add(*part))
}

/// The blocked fraction of the disc, in \[0, 1\].
#[inline(always)]
pub(crate) fn blocked_fraction(center_is_blocked: bool, sum: i32) -> f32 {
    let center = if center_is_blocked { 1.0 } else { 0.0 };
    let blocked = center + sum as f32 / TURN;
    let blocked = if blocked > 0.0 { blocked } else { 0.0 };
    if blocked < 1.0 { blocked } else { 1.0 }
}
