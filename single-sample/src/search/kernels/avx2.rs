//! The operation with AVX2: a row of a block is two vectors.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use super::{Bits, Work};
use crate::search::facing::Surroundings;
use crate::search::field::{BLOCK_ROWS, Row};
use crate::search::texel_test::Limits;

#[target_feature(enable = "avx2")]
pub(crate) fn run(work: impl Work) {
    work.run(&(
        |limits: &Limits, rows: &[&Row; BLOCK_ROWS]| passing(limits, rows),
        |block: &Surroundings<'_>, rows: &mut [[Row; BLOCK_ROWS]; 2]| unfaced(block, rows),
    ));
}

#[target_feature(enable = "avx2")]
fn unfaced(block: &Surroundings<'_>, rows: &mut [[Row; BLOCK_ROWS]; 2]) {
    block.unfaced(rows);
}

#[target_feature(enable = "avx2")]
#[inline]
fn passing(limits: &Limits, rows: &[&Row; BLOCK_ROWS]) -> Bits {
    let all = |value: f32| _mm256_set1_ps(value);
    let (hn, least) = (all(limits.hn), all(limits.nearness));
    let columns: [__m256; 2] = cast(limits.columns);
    let mut found = [0; BLOCK_ROWS];
    for (y, row) in rows.iter().enumerate() {
        let texels: [__m256; 2] = cast(**row);
        for part in 0..2 {
            let plane = _mm256_sub_ps(all(limits.rows[y]), columns[part]);
            let is_above = _mm256_cmp_ps::<_CMP_GT_OQ>(_mm256_mul_ps(hn, texels[part]), plane);
            let nearer = _mm256_cmp_ps::<_CMP_GT_OQ>(texels[part], least);
            let bits = _mm256_movemask_ps(_mm256_and_ps(is_above, nearer));
            found[y] |= (bits as u16) << (8 * part);
        }
    }
    Bits::new(found)
}
