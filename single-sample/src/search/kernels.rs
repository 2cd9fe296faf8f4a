//! The one operation that every instruction set writes by hand, and the door to them.
//!
//! Everything else is plain Rust over arrays, which the compiler turns into the instructions of
//! the function it is inlined into. None of it depends on the width: the bits are the same.

use super::field::{Test, WINDOW};

/// Which of the texels of a window block some, and which all of a test's receivers: of texel i,
/// bit i. `rows` is `above - hv * t`, `column` the first texel's centre.
pub(crate) trait Ops {
    fn blocking(&self, test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2];
}

type Texels = [f32; WINDOW];

impl<F: Fn(&Test, [f32; 2], f32, &Texels) -> [u32; 2]> Ops for F {
    #[inline(always)]
    fn blocking(&self, test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2] {
        self(test, rows, column, texels)
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
