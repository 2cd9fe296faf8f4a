//! The one operation that every instruction set writes by hand, and the door to them.
//!
//! Everything else is plain Rust over arrays, which the compiler turns into the instructions of
//! the function it is inlined into. None of it depends on the width: the bits are the same.

use shadowmap_core::Level;

use super::field::{BLOCK_ROWS, Block, Test};

#[cfg(target_feature = "sse2")]
mod avx2;
#[cfg(target_feature = "sse2")]
mod avx512;
#[cfg(target_feature = "sse2")]
mod sse41;

/// A bit per texel of a block, row by row: texel i of a row is bit i.
pub(crate) type Bits = [u16; BLOCK_ROWS];

/// Which of the texels of a block pass a test.
///
/// Each instruction set makes a closure inside a function with its target features: closures
/// have the features of the function they are made in, and everything between is
/// `#[inline(always)]`.
pub(crate) trait Ops {
    fn blocking(&self, test: &Test, block: &Block<'_>) -> Bits;
}

impl<F: Fn(&Test, &Block<'_>) -> Bits> Ops for F {
    #[inline(always)]
    fn blocking(&self, test: &Test, block: &Block<'_>) -> Bits {
        self(test, block)
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
        _ => work.run(&plain),
    }
}

/// The operation in plain Rust: what all others equal bit for bit.
#[inline(always)]
fn plain(test: &Test, block: &Block<'_>) -> Bits {
    let mut found = [0; BLOCK_ROWS];
    for (y, texels) in block.rows.iter().enumerate() {
        let row = test.above - test.hv * (block.first[1] + y as f32);
        for (i, &nearness) in texels.iter().enumerate() {
            let along = test.hu * (block.first[0] + i as f32);
            let blocks = (test.hn * nearness > row - along) & (nearness > test.nearness);
            found[y] |= u16::from(blocks) << i;
        }
    }
    found
}
