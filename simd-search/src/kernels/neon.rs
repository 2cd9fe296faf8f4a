//! NEON: four lanes.

use core::arch::aarch64::*;

use crate::kernels::receivers::{ask, matters, sift};
use crate::kernels::vectors::{Vectors, equal, group, leaf, operations, tile};
use crate::kernels::{Job, Kernels};
use crate::leaf::{Candidate, Leaf, SiftTest};
use crate::map::{ROWS, Row};
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{Boxes, GroupTest};
use crate::receivers::Seekers;
use crate::search::TileTest;

#[derive(Clone, Copy)]
struct Neon(());

#[target_feature(enable = "neon")]
pub(crate) fn run(job: Job<'_>) {
    let v = Neon(());
    // Closures have the features of this function.
    job.run(&Kernels {
        tile: |test: &TileTest, rows: [&Row; ROWS]| tile(v, test, rows),
        sift: |test: &SiftTest, rows: [&Row; ROWS]| sift(v, test, rows),
        equal: |numbers: &[u32; LANES], number: u32| equal(v, numbers, number),
        group: |test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup| group(v, test, boxes, nodes),
        leaf: |rows: [&Row; ROWS], slope: [f32; 2]| leaf(v, rows, slope),
        matters: |leaf: &Leaf, rows: [&Row; ROWS], seekers: &Seekers, lit: bool| {
            matters(v, leaf, rows, seekers, lit)
        },
        ask: |texels: &[Candidate], seekers: &mut Seekers, lanes: u64, lit: bool| {
            ask(v, texels, seekers, lanes, lit)
        },
    });
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
        same_bits(a: F, b: u32) -> M = vceqq_u32(vreinterpretq_u32_f32(a), vdupq_n_u32(b));
        both(a: M, b: M) -> M = vandq_u32(a, b);
        either(a: M, b: M) -> M = vorrq_u32(a, b);
        choose(m: M, a: F, b: F) -> F = vbslq_f32(m, a, b);
        bits(m: M) -> u32 = vaddvq_u32(vandq_u32(m, bytemuck::cast([1_u32, 2, 4, 8])));
    }
}
