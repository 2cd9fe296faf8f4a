//! Blockers close to a receiver that face it, and hence hide nothing from it.
//!
//! The light's centre is in front of every surface that its map shows. A receiver that is in front
//! of a texel's plane, too, has nothing of that plane between itself and the light. Without this
//! test the ground would block a wall's foot, for it is nearer to the light there and above the
//! wall's horizon, and hide the edge of any shadow that ends at the foot. Farther away the test
//! changes nothing: a surface that faces a receiver is outside of its disc.
//!
//! The slopes of a texel's plane are those on the side away from the receiver, where the surface
//! goes on; and of two there the lesser one, for the other may lead across an edge.

use super::field::{BLOCK_COLUMNS, BLOCK_ROWS, Field, Row, Texel};
use super::kernels::Bits;
use super::planes::ROUNDING;
use super::reach::Extent;
use super::receiver::Receiver;

/// Blockers are close for which the light's disc has a radius up to this many texels.
const CLOSE: f32 = 0.5;

/// Slopes beyond this, and what is no number, count as none; no blocker that is nearer than a
/// receiver by more is close.
const LARGE: f32 = 1e18;

/// Texels around a block that slopes follow from.
const AROUND: usize = 2;

/// How much nearer than a receiver close blockers are at most, for a disc of this radius in texels
/// per nearness.
pub(crate) fn contact(spread: [f32; 2]) -> f32 {
    let contact = CLOSE / spread[0].max(spread[1]);
    if contact < LARGE { contact } else { LARGE }
}

/// Texels up to this much nearer may be close to receivers of this nearness or less, with room for
/// rounding.
#[inline(always)]
pub(crate) fn close_to(contact: f32, nearness: f32) -> f32 {
    contact + (contact + nearness.abs()) * ROUNDING
}

/// The lesser of two slopes between three texels.
#[inline(always)]
fn slope(first: f32, second: f32, third: f32) -> f32 {
    let (near, far) = (second - first, third - second);
    let slope = if near.abs() <= far.abs() { near } else { far };
    if slope.abs() < LARGE { slope } else { 0.0 }
}

impl<T: Texel> Field<'_, T> {
    /// Whether a texel blocks part of what a receiver could see.
    #[inline(always)]
    pub fn blocks(&self, [x, y]: [i32; 2], r: &Receiver) -> bool {
        let (s, t) = (x as f32 + 0.5, y as f32 + 0.5);
        let nearness = self.nearness(x, y);
        r.is_blocked_by(s, t, nearness)
            && (nearness - r.nearness > self.contact || !self.is_facing([x, y], r, nearness))
    }

    /// Whether a receiver is in front of a texel's plane.
    fn is_facing(&self, [x, y]: [i32; 2], r: &Receiver, nearness: f32) -> bool {
        let (dx, dy) = ((x as f32 + 0.5) - r.u, (y as f32 + 0.5) - r.v);
        let along = |beyond: f32, at: &dyn Fn(i32) -> f32| {
            let slope = match beyond > 0.0 {
                true => slope(nearness, at(1), at(2)),
                false => slope(at(-2), at(-1), nearness),
            };
            slope * beyond
        };
        let along_x = along(dx, &|step| self.nearness(x.saturating_add(step), y));
        let along_y = along(dy, &|step| self.nearness(x, y.saturating_add(step)));
        nearness - (along_x + along_y) <= r.nearness
    }
}

/// A block of texels with those around it, and receivers.
pub(crate) struct Surroundings<'a> {
    /// The block's first texel.
    pub at: [i32; 2],
    pub texels: [&'a [f32; Surroundings::COLUMNS]; Surroundings::ROWS],
    pub receivers: &'a Extent,
    /// Whether that is one receiver.
    pub is_one: bool,
    pub contact: f32,
    /// Which texels of the block may be close to receivers.
    pub close: Bits,
}

