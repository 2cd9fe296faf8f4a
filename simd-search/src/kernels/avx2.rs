//! The kernels with AVX2: two vectors of eight lanes.

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
const PARTS: usize = 2;
const WIDTH: usize = 8;

type Vectors = [__m256; PARTS];

#[target_feature(enable = "avx2")]
pub(crate) fn run(job: Job<'_>) {
    // Closures have the features of this function, which lets them call the others.
    job.run(&Kernels {
        tile: |test: &TileTest, rows: [&Row; ROWS]| tile(test, rows),
        equal: |numbers: &[u32; LANES], number: u32| equal(numbers, number),
        group: |test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup| group(test, boxes, nodes),
        leaf: |rows: [&Row; ROWS], slope: [f32; 2]| leaf(rows, slope),
    });
}

#[target_feature(enable = "avx2")]
#[inline]
fn all(x: f32) -> __m256 {
    _mm256_set1_ps(x)
}

/// A mask as bits, those of vector `part` in their place.
#[target_feature(enable = "avx2")]
#[inline]
fn bits(mask: __m256, part: usize) -> u32 {
    (_mm256_movemask_ps(mask) as u32) << (WIDTH * part)
}

#[target_feature(enable = "avx2")]
fn tile(test: &TileTest, rows: [&Row; ROWS]) -> u128 {
    let lane: Vectors = cast(LANE);
    let (mut near, mut blocks) = ([0u16; ROWS], [0u16; ROWS]);
    for part in 0..PARTS {
        let dx = _mm256_sub_ps(_mm256_add_ps(all(test.first), lane[part]), all(test.u));
        let (rise_x, dx_squared) = (_mm256_mul_ps(all(test.slope[0]), dx), _mm256_mul_ps(dx, dx));
        for row in 0..ROWS {
            let texels = cast::<Row, Vectors>(*rows[row])[part];
            let rise = _mm256_add_ps(rise_x, all(test.rise[row]));
            let plane = _mm256_add_ps(_mm256_add_ps(all(test.nearness), rise), all(test.offset));
            let distance = _mm256_add_ps(dx_squared, all(test.dy_squared[row]));
            let mut within = _mm256_cmp_ps::<_CMP_LE_OQ>(distance, all(test.reach_squared));
            if let Some(key) = test.ratio {
                let nearer = _mm256_sub_ps(texels, all(test.nearness));
                let most = _mm256_mul_ps(all(key * RATIO_ROOM), _mm256_mul_ps(nearer, nearer));
                within = _mm256_and_ps(within, _mm256_cmp_ps::<_CMP_GT_OQ>(nearer, all(0.0)));
                within = _mm256_and_ps(within, _mm256_cmp_ps::<_CMP_NGT_UQ>(distance, most));
            }
            near[row] |= bits(within, part) as u16;
            blocks[row] |= bits(_mm256_cmp_ps::<_CMP_GT_OQ>(texels, plane), part) as u16;
        }
    }
    let (near, blocks): (u128, u128) = (cast(near), cast(blocks));
    if test.lit { near & !blocks } else { near & blocks }
}

#[target_feature(enable = "avx2")]
fn equal(numbers: &[u32; LANES], number: u32) -> u32 {
    let (numbers, number): ([__m256i; PARTS], _) =
        (cast(*numbers), _mm256_set1_epi32(number as i32));
    (0..PARTS).fold(0, |found, part| {
        let equal = _mm256_cmpeq_epi32(numbers[part], number);
        found | bits(_mm256_castsi256_ps(equal), part)
    })
}

