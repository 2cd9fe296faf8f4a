//! The operations that every instruction set has functions of its own for, and the door to them.
//!
//! Everything else is plain Rust over arrays, which the compiler turns into the instructions of
//! the function it is inlined into. None of it depends on the width: the bits are the same.

use shadowmap_core::Level;

use super::facing::Surroundings;
use super::field::{BLOCK_ROWS, Row};
use super::texel_test::Limits;

#[cfg(target_feature = "sse2")]
mod avx2;
#[cfg(target_feature = "sse2")]
mod avx512;
#[cfg(target_feature = "sse2")]
mod sse41;

/// The first texel of each of the four rows in a word of [`Bits`].
pub(crate) const ROWS: u64 = 0x1_0001_0001_0001;

/// A bit per texel of a block, row by row: texel i of a row is bit i of the row's 16.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bits {
    /// Four rows each, the first one lowest.
    pub words: [u64; 2],
    pub last: u16,
}

impl Bits {
    pub const NONE: Bits = Bits { words: [0; 2], last: 0 };

    #[inline(always)]
    pub fn new(rows: [u16; BLOCK_ROWS]) -> Bits {
        let word = |first: usize| {
            let [a, b, c, d] = [rows[first], rows[first + 1], rows[first + 2], rows[first + 3]];
            (u64::from(a) | u64::from(b) << 16) | (u64::from(c) << 32 | u64::from(d) << 48)
        };
        Bits { words: [word(0), word(4)], last: rows[BLOCK_ROWS - 1] }
    }

    #[inline(always)]
    pub fn row(&self, y: usize) -> u16 {
        if y < 8 { (self.words[y / 4] >> (y % 4 * 16)) as u16 } else { self.last }
    }

    /// The same done to every row, which must not move bits from one row to another.
    #[inline(always)]
    pub fn each(&self, next: &Bits, change: impl Fn(u64, u64) -> u64) -> Bits {
        Bits {
            words: [change(self.words[0], next.words[0]), change(self.words[1], next.words[1])],
            last: change(u64::from(self.last), u64::from(next.last)) as u16,
        }
    }

    /// The texels of a row that are set in any row, and those that are set in all.
    #[inline(always)]
    pub fn any_and_all(&self) -> (u16, u16) {
        let any = self.words[0] | self.words[1];
        let all = self.words[0] & self.words[1];
        let (any, all) = (any | any >> 32, all & all >> 32);
        ((any | any >> 16) as u16 | self.last, (all & all >> 16) as u16 & self.last)
    }
}

/// Which of the texels of a block pass a test.
///
/// Each instruction set makes a closure inside a function with its target features: closures
/// have the features of the function they are made in, and everything between is
/// `#[inline(always)]`.
pub(crate) trait Ops {
    fn passing(&self, limits: &Limits, rows: &[&Row; BLOCK_ROWS]) -> Bits;

    /// [`Surroundings::unfaced`], which is too long to be inlined.
    fn unfaced(&self, block: &Surroundings<'_>, rows: &mut [[Row; BLOCK_ROWS]; 2]);
}

impl<P, U> Ops for (P, U)
where
    P: Fn(&Limits, &[&Row; BLOCK_ROWS]) -> Bits,
    U: Fn(&Surroundings<'_>, &mut [[Row; BLOCK_ROWS]; 2]),
{
    #[inline(always)]
    fn passing(&self, limits: &Limits, rows: &[&Row; BLOCK_ROWS]) -> Bits {
        self.0(limits, rows)
    }

    #[inline(always)]
    fn unfaced(&self, block: &Surroundings<'_>, rows: &mut [[Row; BLOCK_ROWS]; 2]) {
        self.1(block, rows);
    }
}

/// Something to be done with the operation of some instruction set, with everything in it
/// `#[inline(always)]`.
pub(crate) trait Work {
    fn run(self, ops: &impl Ops);
}

/// Does the work with the instructions of `level`, or in plain Rust where this crate has none by
/// hand.
#[allow(unsafe_code)]
// Not inlined, it would copy the work: whole vectors of what has just been written in pieces, which
// waits for all earlier writes.
#[inline(always)]
pub(crate) fn run(level: Level, work: impl Work) {
    match level.kind() {
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Sse41 => unsafe { sse41::run(work) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Avx2 => unsafe { avx2::run(work) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Avx512 => unsafe { avx512::run(work) },
        _ => work.run(&(plain, |block: &Surroundings<'_>, rows: &mut [[Row; BLOCK_ROWS]; 2]| {
            block.unfaced(rows)
        })),
    }
}

/// The operation in plain Rust: what all others equal bit for bit.
#[inline(always)]
fn plain(limits: &Limits, rows: &[&Row; BLOCK_ROWS]) -> Bits {
    let mut found = [0; BLOCK_ROWS];
    for (y, texels) in rows.iter().enumerate() {
        for (i, &nearness) in texels.iter().enumerate() {
            let is_above = limits.hn * nearness > limits.rows[y] - limits.columns[i];
            found[y] |= u16::from(is_above & (nearness > limits.nearness)) << i;
        }
    }
    Bits::new(found)
}
