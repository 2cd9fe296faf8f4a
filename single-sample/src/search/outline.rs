//! Finding the outline of the blockers in a part of the map.

use super::field::{BLOCK_COLUMNS, BLOCK_ROWS, Field, LANE, Test, Texel};
use super::kernels::Ops;
use super::segments::{PIECES, Segments};

/// A box of places between four texels each: place (x, y) has texel (x, y) at its upper left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Places {
    pub columns: [i32; 2],
    pub rows: [i32; 2],
}

impl Places {
    /// Texel coordinates around all texels of the places.
    pub fn corners(&self) -> [[f32; 2]; 4] {
        let [left, right] = [self.columns[0] as f32, self.columns[1] as f32 + 1.0];
        let [top, bottom] = [self.rows[0] as f32, self.rows[1] as f32 + 1.0];
        [[left, top], [right, top], [left, bottom], [right, bottom]]
    }
}

/// How an attempt at an outline ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All of it was found.
    Complete,
    /// Some texel blocks some of the receivers and not others.
    Ambiguous,
    /// There was no room for all of it.
    Full,
}

/// Places in a row that are looked at together.
pub(crate) const STRIP: i32 = 48;

/// Adds the outline within `places`, no more than [`STRIP`] columns and a block's rows, to
/// `segments`: that of the texels which pass `test`. If some that do not pass `doubt`, the
/// attempt ends.
#[inline(always)]
pub(crate) fn outline<T: Texel>(
    ops: &impl Ops,
    field: &Field<'_, T>,
    test: &Test,
    doubt: Option<&Test>,
    places: Places,
    segments: &mut Segments,
) -> Outcome {
    let [left, right] = places.columns;
    let [top, bottom] = places.rows;
    let (columns, rows) = (right - left, (bottom - top) as usize);
    // Places reach to the texel after them.
    let used = u64::MAX >> (63 - columns);
    let mut room = [LANE; BLOCK_ROWS];
    let mut blocking = [0_u64; BLOCK_ROWS];
    let mut x = 0;
    while x <= columns {
        let block = field.block(left + x, top, &mut room);
        let found = ops.blocking(test, &block);
        for y in 0..BLOCK_ROWS {
            blocking[y] |= u64::from(found[y]) << x;
        }
        if let Some(doubt) = doubt {
            let sure = ops.blocking(doubt, &block);
            for y in 0..=rows {
                if u64::from(found[y] ^ sure[y]) << x & used != 0 {
                    return Outcome::Ambiguous;
                }
            }
        }
        x += BLOCK_COLUMNS as i32;
    }
    for y in 0..rows {
        let (upper, lower) = (blocking[y], blocking[y + 1]);
        let differs = (upper ^ lower) | (upper ^ upper >> 1) | (lower ^ lower >> 1);
        let mut places = differs & used >> 1;
        while places != 0 {
            let i = places.trailing_zeros();
            places &= places - 1;
            let (two, next) = (upper >> i & 3, lower >> i & 3);
            let code = (two | next >> 1 << 2 | (next & 1) << 3) as usize;
            if segments.is_full() {
                return Outcome::Full;
            }
            add(field, left + i as i32, top + y as i32, code, segments);
        }
    }
    Outcome::Complete
}

#[inline(always)]
fn add<T: Texel>(field: &Field<'_, T>, x: i32, y: i32, code: usize, segments: &mut Segments) {
    let (pieces, count) = &PIECES[code];
    for piece in &pieces[..*count] {
        let [a, b] =
            piece.blockers.map(|[dx, dy]| field.nearness(x + i32::from(dx), y + i32::from(dy)));
        let [dx, dy] = piece.middle;
        let middle = [(x as f32 + 0.5) + dx, (y as f32 + 0.5) + dy];
        segments.push(middle, piece.half, (a + b) * 0.5);
    }
}
