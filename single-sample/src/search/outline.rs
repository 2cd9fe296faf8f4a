//! Which texels block, cell by cell.

use super::cell::{CELL, CellBits};
use super::facing::{Surroundings, close_to};
use super::field::{BLOCK_COLUMNS, BLOCK_ROWS, Block, Field, LANE, Row, Texel};
use super::kernels::{Bits, Ops, ROWS};
use super::leaves::Leaves;
use super::reach::Extent;
use super::texel_test::{Limits, Test};

/// A box of places between four texels each: place (x, y) has texel (x, y) at its upper left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Places {
    pub columns: [i32; 2],
    pub rows: [i32; 2],
}

impl Places {
    /// Whether they hold a cell, given by its first texel.
    #[inline(always)]
    pub fn hold(&self, [x, y]: [i32; 2]) -> bool {
        let ([left, right], [top, bottom]) = (self.columns, self.rows);
        (left <= x) & (x < right) & (top <= y) & (y < bottom)
    }
}

impl Places {
    /// Two halves of them.
    #[inline(always)]
    pub fn halves(self) -> [Places; 2] {
        let middle = |[from, end]: [i32; 2]| {
            let cells = (end - from) / CELL as i32;
            from + cells / 2 * CELL as i32
        };
        let (Places { columns, rows }, mut first, mut second) = (self, self, self);
        if columns[1] - columns[0] > rows[1] - rows[0] {
            first.columns[1] = middle(columns);
            second.columns[0] = first.columns[1];
        } else {
            first.rows[1] = middle(rows);
            second.rows[0] = first.rows[1];
        }
        [first, second]
    }
}

/// Places in a row that are looked at together.
pub(crate) const STRIP: i32 = 48;

/// Blocks of texels that a strip touches.
const BLOCKS: usize = STRIP as usize / BLOCK_COLUMNS + 1;

/// Memory for texels that cannot be borrowed from the map, and for what becomes of them.
pub(crate) struct Room {
    block: [Row; BLOCK_ROWS],
    facing: FacingRoom,
}

struct FacingRoom {
    surroundings: [[f32; Surroundings::COLUMNS]; Surroundings::ROWS],
    unfaced: [[Row; BLOCK_ROWS]; 2],
}

impl Room {
    pub const fn new() -> Room {
        let surroundings = [[0.0; Surroundings::COLUMNS]; Surroundings::ROWS];
        let facing = FacingRoom { surroundings, unfaced: [[LANE; BLOCK_ROWS]; 2] };
        Room { block: [LANE; BLOCK_ROWS], facing }
    }
}

/// A row of cells, and which of its texels pass each of some tests.
pub(crate) struct Strip<const TESTS: usize> {
    first: [i32; 2],
    cells: usize,
    passing: [[Bits; TESTS]; BLOCKS],
}

impl<const TESTS: usize> Strip<TESTS> {
    /// Tests the texels of `places`: whole cells, no more than [`STRIP`] columns and one row of
    /// cells.
    #[inline(always)]
    pub fn new<T: Texel>(
        ops: &impl Ops,
        field: &Field<'_, T>,
        tests: &[Test; TESTS],
        extent: &Extent,
        leaves: &Leaves,
        places: Places,
        room: &mut Room,
    ) -> Strip<TESTS> {
        let ([left, right], top) = (places.columns, places.rows[0]);
        let mut passing = [[Bits::default(); TESTS]; BLOCKS];
        // Places reach to the texel after them.
        for (x, passing) in (left..=right).step_by(BLOCK_COLUMNS).zip(&mut passing) {
            let close = leaves.are_close([x, top]).then_some(extent);
            *passing = blocking(ops, field, [x, top], tests, close, room);
        }
        Strip { first: [left, top], cells: (right - left) as usize / CELL, passing }
    }

    /// How many cells there are.
    #[inline(always)]
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// The first texel of a cell, and which of its texels pass each test; `None` if all texels pass
    /// all tests, or none passes any.
    #[inline(always)]
    pub fn divided(&self, i: usize) -> Option<([i32; 2], [CellBits; TESTS])> {
        let mut bits = [Bits::default(); TESTS];
        let (mut any, mut all) = (0, CELL_TEXELS);
        for test in 0..TESTS {
            let [block, next] = [&self.passing[i / 2][test], &self.passing[i / 2 + 1][test]];
            bits[test] = cell_of_blocks(block, next, i % 2);
            let found = bits[test].any_and_all();
            any |= found.0;
            all &= found.1;
        }
        let at = [self.first[0] + (i * CELL) as i32, self.first[1]];
        (any != 0 && all != CELL_TEXELS).then_some((at, bits))
    }
}

