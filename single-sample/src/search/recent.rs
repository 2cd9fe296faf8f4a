//! The outlines of cells that were looked at before.
//!
//! What a cell's outline is follows from its texels and from which of them block. Receivers side by
//! side mostly agree on these, within a tile and from one to the next.

use super::cell::{CELL, CellBits, outline};
use super::field::{Field, Texel};
use super::segments::{Bounds, CELL_MOST, Segment, Segments};

/// How many cells are remembered: two to the power of this. Few in tests, for some to be forgotten.
const CELLS_LOG: u32 = if cfg!(test) { 4 } else { 9 };
const CELLS: usize = 1 << CELLS_LOG;

/// How many segments all of them may have: no less than one cell.
const CAPACITY: usize = if cfg!(test) { CELL_MOST } else { 2048 };

/// A cell by its first texel, which of its texels block, and its range of the segments.
#[derive(Clone, Copy)]
struct Cell {
    at: [i32; 2],
    bits: CellBits,
    segments: [u16; 2],
    bounds: Bounds,
}

impl Cell {
    /// No outline, as is right for any cell where nothing blocks.
    const NONE: Cell =
        Cell { at: [0; 2], bits: CellBits::NONE, segments: [0; 2], bounds: Bounds::EMPTY };
}

/// The outlines of cells of one map that were asked for last.
pub(crate) struct Recent {
    /// Each in the one place it may have.
    cells: [Cell; CELLS],
    segments: [Segment; CAPACITY],
    len: usize,
}

impl Recent {
    pub const fn new() -> Recent {
        Recent { cells: [Cell::NONE; CELLS], segments: [Segment::NONE; CAPACITY], len: 0 }
    }

    /// Adds what [`outline`] does to `segments`, if that is wanted given its bounds. There must be
    /// room for it.
    #[inline(always)]
    pub fn outline<T: Texel>(
        &mut self,
        field: &Field<'_, T>,
        at: [i32; 2],
        bits: &CellBits,
        segments: &mut Segments,
        is_wanted: impl FnOnce(&Bounds) -> bool,
    ) {
        let place = place(at, bits);
        if self.cells[place].at != at || self.cells[place].bits != *bits {
            self.note(field, place, at, bits, segments);
        }
        let known = &self.cells[place];
        if is_wanted(&known.bounds) {
            let [from, end] = known.segments.map(usize::from);
            for segment in &self.segments[from..end] {
                segments.push(*segment);
            }
        }
    }

    /// Notes a cell's outline, which is found behind `segments`.
    fn note<T: Texel>(
        &mut self,
        field: &Field<'_, T>,
        place: usize,
        at: [i32; 2],
        bits: &CellBits,
        segments: &mut Segments,
    ) {
        let first = segments.len();
        outline(field, at, bits, segments);
        let count = segments.len() - first;
        if self.len + count > CAPACITY {
            self.cells = [Cell::NONE; CELLS];
            self.len = 0;
        }
        let from = self.len;
        let mut bounds = Bounds::EMPTY;
        for i in 0..count {
            let segment = segments.get(first + i);
            bounds.include(&segment);
            self.segments[from + i] = segment;
        }
        self.len += count;
        segments.truncate(first);
        let segments = [from as u16, self.len as u16];
        self.cells[place] = Cell { at, bits: *bits, segments, bounds };
    }
}

/// The place of a cell.
#[inline(always)]
fn place([x, y]: [i32; 2], bits: &CellBits) -> usize {
    const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;
    let [upper, lower] = bits.words;
    let cell = (x as u64 / CELL as u64) << 7 ^ (y as u64 / CELL as u64) << 23;
    let mixed =
        (upper ^ lower.rotate_left(17) ^ u64::from(bits.last) << 40 ^ cell).wrapping_mul(SPREAD);
    ((mixed ^ mixed >> 32).wrapping_mul(SPREAD) >> (u64::BITS - CELLS_LOG)) as usize
}
