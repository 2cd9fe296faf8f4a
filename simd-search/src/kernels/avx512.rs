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

/// All lanes of each of four vectors combined: first lanes within the quarters of the vectors, as
/// in the transposition of 4 x 4 numbers, then the quarters.
macro_rules! across {
    ($vectors:expr, $of_16:ident, $of_8:ident, $of_4:ident) => {{
        let [a, b, c, d] = $vectors;
        let ab = $of_16(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let cd = $of_16(_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        let (ab, cd) = (_mm512_castps_pd(ab), _mm512_castps_pd(cd));
        let [even, odd] = [_mm512_unpacklo_pd(ab, cd), _mm512_unpackhi_pd(ab, cd)];
        let all = $of_16(_mm512_castpd_ps(even), _mm512_castpd_ps(odd));
        let all = $of_8(_mm512_castps512_ps256(all), _mm512_extractf32x8_ps::<1>(all));
        let all = $of_4(_mm256_castps256_ps128(all), _mm256_extractf128_ps::<1>(all));
        bytemuck::cast(all)
    }};
}

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
        ordered(m: M, a: F, b: F) -> M = _mm512_mask_cmp_ps_mask::<_CMP_ORD_Q>(m, a, b);
        same_bits(a: F, b: u32) -> M =
            _mm512_cmpeq_epi32_mask(_mm512_castps_si512(a), _mm512_set1_epi32(b as i32));
        choose(m: M, a: F, b: F) -> F = _mm512_mask_blend_ps(m, b, a);
        least_of_each(a: [F; 4]) -> [f32; 4] = across!(a, _mm512_min_ps, _mm256_min_ps, _mm_min_ps);
        greatest_of_each(a: [F; 4]) -> [f32; 4] =
            across!(a, _mm512_max_ps, _mm256_max_ps, _mm_max_ps);
    }
    operations! { safe:
        both(a: M, b: M) -> M = a & b;
        either(a: M, b: M) -> M = a | b;
        without(a: M, b: M) -> M = a & !b;
        bits(m: M) -> u32 = u32::from(m);
    }
}
