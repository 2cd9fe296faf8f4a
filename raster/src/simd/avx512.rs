//! AVX-512 F, BW, DQ and VL: sixteen lanes.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use super::{MAX_LANES, Simd, operations};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

impl Avx512 {
    /// # Safety
    ///
    /// The machine must have AVX-512 F, BW, DQ and VL.
    pub(crate) unsafe fn new() -> Avx512 {
        Avx512(())
    }
}

type F = __m512;
type I = __m512i;
type D = [__m512d; 2];
type M = __mmask16;

impl Simd for Avx512 {
    const LANES: usize = 16;
    type F = F;
    type I = I;
    type D = D;
    type M = M;

    operations! { self, safe:
        and_m(a: M, b: M) -> M = a & b;
        or_m(a: M, b: M) -> M = a | b;
        bits(m: M) -> u32 = u32::from(m);
    }
    operations! { self, unsafe:
        splat_f(a: f32) -> F = _mm512_set1_ps(a);
        splat_i(a: i32) -> I = _mm512_set1_epi32(a);
        splat_d(a: f64) -> D = [_mm512_set1_pd(a); 2];
        lanes() -> I = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);

        add_f(a: F, b: F) -> F = _mm512_add_ps(a, b);
        mul_f(a: F, b: F) -> F = _mm512_mul_ps(a, b);
        min_f(a: F, b: F) -> F = _mm512_min_ps(a, b);
        max_f(a: F, b: F) -> F = _mm512_max_ps(a, b);

        add_i(a: I, b: I) -> I = _mm512_add_epi32(a, b);
        sub_i(a: I, b: I) -> I = _mm512_sub_epi32(a, b);
        mul_i(a: I, b: I) -> I = _mm512_mullo_epi32(a, b);
        min_i(a: I, b: I) -> I = _mm512_min_epi32(a, b);
        max_i(a: I, b: I) -> I = _mm512_max_epi32(a, b);
        or_i(a: I, b: I) -> I = _mm512_or_si512(a, b);

        add_d(a: D, b: D) -> D = [_mm512_add_pd(a[0], b[0]), _mm512_add_pd(a[1], b[1])];
        sub_d(a: D, b: D) -> D = [_mm512_sub_pd(a[0], b[0]), _mm512_sub_pd(a[1], b[1])];
        mul_d(a: D, b: D) -> D = [_mm512_mul_pd(a[0], b[0]), _mm512_mul_pd(a[1], b[1])];
        div_d(a: D, b: D) -> D = [_mm512_div_pd(a[0], b[0]), _mm512_div_pd(a[1], b[1])];

