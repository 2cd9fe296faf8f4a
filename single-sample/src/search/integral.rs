//! What the outline hides of the light's disc.
//!
//! Seen from the receiver, the light is a disc of radius 1, and the outline a closed polygon around
//! what is blocked. Along the direction `phi` from the disc's centre, let the outline be crossed at
//! the distances rho. What lies between two crossings has the area `(rho_1² - rho_0²) / 2` per
//! angle. Summed over all directions, each segment of the outline contributes, whatever the others
//! do,
//!
//! ```text
//!     integral of (1 - rho²) / 2 over the angle that its part within the disc spans
//! ```
//!
//! with the sign of the step (towards a blocker as rho grows: plus), and the whole disc is added
//! if its centre is blocked. For a straight segment the integral of rho² is the cross product of
//! its ends, so it contributes `(angle - cross) / 2`. One straight edge across the whole disc gives
//! the circular segment, the falloff of [`crate::disc::disc_fraction`].

use core::ops::Range;

use super::cell::CELL;
use super::field::{Field, Texel};
use super::lanes::{least, least_of};
use super::receiver::{Receiver, Seen};
use super::rule::WIDE;
use super::segments::{LANES, Segment, Segments, Vertex};
use crate::disc::angle;
use crate::math::sqrt;

/// Numbers in \[8, 16) have a unit of 2^-20 in the last place. Contributions are rounded to it by
/// adding this, and summed as integers: the sum is the same in any order.
const ROUND: f32 = 12.0;

/// Twice pi, in that unit.
const TURN: f32 = core::f32::consts::TAU * 1_048_576.0;

/// Twice the area of the triangle between the receiver and a segment, in texels: negative if the
/// receiver is on the side of the blockers.
#[inline(always)]
fn side([u, v]: [f32; 2], segment: &Segment) -> f32 {
    let Segment { from, to } = segment;
    (from.x - u) * (to.y - v) - (to.x - u) * (from.y - v)
}

/// What one segment contributes to twice the blocked area.
#[inline(always)]
pub(crate) fn contribution(r: &Seen, segment: &Segment) -> i32 {
    let Segment { from, to } = segment;
    let side = side([r.u, r.v], segment);
    // A blocker about as far from the light as the receiver is far outside of the disc.
    let nearer = |nearness: f32| {
        let nearer = nearness - r.nearness;
        if nearer > r.least { nearer } else { r.least }
    };
    let (a, b) = (nearer(from.nearness), nearer(to.nearness));
    let product = 1.0 / (a * b);
    let (a, b) = (b * product, a * product);
    let (x, y) = (from.x - r.u, from.y - r.v);
    let (ax, ay) = ((r.xx * x + r.xy * y) * a, (r.yy * y) * a);
    let (x, y) = (to.x - r.u, to.y - r.v);
    let (bx, by) = ((r.xx * x + r.xy * y) * b, (r.yy * y) * b);
    let cross = (side.abs() * r.area) * product;
    // The part from s to t of the way lies within the disc.
    let (dx, dy) = (bx - ax, by - ay);
    let length = dx * dx + dy * dy;
    let along = ax * dx + ay * dy;
    let root = length - cross * cross;
    let half = sqrt(if root > 0.0 { root } else { 0.0 });
    let inverse = 1.0 / length;
    let (s, t) = ((-along - half) * inverse, (half - along) * inverse);
    let s = if s > 0.0 { s } else { 0.0 };
    let t = if t < 1.0 { t } else { 1.0 };
    let (px, py) = (ax + s * dx, ay + s * dy);
    let (qx, qy) = (ax + t * dx, ay + t * dy);
    let cross = cross * (t - s);
    let within = angle(cross, px * qx + py * qy) - cross;
    // False for NaN.
    let counts = (root > 0.0) & (t > s) & (within > 0.0);
    let part = if counts { within } else { 0.0 };
    let signed = if side < 0.0 { -part } else { part };
    (signed + ROUND).to_bits().wrapping_sub(ROUND.to_bits()) as i32
}

/// Adds what each segment of a group contributes.
#[inline(always)]
fn add_group(sums: &mut [i32; LANES], receiver: &Seen, segments: &Segments, group: usize) {
    let group = segments.group(group);
    for i in 0..LANES {
        sums[i] = sums[i].wrapping_add(contribution(receiver, &group.get(i)));
    }
}

/// The same. Finds the least nearness of those that contribute or begin `around` the disc: no more
/// texels away from it.
#[inline(always)]
fn add_group_around(
    sums: &mut [i32; LANES],
    least: &mut [f32; LANES],
    receiver: &Seen,
    around: f32,
    segments: &Segments,
    group: usize,
) {
    let group = segments.group(group);
    for i in 0..LANES {
        let segment = group.get(i);
        let part = contribution(receiver, &segment);
        sums[i] = sums[i].wrapping_add(part);
        let Vertex { x, y, nearness } = segment.from;
        let (dx, dy, nearer) = (x - receiver.u, y - receiver.v, nearness - receiver.nearness);
        let counts = (part != 0) | receiver.is_around(dx, dy, nearer, around);
        least[i] = if counts & (nearness < least[i]) { nearness } else { least[i] };
    }
}

