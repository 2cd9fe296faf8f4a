//! The operation with AVX2: a row of a block is two vectors.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use super::{Bits, Work};
use crate::search::field::{BLOCK_ROWS, Block, LANE, Test};

#[target_feature(enable = "avx2")]
pub(crate) fn run(work: impl Work) {
    work.run(&|test: &Test, block: &Block<'_>| blocking(test, block));
}

#[target_feature(enable = "avx2")]
#[inline]
fn blocking(test: &Test, block: &Block<'_>) -> Bits {
    let all = |value: f32| _mm256_set1_ps(value);
    let lanes: [__m256; 2] = cast(LANE);
    let along =
        lanes.map(|lane| _mm256_mul_ps(all(test.hu), _mm256_add_ps(all(block.first[0]), lane)));
    let mut found = [0; BLOCK_ROWS];
    for (y, row) in block.rows.iter().enumerate() {
        let texels: [__m256; 2] = cast(**row);
        let row = all(test.above - test.hv * (block.first[1] + y as f32));
        for part in 0..2 {
            let height = _mm256_mul_ps(all(test.hn), texels[part]);
            let plane = _mm256_sub_ps(row, along[part]);
            let is_above = _mm256_cmp_ps::<_CMP_GT_OQ>(height, plane);
            let nearer = _mm256_cmp_ps::<_CMP_GT_OQ>(texels[part], all(test.nearness));
            let bits = _mm256_movemask_ps(_mm256_and_ps(is_above, nearer));
            found[y] |= (bits as u16) << (8 * part);
        }
    }
    Bits::new(found)
}
