//! Triangles of less than 16 texels in width and height.

use crate::band::Rows;
use crate::bins::Small;
use crate::line::{clamp, winners};
use crate::simd::Simd;

impl Rows<'_> {
    #[inline(always)]
    pub(crate) fn small<S: Simd>(&mut self, s: S, small: &Small) {
        let range = self.range();
        let first = i32::from(small.y).max(range.start);
        let end = (i32::from(small.last_y) + 1).min(range.end);
        let columns = usize::from(small.last_x - small.x) + 1;
        // Two rows at a time, if the vector holds two; at the end of the band they may include
        // rows above the triangle's.
        let pairs = (end - first + 1) / 2;
        let first_pair = first.min(range.end - 2 * pairs);
        if columns <= S::LANES / 2 && first_pair >= range.start {
            self.pairs(s, small, first_pair, pairs);
            return;
        }
        for strip in (0..columns).step_by(S::LANES) {
            self.strip(s, small, usize::from(small.x) + strip, first, end);
        }
    }

    /// Draws as many columns as a vector has lanes, row by row.
    #[inline(always)]
    fn strip<S: Simd>(&mut self, s: S, small: &Small, x: usize, first: i32, end: i32) {
        let width = self.grid.width as usize;
        // At the right side of the map the vector includes columns to the left.
        let x = x.min(width - S::LANES);
        let (right, down) = (x as i32 - i32::from(small.x), first - i32::from(small.y));
        let (mut edges, mut step_y) = ([s.splat_i(0); 3], [s.splat_i(0); 3]);
        for k in 0..3 {
            let start = small.edges[k] + right * small.step_x[k] + down * small.step_y[k];
            let along = s.mul_i(s.lanes(), s.splat_i(small.step_x[k]));
            edges[k] = s.add_i(s.splat_i(start), along);
            step_y[k] = s.splat_i(small.step_y[k]);
        }
        let plane = &small.plane;
        let (low, high) = (s.splat_f(plane.low), s.splat_f(plane.high));
        let mine = s.splat_i(small.payload as i32);
        let px = s.add_d(s.d_from_f(s.f_from_i(s.lanes())), s.splat_d(x as f64 + 0.5));
        let along = s.mul_d(s.splat_d(plane.a), px);
        let mut py = f64::from(first) + 0.5;
        let mut start = (first - self.range().start) as usize * width + x;
        for _ in first..end {
            let (nearness, payload) = (&mut self.nearness[start..], &mut self.payload[start..]);
            let outside = s.or_i(s.or_i(edges[0], edges[1]), edges[2]);
            let covered = s.greater_i(outside, s.splat_i(-1));
            let row = s.splat_d(plane.b * py + plane.c);
            let near = clamp(s, s.f_from_d(s.add_d(along, row)), low, high);
            let (wins, ties) = winners(s, s.load_f(nearness), near, covered);
            let wins = if s.bits(ties) == 0 {
                wins
            } else {
                let smaller = s.below_u(mine, s.load_u(payload));
                s.or_m(wins, s.and_m(ties, smaller))
            };
            s.blend_f(nearness, wins, near);
            s.blend_u(payload, wins, mine);
            for k in 0..3 {
                edges[k] = s.add_i(edges[k], step_y[k]);
            }
            py += 1.0;
            start += width;
        }
    }

    /// Draws half as many columns, two rows at a time.
    #[inline(always)]
    fn pairs<S: Simd>(&mut self, s: S, small: &Small, first: i32, pairs: i32) {
        let width = self.grid.width as usize;
        let half = S::LANES / 2;
        let x = usize::from(small.x).min(width - half);
        let (right, down) = (x as i32 - i32::from(small.x), first - i32::from(small.y));
        let upper = s.greater_i(s.lanes(), s.splat_i(half as i32 - 1));
        let column = s.select_i(upper, s.sub_i(s.lanes(), s.splat_i(half as i32)), s.lanes());
        let (mut edges, mut step_y) = ([s.splat_i(0); 3], [s.splat_i(0); 3]);
        for k in 0..3 {
            let start = small.edges[k] + right * small.step_x[k] + down * small.step_y[k];
            let below = s.splat_i(start + small.step_y[k]);
            let start = s.select_i(upper, below, s.splat_i(start));
            edges[k] = s.add_i(start, s.mul_i(column, s.splat_i(small.step_x[k])));
            step_y[k] = s.splat_i(2 * small.step_y[k]);
        }
        let plane = &small.plane;
        let (low, high) = (s.splat_f(plane.low), s.splat_f(plane.high));
        let mine = s.splat_i(small.payload as i32);
        let px = s.add_d(s.d_from_f(s.f_from_i(column)), s.splat_d(x as f64 + 0.5));
        let along = s.mul_d(s.splat_d(plane.a), px);
        let mut py = f64::from(first) + 0.5;
        let mut start = (first - self.range().start) as usize * width + x;
        for _ in 0..pairs {
            let (nearness, payload) = (&mut self.nearness[start..], &mut self.payload[start..]);
            let outside = s.or_i(s.or_i(edges[0], edges[1]), edges[2]);
            let covered = s.greater_i(outside, s.splat_i(-1));
            let row = s.halves_d(plane.b * py + plane.c, plane.b * (py + 1.0) + plane.c);
            let near = clamp(s, s.f_from_d(s.add_d(along, row)), low, high);
            let (wins, ties) = winners(s, s.load_rows_f(nearness, width), near, covered);
            let wins = if s.bits(ties) == 0 {
                wins
            } else {
                let smaller = s.below_u(mine, s.load_rows_u(payload, width));
                s.or_m(wins, s.and_m(ties, smaller))
            };
            s.blend_rows_f(nearness, width, wins, near);
            s.blend_rows_u(payload, width, wins, mine);
            for k in 0..3 {
                edges[k] = s.add_i(edges[k], step_y[k]);
            }
            py += 2.0;
            start += 2 * width;
        }
    }
}
