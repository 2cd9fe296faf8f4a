//! The operation with SSE4.1: a window is four vectors.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use super::{LANE, Texels, Work};
use crate::search::field::Test;

#[target_feature(enable = "sse4.1")]
pub(crate) fn run(work: impl Work) {
    work.run(&|test: &Test, rows: [f32; 2], column: f32, texels: &Texels| {
        blocking(test, rows, column, texels)
    });
}

#[target_feature(enable = "sse4.1")]
#[inline]
fn blocking(test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2] {
    let (texels, lanes): ([__m128; 4], [__m128; 4]) = (cast(*texels), cast(LANE));
    let mut found = [0; 2];
    for part in 0..4 {
        let columns = _mm_add_ps(_mm_set1_ps(column), lanes[part]);
        let along = _mm_mul_ps(_mm_set1_ps(test.hu), columns);
        let height = _mm_mul_ps(_mm_set1_ps(test.hn), texels[part]);
        for i in 0..2 {
            let plane = _mm_sub_ps(_mm_set1_ps(rows[i]), along);
            let is_above = _mm_cmpgt_ps(height, plane);
            let least = _mm_set1_ps(test.nearness[i]);
            let nearer = _mm_cmpgt_ps(texels[part], least);
            let both = _mm_movemask_ps(_mm_and_ps(is_above, nearer));
            found[i] |= (both as u32) << (4 * part);
        }
    }
    found
}
