//! The one operation that every instruction set writes by hand, and the door to them.
//!
//! Everything else is plain Rust over arrays, which the compiler turns into the instructions of
//! the function it is inlined into. None of it depends on the width: the bits are the same.

use shadowmap_core::{Level, LevelKind};

use super::field::{Test, WINDOW};

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod avx2;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod avx512;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod sse41;

pub(crate) type Texels = [f32; WINDOW];

/// The number of each lane.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
const LANE: Texels =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Which of the texels of a window block some, and which all of a test's receivers: of texel i,
/// bit i. `rows` is `above - hv * t`, `column` the first texel's centre.
///
/// Each instruction set makes a closure inside a function with its target features: closures
/// have the features of the function they are made in, and everything between is
/// `#[inline(always)]`.
pub(crate) trait Ops {
    fn blocking(&self, test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2];
}

impl<F: Fn(&Test, [f32; 2], f32, &Texels) -> [u32; 2]> Ops for F {
    #[inline(always)]
    fn blocking(&self, test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2] {
        self(test, rows, column, texels)
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
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        LevelKind::Sse41 => unsafe { sse41::run(work) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        LevelKind::Avx2 => unsafe { avx2::run(work) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        LevelKind::Avx512 => unsafe { avx512::run(work) },
        _ => work.run(&plain),
    }
}

/// The operation in plain Rust: what all others equal bit for bit.
#[inline(always)]
pub(crate) fn plain(test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2] {
    let mut found = [0; 2];
    for (i, &nearness) in texels.iter().enumerate() {
        let along = test.hu * (column + i as f32);
        for (found, (row, least)) in found.iter_mut().zip(rows.into_iter().zip(test.nearness)) {
            let blocks = test.hn * nearness > row - along && nearness > least;
            *found |= u32::from(blocks) << i;
        }
    }
    found
}
