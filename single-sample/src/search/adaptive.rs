//! Adaptive sampling (Brabec and Seidel 2002, section 4.3), within one tile of the image.
//!
//! The paper searches groups of pixels along some columns, and then along all rows between them.
//! Here rows come first, for all columns between two rows can be looked at side by side; and what
//! these need from a row between is searched in groups along that row, again.
//!
//! Unlike in the paper, not only objects and hard shadow test results of a group's pixels decide
//! whether it is interpolated, but also the values ([`super::rule`]).

#[cfg(test)]
mod tests;

use super::curve::Curve;
use super::lanes::{Bits, least, rows_of_bits};
use super::list::List;
use super::rule::{Beyond, Room, Rule};
use super::soa::Receivers;
use super::strip::Strip;

/// Pixels along each side of a tile.
pub(crate) const TILE: usize = 16;
/// Pixels of a tile.
pub(crate) const COUNT: usize = TILE * TILE;

/// The blocked fractions of a tile's pixels, searched or interpolated.
///
/// Pixels are asked for in rounds: [`Samples::begin`] asks for the first, and as long as
/// [`Samples::wanted`] are searched, [`Samples::refine`] asks for more.
pub(crate) struct Samples {
    pub values: [f32; COUNT],
    /// A radius in texels which the light's disc has at least at any blocker that may hide part of
    /// it, from there or from the pixels that were interpolated.
    pub discs: [f32; COUNT],
    /// Which values come from a search.
    pub searched: Bits,
    /// Those whose value matters.
    pub needed: Bits,
    wanted: List<u8, COUNT>,
    /// Which pixels show the object that the next one in the row does, and the one below.
    pub(super) same_object: [Bits; 2],
    /// Which pixels have the hard shadow test result of these.
    pub(super) same_hard: [Bits; 2],
    /// Groups along rows, and along columns between these rows. All but the last few are done.
    groups: List<Group, COUNT>,
    groups_done: usize,
    pub(super) strips: List<Strip, { 2 * TILE }>,
    strips_done: usize,
    /// Pixels that strips need.
    pub(super) asked: Bits,
}

/// What a tile's pixels must have in common to be interpolated.
pub(crate) struct Keys<'a> {
    /// The objects' IDs.
    pub objects: &'a [u32; COUNT],
    /// Which pixels are in shadow by the hard shadow test.
    pub hard: Bits,
    /// Which pixels may be in shadow: the others need no value.
    pub needed: Bits,
}

/// Pixels side by side in a row, the first and the last of which are known or asked for.
#[derive(Clone, Copy)]
struct Group {
    first: u8,
    last: u8,
    /// A known one in the same row before or after these; if there is none, the first.
    outer: u8,
    /// Whether the one in the middle is known, too.
    is_halved: bool,
}

impl Group {
    #[inline(always)]
    fn new(pixels: [usize; 3]) -> Group {
        let [first, last, outer] = pixels.map(|pixel| pixel as u8);
        Group { first, last, outer, is_halved: false }
    }
}

/// When pixels between two others are interpolated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Pixels of the tile, at most [`TILE`] along each side.
    pub width: usize,
    pub height: usize,
    /// Pixels from one searched row to the next.
    pub group: usize,
    /// The greatest difference of the two ends.
    pub tolerance: f32,
}

impl Grid {
    /// The first and the last of each group from `first` to `last`, and another group's end; if
    /// there is no other, the first.
    #[inline(always)]
    fn groups(&self, first: usize, last: usize) -> impl Iterator<Item = [usize; 3]> + use<> {
        let group = self.group;
        (first..last).step_by(group).map(move |start| {
            let end = (start + group).min(last);
            let next = (end + group).min(last);
            let outer = if start > first { start - group } else { next };
            [start, end, if outer == end { start } else { outer }]
        })
    }
}

