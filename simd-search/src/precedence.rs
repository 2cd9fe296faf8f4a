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

/// A texel that counts for all receivers.
#[derive(Clone, Copy)]
pub(crate) struct Sure {
    /// Where the receivers end: their least and greatest u, their least and greatest v.
    ends: [f32; 4],
    /// The texel's squared distances from there, along one axis.
    squares: [f32; 4],
    /// A difference of squared distances below this is less than nothing in spite of all rounding.
    less: f32,
}

impl Sure {
    /// The texel whose centre is (x, y).
    #[inline(always)]
    pub fn new(reach: &Reach, x: f32, y: f32) -> Sure {
        let ends = [reach.u[0], reach.u[1], reach.v[0], reach.v[1]];
        let mut squares = [0.0; 4];
        for i in 0..4 {
            let away = ends[i] - [x, x, y, y][i];
            squares[i] = away * away;
        }
        let most = larger(squares[0], squares[1]) + larger(squares[2], squares[3]);
        Sure { ends, squares, less: most * (-1.0 / 524288.0) }
    }

    /// Whether the texel is closer to each receiver than all others of a box, whose outermost
    /// texels have their centres at `u` and `v`.
    #[inline(always)]
    pub fn precedes_box(&self, u: [f32; 2], v: [f32; 2]) -> bool {
        // By how much the square of one distance exceeds that of another is a sum of one term for
        // each axis. For any place in the box it is linear in the receiver's coordinate, hence
        // greatest where the receivers end.
        let first = [u[0], u[0], v[0], v[0]];
        let last = [u[1], u[1], v[1], v[1]];
        let mut excess = [0.0; 4];
        for i in 0..4 {
            let gap = larger(larger(first[i] - self.ends[i], self.ends[i] - last[i]), 0.0);
            excess[i] = self.squares[i] - gap * gap;
        }
        larger(excess[0], excess[1]) + larger(excess[2], excess[3]) < self.less
    }
}
