//! How much of a rectified light sixteen receivers see, of which some samples see each.

use super::SkinShadow;
use super::planes::SurfaceLanes;
use super::sixteen::{SampleLanes, Sixteen};
use crate::lanes::{LANES, Lanes, Ops, gather, lanes, max, min};

impl SkinShadow<'_> {
    /// [`SkinShadow::sum`] of sixteen receivers. Lanes that `of` leaves out hold anything.
    #[inline(always)]
    pub(super) fn sum_sixteen(
        &self,
        ops: impl Ops,
        disparity: f32,
        sixteen: &Sixteen,
        surfaces: &SurfaceLanes,
        of: u32,
    ) -> Lanes {
        let segments = self.maps.len() - 1;
        let per_segment = 1.0 / segments as f32;
        let weights = [lanes(|i| 1.0 - sixteen.below[i]), sixteen.below];
        let [mut visibility, mut carried] = [[0.0; LANES]; 2];
        let mut near = sixteen.sample(ops, 0.0, &self.maps[0]);
        for segment in 0..segments {
            let shift = disparity * (segment + 1) as f32;
            let far = sixteen.sample(ops, shift, &self.maps[segment + 1]);
            // The part of the segment above the horizon, in its own parameter.
            let part =
                |t: &Lanes| lanes(|i| (t[i] * segments as f32 - segment as f32).clamp(0.0, 1.0));
            let above = [part(&surfaces.above[0]), part(&surfaces.above[1])];
            let mut shares = [[0.0; LANES]; 2];
            for (row, weight) in weights.iter().enumerate() {
                let (near_lit, far_lit) = (near.lit[row], far.lit[row]);
                let (from_near, from_far) = (near_lit & !far_lit, far_lit & !near_lit);
                // From an end that is lit up to the nearest blocker.
                let mut seen = [[0.0; LANES], [1.0; LANES]];
                let asked = from_near & near.inside;
                if asked & of != 0 {
                    let to = self.seen_sixteen(sixteen, [segment, 0], &near, row);
                    seen[1] = ops.select(asked, &to, &seen[1]);
                }
                let asked = from_far & far.inside;
                if asked & of != 0 {
                    let to = self.seen_sixteen(sixteen, [segment, 1], &far, row);
                    seen[0] = ops.select(asked, &lanes(|i| 1.0 - to[i]), &seen[0]);
                }
                let length = lanes(|i| {
                    let [from, to] = [max(above[0][i], seen[0][i]), min(above[1][i], seen[1][i])];
                    max(to - from, 0.0) * weight[i]
                });
                let half = lanes(|i| 0.5 * length[i]);
                for (share, alone) in shares.iter_mut().zip([from_near, from_far]) {
                    let mine = ops.select(near_lit & far_lit, &half, &[0.0; LANES]);
                    let mine = ops.select(alone, &length, &mine);
                    *share = lanes(|i| share[i] + mine[i]);
                }
            }
            visibility = lanes(|i| visibility[i] + (carried[i] + shares[0][i]) * per_segment);
            carried = shares[1];
            near = far;
        }
        // Parts of a whole add up to 1 only as far as rounding lets them.
        lanes(|i| min(visibility[i] + carried[i] * per_segment, 1.0))
    }

    /// [`SkinShadow::seen`] of sixteen receivers, from one end of a segment.
    #[inline(always)]
    fn seen_sixteen(
        &self,
        sixteen: &Sixteen,
        [segment, end]: [usize; 2],
        sample: &SampleLanes,
        row: usize,
    ) -> Lanes {
        let (channels, map) = (self.channels, &self.maps[segment + end]);
        let (columns, right, tolerance) = sample.around(map.width(), channels.texel_in_nearness);
        let (seen, stride) = channels.rows(segment, end);
        let [mut sum, mut weights] = [[0.0; LANES]; 2];
        let mut nearest = [0.0; LANES];
        for (side, x) in columns.iter().enumerate() {
            let front = sixteen.in_front(sample, map, x, row);
            let seen = gather(seen, sixteen.index(x, row, stride));
            let near = lanes(|i| if side == 0 { 1.0 - right[i] } else { right[i] });
            let weight = lanes(|i| if front[i].abs() <= tolerance[i] { near[i] } else { 0.0 });
            sum = lanes(|i| sum[i] + weight[i] * seen[i]);
            weights = lanes(|i| weights[i] + weight[i]);
            nearest = lanes(|i| if near[i] >= 0.5 { seen[i] } else { nearest[i] });
        }
        lanes(|i| if weights[i] > 0.0 { sum[i] / weights[i] } else { nearest[i] })
    }
}