        i_from_bits(a: F) -> I = _mm512_castps_si512(a);
        f_from_bits(a: I) -> F = _mm512_castsi512_ps(a);
        f_from_i(a: I) -> F = _mm512_cvtepi32_ps(a);
        d_from_f(a: F) -> D = [
            _mm512_cvtps_pd(_mm512_castps512_ps256(a)),
            _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(a)),
        ];
        f_from_d(a: D) -> F = _mm512_insertf32x8::<1>(
            _mm512_castps256_ps512(_mm512_cvtpd_ps(a[0])),
            _mm512_cvtpd_ps(a[1]),
        );

        less_f(a: F, b: F) -> M = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
        equal_f(a: F, b: F) -> M = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b);
        less_f_in(m: M, a: F, b: F) -> M = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(m, a, b);
        equal_f_in(m: M, a: F, b: F) -> M = _mm512_mask_cmp_ps_mask::<_CMP_EQ_OQ>(m, a, b);
        not_negative(a: I) -> M = _mm512_cmpge_epi32_mask(a, _mm512_setzero_si512());
        greater_i(a: I, b: I) -> M = _mm512_cmpgt_epi32_mask(a, b);
        below_u(a: I, b: I) -> M = _mm512_cmplt_epu32_mask(a, b);
        select_f(m: M, a: F, b: F) -> F = _mm512_mask_blend_ps(m, b, a);
        select_i(m: M, a: I, b: I) -> I = _mm512_mask_blend_epi32(m, b, a);

        load_f(from: &[f32]) -> F = _mm512_loadu_ps(from[..16].as_ptr());
        load_u(from: &[u32]) -> I = _mm512_loadu_epi32(from[..16].as_ptr().cast());
        store_f(to: &mut [f32], a: F) = _mm512_storeu_ps(to[..16].as_mut_ptr(), a);
        store_u(to: &mut [u32], a: I) = _mm512_storeu_epi32(to[..16].as_mut_ptr().cast(), a);
        store_d(to: &mut [f64; MAX_LANES], a: D) = {
            _mm512_storeu_pd(to[..8].as_mut_ptr(), a[0]);
            _mm512_storeu_pd(to[8..].as_mut_ptr(), a[1]);
        };
        blend_f(to: &mut [f32], m: M, a: F) = _mm512_mask_storeu_ps(to[..16].as_mut_ptr(), m, a);
        blend_u(to: &mut [u32], m: M, a: I) =
            _mm512_mask_storeu_epi32(to[..16].as_mut_ptr().cast(), m, a);
        prefetch(at: *const u8) = _mm_prefetch::<_MM_HINT_ET0>(at.cast());
        prefetch_later(at: *const u8) = _mm_prefetch::<_MM_HINT_T1>(at.cast());
        prefetch_read(at: *const u8) = _mm_prefetch::<_MM_HINT_T0>(at.cast());

        gather(table: &[[f32; 4]], triangles: &[[u32; 3]], missing: [f32; 4]) -> [[F; 4]; 3] = {
            let [a, b, c] = corner_indices(triangles);
            [gather(table, a, missing), gather(table, b, missing), gather(table, c, missing)]
        };
        compress_u(to: &mut [u32], bits: u32, a: I) = _mm512_storeu_epi32(
            to[..16].as_mut_ptr().cast(),
            _mm512_maskz_compress_epi32(bits as M, a),
        );
        compress_f(to: &mut [f32], bits: u32, a: F) = _mm512_storeu_ps(
            to[..16].as_mut_ptr(),
            _mm512_maskz_compress_ps(bits as M, a),
        );
    }

    #[inline(always)]
    unsafe fn load_block<const ROWS: usize>(self, from: *const u32, stride: usize) -> I {
        // SAFETY: as for the operations above; the caller promises the elements.
        unsafe { load_block::<ROWS>(from.cast(), stride) }
    }

    #[inline(always)]
    unsafe fn blend_block<const ROWS: usize>(self, to: *mut u32, stride: usize, m: M, a: I) {
        // SAFETY: as for the operations above; the caller promises the elements.
        unsafe { blend_block::<ROWS>(to.cast(), stride, m, a) }
    }

    #[inline(always)]
    fn shift_right<const BITS: u32>(self, a: I) -> I {
        // SAFETY: as for the operations above.
        unsafe { _mm512_srai_epi32::<BITS>(a) }
    }

    #[inline(always)]
    fn shift_left<const BITS: u32>(self, a: I) -> I {
        // SAFETY: as for the operations above.
        unsafe { _mm512_slli_epi32::<BITS>(a) }
    }
}

/// [`Simd::load_block`].
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl")]
unsafe fn load_block<const ROWS: usize>(from: *const i32, stride: usize) -> I {
    // SAFETY: the caller promises the elements.
    unsafe {
        match ROWS {
            1 => _mm512_loadu_epi32(from),
            2 => two_rows(_mm256_loadu_epi32(from), _mm256_loadu_epi32(from.add(stride))),
            _ => {
                let (a, b) = (_mm_loadu_epi32(from), _mm_loadu_epi32(from.add(stride)));
                let c = _mm_loadu_epi32(from.add(2 * stride));
                let d = _mm_loadu_epi32(from.add(3 * stride));
                two_rows(_mm256_set_m128i(b, a), _mm256_set_m128i(d, c))
            }
        }
    }
}

#[inline]
#[target_feature(enable = "avx512f,avx512dq")]
fn two_rows(low: __m256i, high: __m256i) -> I {
    _mm512_inserti32x8::<1>(_mm512_castsi256_si512(low), high)
}