/// Texels of a cell along a row.
pub(crate) const CELL_TEXELS: u16 = (2 << CELL) - 1;

/// The left or the right cell of a block. The right one has its last column from the next block.
#[inline(always)]
fn cell_of_blocks(block: &Bits, next: &Bits, right: usize) -> CellBits {
    if right == 0 {
        block.each(next, |block, _| block & (ROWS * CELL_TEXELS as u64))
    } else {
        block.each(next, |block, next| (block >> CELL & (ROWS * 0xff)) | (next & ROWS) << CELL)
    }
}

/// Which texels of a cell block the receiver in `extent` that has this test; none if none of them
/// is in `reach` ([`Test::in_reach`]).
#[inline(always)]
pub(crate) fn cell_bits<T: Texel>(
    ops: &impl Ops,
    field: &Field<'_, T>,
    test: &Test,
    reach: Option<&Test>,
    close: Option<&Extent>,
    at: [i32; 2],
    room: &mut Room,
) -> CellBits {
    let block = field.block(at, &mut room.block);
    let cell = |block: &Bits| cell_of_blocks(block, block, 0);
    let limits = test.limits(block.first);
    let passing = ops.passing(&limits, &block.rows);
    if cell(&passing) == CellBits::NONE {
        return CellBits::NONE;
    }
    if let Some(reach) = reach {
        let within = ops.passing(&reach.limits(block.first), &block.rows);
        if cell(&within) == CellBits::NONE {
            return CellBits::NONE;
        }
    }
    let [passing] = match close {
        Some(extent) => {
            unfaced(ops, field, &[limits], [passing], at, &block, extent, &mut room.facing)
        }
        None => [passing],
    };
    cell(&passing)
}

/// Which texels of a block pass the tests and do not face the receivers, of which some may be
/// `close` to blockers.
#[inline(always)]
fn blocking<T: Texel, const TESTS: usize>(
    ops: &impl Ops,
    field: &Field<'_, T>,
    at: [i32; 2],
    tests: &[Test; TESTS],
    close: Option<&Extent>,
    room: &mut Room,
) -> [Bits; TESTS] {
    let block = field.block(at, &mut room.block);
    let mut limits = [tests[0].limits(block.first); TESTS];
    for test in 1..TESTS {
        limits[test] = tests[test].limits(block.first);
    }
    let mut passing = [Bits::default(); TESTS];
    for test in 0..TESTS {
        passing[test] = ops.passing(&limits[test], &block.rows);
    }
    // What passes another test passes the first.
    match close.filter(|_| passing[0] != Bits::default()) {
        Some(extent) => unfaced(ops, field, &limits, passing, at, &block, extent, &mut room.facing),
        None => passing,
    }
}

/// What is left of the passing texels of a block without those that face the receivers.
#[inline(always)]
fn unfaced<T: Texel, const TESTS: usize>(
    ops: &impl Ops,
    field: &Field<'_, T>,
    limits: &[Limits; TESTS],
    mut passing: [Bits; TESTS],
    at: [i32; 2],
    block: &Block<'_>,
    extent: &Extent,
    room: &mut FacingRoom,
) -> [Bits; TESTS] {
    let most = extent.nearness[1];
    let beyond = Limits { nearness: most + close_to(field.contact, most), ..limits[0] };
    let far = ops.passing(&beyond, &block.rows);
    if far == passing[0] {
        return passing;
    }
    let close = passing[0].each(&far, |passing, far| passing & !far);
    let texels = field.rows(Surroundings::first(at), &mut room.surroundings);
    let (receivers, contact) = (extent, field.contact);
    let is_one = TESTS == 1;
    let around = Surroundings { at, texels, receivers, is_one, contact, close };
    ops.unfaced(&around, &mut room.unfaced);
    for test in 0..TESTS {
        passing[test] = ops.passing(&limits[test], &room.unfaced[test].each_ref());
    }
    passing
}
