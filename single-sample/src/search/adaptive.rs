//! Adaptive sampling (Brabec and Seidel 2002, section 4.3), within one tile of the image.
//!
//! Unlike in the paper, not only the keys of a group's pixels decide whether it is interpolated, but
//! also the values: those of the ends, and where these differ, that of the middle. And where a group
//! is longer than the discs of its ends are wide, a whole penumbra may lie between them: there the
//! middle is asked for in any case.

use super::soa::Receivers;
use crate::math::sqrt;

/// Pixels along each side of a tile.
pub(crate) const TILE: usize = 16;
/// Pixels of a tile.
pub(crate) const COUNT: usize = TILE * TILE;

/// A pixel that needs no search.
pub(crate) const NO_KEY: u32 = 0;

/// The blocked fractions of a tile's pixels, searched or interpolated.
///
/// Pixels are asked for in rounds: [`Samples::begin`] asks for the first, and as long as
/// [`Samples::wanted`] are searched, [`Samples::refine`] asks for more.
pub(crate) struct Samples {
    /// What pixels must have in common to be interpolated: the object and the hard shadow test.
    /// [`NO_KEY`] for those whose value does not matter.
    pub keys: [u32; COUNT],
    pub values: [f32; COUNT],
    /// A radius in texels which the light's disc has at least at any blocker that may hide part of
    /// it, from there or from the pixels that were interpolated.
    pub discs: [f32; COUNT],
    wanted: [u8; COUNT],
    wanted_len: usize,
    known: Bits,
    /// Which values come from a search.
    pub searched: Bits,
    /// Which pixels have the key of the next one in the row, and of the one below.
    same: [Bits; 2],
    /// Groups to be looked at, and those they are split into.
    open: [[Group; COUNT]; 2],
    side: usize,
    open_len: usize,
}

/// Of pixel (x, y), bit x of element y.
pub(crate) type Bits = [u16; TILE];

/// Pixels in a line, the first and the last of which are known or wanted.
#[derive(Clone, Copy)]
struct Group {
    first: u8,
    last: u8,
    /// From one to the next: 1 along a row, [`TILE`] along a column.
    step: u8,
    /// Whether the one in the middle is, too.
    is_halved: bool,
}

/// How far the middle of a group may be from the straight line between its ends, relative to the
/// greatest difference of these.
const BEND: f32 = 0.5;

/// When pixels between two others are interpolated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Pixels of the tile, at most [`TILE`] along each side.
    pub width: usize,
    pub height: usize,
    /// Pixels from one searched column to the next.
    pub group: usize,
    /// The greatest difference of the two ends.
    pub tolerance: f32,
}

impl Grid {
    /// The next searched pixel of a line of `count`.
    fn next(&self, at: usize, count: usize) -> usize {
        (at + self.group).min(count - 1)
    }
}

/// When a group is interpolated without a look at its middle.
struct Rule<'a> {
    tolerance: f32,
    receivers: &'a Receivers,
}

impl Rule<'_> {
    /// Texels from one pixel's place in the map to another's.
    #[inline(always)]
    fn distance(&self, first: usize, last: usize) -> f32 {
        let Receivers { u, v, .. } = self.receivers;
        let (du, dv) = (u[last] - u[first], v[last] - v[first]);
        sqrt(du * du + dv * dv)
    }
}

impl Samples {
    pub const fn new() -> Samples {
        Samples {
            keys: [NO_KEY; COUNT],
            values: [0.0; COUNT],
            discs: [f32::INFINITY; COUNT],
            wanted: [0; COUNT],
            wanted_len: 0,
            known: [0; TILE],
            searched: [0; TILE],
            same: [[0; TILE]; 2],
            open: [[Group { first: 0, last: 0, step: 0, is_halved: false }; COUNT]; 2],
            side: 0,
            open_len: 0,
        }
    }

    /// The pixels to be searched now.
    pub fn wanted(&self) -> &[u8] {
        &self.wanted[..self.wanted_len]
    }

    /// Asks for the ends of all groups along every `group`-th column.
    #[inline(always)]
    pub fn begin(&mut self, grid: &Grid) {
        self.compare_keys();
        (self.known, self.searched) = ([0; TILE], [0; TILE]);
        self.values = [0.0; COUNT];
        self.discs = [f32::INFINITY; COUNT];
        self.wanted_len = 0;
        self.open_len = 0;
        let mut x = 0;
        loop {
            self.want(x);
            let mut y = 0;
            while y + 1 < grid.height {
                let next = grid.next(y, grid.height);
                self.want(next * TILE + x);
                self.open(y * TILE + x, next * TILE + x, TILE, false);
                y = next;
            }
            if x + 1 >= grid.width {
                return;
            }
            x = grid.next(x, grid.width);
        }
    }

