//! The operation with AVX-512: a row of a block is one vector.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use super::{Bits, Work};
use crate::search::facing::Surroundings;
use crate::search::field::{BLOCK_ROWS, Row};
use crate::search::texel_test::Limits;

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(crate) fn run(work: impl Work) {
    work.run(&(
        |limits: &Limits, rows: &[&Row; BLOCK_ROWS]| passing(limits, rows),
        |block: &Surroundings<'_>, rows: &mut [[Row; BLOCK_ROWS]; 2]| unfaced(block, rows),
    ));
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn unfaced(block: &Surroundings<'_>, rows: &mut [[Row; BLOCK_ROWS]; 2]) {
    block.unfaced(rows);
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
#[inline]
fn passing(limits: &Limits, rows: &[&Row; BLOCK_ROWS]) -> Bits {
    let all = |value: f32| _mm512_set1_ps(value);
    let (hn, least, columns) = (all(limits.hn), all(limits.nearness), cast(limits.columns));
    // Spread from a register: one by one from memory, they would wait for being written there.
    let limits: __m512 = cast(limits.rows);
    let mut found = [0; BLOCK_ROWS];
    for (y, row) in rows.iter().enumerate() {
        let texels: __m512 = cast(**row);
        let limit = _mm512_permutexvar_ps(_mm512_set1_epi32(y as i32), limits);
        let plane = _mm512_sub_ps(limit, columns);
        let is_above = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(_mm512_mul_ps(hn, texels), plane);
        found[y] = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(is_above, texels, least);
    }
    Bits::new(found)
}