impl Samples {
    pub const fn new() -> Samples {
        Samples {
            values: [0.0; COUNT],
            discs: [f32::INFINITY; COUNT],
            searched: [0; TILE],
            needed: [0; TILE],
            wanted: List::new(0),
            same_object: [[0; TILE]; 2],
            same_hard: [[0; TILE]; 2],
            groups: List::new(Group { first: 0, last: 0, outer: 0, is_halved: false }),
            groups_done: 0,
            strips: List::new(Strip::NONE),
            strips_done: 0,
            asked: [0; TILE],
        }
    }

    /// The pixels to be searched now.
    #[inline(always)]
    pub fn wanted(&self) -> &[u8] {
        self.wanted.all()
    }

    /// Takes what the search of a pixel found that was not asked for.
    #[inline(always)]
    pub fn add(&mut self, pixel: usize, value: f32) {
        self.values[pixel] = value;
        for pixels in [&mut self.needed, &mut self.searched] {
            pixels[pixel / TILE] |= 1 << (pixel % TILE);
        }
    }

    /// Asks for the ends of all groups along every `group`-th row.
    #[inline(always)]
    pub fn begin(&mut self, grid: &Grid, keys: &Keys<'_>) {
        self.compare(keys);
        self.needed = keys.needed;
        self.searched = [0; TILE];
        self.values = [0.0; COUNT];
        self.discs = [f32::INFINITY; COUNT];
        self.wanted.clear();
        self.groups.clear();
        self.strips.clear();
        (self.groups_done, self.strips_done) = (0, 0);
        let last = grid.width - 1;
        self.ask_row(grid, 0, [0, last]);
        for rows in grid.groups(0, grid.height - 1) {
            self.ask_row(grid, rows[1], [0, last]);
            let columns = u16::MAX >> (TILE - grid.width);
            self.strips.push(Strip::new(rows, columns));
        }
    }

    /// Interpolates what the pixels searched so far allow, and asks for the middles of the other
    /// groups; false once there are none.
    #[inline(always)]
    pub fn refine(&mut self, grid: &Grid, receivers: &Receivers) -> bool {
        self.wanted.clear();
        let rule = Rule { tolerance: grid.tolerance, receivers };
        loop {
            let groups = self.groups_done..self.groups.len();
            let strips = self.strips_done..self.strips.len();
            if !groups.is_empty() {
                self.groups_done = groups.end;
                for i in groups {
                    self.settle(self.groups.all()[i], &rule);
                }
            } else if !strips.is_empty() {
                self.strips_done = strips.end;
                self.asked = [0; TILE];
                for i in strips {
                    self.settle_strip(self.strips.all()[i], &rule);
                }
                self.ask_rows(grid);
            } else {
                return false;
            }
            if !self.wanted.all().is_empty() {
                return true;
            }
        }
    }

    /// Asks for what strips need of the rows in their middle, in groups along these.
    #[inline(always)]
    fn ask_rows(&mut self, grid: &Grid) {
        for y in 0..TILE {
            let mut columns = u32::from(self.asked[y]);
            while columns != 0 {
                let first = columns.trailing_zeros();
                let end = first + (!(columns >> first)).trailing_zeros();
                columns &= u32::MAX << end;
                self.ask_row(grid, y, [first as usize, end as usize - 1]);
            }
        }
    }

    /// Asks for the pixels from column `first` to `last` of a row, in groups.
    #[inline(always)]
    fn ask_row(&mut self, grid: &Grid, y: usize, [first, last]: [usize; 2]) {
        let row = y * TILE;
        self.want(row + first);
        for ends in grid.groups(row + first, row + last) {
            self.want(ends[1]);
            self.groups.push(Group::new(ends));
        }
    }

