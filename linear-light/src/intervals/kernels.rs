//! What every instruction set writes by hand, and the door to the kernels.

use shadowmap_core::Level;

use super::block::{self, Counters};
use super::bounds::{self, Nodes};
use super::frame::Frame;
use super::group::Scratch;
use super::lanes::{BIT, LANES, Lanes, Ops};

/// What is done with kernels: one band of rows at a time.
pub(super) enum Job<'a> {
    /// Bound the texels of a band of a map.
    Bound { nodes: &'a mut [Nodes], most: &'a mut f32, rows: &'a [f32], width: usize },
    /// Judge the receivers of a band of the camera's image, from row `first_row` on.
    Judge {
        frame: &'a Frame<'a>,
        first_row: usize,
        out: &'a mut [f32],
        scratch: &'a mut Scratch,
        counters: &'a mut Counters,
    },
}

impl Job<'_> {
    #[inline(always)]
    fn run(self, ops: impl Ops) {
        match self {
            Job::Bound { nodes, most, rows, width } => *most = bounds::build(nodes, rows, width),
            Job::Judge { frame, first_row, out, scratch, counters } => {
                block::judge_band(ops, frame, first_row, out, scratch, counters);
            }
        }
    }
}

/// [`Ops`] of two closures: they have the features of the function that they are made in.
#[derive(Clone, Copy)]
struct Closures<G, S> {
    greater: G,
    select: S,
}

impl<G, S> Ops for Closures<G, S>
where
    G: Fn(&Lanes, &Lanes) -> u32 + Copy,
    S: Fn(u32, &Lanes, &Lanes) -> Lanes + Copy,
{
    #[inline(always)]
    fn greater(self, a: &Lanes, b: &Lanes) -> u32 {
        (self.greater)(a, b)
    }
    #[inline(always)]
    fn select(self, bits: u32, a: &Lanes, b: &Lanes) -> Lanes {
        (self.select)(bits, a, b)
    }
}

/// Does a job with the instructions of `level`, and plainly where the level is of another
/// architecture than this program.
#[allow(unsafe_code)]
pub(super) fn run(level: Level, job: Job<'_>) {
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
        #[cfg(target_arch = "aarch64")]
        shadowmap_core::LevelKind::Neon => unsafe { neon::neon(job) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_arch = "wasm32")]
        shadowmap_core::LevelKind::Simd128 => unsafe { wasm::simd128(job) },
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
    let select = |bits: u32, a: &Lanes, b: &Lanes| {
        let mut out = *b;
        for i in 0..LANES {
            out[i] = if bits & BIT[i] != 0 { a[i] } else { b[i] };
        }
        out
    };
    job.run(Closures { greater, select });
}

#[cfg(target_feature = "sse2")]
mod x86 {
    #[cfg(target_arch = "x86")]
    use core::arch::x86::*;
    #[cfg(target_arch = "x86_64")]
    use core::arch::x86_64::*;

    use bytemuck::cast;

    use super::super::lanes::{BIT, Lanes};
    use super::{Closures, Job};

    #[target_feature(enable = "sse4.1")]
    pub(super) fn sse41(job: Job<'_>) {
        let bit: [__m128i; 4] = cast(BIT);
        let greater = |a: &Lanes, b: &Lanes| {
            let (a, b): ([__m128; 4], [__m128; 4]) = (cast(*a), cast(*b));
            let bits = |i: usize| _mm_movemask_ps(_mm_cmpgt_ps(a[i], b[i])) as u32;
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
        job.run(Closures { greater, select });
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
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            let (a, mut b): ([__m256; 2], [__m256; 2]) = (cast(*a), cast(*b));
            for i in 0..2 {
                let mine = _mm256_and_si256(_mm256_set1_epi32(bits as i32), bit[i]);
                let set = _mm256_castsi256_ps(_mm256_cmpeq_epi32(mine, bit[i]));
                b[i] = _mm256_blendv_ps(b[i], a[i], set);
            }
            cast(b)
        };
        job.run(Closures { greater, select });
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    pub(super) fn avx512(job: Job<'_>) {
        let greater =
            |a: &Lanes, b: &Lanes| u32::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(cast(*a), cast(*b)));
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            cast(_mm512_mask_blend_ps(bits as u16, cast(*b), cast(*a)))
        };
        job.run(Closures { greater, select });
    }
}

#[cfg(target_arch = "aarch64")]
mod neon {
    use core::arch::aarch64::*;

    use bytemuck::cast;

    use super::super::lanes::{BIT, Lanes};
    use super::{Closures, Job};

    #[target_feature(enable = "neon")]
    pub(super) fn neon(job: Job<'_>) {
        let bit: [uint32x4_t; 4] = cast(BIT);
        let greater = |a: &Lanes, b: &Lanes| {
            let (a, b): ([float32x4_t; 4], [float32x4_t; 4]) = (cast(*a), cast(*b));
            let bits = |i: usize| vaddvq_u32(vandq_u32(vcgtq_f32(a[i], b[i]), bit[i]));
            bits(0) | bits(1) | bits(2) | bits(3)
        };
        let select = |bits: u32, a: &Lanes, b: &Lanes| {
            let (a, mut b): ([float32x4_t; 4], [float32x4_t; 4]) = (cast(*a), cast(*b));
            for i in 0..4 {
                b[i] = vbslq_f32(vtstq_u32(vdupq_n_u32(bits), bit[i]), a[i], b[i]);
            }
            cast(b)
        };
        job.run(Closures { greater, select });
    }
}

#[cfg(target_arch = "wasm32")]
mod wasm {
    use core::arch::wasm32::*;

    use bytemuck::cast;

    use super::super::lanes::{BIT, Lanes};
    use super::{Closures, Job};

    #[target_feature(enable = "simd128")]
    pub(super) fn simd128(job: Job<'_>) {
        let bit: [v128; 4] = cast(BIT);
        let greater = |a: &Lanes, b: &Lanes| {
            let (a, b): ([v128; 4], [v128; 4]) = (cast(*a), cast(*b));
            let bits = |i: usize| u32::from(u32x4_bitmask(f32x4_gt(a[i], b[i])));
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
        job.run(Closures { greater, select });
    }
}
