//! The kernels with AVX2: two times eight lanes.

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

#[target_feature(enable = "avx2")]
pub(crate) fn run(job: Job<'_>) {
    let all = |x: f32| _mm256_set1_ps(x);
    let bits = |mask: __m256| _mm256_movemask_ps(mask) as u32;
    let lane: [__m256; 2] = cast(LANE);

    let window = |test: &WindowTest, texels: &[f32; WINDOW]| {
        let texels: [__m256; 2] = cast(*texels);
        let mut found = 0;
        for i in 0..2 {
            let dx = _mm256_sub_ps(_mm256_add_ps(all(test.first), lane[i]), all(test.u));
            let rise = _mm256_add_ps(_mm256_mul_ps(all(test.slope), dx), all(test.rise));
            let plane = _mm256_add_ps(_mm256_add_ps(all(test.nearness), rise), all(test.offset));
            let blocks = _mm256_cmp_ps::<_CMP_GT_OQ>(texels[i], plane);
            let distance = _mm256_add_ps(_mm256_mul_ps(dx, dx), all(test.dy_squared));
            let mut near = _mm256_cmp_ps::<_CMP_LE_OQ>(distance, all(test.reach_squared));
            if let Some(key) = test.ratio {
                let nearer = _mm256_sub_ps(texels[i], all(test.nearness));
                let within = _mm256_mul_ps(all(key), _mm256_mul_ps(nearer, nearer));
                near = _mm256_and_ps(near, _mm256_cmp_ps::<_CMP_GT_OQ>(nearer, all(0.0)));
                near = _mm256_and_ps(near, _mm256_cmp_ps::<_CMP_NGT_UQ>(distance, within));
            }
            found |= (bits(near) & (bits(blocks) ^ (test.flip & 0xff))) << (8 * i);
        }
        found
    };

    let equal = |numbers: &[u32; LANES], number: u32| {
        let [low, high]: [__m256i; 2] = cast(*numbers);
        let same = |x| {
            let equal = _mm256_cmpeq_epi32(x, _mm256_set1_epi32(number as i32));
            bits(_mm256_castsi256_ps(equal))
        };
        same(low) | same(high) << 8
    };

    let group = |test: &GroupTest, nodes: &NodeGroup| {
        let GroupTest { first, size, from, to, plane, .. } = *test;
        let zero = all(0.0);
        let along = |cell: __m256, axis: usize| {
            let start = _mm256_add_ps(all(first[axis]), _mm256_mul_ps(cell, all(size[axis])));
            let end = _mm256_add_ps(start, all(size[axis] - 1.0));
            let before = _mm256_sub_ps(start, all(to[axis]));
            let after = _mm256_sub_ps(all(from[axis]), end);
            let distance = _mm256_max_ps(_mm256_max_ps(before, after), zero);
            let center = _mm256_add_ps(start, all((size[axis] - 1.0) * 0.5));
            (_mm256_mul_ps(distance, distance), center)
        };
        let half = [all((size[0] - 1.0) * 0.5), all((size[1] - 1.0) * 0.5)];
        let tilt = |slope: __m256, axis: usize| {
            _mm256_mul_ps(_mm256_andnot_ps(all(-0.0), slope), half[axis])
        };
        let (cell_x, cell_y): ([__m256; 2], [__m256; 2]) = (cast(CELL_X), cast(CELL_Y));
        let slope: [[__m256; 2]; 2] = [cast(nodes.slope_x), cast(nodes.slope_y)];
        let (low, high): ([__m256; 2], [__m256; 2]) = (cast(nodes.low), cast(nodes.high));
        let (mut may_block, mut may_be_lit, mut all_keys) = (0, 0, [zero; 2]);
        for i in 0..2 {
            let (dx, center_x) = along(cell_x[i], 0);
            let (dy, center_y) = along(cell_y[i], 1);
            let distance = _mm256_add_ps(dx, dy);
            let near = bits(_mm256_cmp_ps::<_CMP_LE_OQ>(distance, all(test.reach_squared)));

            let x = _mm256_sub_ps(center_x, all(plane.u));
            let y = _mm256_sub_ps(center_y, all(plane.v));
            let rise = _mm256_add_ps(
                _mm256_mul_ps(all(plane.slope.x), x),
                _mm256_mul_ps(all(plane.slope.y), y),
            );
            let at_center = _mm256_add_ps(all(plane.nearness), rise);
            let spread = _mm256_add_ps(
                tilt(_mm256_sub_ps(slope[0][i], all(plane.slope.x)), 0),
                tilt(_mm256_sub_ps(slope[1][i], all(plane.slope.y)), 1),
            );
            let highest = _mm256_sub_ps(_mm256_add_ps(high[i], spread), at_center);
            let lowest = _mm256_sub_ps(_mm256_sub_ps(low[i], spread), at_center);
            let below = bits(_mm256_cmp_ps::<_CMP_LE_OQ>(highest, all(test.least)));
            let above = bits(_mm256_cmp_ps::<_CMP_GT_OQ>(lowest, all(test.most)));

            let (mut keys, mut outside) = (distance, 0);
            if let Some(cone) = test.cone {
                let steep = _mm256_add_ps(tilt(slope[0][i], 0), tilt(slope[1][i], 1));
                let nearer = _mm256_sub_ps(_mm256_add_ps(high[i], steep), all(cone.nearness));
                keys = _mm256_div_ps(distance, _mm256_mul_ps(nearer, nearer));
                outside = bits(_mm256_cmp_ps::<_CMP_LE_OQ>(nearer, zero))
                    | bits(_mm256_cmp_ps::<_CMP_GT_OQ>(keys, all(cone.at_most)));
            }
            may_block |= (near & !below & !outside) << (8 * i);
            may_be_lit |= (near & !above) << (8 * i);
            all_keys[i] = keys;
        }
        Verdicts { may_block, may_be_lit, keys: cast(all_keys) }
    };

    let leaf = |texels: &[[f32; WINDOW]; ROWS], slope: [f32; 2]| {
        let mut flat = [all(f32::INFINITY), all(f32::NEG_INFINITY)];
        let (mut planar, mut nan) = (flat, all(0.0));
        for i in 0..2 {
            let across = _mm256_mul_ps(all(slope[0]), _mm256_add_ps(all(FIRST[0]), lane[i]));
            for (row, y) in texels.iter().zip(0u8..) {
                let texels = cast::<_, [__m256; 2]>(*row)[i];
                let plane = _mm256_add_ps(across, all(slope[1] * (FIRST[1] + f32::from(y))));
                let above = _mm256_sub_ps(texels, plane);
                // Of a NaN and a number, these take the second operand.
                flat = [_mm256_min_ps(texels, flat[0]), _mm256_max_ps(texels, flat[1])];
                planar = [_mm256_min_ps(above, planar[0]), _mm256_max_ps(above, planar[1])];
                nan = _mm256_or_ps(nan, _mm256_cmp_ps::<_CMP_UNORD_Q>(texels, texels));
            }
        }
        let range = |[low, high]: [__m256; 2]| {
            let (low, high): ([f32; 8], [f32; 8]) = (cast(low), cast(high));
            [low.into_iter().fold(f32::INFINITY, f32::min), high.into_iter().fold(f32::NEG_INFINITY, f32::max)]
        };
        Ranges { flat: range(flat), planar: range(planar), nan: bits(nan) != 0 }
    };

    job.run(&Kernels { window, equal, group, leaf });
}
