//! When the pixels of a group are interpolated.
//!
//! All of them must show one object. Their hard shadow test must have one result, too, unless the
//! group lies within a penumbra: blockers are in reach, and discs are wide for its length.
//!
//! A group whose ends are close needs no look at its middle if its ends' discs are far wider than
//! it is long: what blocks between them hides as much of theirs. And if a parabola through them and
//! the next known pixel is flat there: a ridge may lie between two penumbrae. Others do, and are
//! interpolated if a straight line comes close to it; the interpolation goes through it. But if all
//! three are close, no penumbra may fit between them, unless the group is short.

use super::soa::Receivers;
use crate::math::sqrt;

/// How far the middle of a group may be from the straight line between its ends, relative to the
/// greatest difference of close ends.
const BEND: f32 = 0.5;

/// Pixels from the first to the last of a short group.
const SHORT: usize = 5;

/// How many times as long as a group the radius of its ends' discs is where it needs no look at its
/// middle. A bar there hides 0.97 of what it does in the middle from either end, with 1 only 0.87.
pub(super) const WIDE: f32 = 2.0;

/// See the module.
pub(crate) struct Rule<'a> {
    /// The greatest difference of close ends.
    pub tolerance: f32,
    pub receivers: &'a Receivers,
}

impl Rule<'_> {
    /// The room in a group of which the middle is not known, where no disc is narrower than `disc`.
    #[inline(always)]
    pub fn room(&self, first: usize, last: usize, disc: f32) -> Room {
        Room::of(self.distance(first, last) * WIDE, disc)
    }

    /// The room on either side of a group's middle, which is known.
    #[inline(always)]
    pub fn room_in_half(&self, first: usize, last: usize, disc: f32) -> Room {
        Room::of(self.distance(first, last) * 0.5, disc)
    }

    /// Texels from one pixel's place in the map to another's.
    #[inline(always)]
    fn distance(&self, first: usize, last: usize) -> f32 {
        let Receivers { u, v, .. } = self.receivers;
        let (du, dv) = (u[last] - u[first], v[last] - v[first]);
        sqrt(du * du + dv * dv)
    }

    /// Whether a group with these ends is interpolated at once.
    #[inline(always)]
    pub fn are_close(&self, ends: &[f32; 2], room: Room) -> bool {
        room.is_full & self.is_level(ends)
    }

    /// Whether a group is interpolated whose middle is off a straight line by `bend`. `room` is
    /// that between the middle and the ends.
    #[inline(always)]
    pub fn fits(&self, ends: &[f32; 2], bend: f32, room: Room, length: usize) -> bool {
        let is_straight = bend.abs() <= self.tolerance * BEND;
        is_straight & (room.is_full | (length <= SHORT) | !self.is_level(ends))
    }

    /// Whether a parabola through a group's ends and the `outer` pixel is flat in between.
    #[inline(always)]
    pub fn is_flat(&self, ends: &[f32; 2], outer: f32, beyond: Beyond) -> bool {
        let Beyond { is_before, length, bend } = beyond;
        let [near, far] = if is_before { *ends } else { [ends[1], ends[0]] };
        let rise = (outer - near) * length - (near - far);
        rise.abs() * bend <= self.tolerance * BEND
    }

    #[inline(always)]
    fn is_level(&self, ends: &[f32; 2]) -> bool {
        (ends[1] - ends[0]).abs() <= self.tolerance
    }
}

/// Where a pixel beyond a group is.
#[derive(Clone, Copy)]
pub(crate) struct Beyond {
    is_before: bool,
    /// The length of the group, in ways from that pixel to the nearer end.
    length: f32,
    /// What a parabola through the three is off a straight line in the middle of the group,
    /// relative to how much more it would rise along a group there than along this one.
    bend: f32,
}

impl Beyond {
    /// That of `outer`; if that is `first`, there is none.
    #[inline(always)]
    pub fn of(first: usize, last: usize, outer: usize) -> Beyond {
        let (is_before, length) = (outer < first, (last - first) as f32);
        if outer == first {
            return Beyond { is_before, length, bend: 0.0 };
        }
        let way = if is_before { first - outer } else { outer - last } as f32;
        Beyond { is_before, length: length / way, bend: 0.25 * length / (length + way) }
    }
}

/// What there may be between pixels.
#[derive(Clone, Copy)]
pub(crate) struct Room {
    /// Whether discs are so wide that nothing between them is missed.
    pub is_full: bool,
    /// Whether what is between them is in the midst of penumbrae if in any.
    pub is_within_penumbra: bool,
}

impl Room {
    #[inline(always)]
    fn of(gap: f32, disc: f32) -> Room {
        let is_full = gap <= disc;
        Room { is_full, is_within_penumbra: is_full & (disc < f32::INFINITY) }
    }
}
