//! WebAssembly's simd128: four lanes.

use core::arch::wasm32::*;

use crate::kernels::Job;
use crate::kernels::vectors::{Vectors, kernels, operations};

#[derive(Clone, Copy)]
struct Simd128(());

#[target_feature(enable = "simd128")]
pub(crate) fn run(job: Job<'_>) {
    let v = Simd128(());
    job.run(&kernels!(v));
}

type F = v128;
type M = v128;

impl Vectors for Simd128 {
    type F = F;
    type M = M;

    operations! { safe:
        all(a: f32) -> F = f32x4_splat(a);
        add(a: F, b: F) -> F = f32x4_add(a, b);
        sub(a: F, b: F) -> F = f32x4_sub(a, b);
        mul(a: F, b: F) -> F = f32x4_mul(a, b);
        div(a: F, b: F) -> F = f32x4_div(a, b);
        abs(a: F) -> F = f32x4_abs(a);
        smaller(a: F, b: F) -> F = f32x4_pmin(b, a);
        larger(a: F, b: F) -> F = f32x4_pmax(b, a);
        greater(a: F, b: F) -> M = f32x4_gt(a, b);
        at_most(a: F, b: F) -> M = f32x4_le(a, b);
        ordered(m: M, a: F, b: F) -> M = v128_and(m, v128_and(f32x4_eq(a, a), f32x4_eq(b, b)));
        same_bits(a: F, b: u32) -> M = u32x4_eq(a, u32x4_splat(b));
        both(a: M, b: M) -> M = v128_and(a, b);
        either(a: M, b: M) -> M = v128_or(a, b);
        without(a: M, b: M) -> M = v128_andnot(a, b);
        choose(m: M, a: F, b: F) -> F = v128_bitselect(a, b, m);
        bits(m: M) -> u32 = u32::from(u32x4_bitmask(m));
    }
}
