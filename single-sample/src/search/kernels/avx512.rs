//! The operation with AVX-512: a window is one vector.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use super::{LANE, Texels, Work};
use crate::search::field::Test;

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(crate) fn run(work: impl Work) {
    work.run(&|test: &Test, rows: [f32; 2], column: f32, texels: &Texels| {
        blocking(test, rows, column, texels)
    });
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
#[inline]
fn blocking(test: &Test, rows: [f32; 2], column: f32, texels: &Texels) -> [u32; 2] {
    let texels: __m512 = cast(*texels);
    let columns = _mm512_add_ps(_mm512_set1_ps(column), cast(LANE));
    let along = _mm512_mul_ps(_mm512_set1_ps(test.hu), columns);
    let height = _mm512_mul_ps(_mm512_set1_ps(test.hn), texels);
    let found = |row: f32, least: f32| {
        let plane = _mm512_sub_ps(_mm512_set1_ps(row), along);
        let is_above = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(height, plane);
        let nearer = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(texels, _mm512_set1_ps(least));
        u32::from(is_above & nearer)
    };
    [found(rows[0], test.nearness[0]), found(rows[1], test.nearness[1])]
}
