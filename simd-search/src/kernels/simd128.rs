//! The kernels with WebAssembly's simd128: four vectors of four lanes.

use core::arch::wasm32::*;

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

type Vectors = [v128; PARTS];

#[target_feature(enable = "simd128")]
pub(crate) fn run(job: Job<'_>) {
    // Closures have the features of this function, which lets them call the others.
    job.run(&Kernels {
        tile: |test: &TileTest, rows: [&Row; ROWS]| tile(test, rows),
        equal: |numbers: &[u32; LANES], number: u32| equal(numbers, number),
        group: |test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup| group(test, boxes, nodes),
        leaf: |rows: [&Row; ROWS], slope: [f32; 2]| leaf(rows, slope),
    });
}

#[target_feature(enable = "simd128")]
#[inline]
fn all(x: f32) -> v128 {
    f32x4_splat(x)
}

/// A mask as bits, those of vector `part` in their place.
#[target_feature(enable = "simd128")]
#[inline]
fn bits(mask: v128, part: usize) -> u32 {
    u32::from(u32x4_bitmask(mask)) << (WIDTH * part)
}

#[target_feature(enable = "simd128")]
fn tile(test: &TileTest, rows: [&Row; ROWS]) -> u128 {
    let lane: Vectors = cast(LANE);
    let (mut near, mut blocks) = ([0u16; ROWS], [0u16; ROWS]);
    for part in 0..PARTS {
        let dx = f32x4_sub(f32x4_add(all(test.first), lane[part]), all(test.u));
        let (rise_x, dx_squared) = (f32x4_mul(all(test.slope[0]), dx), f32x4_mul(dx, dx));
        for row in 0..ROWS {
            let texels = cast::<Row, Vectors>(*rows[row])[part];
            let rise = f32x4_add(rise_x, all(test.rise[row]));
            let plane = f32x4_add(f32x4_add(all(test.nearness), rise), all(test.offset));
            let distance = f32x4_add(dx_squared, all(test.dy_squared[row]));
            let mut within = f32x4_le(distance, all(test.reach_squared));
            if let Some(key) = test.ratio {
                let nearer = f32x4_sub(texels, all(test.nearness));
                let most = f32x4_mul(all(key * RATIO_ROOM), f32x4_mul(nearer, nearer));
                within = v128_and(within, f32x4_gt(nearer, all(0.0)));
                within = v128_and(within, v128_not(f32x4_gt(distance, most)));
            }
            near[row] |= bits(within, part) as u16;
            blocks[row] |= bits(f32x4_gt(texels, plane), part) as u16;
        }
    }
    let (near, blocks): (u128, u128) = (cast(near), cast(blocks));
    if test.lit { near & !blocks } else { near & blocks }
}

#[target_feature(enable = "simd128")]
fn equal(numbers: &[u32; LANES], number: u32) -> u32 {
    let (numbers, number): ([v128; PARTS], _) = (cast(*numbers), u32x4_splat(number));
    (0..PARTS).fold(0, |found, part| {
        let equal = u32x4_eq(numbers[part], number);
        found | bits(equal, part)
    })
}

#[target_feature(enable = "simd128")]
fn group(test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
    let gap = |low: v128, high: v128, axis: usize| {
        let before = f32x4_sub(low, all(test.to[axis]));
        let after = f32x4_sub(all(test.from[axis]), high);
        f32x4_max(f32x4_max(before, after), all(0.0))
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
        let distance = f32x4_add(f32x4_mul(dx, dx), f32x4_mul(dy, dy));
        keys[part] = distance;

        let x = f32x4_sub(f32x4_mul(f32x4_add(left, right), all(0.5)), all(plane.u));
        let y = f32x4_sub(f32x4_mul(f32x4_add(top, bottom), all(0.5)), all(plane.v));
        let (x, y) = (f32x4_mul(all(plane.slope.x), x), f32x4_mul(all(plane.slope.y), y));
        let at_center = f32x4_add(all(plane.nearness), f32x4_add(x, y));

        let half_x = f32x4_mul(f32x4_sub(right, left), all(0.5));
        let half_y = f32x4_mul(f32x4_sub(bottom, top), all(0.5));
        let tilt = |x: v128, y: v128| {
            let (x, y) = (f32x4_abs(x), f32x4_abs(y));
            f32x4_add(f32x4_mul(x, half_x), f32x4_mul(y, half_y))
        };
        let (x, y) = (slope_x[part], slope_y[part]);
        let spread = tilt(f32x4_sub(x, all(plane.slope.x)), f32x4_sub(y, all(plane.slope.y)));
        let highest = f32x4_sub(f32x4_add(high[part], spread), at_center);
        let lowest = f32x4_sub(f32x4_sub(low[part], spread), at_center);
        let near = f32x4_le(distance, all(test.reach_squared));
        let not_above = v128_not(f32x4_gt(lowest, all(test.most)));
        let mut counts = v128_and(near, v128_not(f32x4_le(highest, all(test.least))));
        if let Some(cone) = test.cone {
            let most = f32x4_add(high[part], tilt(x, y));
            let nearer = f32x4_sub(most, all(cone.nearness));
            keys[part] = f32x4_div(distance, f32x4_mul(nearer, nearer));
            counts = v128_and(counts, v128_not(f32x4_le(nearer, all(0.0))));
            counts = v128_and(counts, v128_not(f32x4_gt(keys[part], all(cone.at_most))));
        }
        may_block |= bits(counts, part);
        may_be_lit |= bits(v128_and(near, not_above), part);
    }
    Verdicts { may_block, may_be_lit, keys: cast(keys) }
}

#[target_feature(enable = "simd128")]
fn leaf(rows: [&Row; ROWS], slope: [f32; 2]) -> Ranges {
    let lane: Vectors = cast(LANE);
    let (mut low, mut high) = (all(f32::INFINITY), all(f32::NEG_INFINITY));
    let mut nan = u32x4_splat(0);
    for part in 0..PARTS {
        let rise_x = f32x4_mul(all(slope[0]), f32x4_add(all(FIRST[0]), lane[part]));
        for (row, y) in rows.into_iter().zip(0u8..) {
            let texels = cast::<Row, Vectors>(*row)[part];
            let plane = f32x4_add(rise_x, all(slope[1] * (FIRST[1] + f32::from(y))));
            let above = f32x4_sub(texels, plane);
            // Of a number and a NaN, these take the first operand.
            (low, high) = (f32x4_pmin(low, above), f32x4_pmax(high, above));
            nan = v128_or(nan, f32x4_ne(texels, texels));
        }
    }
    let fold = |lanes: v128, smaller: fn(f32, f32) -> f32| {
        let lanes: [f32; WIDTH] = cast(lanes);
        lanes.into_iter().fold(lanes[0], smaller)
    };
    Ranges { low: fold(low, f32::min), high: fold(high, f32::max), nan: bits(nan, 0) != 0 }
}