/// [`Simd::blend_block`].
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl")]
unsafe fn blend_block<const ROWS: usize>(to: *mut i32, stride: usize, m: M, a: I) {
    // SAFETY: the caller promises the elements.
    unsafe {
        match ROWS {
            1 => _mm512_mask_storeu_epi32(to, m, a),
            2 => {
                let (low, high) = (_mm512_castsi512_si256(a), _mm512_extracti32x8_epi32::<1>(a));
                _mm256_mask_storeu_epi32(to, m as __mmask8, low);
                _mm256_mask_storeu_epi32(to.add(stride), (m >> 8) as __mmask8, high);
            }
            _ => {
                let b = _mm512_extracti32x4_epi32::<1>(a);
                let c = _mm512_extracti32x4_epi32::<2>(a);
                let d = _mm512_extracti32x4_epi32::<3>(a);
                _mm_mask_storeu_epi32(to, m as __mmask8, _mm512_castsi512_si128(a));
                _mm_mask_storeu_epi32(to.add(stride), (m >> 4) as __mmask8, b);
                _mm_mask_storeu_epi32(to.add(2 * stride), (m >> 8) as __mmask8, c);
                _mm_mask_storeu_epi32(to.add(3 * stride), (m >> 12) as __mmask8, d);
            }
        }
    }
}

/// The vertex indices of sixteen triangles, by corner: every third of 48 numbers.
#[inline]
#[target_feature(enable = "avx512f")]
fn corner_indices(triangles: &[[u32; 3]]) -> [I; 3] {
    let numbers = triangles[..16].as_flattened();
    // SAFETY: sixteen triangles have three times sixteen numbers.
    let (a, b, c) = unsafe {
        (
            _mm512_loadu_epi32(numbers.as_ptr().cast()),
            _mm512_loadu_epi32(numbers[16..].as_ptr().cast()),
            _mm512_loadu_epi32(numbers[32..].as_ptr().cast()),
        )
    };
    // The closure inherits the function's instructions. Numbers 0, 3, .. 30 come from a and b, the
    // rest from c; and so on.
    let pick = |from_ab: I, from_c: I| {
        let ab = _mm512_permutex2var_epi32(a, from_ab, b);
        _mm512_permutex2var_epi32(ab, from_c, c)
    };
    [
        pick(
            _mm512_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 0, 0, 0, 0, 0),
            _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 17, 20, 23, 26, 29),
        ),
        pick(
            _mm512_setr_epi32(1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 31, 0, 0, 0, 0, 0),
            _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 18, 21, 24, 27, 30),
        ),
        pick(
            _mm512_setr_epi32(2, 5, 8, 11, 14, 17, 20, 23, 26, 29, 0, 0, 0, 0, 0, 0),
            _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 19, 22, 25, 28, 31),
        ),
    ]
}

#[inline]
#[target_feature(enable = "avx512f,avx512dq")]
fn gather(table: &[[f32; 4]], index: I, missing: [f32; 4]) -> [F; 4] {
    // In pairs, of which the table has twice as many. Gathers take indices as signed: what lies
    // beyond counts as out of range.
    let length = _mm512_set1_epi32(table.len().min(i32::MAX as usize / 2) as i32);
    let inside = _mm512_cmplt_epu32_mask(index, length);
    let pair = _mm512_add_epi32(index, index);
    let (low, high) = (_mm512_castsi512_si256(pair), _mm512_extracti32x8_epi32::<1>(pair));
    let even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    let odd = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
    let pairs = table.as_ptr().cast::<f64>();
    // The closure inherits the function's instructions.
    let parts = |half: usize| {
        let missing: [f32; 2] = [missing[2 * half], missing[2 * half + 1]];
        let missing = _mm512_set1_pd(bytemuck::cast(missing));
        let pairs = pairs.wrapping_add(half);
        // SAFETY: only entries inside of the table are read.
        let (a, b) = unsafe {
            (
                _mm512_mask_i32gather_pd::<8>(missing, inside as __mmask8, low, pairs),
                _mm512_mask_i32gather_pd::<8>(missing, (inside >> 8) as __mmask8, high, pairs),
            )
        };
        let (a, b) = (_mm512_castpd_ps(a), _mm512_castpd_ps(b));
        [_mm512_permutex2var_ps(a, even, b), _mm512_permutex2var_ps(a, odd, b)]
    };
    let ([a, b], [c, d]) = (parts(0), parts(1));
    [a, b, c, d]
}