#[target_feature(enable = "avx2")]
fn group(test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
    let gap = |low: __m256, high: __m256, axis: usize| {
        let before = _mm256_sub_ps(low, all(test.to[axis]));
        let after = _mm256_sub_ps(all(test.from[axis]), high);
        _mm256_max_ps(_mm256_max_ps(before, after), all(0.0))
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
        let distance = _mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy));
        keys[part] = distance;

        let x = _mm256_sub_ps(_mm256_mul_ps(_mm256_add_ps(left, right), all(0.5)), all(plane.u));
        let y = _mm256_sub_ps(_mm256_mul_ps(_mm256_add_ps(top, bottom), all(0.5)), all(plane.v));
        let (x, y) = (_mm256_mul_ps(all(plane.slope.x), x), _mm256_mul_ps(all(plane.slope.y), y));
        let at_center = _mm256_add_ps(all(plane.nearness), _mm256_add_ps(x, y));

        let half_x = _mm256_mul_ps(_mm256_sub_ps(right, left), all(0.5));
        let half_y = _mm256_mul_ps(_mm256_sub_ps(bottom, top), all(0.5));
        let tilt = |x: __m256, y: __m256| {
            let (x, y) = (_mm256_andnot_ps(all(-0.0), x), _mm256_andnot_ps(all(-0.0), y));
            _mm256_add_ps(_mm256_mul_ps(x, half_x), _mm256_mul_ps(y, half_y))
        };
        let (x, y) = (slope_x[part], slope_y[part]);
        let spread =
            tilt(_mm256_sub_ps(x, all(plane.slope.x)), _mm256_sub_ps(y, all(plane.slope.y)));
        let highest = _mm256_sub_ps(_mm256_add_ps(high[part], spread), at_center);
        let lowest = _mm256_sub_ps(_mm256_sub_ps(low[part], spread), at_center);
        let near = _mm256_cmp_ps::<_CMP_LE_OQ>(distance, all(test.reach_squared));
        let not_above = _mm256_cmp_ps::<_CMP_NGT_UQ>(lowest, all(test.most));
        let mut counts =
            _mm256_and_ps(near, _mm256_cmp_ps::<_CMP_NLE_UQ>(highest, all(test.least)));
        if let Some(cone) = test.cone {
            let most = _mm256_add_ps(high[part], tilt(x, y));
            let nearer = _mm256_sub_ps(most, all(cone.nearness));
            keys[part] = _mm256_div_ps(distance, _mm256_mul_ps(nearer, nearer));
            counts = _mm256_and_ps(counts, _mm256_cmp_ps::<_CMP_NLE_UQ>(nearer, all(0.0)));
            counts =
                _mm256_and_ps(counts, _mm256_cmp_ps::<_CMP_NGT_UQ>(keys[part], all(cone.at_most)));
        }
        may_block |= bits(counts, part);
        may_be_lit |= bits(_mm256_and_ps(near, not_above), part);
    }
    Verdicts { may_block, may_be_lit, keys: cast(keys) }
}

#[target_feature(enable = "avx2")]
fn leaf(rows: [&Row; ROWS], slope: [f32; 2]) -> Ranges {
    let lane: Vectors = cast(LANE);
    let (mut low, mut high) = (all(f32::INFINITY), all(f32::NEG_INFINITY));
    let mut nan = all(0.0);
    for part in 0..PARTS {
        let rise_x = _mm256_mul_ps(all(slope[0]), _mm256_add_ps(all(FIRST[0]), lane[part]));
        for (row, y) in rows.into_iter().zip(0u8..) {
            let texels = cast::<Row, Vectors>(*row)[part];
            let plane = _mm256_add_ps(rise_x, all(slope[1] * (FIRST[1] + f32::from(y))));
            let above = _mm256_sub_ps(texels, plane);
            // Of a NaN and a number, these take the second operand.
            (low, high) = (_mm256_min_ps(above, low), _mm256_max_ps(above, high));
            nan = _mm256_or_ps(nan, _mm256_cmp_ps::<_CMP_UNORD_Q>(texels, texels));
        }
    }
    let fold = |lanes: __m256, smaller: fn(f32, f32) -> f32| {
        let lanes: [f32; WIDTH] = cast(lanes);
        lanes.into_iter().fold(lanes[0], smaller)
    };
    Ranges { low: fold(low, f32::min), high: fold(high, f32::max), nan: bits(nan, 0) != 0 }
}