impl Surroundings<'_> {
    /// Of the block and those around it.
    pub const COLUMNS: usize = BLOCK_COLUMNS + 2 * AROUND;
    pub const ROWS: usize = BLOCK_ROWS + 2 * AROUND;

    /// The first texel around the block whose first is (x, y).
    #[inline(always)]
    pub fn first([x, y]: [i32; 2]) -> [i32; 2] {
        [x - AROUND as i32, y - AROUND as i32]
    }

    /// Writes the rows of the block with NaN for close texels that surely face all of the
    /// receivers, and with NaN for those that may face any. For one receiver both would be the
    /// same, and only the first are written.
    #[inline(always)]
    pub fn unfaced(&self, rows: &mut [[Row; BLOCK_ROWS]; 2]) {
        if self.is_one { self.unfaced_by::<1>(rows) } else { self.unfaced_by::<2>(rows) }
    }

    /// Writes the first `ENDS` of these.
    #[inline(always)]
    fn unfaced_by<const ENDS: usize>(&self, rows: &mut [[Row; BLOCK_ROWS]; 2]) {
        let Extent { u, v, nearness: receivers } = *self.receivers;
        let across = Line::<BLOCK_COLUMNS>::new(self.at[0], u);
        let down = Line::<BLOCK_ROWS>::new(self.at[1], v);
        for y in 0..BLOCK_ROWS {
            if self.close.row(y) == 0 {
                let row = self.texels[y + AROUND][AROUND..].first_chunk();
                let row = row.expect("the block's texels lie within those around it");
                for end in 0..ENDS {
                    rows[end][y] = *row;
                }
                continue;
            }
            for x in 0..BLOCK_COLUMNS {
                let at = |i: usize, j: usize| self.texels[y + j][x + i];
                let nearness = at(2, 2);
                let before = slope(at(0, 2), at(1, 2), nearness);
                let after = slope(nearness, at(3, 2), at(4, 2));
                let above = slope(at(2, 0), at(2, 1), nearness);
                let below = slope(nearness, at(2, 3), at(2, 4));
                let along_x = across.rise::<ENDS>(x, [before, after]);
                let along_y = down.rise::<ENDS>(y, [above, below]);
                for end in 0..ENDS {
                    let plane = nearness - (along_x[end] + along_y[end]);
                    let is_close = nearness - receivers[end] <= self.contact;
                    let is_facing = is_close & (plane <= receivers[end]);
                    rows[end][y][x] = if is_facing { f32::NAN } else { nearness };
                }
            }
        }
    }
}

/// Some receivers, as a line of texels sees them along one axis.
struct Line<const LENGTH: usize> {
    /// How far each texel is beyond the first receiver, and beyond the last.
    beyond: [[f32; LENGTH]; 2],
    /// 0 for texels between those, else infinite.
    between: [f32; LENGTH],
}

impl<const LENGTH: usize> Line<LENGTH> {
    #[inline(always)]
    fn new(first: i32, [least, most]: [f32; 2]) -> Self {
        let (mut beyond, mut between) = ([[0.0; LENGTH]; 2], [f32::INFINITY; LENGTH]);
        for i in 0..LENGTH {
            let at = (first as f32 + 0.5) + i as f32;
            let (after_first, after_last) = (at - least, at - most);
            (beyond[0][i], beyond[1][i]) = (after_first, after_last);
            let is_between = (after_first > 0.0) & (after_last <= 0.0);
            between[i] = if is_between { 0.0 } else { f32::INFINITY };
        }
        Line { beyond, between }
    }

    /// Bounds on what a texel's plane rises by from the receivers to the texel, with the slope
    /// before the texel and the one after it.
    #[inline(always)]
    fn rise<const ENDS: usize>(&self, i: usize, [before, after]: [f32; 2]) -> [f32; 2] {
        let rise = |beyond: f32| (if beyond > 0.0 { after } else { before }) * beyond;
        let first = rise(self.beyond[0][i]);
        if ENDS == 1 {
            return [first; 2];
        }
        let last = rise(self.beyond[1][i]);
        let between = self.between[i];
        let low = if first < last { first } else { last };
        let high = if first > last { first } else { last };
        let low = if low < between { low } else { between };
        let high = if high > -between { high } else { -between };
        [low, high]
    }
}
