//! What every instruction set writes by hand, and the door to the kernels.

use core::ops::Range;

use shadowmap_core::Level;

use crate::Counters;
use crate::intervals::{Frame, IntervalCounters, Nodes, Scratch, build, judge_band};
use crate::lanes::{self, BIT, Ids, LANES, Lanes, Ops, lanes, reduce};
use crate::shading::Image;
use crate::skin_spans::SpanRow;

/// What is done with kernels: one band of rows at a time.
pub(crate) enum Job<'a> {
    /// Bound the texels of a band of a map.
    Bound { nodes: &'a mut [Nodes], most: &'a mut f32, rows: &'a [f32], width: usize },
    /// Judge the receivers of a band of the camera's image, from row `first_row` on.
    Judge {
        frame: &'a Frame<'a>,
        first_row: usize,
        out: &'a mut [f32],
        scratch: &'a mut Scratch,
        counters: &'a mut IntervalCounters,
    },
    /// Draw the skins of a row.
    Skins { row: &'a SpanRow<'a>, out: &'a mut [f32], touched: &'a mut Range<usize> },
    /// Shade row `y` of an image with skins.
    Shade { image: &'a Image<'a>, y: usize, out: &'a mut [f32], counters: &'a mut Counters },
}

impl Job<'_> {
    #[inline(always)]
    fn run(self, ops: impl Ops) {
        match self {
            Job::Bound { nodes, most, rows, width } => {
                *most = build(ops, nodes, rows, width);
            }
            Job::Judge { frame, first_row, out, scratch, counters } => {
                judge_band(ops, frame, first_row, out, scratch, counters);
            }
            Job::Skins { row, out, touched } => row.draw_with(ops, out, touched),
            Job::Shade { image, y, out, counters } => image.shade_row(ops, y, out, counters),
        }
    }
}

/// [`Ops`] of two closures: they have the features of the function that they are made in.
#[derive(Clone, Copy)]
struct Closures<G, E, S, L, M, R, T> {
    greater: G,
    equal: E,
    select: S,
    min: L,
    max: M,
    least: R,
    greatest: T,
}

impl<G, E, S, L, M, R, T> Ops for Closures<G, E, S, L, M, R, T>
where
    G: Fn(&Lanes, &Lanes) -> u32 + Copy,
    E: Fn(&Ids, u32) -> u32 + Copy,
    S: Fn(u32, &Lanes, &Lanes) -> Lanes + Copy,
    L: Fn(&Lanes, &Lanes) -> Lanes + Copy,
    M: Fn(&Lanes, &Lanes) -> Lanes + Copy,
    R: Fn(&Lanes) -> f32 + Copy,
    T: Fn(&Lanes) -> f32 + Copy,
{
    #[inline(always)]
    fn greater(self, a: &Lanes, b: &Lanes) -> u32 {
        (self.greater)(a, b)
    }
    #[inline(always)]
    fn equal(self, a: &Ids, b: u32) -> u32 {
        (self.equal)(a, b)
    }
    #[inline(always)]
    fn select(self, bits: u32, a: &Lanes, b: &Lanes) -> Lanes {
        (self.select)(bits, a, b)
    }
    #[inline(always)]
    fn min(self, a: &Lanes, b: &Lanes) -> Lanes {
        (self.min)(a, b)
    }
    #[inline(always)]
    fn max(self, a: &Lanes, b: &Lanes) -> Lanes {
        (self.max)(a, b)
    }
    #[inline(always)]
    fn least(self, a: &Lanes) -> f32 {
        (self.least)(a)
    }
    #[inline(always)]
    fn greatest(self, a: &Lanes) -> f32 {
        (self.greatest)(a)
    }
}