    /// Interpolates a group or asks for its middle; once that is known, looks at both halves.
    #[inline(always)]
    fn settle(&mut self, group: Group, rule: &Rule<'_>) {
        let [first, last, outer] = [group.first, group.last, group.outer].map(usize::from);
        if !group.is_halved {
            return self.halve([first, last, outer], rule);
        }
        let length = last - first;
        let half = length / 2;
        let middle = first + half;
        let ends = [self.values[first], self.values[last]];
        let line = Curve::line(ends, length);
        let bend = self.values[middle] - line.at(half, length);
        let disc = least(least(self.discs[first], self.discs[middle]), self.discs[last]);
        let room = rule.room_in_half(first, last, disc);
        if rule.fits(&ends, bend, room, length) && self.row_agrees(first, length, room) {
            let curve = line.bent(half, length, bend);
            self.interpolate([first, middle], [first, length], &curve, disc);
            self.interpolate([middle, last], [first, length], &curve, disc);
        } else {
            self.halve([first, middle, last], rule);
            self.halve([middle, last, first], rule);
        }
    }

    /// Interpolates a group whose ends are close, or asks for its middle.
    #[inline(always)]
    fn halve(&mut self, [first, last, outer]: [usize; 3], rule: &Rule<'_>) {
        let length = last - first;
        if length <= 1 {
            return;
        }
        let ends = [self.values[first], self.values[last]];
        let disc = least(self.discs[first], self.discs[last]);
        let room = rule.room(first, last, disc);
        let is_flat = || {
            let (from, to) = (first.min(outer), last.max(outer));
            !self.row_agrees(from, to - from, room)
                || rule.is_flat(&ends, self.values[outer], Beyond::of(first, last, outer))
        };
        if rule.are_close(&ends, room) && self.row_agrees(first, length, room) && is_flat() {
            self.interpolate([first, last], [first, length], &Curve::line(ends, length), disc);
        } else {
            self.want(first + length / 2);
            if length > 2 {
                self.groups.push(Group { is_halved: true, ..Group::new([first, last, outer]) });
            }
        }
    }

    /// Interpolates what lies between two pixels of a group.
    #[inline(always)]
    fn interpolate(
        &mut self,
        [from, to]: [usize; 2],
        [first, length]: [usize; 2],
        curve: &Curve,
        disc: f32,
    ) {
        for pixel in from + 1..to {
            self.values[pixel] = curve.at(pixel - first, length);
            self.discs[pixel] = disc;
        }
    }

    /// Whether so many pixels after the first one agree with it, given the `room` between them.
    #[inline(always)]
    fn row_agrees(&self, first: usize, length: usize, room: Room) -> bool {
        let all = ((1 << length) - 1) << (first % TILE);
        let agree = |same: &Bits| u32::from(same[first / TILE]) & all == all;
        agree(&self.same_object[0]) && (room.is_within_penumbra || agree(&self.same_hard[0]))
    }

    /// Compares each pixel with its neighbours.
    #[inline(always)]
    fn compare(&mut self, keys: &Keys<'_>) {
        let objects = keys.objects;
        let (mut right, mut down) = ([0; COUNT], [0; COUNT]);
        for i in 0..COUNT - 1 {
            right[i] = u8::from(objects[i] == objects[i + 1]);
        }
        for i in 0..COUNT - TILE {
            down[i] = u8::from(objects[i] == objects[i + TILE]);
        }
        self.same_object = [rows_of_bits(&right), rows_of_bits(&down)];
        for y in 0..TILE {
            let below = (y + 1).min(TILE - 1);
            let right = |bits: &Bits| !(bits[y] ^ bits[y] >> 1);
            let down = |bits: &Bits| !(bits[y] ^ bits[below]);
            // The last pixel of a row has no next one.
            self.same_object[0][y] &= right(&keys.needed) & u16::MAX >> 1;
            self.same_object[1][y] &= down(&keys.needed);
            self.same_hard[0][y] = right(&keys.hard);
            self.same_hard[1][y] = down(&keys.hard);
        }
    }

    /// Asks for a pixel, unless its value does not matter.
    #[inline(always)]
    fn want(&mut self, pixel: usize) {
        let bit = 1 << (pixel % TILE);
        if self.needed[pixel / TILE] & bit != 0 {
            self.searched[pixel / TILE] |= bit;
            self.wanted.push(pixel as u8);
        }
    }
}
