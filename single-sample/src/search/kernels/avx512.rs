//! The operation with AVX-512: a row of a block is one vector.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use super::{Bits, Work};
use crate::search::field::{BLOCK_ROWS, Block, LANE, Test};

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(crate) fn run(work: impl Work) {
    work.run(&|test: &Test, block: &Block<'_>| blocking(test, block));
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
#[inline]
fn blocking(test: &Test, block: &Block<'_>) -> Bits {
    let all = |value: f32| _mm512_set1_ps(value);
    let along = _mm512_mul_ps(all(test.hu), _mm512_add_ps(all(block.first[0]), cast(LANE)));
    let mut found = [0; BLOCK_ROWS];
    for (y, row) in block.rows.iter().enumerate() {
        let t = block.first[1] + y as f32;
        let texels: __m512 = cast(**row);
        let height = _mm512_mul_ps(all(test.hn), texels);
        let plane = _mm512_sub_ps(all(test.above - test.hv * t), along);
        let is_above = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(height, plane);
        let least = all(test.nearness);
        found[y] = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(is_above, texels, least);
    }
    Bits::new(found)
}
