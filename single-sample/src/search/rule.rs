//! When the pixels of a group are interpolated.
//!
//! All of them must have one key. A group whose ends are close needs no look at its middle, unless it is
//! longer than the discs of its ends are wide: a whole penumbra may lie between them. Others do, and
//! are interpolated if a straight line comes close to it; the interpolation goes through it. Again,
//! if all three are close, nothing may fit between them, but in a short group.

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

    /// Whether a group with these ends is interpolated at once. `is_full`: nothing fits between them.
    #[inline(always)]
    pub fn are_close(&self, ends: &[f32; 2], is_full: bool) -> bool {
        is_full & ((ends[1] - ends[0]).abs() <= self.tolerance)
    }

    /// Whether a group is interpolated whose middle is off a straight line by `bend`. `is_full`:
    /// nothing fits between that and the ends.
    #[inline(always)]
    pub fn fits(&self, ends: &[f32; 2], bend: f32, is_full: bool, length: usize) -> bool {
        let is_straight = bend.abs() <= self.tolerance * BEND;
        is_straight & (is_full | (length <= SHORT) | !self.are_close(ends, true))
    }
}
