//! The outline of the blockers in a square part of the map, as few straight segments.
//!
//! A cell is the square between the centres of 9 x 9 texels. Where the outline enters and leaves it
//! once, it is replaced by a straight segment from the one place to the other, or by two segments
//! that leave the blocked area as large as it is. Any other cell is cut into four, for which the
//! same is tried, and failing that the outline is that of marching squares, between four texels
//! each. On the sides of all these squares the outline stays where it is, hence it stays closed.
//!
//! That makes a search cheap however many texels it spans, and slanted edges straight instead of
//! stepped.

use super::field::{Field, Texel};
use super::kernels::{Bits, ROWS};
use super::segments::{Segment, Segments, Vertex};
use super::squares::{CORNERS, PIECES};

/// Places between four texels along each side of a cell.
pub(crate) const CELL: usize = 8;

/// Which texels of a cell block, as the left columns of a block of texels.
pub(crate) type CellBits = Bits;

/// The greatest difference of the blockers' nearness at the two ends of an outline that is
/// replaced, relative to the lesser one.
pub(crate) const SAME_LAYER: f32 = 1.0 / 32.0;

/// How far two segments may stray from the straight connection, relative to its length.
const GREATEST_BULGE: f32 = 0.25;

/// The area in texels up to which one segment does for two.
const SMALL_AREA: f32 = 0.5;

/// Whether all texels of a cell block, or none.
#[inline(always)]
pub(crate) fn is_uniform(bits: &CellBits) -> bool {
    let (any, all) = bits.any_and_all();
    any == 0 || all == (2 << CELL) - 1
}

/// Adds the outline within the cell whose first texel is `at` to `segments`.
pub(crate) fn outline<T: Texel>(
    field: &Field<'_, T>,
    at: [i32; 2],
    bits: &CellBits,
    segments: &mut Segments,
) {
    let cell = Cell { field, at, bits };
    if cell.add_simple(&cell.whole(), segments) {
        return;
    }
    let mut room = [[0.0; CELL + 1]; CELL + 1];
    let texels = field.rows(at, &mut room);
    for (x, y) in [(0, 0), (HALF, 0), (0, HALF), (HALF, HALF)] {
        let part = cell.quarter(x, y);
        if !cell.add_simple(&part, segments) {
            cell.add_pieces(&part, &texels, segments);
        }
    }
}

/// Places along each side of the parts that a cell is cut into.
const HALF: usize = CELL / 2;

/// What a cell's outline is made from.
struct Cell<'a, T> {
    field: &'a Field<'a, T>,
    /// The first texel.
    at: [i32; 2],
    bits: &'a CellBits,
}

/// A cell or a part of it, with `SIZE` places along each side: one less than texels.
struct Square<const SIZE: usize> {
    /// The first texel, in the cell.
    x: usize,
    y: usize,
    /// Texels along the sides, clockwise from the first. Bit i: whether texel i blocks.
    ring: u32,
    /// How many texels block.
    count: u32,
}

