//! Texels that cannot be the answer, because another one is closer to every receiver.
//!
//! A tile is a word of 128 bits here: 16 for each row, the first row in the lowest.

use crate::leaf::larger;
use crate::map::{COLUMNS, ROWS};
use crate::reach::Reach;

/// The texels of a tile that another one precedes for every receiver: one in the same row or
/// column, between the texel and the receivers, that counts for all of them.
#[inline(always)]
pub(crate) fn preceded(reach: &Reach, x: u32, y: u32, sure: u128) -> u128 {
    let [left, right] = sides(reach.u, x, COLUMNS as u32);
    let [above, below] = sides(reach.v, y, ROWS as u32);
    let columns = |bits: u32| u128::from(bits as u16) * EACH_ROW;
    let up_to = |columns: u32| (1 << columns) - 1;

    let s = sure & columns(up_to(left));
    let mut before = s >> 1 & columns(0x7fff);
    before |= before >> 1 & columns(0x7fff);
    before |= before >> 2 & columns(0x3fff);
    before |= before >> 4 & columns(0x0fff);
    before |= before >> 8 & columns(0x00ff);

    let s = sure & columns(!up_to(right));
    let mut after = s << 1 & columns(!0x1);
    after |= after << 1 & columns(!0x1);
    after |= after << 2 & columns(!0x3);
    after |= after << 4 & columns(!0xf);
    after |= after << 8 & columns(!0xff);

    let whole = |rows: u32| if rows == ROWS as u32 { u128::MAX } else { (1 << (16 * rows)) - 1 };
    let mut higher = (sure & whole(above)) >> 16;
    higher |= higher >> 16;
    higher |= higher >> 32;
    higher |= higher >> 64;
    let mut lower = (sure & !whole(below)) << 16;
    lower |= lower << 16;
    lower |= lower << 32;
    lower |= lower << 64;
    before | after | higher | lower
}

/// One bit in each row of a tile.
const EACH_ROW: u128 = 0x0001_0001_0001_0001_0001_0001_0001_0001;

/// Of a tile's columns, whose first is `first`, or of its rows: how many lie before all
/// receivers, and which is the first that lies behind all of them.
#[inline(always)]
fn sides([from, to]: [f32; 2], first: u32, size: u32) -> [u32; 2] {
    // These casts saturate. Differences are exact where they matter.
    let first = first as f32 + 0.5;
    let before = (from - first) as u32;
    let before = if from >= first { before.saturating_add(1) } else { 0 };
    let behind = (to - first) as u32;
    let behind = behind.saturating_add(u32::from((behind as f32) < to - first));
    [before.min(size), behind.min(size)]
}

/// Whether a texel that counts for all receivers, at `sure`, is closer to each of them than any place
/// in a box from `low` to `high`, by more than distances are rounded.
#[inline(always)]
pub(crate) fn precedes_box(reach: &Reach, sure: [f32; 2], low: [f32; 2], high: [f32; 2]) -> bool {
    // By how much the square of one distance exceeds that of the other is a sum of one term for
    // each axis. For every place of the box it is linear in the receiver's coordinate, hence
    // greatest where the receivers end.
    let (mut excess, mut room) = (0.0, 0.0);
    for (axis, ends) in [reach.u, reach.v].into_iter().enumerate() {
        let mut terms = [0.0; 2];
        for end in 0..2 {
            let at = ends[end];
            let to_box = larger(larger(low[axis] - at, at - high[axis]), 0.0);
            let squares = [(at - sure[axis]) * (at - sure[axis]), to_box * to_box];
            terms[end] = squares[0] - squares[1];
            room += squares[0] + squares[1];
        }
        excess += larger(terms[0], terms[1]);
    }
    excess < room * (-1.0 / 1048576.0)
}
