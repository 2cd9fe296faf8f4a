//! The operation with AVX2: a window is two vectors.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use super::{LANE, Texels, Work};
use crate::search::field::Test;

#[target_feature(enable = "avx2")]
pub(crate) fn run(work: impl Work) {
    work.run(&|test: &Test, rows: [f32; 2], column: f32, texels: &Texels| {
        blocking(test, rows, column, texels)
    });
}

#[target_feature(enable = "avx2")]
#[inline]
fn blocking(test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2] {
    let (texels, lanes): ([__m256; 2], [__m256; 2]) = (cast(*texels), cast(LANE));
    let mut found = [0; 2];
    for part in 0..2 {
        let columns = _mm256_add_ps(_mm256_set1_ps(column), lanes[part]);
        let along = _mm256_mul_ps(_mm256_set1_ps(test.hu), columns);
        let height = _mm256_mul_ps(_mm256_set1_ps(test.hn), texels[part]);
        for i in 0..2 {
            let plane = _mm256_sub_ps(_mm256_set1_ps(rows[i]), along);
            let is_above = _mm256_cmp_ps::<_CMP_GT_OQ>(height, plane);
            let least = _mm256_set1_ps(test.nearness[i]);
            let nearer = _mm256_cmp_ps::<_CMP_GT_OQ>(texels[part], least);
            let both = _mm256_movemask_ps(_mm256_and_ps(is_above, nearer));
            found[i] |= (both as u32) << (8 * part);
        }
    }
    found
}
