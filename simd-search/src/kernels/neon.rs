//! The kernels with NEON: four vectors of four lanes.

use core::arch::aarch64::*;

use bytemuck::cast;

use crate::build::{FIRST, Ranges};
use crate::kernels::{Job, Kernels, LANE};
use crate::map::{ROWS, Row};
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{Boxes, GroupTest, Verdicts};
use crate::search::{RATIO_ROOM, TileTest};

/// Vectors in a tile's row or a group of nodes, and lanes in a vector.
const PARTS: usize = 4;
const WIDTH: usize = 4;

type Vectors = [float32x4_t; PARTS];

#[target_feature(enable = "neon")]
pub(crate) fn run(job: Job<'_>) {
    // Closures have the features of this function, which lets them call the others.
    job.run(&Kernels {
        tile: |test: &TileTest, rows: [&Row; ROWS]| tile(test, rows),
        equal: |numbers: &[u32; LANES], number: u32| equal(numbers, number),
        group: |test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup| group(test, boxes, nodes),
        leaf: |rows: [&Row; ROWS], slope: [f32; 2]| leaf(rows, slope),
    });
}

#[target_feature(enable = "neon")]
#[inline]
fn all(x: f32) -> float32x4_t {
    vdupq_n_f32(x)
}

/// A mask as bits, those of vector `part` in their place.
#[target_feature(enable = "neon")]
#[inline]
fn bits(mask: uint32x4_t, part: usize) -> u32 {
    vaddvq_u32(vandq_u32(mask, cast([1_u32, 2, 4, 8]))) << (WIDTH * part)
}

#[target_feature(enable = "neon")]
fn tile(test: &TileTest, rows: [&Row; ROWS]) -> u128 {
    let lane: Vectors = cast(LANE);
    let (mut near, mut blocks) = ([0u16; ROWS], [0u16; ROWS]);
    for part in 0..PARTS {
        let dx = vsubq_f32(vaddq_f32(all(test.first), lane[part]), all(test.u));
        let (rise_x, dx_squared) = (vmulq_f32(all(test.slope[0]), dx), vmulq_f32(dx, dx));
        for row in 0..ROWS {
            let texels = cast::<Row, Vectors>(*rows[row])[part];
            let rise = vaddq_f32(rise_x, all(test.rise[row]));
            let plane = vaddq_f32(vaddq_f32(all(test.nearness), rise), all(test.offset));
            let distance = vaddq_f32(dx_squared, all(test.dy_squared[row]));
            let mut within = vcleq_f32(distance, all(test.reach_squared));
            if let Some(key) = test.ratio {
                let nearer = vsubq_f32(texels, all(test.nearness));
                let most = vmulq_f32(all(key * RATIO_ROOM), vmulq_f32(nearer, nearer));
                within = vandq_u32(within, vcgtq_f32(nearer, all(0.0)));
                within = vandq_u32(within, vmvnq_u32(vcgtq_f32(distance, most)));
            }
            near[row] |= bits(within, part) as u16;
            blocks[row] |= bits(vcgtq_f32(texels, plane), part) as u16;
        }
    }
    let (near, blocks): (u128, u128) = (cast(near), cast(blocks));
    if test.lit { near & !blocks } else { near & blocks }
}

#[target_feature(enable = "neon")]
fn equal(numbers: &[u32; LANES], number: u32) -> u32 {
    let (numbers, number): ([uint32x4_t; PARTS], _) = (cast(*numbers), vdupq_n_u32(number));
    (0..PARTS).fold(0, |found, part| {
        let equal = vceqq_u32(numbers[part], number);
        found | bits(equal, part)
    })
}

