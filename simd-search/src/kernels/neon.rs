//! NEON: four lanes.

use core::arch::aarch64::*;

use crate::kernels::Job;
use crate::kernels::vectors::{Vectors, kernels, operations};

#[derive(Clone, Copy)]
struct Neon(());

#[target_feature(enable = "neon")]
pub(crate) fn run(job: Job<'_>) {
    let v = Neon(());
    job.run(&kernels!(v));
}

type F = float32x4_t;
type M = uint32x4_t;

impl Vectors for Neon {
    type F = F;
    type M = M;

    operations! { unsafe:
        all(a: f32) -> F = vdupq_n_f32(a);
        add(a: F, b: F) -> F = vaddq_f32(a, b);
        sub(a: F, b: F) -> F = vsubq_f32(a, b);
        mul(a: F, b: F) -> F = vmulq_f32(a, b);
        div(a: F, b: F) -> F = vdivq_f32(a, b);
        abs(a: F) -> F = vabsq_f32(a);
        smaller(a: F, b: F) -> F = vbslq_f32(vcltq_f32(a, b), a, b);
        larger(a: F, b: F) -> F = vbslq_f32(vcgtq_f32(a, b), a, b);
        greater(a: F, b: F) -> M = vcgtq_f32(a, b);
        at_most(a: F, b: F) -> M = vcleq_f32(a, b);
        ordered(m: M, a: F, b: F) -> M = vandq_u32(m, vandq_u32(vceqq_f32(a, a), vceqq_f32(b, b)));
        same_bits(a: F, b: u32) -> M = vceqq_u32(vreinterpretq_u32_f32(a), vdupq_n_u32(b));
        both(a: M, b: M) -> M = vandq_u32(a, b);
        either(a: M, b: M) -> M = vorrq_u32(a, b);
        without(a: M, b: M) -> M = vbicq_u32(a, b);
        choose(m: M, a: F, b: F) -> F = vbslq_f32(m, a, b);
        bits(m: M) -> u32 = vaddvq_u32(vandq_u32(m, bytemuck::cast([1_u32, 2, 4, 8])));
    }
}