/// Does a job with the instructions of `level`, and plainly where the level is of another
/// architecture than this program.
#[allow(unsafe_code)]
pub(crate) fn run(level: Level, job: Job<'_>) {
    match level.kind() {
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Sse41 => unsafe { x86::sse41(job) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Avx2 => unsafe { x86::avx2(job) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Avx512 => unsafe { x86::avx512(job) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(all(target_arch = "aarch64", target_endian = "little"))]
        shadowmap_core::LevelKind::Neon => unsafe { neon::neon(job) },
        // Not in modules without: one function with SIMD makes the whole module need it.
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        shadowmap_core::LevelKind::Simd128 => wasm::simd128(job),
        _ => plain(job),
    }
}

fn plain(job: Job<'_>) {
    let greater = |a: &Lanes, b: &Lanes| {
        let mut bits = 0;
        for i in 0..LANES {
            bits |= u32::from(a[i] > b[i]) << i;
        }
        bits
    };
    let equal =
        |a: &Ids, b: u32| a.iter().rev().fold(0, |bits, id| bits << 1 | u32::from(*id == b));
    let select = |bits: u32, a: &Lanes, b: &Lanes| {
        let mut out = *b;
        for i in 0..LANES {
            out[i] = if bits & BIT[i] != 0 { a[i] } else { b[i] };
        }
        out
    };
    let min = |a: &Lanes, b: &Lanes| lanes(|i| lanes::min(a[i], b[i]));
    let max = |a: &Lanes, b: &Lanes| lanes(|i| lanes::max(a[i], b[i]));
    let least = |a: &Lanes| reduce(a, lanes::min);
    let greatest = |a: &Lanes| reduce(a, lanes::max);
    job.run(Closures { greater, equal, select, min, max, least, greatest });
}

#[cfg(target_feature = "sse2")]
mod x86 {
    #[cfg(target_arch = "x86")]
    use core::arch::x86::*;
    #[cfg(target_arch = "x86_64")]
    use core::arch::x86_64::*;

    use bytemuck::cast;

    use super::{Closures, Job};
    use crate::lanes::{BIT, Ids, Lanes};

    #[target_feature(enable = "sse4.1")]
    #[inline]
    fn least_of_four(a: __m128) -> f32 {
        let b = _mm_min_ps(a, _mm_movehl_ps(a, a));
        _mm_cvtss_f32(_mm_min_ss(b, _mm_movehdup_ps(b)))
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn least_by_eight(a: &Lanes) -> f32 {
        let a: [__m256; 2] = cast(*a);
        let b: [__m128; 2] = cast(_mm256_min_ps(a[0], a[1]));
        least_of_four(_mm_min_ps(b[0], b[1]))
    }

    #[target_feature(enable = "sse4.1")]
    #[inline]
    fn greatest_of_four(a: __m128) -> f32 {
        let b = _mm_max_ps(a, _mm_movehl_ps(a, a));
        _mm_cvtss_f32(_mm_max_ss(b, _mm_movehdup_ps(b)))
    }

    #[target_feature(enable = "avx2")]
    #[inline]
    fn greatest_by_eight(a: &Lanes) -> f32 {
        let a: [__m256; 2] = cast(*a);
        let b: [__m128; 2] = cast(_mm256_max_ps(a[0], a[1]));
        greatest_of_four(_mm_max_ps(b[0], b[1]))
    }

    #[target_feature(enable = "sse4.1")]
    pub(super) fn sse41(job: Job<'_>) {
        let bit: [__m128i; 4] = cast(BIT);
        let greater = |a: &Lanes, b: &Lanes| {
            let (a, b): ([__m128; 4], [__m128; 4]) = (cast(*a), cast(*b));
            let bits = |i: usize| _mm_movemask_ps(_mm_cmpgt_ps(a[i], b[i])) as u32;
            bits(0) | bits(1) << 4 | bits(2) << 8 | bits(3) << 12
        };
        let equal = |a: &Ids, b: u32| {
            let (a, b): ([__m128i; 4], _) = (cast(*a), _mm_set1_epi32(b as i32));
            let bits =
                |i: usize| _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(a[i], b))) as u32;
            bits(0) | bits(1) << 4 | bits(2) << 8 | bits(3) << 12
        };
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            let (a, mut b): ([__m128; 4], [__m128; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                let mine = _mm_and_si128(_mm_set1_epi32(bits as i32), bit[i]);
                let set = _mm_castsi128_ps(_mm_cmpeq_epi32(mine, bit[i]));
                b[i] = _mm_blendv_ps(b[i], a[i], set);
            }
            cast(b)
        };
        let min = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([__m128; 4], [__m128; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                a[i] = _mm_min_ps(a[i], b[i]);
            }
            cast(a)
        };
        let max = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([__m128; 4], [__m128; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                a[i] = _mm_max_ps(a[i], b[i]);
            }
            cast(a)
        };
        let least = |a: &Lanes| {
            let a: [__m128; 4] = cast(*a);
            least_of_four(_mm_min_ps(_mm_min_ps(a[0], a[2]), _mm_min_ps(a[1], a[3])))
        };
        let greatest = |a: &Lanes| {
            let a: [__m128; 4] = cast(*a);
            greatest_of_four(_mm_max_ps(_mm_max_ps(a[0], a[2]), _mm_max_ps(a[1], a[3])))
        };
        job.run(Closures { greater, equal, select, min, max, least, greatest });
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn avx2(job: Job<'_>) {
        let bit: [__m256i; 2] = cast(BIT);
        let greater = |a: &Lanes, b: &Lanes| {
            let (a, b): ([__m256; 2], [__m256; 2]) = (cast(*a), cast(*b));
            let bits =
                |i: usize| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(a[i], b[i])) as u32;
            bits(0) | bits(1) << 8
        };
        let equal = |a: &Ids, b: u32| {
            let (a, b): ([__m256i; 2], _) = (cast(*a), _mm256_set1_epi32(b as i32));
            let bits = |i: usize| {
                _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(a[i], b))) as u32
            };
            bits(0) | bits(1) << 8
        };
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            let (a, mut b): ([__m256; 2], [__m256; 2]) = (cast(*a), cast(*b));
            for i in 0..2 {
                let mine = _mm256_and_si256(_mm256_set1_epi32(bits as i32), bit[i]);
                let set = _mm256_castsi256_ps(_mm256_cmpeq_epi32(mine, bit[i]));
                b[i] = _mm256_blendv_ps(b[i], a[i], set);
            }
            cast(b)
        };
        let min = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([__m256; 2], [__m256; 2]) = (cast(*a), cast(*b));
            for i in 0..2 {
                a[i] = _mm256_min_ps(a[i], b[i]);
            }
            cast(a)
        };
        let max = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([__m256; 2], [__m256; 2]) = (cast(*a), cast(*b));
            for i in 0..2 {
                a[i] = _mm256_max_ps(a[i], b[i]);
            }
            cast(a)
        };
        let least = |a: &Lanes| least_by_eight(a);
        let greatest = |a: &Lanes| greatest_by_eight(a);
        job.run(Closures { greater, equal, select, min, max, least, greatest });
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub(super) fn avx512(job: Job<'_>) {
        let greater =
            |a: &Lanes, b: &Lanes| u32::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(cast(*a), cast(*b)));
        let equal = |a: &Ids, b: u32| {
            u32::from(_mm512_cmpeq_epi32_mask(cast(*a), _mm512_set1_epi32(b as i32)))
        };
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            cast(_mm512_mask_blend_ps(bits as u16, cast(*b), cast(*a)))
        };
        let min = |a: &Lanes, b: &Lanes| cast(_mm512_min_ps(cast(*a), cast(*b)));
        let max = |a: &Lanes, b: &Lanes| cast(_mm512_max_ps(cast(*a), cast(*b)));
        let least = |a: &Lanes| least_by_eight(a);
        let greatest = |a: &Lanes| greatest_by_eight(a);
        job.run(Closures { greater, equal, select, min, max, least, greatest });
    }
}

