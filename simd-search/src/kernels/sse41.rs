//! SSE4.1: four lanes.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use crate::kernels::Job;
use crate::kernels::vectors::{Vectors, kernels, operations};

#[derive(Clone, Copy)]
struct Sse41(());

#[target_feature(enable = "sse4.1")]
pub(crate) fn run(job: Job<'_>) {
    let v = Sse41(());
    job.run(&kernels!(v));
}

type F = __m128;
type M = __m128;

impl Vectors for Sse41 {
    type F = F;
    type M = M;

    operations! { unsafe:
        all(a: f32) -> F = _mm_set1_ps(a);
        add(a: F, b: F) -> F = _mm_add_ps(a, b);
        sub(a: F, b: F) -> F = _mm_sub_ps(a, b);
        mul(a: F, b: F) -> F = _mm_mul_ps(a, b);
        div(a: F, b: F) -> F = _mm_div_ps(a, b);
        abs(a: F) -> F = _mm_andnot_ps(_mm_set1_ps(-0.0), a);
        smaller(a: F, b: F) -> F = _mm_min_ps(a, b);
        larger(a: F, b: F) -> F = _mm_max_ps(a, b);
        greater(a: F, b: F) -> M = _mm_cmpgt_ps(a, b);
        at_most(a: F, b: F) -> M = _mm_cmple_ps(a, b);
        ordered(m: M, a: F, b: F) -> M = _mm_and_ps(m, _mm_cmpord_ps(a, b));
        same_bits(a: F, b: u32) -> M =
            _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_castps_si128(a), _mm_set1_epi32(b as i32)));
        both(a: M, b: M) -> M = _mm_and_ps(a, b);
        either(a: M, b: M) -> M = _mm_or_ps(a, b);
        without(a: M, b: M) -> M = _mm_andnot_ps(b, a);
        choose(m: M, a: F, b: F) -> F = _mm_blendv_ps(b, a, m);
        bits(m: M) -> u32 = _mm_movemask_ps(m) as u32;
    }
}
