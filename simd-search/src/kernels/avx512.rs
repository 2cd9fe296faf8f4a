//! The kernels with AVX-512: sixteen lanes, a tile's row or a group of nodes at once.

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

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(crate) fn run(job: Job<'_>) {
    // Closures have the features of this function, which lets them call the others.
    job.run(&Kernels {
        tile: |test: &TileTest, rows: [&Row; ROWS]| tile(test, rows),
        equal: |numbers: &[u32; LANES], number: u32| equal(numbers, number),
        group: |test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup| group(test, boxes, nodes),
        leaf: |rows: [&Row; ROWS], slope: [f32; 2]| leaf(rows, slope),
    });
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
#[inline]
fn all(x: f32) -> __m512 {
    _mm512_set1_ps(x)
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn tile(test: &TileTest, rows: [&Row; ROWS]) -> u128 {
    let dx = _mm512_sub_ps(_mm512_add_ps(all(test.first), cast(LANE)), all(test.u));
    let (rise_x, dx_squared) = (_mm512_mul_ps(all(test.slope[0]), dx), _mm512_mul_ps(dx, dx));
    let mut masks = [0u16; ROWS];
    for row in 0..ROWS {
        let texels: __m512 = cast(*rows[row]);
        let rise = _mm512_add_ps(rise_x, all(test.rise[row]));
        let plane = _mm512_add_ps(_mm512_add_ps(all(test.nearness), rise), all(test.offset));
        masks[row] = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(texels, plane);
    }
    let blocks = word(masks);
    let found = if test.lit { !blocks } else { blocks };
    if found == 0 {
        return 0;
    }
    for row in 0..ROWS {
        let distance = _mm512_add_ps(dx_squared, all(test.dy_squared[row]));
        masks[row] = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(distance, all(test.reach_squared));
        if let Some(key) = test.ratio {
            let texels: __m512 = cast(*rows[row]);
            let nearer = _mm512_sub_ps(texels, all(test.nearness));
            let within = _mm512_mul_ps(all(key * RATIO_ROOM), _mm512_mul_ps(nearer, nearer));
            masks[row] &= _mm512_cmp_ps_mask::<_CMP_GT_OQ>(nearer, all(0.0))
                & _mm512_cmp_ps_mask::<_CMP_NGT_UQ>(distance, within);
        }
    }
    found & word(masks)
}

#[inline(always)]
fn word(m: [u16; ROWS]) -> u128 {
    let half = |i: usize| {
        u64::from(m[i])
            | u64::from(m[i + 1]) << 16
            | u64::from(m[i + 2]) << 32
            | u64::from(m[i + 3]) << 48
    };
    u128::from(half(0)) | u128::from(half(4)) << 64
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn equal(numbers: &[u32; LANES], number: u32) -> u32 {
    u32::from(_mm512_cmpeq_epi32_mask(cast(*numbers), _mm512_set1_epi32(number as i32)))
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn group(test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
    let gap = |low: __m512, high: __m512, axis: usize| {
        let before = _mm512_sub_ps(low, all(test.to[axis]));
        let after = _mm512_sub_ps(all(test.from[axis]), high);
        _mm512_max_ps(_mm512_max_ps(before, after), all(0.0))
    };
    let (left, right): (__m512, __m512) = (cast(boxes.left), cast(boxes.right));
    let (top, bottom): (__m512, __m512) = (cast(boxes.top), cast(boxes.bottom));
    let (dx, dy) = (gap(left, right, 0), gap(top, bottom, 1));
    let distance = _mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy));

    let plane = test.plane;
    let x = _mm512_sub_ps(_mm512_mul_ps(_mm512_add_ps(left, right), all(0.5)), all(plane.u));
    let y = _mm512_sub_ps(_mm512_mul_ps(_mm512_add_ps(top, bottom), all(0.5)), all(plane.v));
    let (x, y) = (_mm512_mul_ps(all(plane.slope.x), x), _mm512_mul_ps(all(plane.slope.y), y));
    let at_center = _mm512_add_ps(all(plane.nearness), _mm512_add_ps(x, y));

    let half_x = _mm512_mul_ps(_mm512_sub_ps(right, left), all(0.5));
    let half_y = _mm512_mul_ps(_mm512_sub_ps(bottom, top), all(0.5));
    let tilt = |x: __m512, y: __m512| {
        let (x, y) = (_mm512_abs_ps(x), _mm512_abs_ps(y));
        _mm512_add_ps(_mm512_mul_ps(x, half_x), _mm512_mul_ps(y, half_y))
    };
    let (x, y): (__m512, __m512) = (cast(nodes.slope_x), cast(nodes.slope_y));
    let (low, high): (__m512, __m512) = (cast(nodes.low), cast(nodes.high));
    let spread = tilt(_mm512_sub_ps(x, all(plane.slope.x)), _mm512_sub_ps(y, all(plane.slope.y)));
    let highest = _mm512_sub_ps(_mm512_add_ps(high, spread), at_center);
    let lowest = _mm512_sub_ps(_mm512_sub_ps(low, spread), at_center);
    let not_below = _mm512_cmp_ps_mask::<_CMP_NLE_UQ>(highest, all(test.least));
    let not_above = _mm512_cmp_ps_mask::<_CMP_NGT_UQ>(lowest, all(test.most));
    let (mut keys, mut outside) = (distance, 0);
    if let Some(cone) = test.cone {
        let nearer = _mm512_sub_ps(_mm512_add_ps(high, tilt(x, y)), all(cone.nearness));
        keys = _mm512_div_ps(distance, _mm512_mul_ps(nearer, nearer));
        outside = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(nearer, all(0.0))
            | _mm512_cmp_ps_mask::<_CMP_GT_OQ>(keys, all(cone.at_most));
    }
    let near = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(distance, all(test.reach_squared));
    Verdicts {
        may_block: u32::from(near & not_below & !outside),
        may_be_lit: u32::from(near & not_above),
        keys: cast(keys),
    }
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
fn leaf(rows: [&Row; ROWS], slope: [f32; 2]) -> Ranges {
    let (mut low, mut high) = (all(f32::INFINITY), all(f32::NEG_INFINITY));
    let mut nan = 0;
    let rise_x = _mm512_mul_ps(all(slope[0]), _mm512_add_ps(all(FIRST[0]), cast(LANE)));
    for (row, y) in rows.into_iter().zip(0u8..) {
        let texels: __m512 = cast(*row);
        let plane = _mm512_add_ps(rise_x, all(slope[1] * (FIRST[1] + f32::from(y))));
        let above = _mm512_sub_ps(texels, plane);
        // Of a NaN and a number, these take the second operand.
        (low, high) = (_mm512_min_ps(above, low), _mm512_max_ps(above, high));
        nan |= _mm512_cmp_ps_mask::<_CMP_UNORD_Q>(texels, texels);
    }
    Ranges { low: _mm512_reduce_min_ps(low), high: _mm512_reduce_max_ps(high), nan: nan != 0 }
}
