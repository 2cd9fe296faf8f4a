//! When the pixels of a group are interpolated.
//!
//! All of them must show one object. Their hard shadow test must have one result, too, unless the group
//! lies within a penumbra: discs are wider than it is long, and blockers are in reach.
//!
//! A group whose ends are close needs no look at its middle, unless it is longer than the discs of its
//! ends are wide: a whole penumbra may lie between them. Others do, and are interpolated if a straight
//! line comes close to it; the interpolation goes through it. Again, if all three are close, nothing
//! may fit between them, but in a short group.

use super::soa::Receivers;
use crate::math::sqrt;

/// How far the middle of a group may be from the straight line between its ends, relative to the
/// greatest difference of close ends.
const BEND: f32 = 0.5;

/// Pixels from the first to the last of a short group.
const SHORT: usize = 5;

/// See the module.
pub(crate) struct Rule<'a> {
    /// The greatest difference of close ends.
    pub tolerance: f32,
    pub receivers: &'a Receivers,
}

impl Rule<'_> {
    /// Texels from one pixel's place in the map to another's.
    #[inline(always)]
    pub fn distance(&self, first: usize, last: usize) -> f32 {
        let Receivers { u, v, .. } = self.receivers;
        let (du, dv) = (u[last] - u[first], v[last] - v[first]);
        sqrt(du * du + dv * dv)
    }

    /// Whether a group with these ends is interpolated at once.
    #[inline(always)]
    pub fn are_close(&self, ends: &[f32; 2], room: Room) -> bool {
        room.is_full & self.is_level(ends)
    }

    /// Whether a group is interpolated whose middle is off a straight line by `bend`. `room` is that
    /// between the middle and the ends.
    #[inline(always)]
    pub fn fits(&self, ends: &[f32; 2], bend: f32, room: Room, length: usize) -> bool {
        let is_straight = bend.abs() <= self.tolerance * BEND;
        is_straight & (room.is_full | (length <= SHORT) | !self.is_level(ends))
    }

    #[inline(always)]
    fn is_level(&self, ends: &[f32; 2]) -> bool {
        (ends[1] - ends[0]).abs() <= self.tolerance
    }
}

/// What there may be between two pixels.
#[derive(Clone, Copy)]
pub(crate) struct Room {
    /// Whether no penumbra fits between them.
    pub is_full: bool,
    /// Whether they are, and all between them is, in the midst of penumbrae if in any.
    pub is_within_penumbra: bool,
}

impl Room {
    /// That between pixels so many texels apart, where no disc is narrower than `disc`.
    #[inline(always)]
    pub fn of(gap: f32, disc: f32) -> Room {
        let is_full = gap <= disc;
        Room { is_full, is_within_penumbra: is_full & (disc < f32::INFINITY) }
    }
}
