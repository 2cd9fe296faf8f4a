//! AVX2: eight lanes.
#![allow(unsafe_code)]

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use super::{MAX_LANES, Simd, operations};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// # Safety
    ///
    /// The machine must have AVX2.
    pub(crate) unsafe fn new() -> Avx2 {
        Avx2(())
    }
}

type F = __m256;
type I = __m256i;
type D = [__m256d; 2];
/// All bits of a lane are set, or none.
type M = __m256i;

impl Simd for Avx2 {
    const LANES: usize = 8;
    type F = F;
    type I = I;
    type D = D;
    type M = M;

    operations! { self, unsafe:
        splat_f(a: f32) -> F = _mm256_set1_ps(a);
        splat_i(a: i32) -> I = _mm256_set1_epi32(a);
        splat_d(a: f64) -> D = [_mm256_set1_pd(a); 2];
        lanes() -> I = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);

        add_f(a: F, b: F) -> F = _mm256_add_ps(a, b);
        mul_f(a: F, b: F) -> F = _mm256_mul_ps(a, b);
        min_f(a: F, b: F) -> F = _mm256_min_ps(a, b);
        max_f(a: F, b: F) -> F = _mm256_max_ps(a, b);

        add_i(a: I, b: I) -> I = _mm256_add_epi32(a, b);
        sub_i(a: I, b: I) -> I = _mm256_sub_epi32(a, b);
        mul_i(a: I, b: I) -> I = _mm256_mullo_epi32(a, b);
        min_i(a: I, b: I) -> I = _mm256_min_epi32(a, b);
        max_i(a: I, b: I) -> I = _mm256_max_epi32(a, b);
        or_i(a: I, b: I) -> I = _mm256_or_si256(a, b);

        add_d(a: D, b: D) -> D = [_mm256_add_pd(a[0], b[0]), _mm256_add_pd(a[1], b[1])];
        sub_d(a: D, b: D) -> D = [_mm256_sub_pd(a[0], b[0]), _mm256_sub_pd(a[1], b[1])];
        mul_d(a: D, b: D) -> D = [_mm256_mul_pd(a[0], b[0]), _mm256_mul_pd(a[1], b[1])];
        div_d(a: D, b: D) -> D = [_mm256_div_pd(a[0], b[0]), _mm256_div_pd(a[1], b[1])];

        i_from_bits(a: F) -> I = _mm256_castps_si256(a);
        f_from_bits(a: I) -> F = _mm256_castsi256_ps(a);
        f_from_i(a: I) -> F = _mm256_cvtepi32_ps(a);
        d_from_f(a: F) -> D = [
            _mm256_cvtps_pd(_mm256_castps256_ps128(a)),
            _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a)),
        ];
        f_from_d(a: D) -> F = _mm256_set_m128(_mm256_cvtpd_ps(a[1]), _mm256_cvtpd_ps(a[0]));

        less_f(a: F, b: F) -> M = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b));
        equal_f(a: F, b: F) -> M = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_EQ_OQ>(a, b));
        greater_i(a: I, b: I) -> M = _mm256_cmpgt_epi32(a, b);
        below_u(a: I, b: I) -> M = {
            let sign = _mm256_set1_epi32(i32::MIN);
            _mm256_cmpgt_epi32(_mm256_xor_si256(b, sign), _mm256_xor_si256(a, sign))
        };
        and_m(a: M, b: M) -> M = _mm256_and_si256(a, b);
        or_m(a: M, b: M) -> M = _mm256_or_si256(a, b);
        bits(m: M) -> u32 = _mm256_movemask_ps(_mm256_castsi256_ps(m)) as u32;
        select_f(m: M, a: F, b: F) -> F = _mm256_blendv_ps(b, a, _mm256_castsi256_ps(m));
        select_i(m: M, a: I, b: I) -> I = _mm256_blendv_epi8(b, a, m);

        load_f(from: &[f32]) -> F = _mm256_loadu_ps(from[..8].as_ptr());
        load_u(from: &[u32]) -> I = _mm256_loadu_si256(from[..8].as_ptr().cast());
        store_f(to: &mut [f32], a: F) = _mm256_storeu_ps(to[..8].as_mut_ptr(), a);
        store_u(to: &mut [u32], a: I) = _mm256_storeu_si256(to[..8].as_mut_ptr().cast(), a);
        store_d(to: &mut [f64; MAX_LANES], a: D) = {
            _mm256_storeu_pd(to[..4].as_mut_ptr(), a[0]);
            _mm256_storeu_pd(to[4..8].as_mut_ptr(), a[1]);
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
    unsafe fn load_block<const ROWS: usize>(self, from: *const u32, stride: usize) -> I {
        // SAFETY: as for the operations above; the caller promises the elements.
        unsafe {
            match ROWS {
                1 => _mm256_loadu_si256(from.cast()),
                _ => _mm256_loadu2_m128i(from.add(stride).cast(), from.cast()),
            }
        }
    }

    #[inline(always)]
    unsafe fn blend_block<const ROWS: usize>(self, to: *mut u32, stride: usize, m: M, a: I) {
        // SAFETY: as for the operations above; the caller promises the elements.
        unsafe {
            let new = self.select_i(m, a, self.load_block::<ROWS>(to, stride));
            match ROWS {
                1 => _mm256_storeu_si256(to.cast(), new),
                _ => _mm256_storeu2_m128i(to.add(stride).cast(), to.cast(), new),
            }
        }
    }

    #[inline(always)]
    fn shift_right<const BITS: u32>(self, a: I) -> I {
        // SAFETY: as for the operations above.
        unsafe { _mm256_sra_epi32(a, _mm_cvtsi32_si128(BITS as i32)) }
    }

    #[inline(always)]
    fn shift_left<const BITS: u32>(self, a: I) -> I {
        // SAFETY: as for the operations above.
        unsafe { _mm256_sll_epi32(a, _mm_cvtsi32_si128(BITS as i32)) }
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn gather(table: &[[f32; 4]], triangles: &[[u32; 3]], corner: usize, missing: [f32; 4]) -> [F; 4] {
    let triangles = &triangles[..8];
    let entry = |lane: usize| -> __m128 {
        let entry = table.get(triangles[lane][corner] as usize).unwrap_or(&missing);
        // SAFETY: an entry has four numbers.
        unsafe { _mm_loadu_ps(entry.as_ptr()) }
    };
    // Two 4 x 4 matrices, transposed side by side.
    let rows = |lane: usize| _mm256_set_m128(entry(lane + 4), entry(lane));
    let (r0, r1, r2, r3) = (rows(0), rows(1), rows(2), rows(3));
    let (a, b) = (_mm256_unpacklo_ps(r0, r1), _mm256_unpackhi_ps(r0, r1));
    let (c, d) = (_mm256_unpacklo_ps(r2, r3), _mm256_unpackhi_ps(r2, r3));
    [
        _mm256_shuffle_ps::<0b01_00_01_00>(a, c),
        _mm256_shuffle_ps::<0b11_10_11_10>(a, c),
        _mm256_shuffle_ps::<0b01_00_01_00>(b, d),
        _mm256_shuffle_ps::<0b11_10_11_10>(b, d),
    ]
}