    /// Interpolates what the pixels searched so far allow, and asks for the middles of the other
    /// groups. False once there are none; columns and rows each end that way.
    pub fn refine(&mut self, grid: &Grid, receivers: &Receivers) -> bool {
        self.wanted_len = 0;
        let count = self.open_len;
        if count == 0 {
            return false;
        }
        let rule = Rule { tolerance: grid.tolerance, receivers };
        let side = self.side;
        (self.side, self.open_len) = (1 - side, 0);
        for i in 0..count {
            let group = self.open[side][i];
            match group.step {
                1 => self.settle::<1>(group, &rule),
                _ => self.settle::<TILE>(group, &rule),
            }
        }
        true
    }

    /// Interpolates a group or asks for its middle; once that is known, looks at both halves.
    #[inline(always)]
    fn settle<const STEP: usize>(&mut self, group: Group, rule: &Rule<'_>) {
        let (first, last) = (usize::from(group.first), usize::from(group.last));
        let length = (last - first) / STEP;
        if !group.is_halved {
            return self.halve::<STEP>(first, last, false, rule);
        }
        let middle = first + length / 2 * STEP;
        let [start, between, stop] = [first, middle, last].map(|pixel| self.values[pixel]);
        let straight = start + (stop - start) / length as f32 * (length / 2) as f32;
        let is_straight = (between - straight).abs() <= rule.tolerance * BEND
            && self.agrees::<STEP>(first, length);
        self.halve::<STEP>(first, middle, is_straight, rule);
        self.halve::<STEP>(middle, last, is_straight, rule);
    }

    /// Interpolates between two pixels if that is known to be `fine` or their values are close and
    /// nothing fits between them, else asks for the one in their middle.
    #[inline(always)]
    fn halve<const STEP: usize>(&mut self, first: usize, last: usize, fine: bool, rule: &Rule<'_>) {
        let length = (last - first) / STEP;
        if length <= 1 {
            return;
        }
        let (start, stop) = (self.values[first], self.values[last]);
        let disc = self.discs[first].min(self.discs[last]);
        let is_close = (stop - start).abs() <= rule.tolerance
            && self.agrees::<STEP>(first, length)
            && disc >= rule.distance(first, last);
        if fine | is_close {
            let slope = (stop - start) / length as f32;
            for i in 1..length {
                let pixel = first + i * STEP;
                self.values[pixel] = start + slope * i as f32;
                self.discs[pixel] = disc;
                self.known[pixel / TILE] |= 1 << (pixel % TILE);
            }
        } else {
            self.want(first + length / 2 * STEP);
            if length > 2 {
                self.open(first, last, STEP, true);
            }
        }
    }

    /// Whether so many pixels after the first one have its key.
    #[inline(always)]
    fn agrees<const STEP: usize>(&self, first: usize, length: usize) -> bool {
        let (x, y) = (first % TILE, first / TILE);
        if STEP == 1 {
            let all = ((1 << length) - 1) << x;
            u32::from(self.same[0][y]) & all == all
        } else {
            let column = &self.same[1][y..y + length];
            column.iter().fold(u16::MAX, |all, row| all & row) >> x & 1 == 1
        }
    }

    #[inline(always)]
    fn compare_keys(&mut self) {
        let keys = self.keys.as_chunks::<TILE>().0;
        for y in 0..TILE {
            let (row, below) = (&keys[y], &keys[(y + 1).min(TILE - 1)]);
            let (mut right, mut down) = (0, 0);
            for x in 0..TILE {
                down |= u16::from(row[x] == below[x]) << x;
            }
            for x in 0..TILE - 1 {
                right |= u16::from(row[x] == row[x + 1]) << x;
            }
            (self.same[0][y], self.same[1][y]) = (right, down);
        }
    }

    /// After the columns: the groups along all rows between them.
    pub fn begin_rows(&mut self, grid: &Grid) {
        self.wanted_len = 0;
        self.open_len = 0;
        for row in 0..grid.height {
            let mut x = 0;
            while x + 1 < grid.width {
                let next = grid.next(x, grid.width);
                self.open(row * TILE + x, row * TILE + next, 1, false);
                x = next;
            }
        }
    }

    fn open(&mut self, first: usize, last: usize, step: usize, is_halved: bool) {
        self.open[self.side][self.open_len] =
            Group { first: first as u8, last: last as u8, step: step as u8, is_halved };
        self.open_len += 1;
    }

    fn want(&mut self, pixel: usize) {
        let (row, bit) = (pixel / TILE, 1 << (pixel % TILE));
        if self.known[row] & bit == 0 {
            self.known[row] |= bit;
            if self.keys[pixel] != NO_KEY {
                self.searched[row] |= bit;
                self.wanted[self.wanted_len] = pixel as u8;
                self.wanted_len += 1;
            }
        }
    }
}
