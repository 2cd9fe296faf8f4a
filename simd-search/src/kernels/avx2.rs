//! AVX2: eight lanes.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use crate::kernels::Job;
use crate::kernels::vectors::{Vectors, kernels, operations};

#[derive(Clone, Copy)]
struct Avx2(());

#[target_feature(enable = "avx2")]
pub(crate) fn run(job: Job<'_>) {
    let v = Avx2(());
    job.run(&kernels!(v));
}

type F = __m256;
type M = __m256;

impl Vectors for Avx2 {
    type F = F;
    type M = M;

    operations! { unsafe:
        all(a: f32) -> F = _mm256_set1_ps(a);
        add(a: F, b: F) -> F = _mm256_add_ps(a, b);
        sub(a: F, b: F) -> F = _mm256_sub_ps(a, b);
        mul(a: F, b: F) -> F = _mm256_mul_ps(a, b);
        div(a: F, b: F) -> F = _mm256_div_ps(a, b);
        abs(a: F) -> F = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        smaller(a: F, b: F) -> F = _mm256_min_ps(a, b);
        larger(a: F, b: F) -> F = _mm256_max_ps(a, b);
        greater(a: F, b: F) -> M = _mm256_cmp_ps::<_CMP_GT_OQ>(a, b);
        at_most(a: F, b: F) -> M = _mm256_cmp_ps::<_CMP_LE_OQ>(a, b);
        ordered(m: M, a: F, b: F) -> M = _mm256_and_ps(m, _mm256_cmp_ps::<_CMP_ORD_Q>(a, b));
        same_bits(a: F, b: u32) -> M =
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_castps_si256(a), _mm256_set1_epi32(b as i32)));
        both(a: M, b: M) -> M = _mm256_and_ps(a, b);
        either(a: M, b: M) -> M = _mm256_or_ps(a, b);
        without(a: M, b: M) -> M = _mm256_andnot_ps(b, a);
        choose(m: M, a: F, b: F) -> F = _mm256_blendv_ps(b, a, m);
        bits(m: M) -> u32 = _mm256_movemask_ps(m) as u32;
    }
}