impl<T: Texel> Cell<'_, T> {
    /// All of the cell.
    #[inline(always)]
    fn whole(&self) -> Square<CELL> {
        let Bits { words: [upper, lower], last } = *self.bits;
        let last = u32::from(last);
        // The least significant bits of a word's four rows, side by side.
        let column = |word: u64| (word & ROWS).wrapping_mul(1 << 48 | 1 << 33 | 1 << 18 | 1 << 3);
        let column = |x: usize| {
            let [upper, lower] = [column(upper >> x) >> 48, column(lower >> x) >> 48];
            upper as u32 & 0xf | (lower as u32 & 0xf) << 4
        };
        let top = upper as u32 & 0xff;
        let bottom = (last >> 1).reverse_bits() >> 24;
        let left = (column(0) >> 1 | (last & 1) << 7).reverse_bits() >> 24;
        Square {
            x: 0,
            y: 0,
            ring: top | column(CELL) << 8 | bottom << 16 | left << 24,
            count: upper.count_ones() + lower.count_ones() + last.count_ones(),
        }
    }

    /// A quarter of the cell.
    #[inline(always)]
    fn quarter(&self, x: usize, y: usize) -> Square<HALF> {
        const SIDE: u32 = (1 << HALF) - 1;
        let (mut right, mut left, mut all) = (0, 0, 0_u32);
        let row = |i: usize| u32::from(self.bits.row(y + i)) >> x & (2 * SIDE + 1);
        for i in 0..=HALF {
            let row = row(i);
            right |= (row >> HALF) << i;
            left |= (row & 1) << (HALF - i);
            all |= row << (i * (HALF + 1));
        }
        let top = row(0) & SIDE;
        let bottom = (row(HALF) >> 1).reverse_bits() >> (32 - HALF);
        Square {
            x,
            y,
            ring: top | (right & SIDE) << HALF | bottom << (2 * HALF) | (left & SIDE) << (3 * HALF),
            count: all.count_ones(),
        }
    }

    #[inline(always)]
    fn nearness(&self, [x, y]: [usize; 2]) -> f32 {
        self.field.nearness(self.at[0] + x as i32, self.at[1] + y as i32)
    }

    /// The vertex (x, y) texels from the centre of the first one.
    #[inline(always)]
    fn vertex(&self, [x, y]: [f32; 2], nearness: f32) -> Vertex {
        Vertex { x: (self.at[0] as f32 + 0.5) + x, y: (self.at[1] as f32 + 0.5) + y, nearness }
    }

    /// Adds the pieces between any four texels.
    fn add_pieces<const SIZE: usize>(
        &self,
        square: &Square<SIZE>,
        texels: &[&[f32; CELL + 1]; CELL + 1],
        segments: &mut Segments,
    ) {
        for y in square.y..square.y + SIZE {
            let (upper, lower) = (self.bits.row(y) >> square.x, self.bits.row(y + 1) >> square.x);
            let differs = (upper ^ lower) | (upper ^ upper >> 1) | (lower ^ lower >> 1);
            let mut places = differs & ((1 << SIZE) - 1);
            while places != 0 {
                let i = places.trailing_zeros();
                places &= places - 1;
                let (two, next) = (upper >> i & 3, lower >> i & 3);
                let (pieces, count) = &PIECES[usize::from(two | next >> 1 << 2 | (next & 1) << 3)];
                let x = square.x + i as usize;
                for piece in &pieces[..*count] {
                    let vertex = |end: usize| {
                        let ([dx, dy], [i, j]) = (piece.ends[end], CORNERS[piece.blockers[end]]);
                        let nearness = texels[y + j][x + i];
                        self.vertex([x as f32 + dx, y as f32 + dy], nearness)
                    };
                    segments.push(Segment { from: vertex(0), to: vertex(1) });
                }
            }
        }
    }

    /// Adds the one or two segments that stand for all of a square's outline, or none if there is
    /// none; false if none may.
    #[inline(always)]
    fn add_simple<const SIZE: usize>(
        &self,
        square: &Square<SIZE>,
        segments: &mut Segments,
    ) -> bool {
        let Some([enter, leave]) = square.crossings() else {
            return square.count == 0 || square.count as usize == (SIZE + 1) * (SIZE + 1);
        };
        let len = Square::<SIZE>::RING;
        let before = |i: usize| if i == 0 { len - 1 } else { i - 1 };
        let near = [self.nearness(square.texel(enter)), self.nearness(square.texel(before(leave)))];
        let same_layer = (near[0] - near[1]).abs() <= SAME_LAYER * near[0].min(near[1]);
        if !same_layer {
            return false;
        }
        // The ends, seen from the middle of the square.
        let middle = SIZE as f32 * 0.5;
        let end = |i: usize| {
            let ([ax, ay], [bx, by]) = (square.texel(before(i)), square.texel(i));
            let [x, y] = [(ax + bx) as f32, (ay + by) as f32];
            [x * 0.5 - (square.x as f32 + middle), y * 0.5 - (square.y as f32 + middle)]
        };
        let ([ax, ay], [bx, by]) = (end(enter), end(leave));
        // What blocks beyond what would with a straight connection: the sector around the middle
        // that the ring's blocking run makes, and a triangle.
        let run = if leave > enter { leave - enter } else { leave + len - enter };
        let straight = 0.5 * (middle * run as f32 + (bx * ay - ax * by));
        let area = square.area() - straight;
        let (dx, dy) = (bx - ax, by - ay);
        let bulge = 2.0 * area / (dx * dx + dy * dy);
        if bulge.abs() > GREATEST_BULGE {
            return false;
        }
        let vertex = |x: f32, y: f32, nearness: f32| {
            let [left, top] = [square.x as f32 + middle, square.y as f32 + middle];
            self.vertex([left + x, top + y], nearness)
        };
        let (from, to) = (vertex(ax, ay, near[0]), vertex(bx, by, near[1]));
        if area.abs() <= SMALL_AREA {
            segments.push(Segment { from, to });
        } else {
            let x = ((ax + bx) * 0.5 - bulge * dy).clamp(-middle, middle);
            let y = ((ay + by) * 0.5 + bulge * dx).clamp(-middle, middle);
            let between = vertex(x, y, (near[0] + near[1]) * 0.5);
            segments.push(Segment { from, to: between });
            segments.push(Segment { from: between, to });
        }
        true
    }
}

impl<const SIZE: usize> Square<SIZE> {
    /// Texels along the sides.
    const RING: usize = 4 * SIZE;

    /// Column and row, in the cell, of a texel of the ring.
    #[inline(always)]
    fn texel(&self, i: usize) -> [usize; 2] {
        let along = i % SIZE;
        let [x, y] = match i / SIZE {
            0 => [along, 0],
            1 => [SIZE, along],
            2 => [SIZE - along, SIZE],
            _ => [0, SIZE - along],
        };
        [self.x + x, self.y + y]
    }

    /// The first texel of the only run of the ring that blocks, and the first after it; `None` if
    /// there is not exactly one.
    #[inline(always)]
    fn crossings(&self) -> Option<[usize; 2]> {
        let previous = (self.ring << 1 | self.ring >> (Self::RING - 1))
            & u32::MAX >> (u32::BITS as usize - Self::RING);
        let (enter, leave) = (self.ring & !previous, previous & !self.ring);
        let ends = [enter.trailing_zeros() as usize, leave.trailing_zeros() as usize];
        (enter.is_power_of_two() && leave.is_power_of_two()).then_some(ends)
    }

    /// The blocked area: a texel is a square around its centre, cut off by the sides.
    #[inline(always)]
    fn area(&self) -> f32 {
        let corners = (0..4).map(|side| self.ring >> (side * SIZE) & 1).sum::<u32>();
        (4 * self.count - 2 * self.ring.count_ones() - corners) as f32 * 0.25
    }
}