#[inline(always)]
fn add_up(sums: &[i32; LANES]) -> i32 {
    sums.iter().fold(0, |sum, part| sum.wrapping_add(*part))
}

/// What segments contribute.
#[derive(Clone, Copy)]
pub(crate) struct Sum {
    pub total: i32,
    /// A radius in texels which the disc has at least at any blocker in reach, and at those around
    /// it that are looked for: infinite if there is none.
    pub disc: f32,
}

/// Which discs are looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sought {
    /// Those at blockers that would be in reach so many texels from the receiver.
    pub around: f32,
    /// How much wider ones are does not matter.
    pub widest: f32,
}

impl Sought {
    /// Those that tell what there may be between pixels no farther apart than so many texels.
    #[inline(always)]
    pub fn between(texels: f32) -> Sought {
        // What lies between two pixels is no farther from one of them than half of that.
        Sought { around: texels * 0.5, widest: texels * WIDE }
    }
}

impl Sum {
    pub const NONE: Sum = Sum { total: 0, disc: f32::INFINITY };

    #[inline(always)]
    pub fn add(&mut self, other: &Sum) {
        self.total = self.total.wrapping_add(other.total);
        self.disc = least(other.disc, self.disc);
    }
}

/// The sum over whole groups of segments, for one receiver.
#[inline(always)]
pub(crate) fn sum(
    receiver: &Seen,
    sought: &Sought,
    segments: &Segments,
    groups: Range<usize>,
) -> Sum {
    let mut sums = [0_i32; LANES];
    let mut nearness = [f32::INFINITY; LANES];
    for group in groups {
        add_group_around(&mut sums, &mut nearness, receiver, sought.around, segments, group);
    }
    Sum { total: add_up(&sums), disc: receiver.disc(least_of(nearness)) }
}

/// The same over those groups that are in reach, of which the bounds must be known.
#[inline(always)]
pub(crate) fn sum_in_reach(
    receiver: &Seen,
    sought: &Sought,
    segments: &Segments,
    groups: Range<usize>,
) -> Sum {
    let mut sums = [0_i32; LANES];
    let mut nearness = [f32::INFINITY; LANES];
    let mut any = f32::INFINITY;
    for group in groups {
        let bounds = segments.bounds(group);
        if !bounds.are_in_reach(receiver) {
            continue;
        }
        if receiver.disc(bounds.nearness[0]) >= sought.widest {
            any = least(any, bounds.nearness[0]);
            add_group(&mut sums, receiver, segments, group);
        } else {
            let around = sought.around;
            add_group_around(&mut sums, &mut nearness, receiver, around, segments, group);
        }
    }
    Sum { total: add_up(&sums), disc: receiver.disc(least(any, least_of(nearness))) }
}

/// The first texel of the cell that a receiver lies in.
#[inline(always)]
pub(crate) fn cell_of(u: f32, v: f32) -> [i32; 2] {
    let cell = CELL as f32;
    [u, v].map(|at| {
        let at = (at - 0.5) / cell;
        // Casts saturate.
        let cut = at as i32;
        (if cut as f32 > at { cut.saturating_sub(1) } else { cut }).saturating_mul(CELL as i32)
    })
}

/// Whether the middle of the disc is hidden: the receiver's place lies within the outline.
/// `cell` are the segments of the receiver's cell.
///
/// The texel at a cell's corner is never on the wrong side of its outline; each segment on the way
/// there changes sides.
#[inline(always)]
pub(crate) fn hides_center<T: Texel>(
    field: &Field<'_, T>,
    receiver: &Receiver,
    segments: &Segments,
    cell: Range<usize>,
) -> bool {
    let Receiver { u, v, .. } = *receiver;
    let [x, y] = cell_of(u, v);
    let corner = [x as f32 + 0.5, y as f32 + 0.5];
    let mut hidden = field.blocks([x, y], receiver);
    for segment in cell {
        let segment = segments.get(segment);
        let Segment { from, to } = &segment;
        let left = |x: f32, y: f32| (corner[0] - u) * (y - v) - (x - u) * (corner[1] - v) < 0.0;
        let is_between = left(from.x, from.y) != left(to.x, to.y);
        // As in `contribution`, for both to agree on what lies within.
        let differs = (side([u, v], &segment) < 0.0) != (side(corner, &segment) < 0.0);
        hidden ^= is_between & differs;
    }
    hidden
}

/// The blocked fraction of the disc, in \[0, 1\].
#[inline(always)]
pub(crate) fn blocked_fraction(center_is_blocked: bool, sum: i32) -> f32 {
    let center = if center_is_blocked { 1.0 } else { 0.0 };
    let blocked = center + sum as f32 / TURN;
    let blocked = if blocked > 0.0 { blocked } else { 0.0 };
    if blocked < 1.0 { blocked } else { 1.0 }
}
