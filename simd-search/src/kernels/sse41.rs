//! The kernels with SSE4.1: four vectors of four lanes.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

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

type Vectors = [__m128; PARTS];

#[target_feature(enable = "sse4.1")]
pub(crate) fn run(job: Job<'_>) {
    // Closures have the features of this function, which lets them call the others.
    job.run(&Kernels {
        tile: |test: &TileTest, rows: [&Row; ROWS]| tile(test, rows),
        equal: |numbers: &[u32; LANES], number: u32| equal(numbers, number),
        group: |test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup| group(test, boxes, nodes),
        leaf: |rows: [&Row; ROWS], slope: [f32; 2]| leaf(rows, slope),
    });
}

#[target_feature(enable = "sse4.1")]
#[inline]
fn all(x: f32) -> __m128 {
    _mm_set1_ps(x)
}

/// A mask as bits, those of vector `part` in their place.
#[target_feature(enable = "sse4.1")]
#[inline]
fn bits(mask: __m128, part: usize) -> u32 {
    (_mm_movemask_ps(mask) as u32) << (WIDTH * part)
}

#[target_feature(enable = "sse4.1")]
fn tile(test: &TileTest, rows: [&Row; ROWS]) -> u128 {
    let lane: Vectors = cast(LANE);
    let (mut near, mut blocks) = ([0u16; ROWS], [0u16; ROWS]);
    for part in 0..PARTS {
        let dx = _mm_sub_ps(_mm_add_ps(all(test.first), lane[part]), all(test.u));
        let (rise_x, dx_squared) = (_mm_mul_ps(all(test.slope[0]), dx), _mm_mul_ps(dx, dx));
        for row in 0..ROWS {
            let texels = cast::<Row, Vectors>(*rows[row])[part];
            let rise = _mm_add_ps(rise_x, all(test.rise[row]));
            let plane = _mm_add_ps(_mm_add_ps(all(test.nearness), rise), all(test.offset));
            let distance = _mm_add_ps(dx_squared, all(test.dy_squared[row]));
            let mut within = _mm_cmple_ps(distance, all(test.reach_squared));
            if let Some(key) = test.ratio {
                let nearer = _mm_sub_ps(texels, all(test.nearness));
                let most = _mm_mul_ps(all(key * RATIO_ROOM), _mm_mul_ps(nearer, nearer));
                within = _mm_and_ps(within, _mm_cmpgt_ps(nearer, all(0.0)));
                within = _mm_and_ps(within, _mm_cmpngt_ps(distance, most));
            }
            near[row] |= bits(within, part) as u16;
            blocks[row] |= bits(_mm_cmpgt_ps(texels, plane), part) as u16;
        }
    }
    let (near, blocks): (u128, u128) = (cast(near), cast(blocks));
    if test.lit { near & !blocks } else { near & blocks }
}

#[target_feature(enable = "sse4.1")]
fn equal(numbers: &[u32; LANES], number: u32) -> u32 {
    let (numbers, number): ([__m128i; PARTS], _) = (cast(*numbers), _mm_set1_epi32(number as i32));
    (0..PARTS).fold(0, |found, part| {
        let equal = _mm_cmpeq_epi32(numbers[part], number);
        found | bits(_mm_castsi128_ps(equal), part)
    })
}

#[target_feature(enable = "sse4.1")]
fn group(test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
    let gap = |low: __m128, high: __m128, axis: usize| {
        let before = _mm_sub_ps(low, all(test.to[axis]));
        let after = _mm_sub_ps(all(test.from[axis]), high);
        _mm_max_ps(_mm_max_ps(before, after), all(0.0))
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
        let distance = _mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy));
        keys[part] = distance;

        let x = _mm_sub_ps(_mm_mul_ps(_mm_add_ps(left, right), all(0.5)), all(plane.u));
        let y = _mm_sub_ps(_mm_mul_ps(_mm_add_ps(top, bottom), all(0.5)), all(plane.v));
        let (x, y) = (_mm_mul_ps(all(plane.slope.x), x), _mm_mul_ps(all(plane.slope.y), y));
        let at_center = _mm_add_ps(all(plane.nearness), _mm_add_ps(x, y));

        let half_x = _mm_mul_ps(_mm_sub_ps(right, left), all(0.5));
        let half_y = _mm_mul_ps(_mm_sub_ps(bottom, top), all(0.5));
        let tilt = |x: __m128, y: __m128| {
            let (x, y) = (_mm_andnot_ps(all(-0.0), x), _mm_andnot_ps(all(-0.0), y));
            _mm_add_ps(_mm_mul_ps(x, half_x), _mm_mul_ps(y, half_y))
        };
        let (x, y) = (slope_x[part], slope_y[part]);
        let spread = tilt(_mm_sub_ps(x, all(plane.slope.x)), _mm_sub_ps(y, all(plane.slope.y)));
        let highest = _mm_sub_ps(_mm_add_ps(high[part], spread), at_center);
        let lowest = _mm_sub_ps(_mm_sub_ps(low[part], spread), at_center);
        let near = _mm_cmple_ps(distance, all(test.reach_squared));
        let not_above = _mm_cmpngt_ps(lowest, all(test.most));
        let mut counts = _mm_and_ps(near, _mm_cmpnle_ps(highest, all(test.least)));
        if let Some(cone) = test.cone {
            let most = _mm_add_ps(high[part], tilt(x, y));
            let nearer = _mm_sub_ps(most, all(cone.nearness));
            keys[part] = _mm_div_ps(distance, _mm_mul_ps(nearer, nearer));
            counts = _mm_and_ps(counts, _mm_cmpnle_ps(nearer, all(0.0)));
            counts = _mm_and_ps(counts, _mm_cmpngt_ps(keys[part], all(cone.at_most)));
        }
        may_block |= bits(counts, part);
        may_be_lit |= bits(_mm_and_ps(near, not_above), part);
    }
    Verdicts { may_block, may_be_lit, keys: cast(keys) }
}

#[target_feature(enable = "sse4.1")]
fn leaf(rows: [&Row; ROWS], slope: [f32; 2]) -> Ranges {
    let lane: Vectors = cast(LANE);
    let (mut low, mut high) = (all(f32::INFINITY), all(f32::NEG_INFINITY));
    let mut nan = all(0.0);
    for part in 0..PARTS {
        let rise_x = _mm_mul_ps(all(slope[0]), _mm_add_ps(all(FIRST[0]), lane[part]));
        for (row, y) in rows.into_iter().zip(0u8..) {
            let texels = cast::<Row, Vectors>(*row)[part];
            let plane = _mm_add_ps(rise_x, all(slope[1] * (FIRST[1] + f32::from(y))));
            let above = _mm_sub_ps(texels, plane);
            // Of a NaN and a number, these take the second operand.
            (low, high) = (_mm_min_ps(above, low), _mm_max_ps(above, high));
            nan = _mm_or_ps(nan, _mm_cmpunord_ps(texels, texels));
        }
    }
    let fold = |lanes: __m128, smaller: fn(f32, f32) -> f32| {
        let lanes: [f32; WIDTH] = cast(lanes);
        lanes.into_iter().fold(lanes[0], smaller)
    };
    Ranges { low: fold(low, f32::min), high: fold(high, f32::max), nan: bits(nan, 0) != 0 }
}
