//! AVX-512 F, BW, DQ and VL: sixteen lanes, a tile's row or a group of nodes at once.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use crate::kernels::Job;
use crate::kernels::vectors::{Vectors, kernels, operations};

#[derive(Clone, Copy)]
struct Avx512(());

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(crate) fn run(job: Job<'_>) {
    let v = Avx512(());
    job.run(&kernels!(v));
}

type F = __m512;
type M = __mmask16;

impl Vectors for Avx512 {
    type F = F;
    type M = M;

    operations! { unsafe:
        all(a: f32) -> F = _mm512_set1_ps(a);
        add(a: F, b: F) -> F = _mm512_add_ps(a, b);
        sub(a: F, b: F) -> F = _mm512_sub_ps(a, b);
        mul(a: F, b: F) -> F = _mm512_mul_ps(a, b);
        div(a: F, b: F) -> F = _mm512_div_ps(a, b);
        abs(a: F) -> F = _mm512_abs_ps(a);
        smaller(a: F, b: F) -> F = _mm512_min_ps(a, b);
        larger(a: F, b: F) -> F = _mm512_max_ps(a, b);
        greater(a: F, b: F) -> M = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b);
        at_most(a: F, b: F) -> M = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
        same_bits(a: F, b: u32) -> M =
            _mm512_cmpeq_epi32_mask(_mm512_castps_si512(a), _mm512_set1_epi32(b as i32));
        choose(m: M, a: F, b: F) -> F = _mm512_mask_blend_ps(m, b, a);
        least(a: F) -> f32 = _mm512_reduce_min_ps(a);
        greatest(a: F) -> f32 = _mm512_reduce_max_ps(a);
    }
    operations! { safe:
        both(a: M, b: M) -> M = a & b;
        either(a: M, b: M) -> M = a | b;
        bits(m: M) -> u32 = u32::from(m);
    }
}