#[target_feature(enable = "neon")]
fn group(test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
    let gap = |low: float32x4_t, high: float32x4_t, axis: usize| {
        let before = vsubq_f32(low, all(test.to[axis]));
        let after = vsubq_f32(all(test.from[axis]), high);
        vmaxq_f32(vmaxq_f32(before, after), all(0.0))
    };
    let (left, right): (Vectors, Vectors) = (cast(boxes.left), cast(boxes.right));
    let (top, bottom): (Vectors, Vectors) = (cast(boxes.top), cast(boxes.bottom));
    let (slope_x, slope_y): (Vectors, Vectors) = (cast(nodes.slope_x), cast(nodes.slope_y));
    let (low, high): (Vectors, Vectors) = (cast(nodes.low), cast(nodes.high));
    let plane = test.plane;
    let (mut keys, mut may_block, mut may_be_lit) = ([all(0.0); PARTS], 0, 0);
    for part in 0..PARTS {
        let (left, right, top, bottom) = (left[part], right[part], top[part], bottom[part]);
        let (dx, dy) = (gap(left, right, 0), gap(top, bottom, 1));
        let distance = vaddq_f32(vmulq_f32(dx, dx), vmulq_f32(dy, dy));
        keys[part] = distance;

        let x = vsubq_f32(vmulq_f32(vaddq_f32(left, right), all(0.5)), all(plane.u));
        let y = vsubq_f32(vmulq_f32(vaddq_f32(top, bottom), all(0.5)), all(plane.v));
        let (x, y) = (vmulq_f32(all(plane.slope.x), x), vmulq_f32(all(plane.slope.y), y));
        let at_center = vaddq_f32(all(plane.nearness), vaddq_f32(x, y));

        let half_x = vmulq_f32(vsubq_f32(right, left), all(0.5));
        let half_y = vmulq_f32(vsubq_f32(bottom, top), all(0.5));
        let tilt = |x: float32x4_t, y: float32x4_t| {
            let (x, y) = (vabsq_f32(x), vabsq_f32(y));
            vaddq_f32(vmulq_f32(x, half_x), vmulq_f32(y, half_y))
        };
        let (x, y) = (slope_x[part], slope_y[part]);
        let spread = tilt(vsubq_f32(x, all(plane.slope.x)), vsubq_f32(y, all(plane.slope.y)));
        let highest = vsubq_f32(vaddq_f32(high[part], spread), at_center);
        let lowest = vsubq_f32(vsubq_f32(low[part], spread), at_center);
        let near = vcleq_f32(distance, all(test.reach_squared));
        let not_above = vmvnq_u32(vcgtq_f32(lowest, all(test.most)));
        let mut counts = vandq_u32(near, vmvnq_u32(vcleq_f32(highest, all(test.least))));
        if let Some(cone) = test.cone {
            let most = vaddq_f32(high[part], tilt(x, y));
            let nearer = vsubq_f32(most, all(cone.nearness));
            keys[part] = vdivq_f32(distance, vmulq_f32(nearer, nearer));
            counts = vandq_u32(counts, vmvnq_u32(vcleq_f32(nearer, all(0.0))));
            counts = vandq_u32(counts, vmvnq_u32(vcgtq_f32(keys[part], all(cone.at_most))));
        }
        may_block |= bits(counts, part);
        may_be_lit |= bits(vandq_u32(near, not_above), part);
    }
    Verdicts { may_block, may_be_lit, keys: cast(keys) }
}

#[target_feature(enable = "neon")]
fn leaf(rows: [&Row; ROWS], slope: [f32; 2]) -> Ranges {
    let lane: Vectors = cast(LANE);
    let (mut low, mut high) = (all(f32::INFINITY), all(f32::NEG_INFINITY));
    let mut nan = vdupq_n_u32(0);
    for part in 0..PARTS {
        let rise_x = vmulq_f32(all(slope[0]), vaddq_f32(all(FIRST[0]), lane[part]));
        for (row, y) in rows.into_iter().zip(0u8..) {
            let texels = cast::<Row, Vectors>(*row)[part];
            let plane = vaddq_f32(rise_x, all(slope[1] * (FIRST[1] + f32::from(y))));
            let above = vsubq_f32(texels, plane);
            // Of a NaN and a number, these take the number.
            (low, high) = (vminnmq_f32(above, low), vmaxnmq_f32(above, high));
            nan = vorrq_u32(nan, vmvnq_u32(vceqq_f32(texels, texels)));
        }
    }
    let fold = |lanes: float32x4_t, smaller: fn(f32, f32) -> f32| {
        let lanes: [f32; WIDTH] = cast(lanes);
        lanes.into_iter().fold(lanes[0], smaller)
    };
    Ranges { low: fold(low, f32::min), high: fold(high, f32::max), nan: bits(nan, 0) != 0 }
}
