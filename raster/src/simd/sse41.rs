//! SSE4.1: four lanes.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use super::{MAX_LANES, Simd, operations};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Sse41(());

impl Sse41 {
    /// # Safety
    ///
    /// The machine must have SSE4.1.
    pub(crate) unsafe fn new() -> Sse41 {
        Sse41(())
    }
}

type F = __m128;
type I = __m128i;
type D = [__m128d; 2];
/// All bits of a lane are set, or none.
type M = __m128i;

impl Simd for Sse41 {
    const LANES: usize = 4;
    type F = F;
    type I = I;
    type D = D;
    type M = M;

    operations! { self, unsafe:
        splat_f(a: f32) -> F = _mm_set1_ps(a);
        splat_i(a: i32) -> I = _mm_set1_epi32(a);
        splat_d(a: f64) -> D = [_mm_set1_pd(a); 2];
        lanes() -> I = _mm_setr_epi32(0, 1, 2, 3);

        add_f(a: F, b: F) -> F = _mm_add_ps(a, b);
        mul_f(a: F, b: F) -> F = _mm_mul_ps(a, b);
        min_f(a: F, b: F) -> F = _mm_min_ps(a, b);
        max_f(a: F, b: F) -> F = _mm_max_ps(a, b);

        add_i(a: I, b: I) -> I = _mm_add_epi32(a, b);
        sub_i(a: I, b: I) -> I = _mm_sub_epi32(a, b);
        mul_i(a: I, b: I) -> I = _mm_mullo_epi32(a, b);
        min_i(a: I, b: I) -> I = _mm_min_epi32(a, b);
        max_i(a: I, b: I) -> I = _mm_max_epi32(a, b);
        or_i(a: I, b: I) -> I = _mm_or_si128(a, b);

        add_d(a: D, b: D) -> D = [_mm_add_pd(a[0], b[0]), _mm_add_pd(a[1], b[1])];
        sub_d(a: D, b: D) -> D = [_mm_sub_pd(a[0], b[0]), _mm_sub_pd(a[1], b[1])];
        mul_d(a: D, b: D) -> D = [_mm_mul_pd(a[0], b[0]), _mm_mul_pd(a[1], b[1])];
        div_d(a: D, b: D) -> D = [_mm_div_pd(a[0], b[0]), _mm_div_pd(a[1], b[1])];

        i_from_bits(a: F) -> I = _mm_castps_si128(a);
        f_from_bits(a: I) -> F = _mm_castsi128_ps(a);
        f_from_i(a: I) -> F = _mm_cvtepi32_ps(a);
        d_from_f(a: F) -> D = [
            _mm_cvtps_pd(a),
            _mm_cvtps_pd(_mm_movehl_ps(a, a)),
        ];
        f_from_d(a: D) -> F = _mm_movelh_ps(_mm_cvtpd_ps(a[0]), _mm_cvtpd_ps(a[1]));

        less_f(a: F, b: F) -> M = _mm_castps_si128(_mm_cmplt_ps(a, b));
        equal_f(a: F, b: F) -> M = _mm_castps_si128(_mm_cmpeq_ps(a, b));
        greater_i(a: I, b: I) -> M = _mm_cmpgt_epi32(a, b);
        below_u(a: I, b: I) -> M = {
            let sign = _mm_set1_epi32(i32::MIN);
            _mm_cmpgt_epi32(_mm_xor_si128(b, sign), _mm_xor_si128(a, sign))
        };
        and_m(a: M, b: M) -> M = _mm_and_si128(a, b);
        or_m(a: M, b: M) -> M = _mm_or_si128(a, b);
        bits(m: M) -> u32 = _mm_movemask_ps(_mm_castsi128_ps(m)) as u32;
        select_f(m: M, a: F, b: F) -> F = _mm_blendv_ps(b, a, _mm_castsi128_ps(m));
        select_i(m: M, a: I, b: I) -> I = _mm_blendv_epi8(b, a, m);

        load_f(from: &[f32]) -> F = _mm_loadu_ps(from[..4].as_ptr());
        load_u(from: &[u32]) -> I = _mm_loadu_si128(from[..4].as_ptr().cast());
        store_f(to: &mut [f32], a: F) = _mm_storeu_ps(to[..4].as_mut_ptr(), a);
        store_u(to: &mut [u32], a: I) = _mm_storeu_si128(to[..4].as_mut_ptr().cast(), a);
        store_d(to: &mut [f64; MAX_LANES], a: D) = {
            _mm_storeu_pd(to[..2].as_mut_ptr(), a[0]);
            _mm_storeu_pd(to[2..4].as_mut_ptr(), a[1]);
        };
        prefetch(at: *const u8) = _mm_prefetch::<_MM_HINT_ET0>(at.cast());
        prefetch_later(at: *const u8) = _mm_prefetch::<_MM_HINT_T1>(at.cast());
        prefetch_read(at: *const u8) = _mm_prefetch::<_MM_HINT_T0>(at.cast());

        gather(table: &[[f32; 4]], triangles: &[[u32; 3]], missing: [f32; 4]) -> [[F; 4]; 3] = [
            gather(table, triangles, 0, missing),
            gather(table, triangles, 1, missing),
            gather(table, triangles, 2, missing),
        ];
    }

    #[inline(always)]
    fn shift_right<const BITS: u32>(self, a: I) -> I {
        // SAFETY: as for the operations above.
        unsafe { _mm_sra_epi32(a, _mm_cvtsi32_si128(BITS as i32)) }
    }

    #[inline(always)]
    fn shift_left<const BITS: u32>(self, a: I) -> I {
        // SAFETY: as for the operations above.
        unsafe { _mm_sll_epi32(a, _mm_cvtsi32_si128(BITS as i32)) }
    }
}

#[inline]
#[target_feature(enable = "sse4.1")]
fn gather(table: &[[f32; 4]], triangles: &[[u32; 3]], corner: usize, missing: [f32; 4]) -> [F; 4] {
    let triangles = &triangles[..4];
    let entry = |lane: usize| -> F {
        let entry = table.get(triangles[lane][corner] as usize).unwrap_or(&missing);
        // SAFETY: an entry has four numbers.
        unsafe { _mm_loadu_ps(entry.as_ptr()) }
    };
    // A 4 x 4 matrix, transposed.
    let (r0, r1, r2, r3) = (entry(0), entry(1), entry(2), entry(3));
    let (a, b) = (_mm_unpacklo_ps(r0, r1), _mm_unpackhi_ps(r0, r1));
    let (c, d) = (_mm_unpacklo_ps(r2, r3), _mm_unpackhi_ps(r2, r3));
    [_mm_movelh_ps(a, c), _mm_movehl_ps(c, a), _mm_movelh_ps(b, d), _mm_movehl_ps(d, b)]
}