#[cfg(all(target_arch = "aarch64", target_endian = "little"))]
mod neon {
    use core::arch::aarch64::*;

    use bytemuck::cast;

    use super::{Closures, Job};
    use crate::lanes::{self, BIT, Ids, Lanes, reduce};

    #[target_feature(enable = "neon")]
    pub(super) fn neon(job: Job<'_>) {
        let bit: [uint32x4_t; 4] = cast(BIT);
        let greater = |a: &Lanes, b: &Lanes| {
            let (a, b): ([float32x4_t; 4], [float32x4_t; 4]) = (cast(*a), cast(*b));
            let bits = |i: usize| vaddvq_u32(vandq_u32(vcgtq_f32(a[i], b[i]), bit[i]));
            bits(0) | bits(1) | bits(2) | bits(3)
        };
        let equal = |a: &Ids, b: u32| {
            let (a, b): ([uint32x4_t; 4], _) = (cast(*a), vdupq_n_u32(b));
            let bits = |i: usize| vaddvq_u32(vandq_u32(vceqq_u32(a[i], b), bit[i]));
            bits(0) | bits(1) | bits(2) | bits(3)
        };
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            let (a, mut b): ([float32x4_t; 4], [float32x4_t; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                b[i] = vbslq_f32(vtstq_u32(vdupq_n_u32(bits), bit[i]), a[i], b[i]);
            }
            cast(b)
        };
        let min = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([float32x4_t; 4], [float32x4_t; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                a[i] = vbslq_f32(vcltq_f32(a[i], b[i]), a[i], b[i]);
            }
            cast(a)
        };
        let max = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([float32x4_t; 4], [float32x4_t; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                a[i] = vbslq_f32(vcgtq_f32(a[i], b[i]), a[i], b[i]);
            }
            cast(a)
        };
        let least = |a: &Lanes| reduce(a, lanes::min);
        let greatest = |a: &Lanes| reduce(a, lanes::max);
        job.run(Closures { greater, equal, select, min, max, least, greatest });
    }
}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod wasm {
    use core::arch::wasm32::*;

    use bytemuck::cast;

    use super::{Closures, Job};
    use crate::lanes::{self, BIT, Ids, Lanes, reduce};

    #[target_feature(enable = "simd128")]
    pub(super) fn simd128(job: Job<'_>) {
        let bit: [v128; 4] = cast(BIT);
        let greater = |a: &Lanes, b: &Lanes| {
            let (a, b): ([v128; 4], [v128; 4]) = (cast(*a), cast(*b));
            let bits = |i: usize| u32::from(u32x4_bitmask(f32x4_gt(a[i], b[i])));
            bits(0) | bits(1) << 4 | bits(2) << 8 | bits(3) << 12
        };
        let equal = |a: &Ids, b: u32| {
            let (a, b): ([v128; 4], _) = (cast(*a), u32x4_splat(b));
            let bits = |i: usize| u32::from(u32x4_bitmask(u32x4_eq(a[i], b)));
            bits(0) | bits(1) << 4 | bits(2) << 8 | bits(3) << 12
        };
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            let (a, mut b): ([v128; 4], [v128; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                let set = u32x4_ne(v128_and(u32x4_splat(bits), bit[i]), u32x4_splat(0));
                b[i] = v128_bitselect(a[i], b[i], set);
            }
            cast(b)
        };
        let min = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([v128; 4], [v128; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                a[i] = f32x4_pmin(b[i], a[i]);
            }
            cast(a)
        };
        let max = |a: &Lanes, b: &Lanes| {
            let (mut a, b): ([v128; 4], [v128; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                a[i] = f32x4_pmax(b[i], a[i]);
            }
            cast(a)
        };
        let least = |a: &Lanes| reduce(a, lanes::min);
        let greatest = |a: &Lanes| reduce(a, lanes::max);
        job.run(Closures { greater, equal, select, min, max, least, greatest });
    }
}
