//! The kernels with AVX-512: sixteen lanes, a window or a group at once.

#[cfg(target_arch = "x86")]
use core::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::*;

use bytemuck::cast;

use crate::build::{FIRST, ROWS, Ranges};
use crate::kernels::{CELL_X, CELL_Y, Job, Kernels, LANE};
use crate::map::WINDOW;
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{GroupTest, Verdicts};
use crate::search::WindowTest;

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
pub(crate) fn run(job: Job<'_>) {
    let all = |x: f32| _mm512_set1_ps(x);
    let lane: __m512 = cast(LANE);

    let window = |test: &WindowTest, texels: &[f32; WINDOW]| {
        let texels: __m512 = cast(*texels);
        let dx = _mm512_sub_ps(_mm512_add_ps(all(test.first), lane), all(test.u));
        let rise = _mm512_add_ps(_mm512_mul_ps(all(test.slope), dx), all(test.rise));
        let plane = _mm512_add_ps(_mm512_add_ps(all(test.nearness), rise), all(test.offset));
        let blocks = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(texels, plane);
        let distance = _mm512_add_ps(_mm512_mul_ps(dx, dx), all(test.dy_squared));
        let mut near = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(distance, all(test.reach_squared));
        if let Some(key) = test.ratio {
            let nearer = _mm512_sub_ps(texels, all(test.nearness));
            let within = _mm512_mul_ps(all(key), _mm512_mul_ps(nearer, nearer));
            near &= _mm512_cmp_ps_mask::<_CMP_GT_OQ>(nearer, all(0.0))
                & _mm512_cmp_ps_mask::<_CMP_NGT_UQ>(distance, within);
        }
        u32::from(near) & (u32::from(blocks) ^ test.flip)
    };

    let equal = |numbers: &[u32; LANES], number: u32| {
        u32::from(_mm512_cmpeq_epi32_mask(cast(*numbers), _mm512_set1_epi32(number as i32)))
    };

    let group = |test: &GroupTest, nodes: &NodeGroup| {
        let GroupTest { first, size, from, to, plane, .. } = *test;
        let zero = all(0.0);
        let along = |cell: __m512, axis: usize| {
            let start = _mm512_add_ps(all(first[axis]), _mm512_mul_ps(cell, all(size[axis])));
            let end = _mm512_add_ps(start, all(size[axis] - 1.0));
            let before = _mm512_sub_ps(start, all(to[axis]));
            let after = _mm512_sub_ps(all(from[axis]), end);
            let distance = _mm512_max_ps(_mm512_max_ps(before, after), zero);
            let center = _mm512_add_ps(start, all((size[axis] - 1.0) * 0.5));
            (_mm512_mul_ps(distance, distance), center)
        };
        let (dx, center_x) = along(cast(CELL_X), 0);
        let (dy, center_y) = along(cast(CELL_Y), 1);
        let distance = _mm512_add_ps(dx, dy);
        let near = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(distance, all(test.reach_squared));

        let half = [all((size[0] - 1.0) * 0.5), all((size[1] - 1.0) * 0.5)];
        let slope: [__m512; 2] = [cast(nodes.slope_x), cast(nodes.slope_y)];
        let (low, high): (__m512, __m512) = (cast(nodes.low), cast(nodes.high));
        let tilt = |slope: __m512, axis: usize| _mm512_mul_ps(_mm512_abs_ps(slope), half[axis]);
        let x = _mm512_sub_ps(center_x, all(plane.u));
        let y = _mm512_sub_ps(center_y, all(plane.v));
        let rise = _mm512_add_ps(
            _mm512_mul_ps(all(plane.slope.x), x),
            _mm512_mul_ps(all(plane.slope.y), y),
        );
        let at_center = _mm512_add_ps(all(plane.nearness), rise);
        let spread = _mm512_add_ps(
            tilt(_mm512_sub_ps(slope[0], all(plane.slope.x)), 0),
            tilt(_mm512_sub_ps(slope[1], all(plane.slope.y)), 1),
        );
        let highest = _mm512_sub_ps(_mm512_add_ps(high, spread), at_center);
        let lowest = _mm512_sub_ps(_mm512_sub_ps(low, spread), at_center);
        let below = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(highest, all(test.least));
        let above = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(lowest, all(test.most));

        let (mut keys, mut outside) = (distance, 0);
        if let Some(cone) = test.cone {
            let steep = _mm512_add_ps(tilt(slope[0], 0), tilt(slope[1], 1));
            let nearer = _mm512_sub_ps(_mm512_add_ps(high, steep), all(cone.nearness));
            keys = _mm512_div_ps(distance, _mm512_mul_ps(nearer, nearer));
            outside = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(nearer, zero)
                | _mm512_cmp_ps_mask::<_CMP_GT_OQ>(keys, all(cone.at_most));
        }
        Verdicts {
            may_block: u32::from(near & !below & !outside),
            may_be_lit: u32::from(near & !above),
            keys: cast(keys),
        }
    };

    let leaf = |texels: &[[f32; WINDOW]; ROWS], slope: [f32; 2]| {
        let mut flat = [all(f32::INFINITY), all(f32::NEG_INFINITY)];
        let mut planar = flat;
        let mut nan = 0;
        let across = _mm512_mul_ps(all(slope[0]), _mm512_add_ps(all(FIRST[0]), lane));
        for (row, y) in texels.iter().zip(0u8..) {
            let texels: __m512 = cast(*row);
            let plane = _mm512_add_ps(across, all(slope[1] * (FIRST[1] + f32::from(y))));
            let above = _mm512_sub_ps(texels, plane);
            // Of a NaN and a number, these take the second operand.
            flat = [_mm512_min_ps(texels, flat[0]), _mm512_max_ps(texels, flat[1])];
            planar = [_mm512_min_ps(above, planar[0]), _mm512_max_ps(above, planar[1])];
            nan |= _mm512_cmp_ps_mask::<_CMP_UNORD_Q>(texels, texels);
        }
        let range = |[low, high]: [__m512; 2]| {
            [_mm512_reduce_min_ps(low), _mm512_reduce_max_ps(high)]
        };
        Ranges { flat: range(flat), planar: range(planar), nan: nan != 0 }
    };

    job.run(&Kernels { window, equal, group, leaf });
}
