//! Triangles that are a few vectors wide.

use crate::band::Rows;
use crate::bins::Small;
use crate::line::clamp;
use crate::simd::{MAX_LANES, Simd};

impl Rows<'_> {
    #[inline(always)]
    pub(crate) fn small<S: Simd>(&mut self, s: S, small: &Small) {
        let columns = usize::from(small.last_x - small.x) + 1;
        // A vector of eight or sixteen lanes holds several rows of a narrow triangle.
        let done = (S::LANES == 16 && columns <= 4 && self.block::<S, 4>(s, small, small.x))
            || (S::LANES >= 8 && columns <= S::LANES / 2 && self.block::<S, 2>(s, small, small.x));
        if !done && S::LANES >= 8 && columns > S::LANES {
            // Most rows miss one vector or another: it pays to find the span of each row first.
            self.strips(s, small);
        } else if !done {
            for strip in (0..columns).step_by(S::LANES) {
                self.block::<S, 1>(s, small, small.x + strip as u16);
            }
        }
    }

    /// Draws the columns from `x` on, as many as fit into a vector that holds `ROWS` rows. False if
    /// the band has too few rows.
    #[inline(always)]
    fn block<S: Simd, const ROWS: usize>(&mut self, s: S, small: &Small, x: u16) -> bool {
        let band = self.range();
        let first = i32::from(small.y).max(band.start);
        let end = (i32::from(small.last_y) + 1).min(band.end);
        // At the end of the band the block may start above the triangle.
        let blocks = (end - first + ROWS as i32 - 1) / ROWS as i32;
        let first = first.min(band.end - blocks * ROWS as i32);
        if first < band.start {
            return false;
        }
        let columns = S::LANES / ROWS;
        let width = self.grid.width as usize;
        // At the right side of the map the block may start to the left of the triangle.
        let x = usize::from(x).min(width - columns);
        let (mut lane_x, mut lane_y) = ([0; MAX_LANES], [0; MAX_LANES]);
        for lane in 0..S::LANES {
            lane_x[lane] = (lane % columns) as u32;
            lane_y[lane] = (lane / columns) as u32;
        }
        let (lane_x, lane_y) = (s.load_u(&lane_x), s.load_u(&lane_y));

        let (right, down) = (x as i32 - i32::from(small.x), first - i32::from(small.y));
        let (step_x, step_y) = (small.step_x(), small.step_y());
        let (mut edges, mut step) = ([s.splat_i(0); 3], [s.splat_i(0); 3]);
        for k in 0..3 {
            let start = small.edges[k] + right * step_x[k] + down * step_y[k];
            let along = s.mul_i(lane_x, s.splat_i(step_x[k]));
            edges[k] = s.add_i(s.splat_i(start), along);
            if ROWS > 1 {
                edges[k] = s.add_i(edges[k], s.mul_i(lane_y, s.splat_i(step_y[k])));
            }
            step[k] = s.splat_i(ROWS as i32 * step_y[k]);
        }
        let plane = &small.plane;
        let (low, high) = (s.splat_f(plane.low), s.splat_f(plane.high));
        let mine = s.splat_i(small.payload as i32);
        let px = s.add_d(s.d_from_f(s.f_from_i(lane_x)), s.splat_d(x as f64 + 0.5));
        let mut py = s.add_d(s.d_from_f(s.f_from_i(lane_y)), s.splat_d(f64::from(first) + 0.5));
        let along = s.mul_d(s.splat_d(plane.a), px);
        let (b, c) = (s.splat_d(plane.b), s.splat_d(plane.c));

        let start = (first - band.start) as usize * width + x;
        let rows = blocks as usize * ROWS;
        let all = start..start + (rows - 1) * width + columns;
        let mut nearness = self.nearness[all.clone()].as_mut_ptr().cast::<u32>();
        let mut payload = self.payload[all].as_mut_ptr();
        for _ in 0..blocks {
            let outside = s.or_i(s.or_i(edges[0], edges[1]), edges[2]);
            let covered = s.not_negative(outside);
            let row = s.add_d(s.mul_d(b, py), c);
            let near = clamp(s, s.f_from_d(s.add_d(along, row)), low, high);
            // SAFETY: the slices above hold all blocks, from the first row's first column to the
            // last row's last.
            #[allow(unsafe_code)]
            unsafe {
                let old = s.f_from_bits(s.load_block::<ROWS>(nearness, width));
                let mut wins = s.less_f_in(covered, old, near);
                let ties = s.equal_f_in(covered, old, near);
                if s.bits(ties) != 0 {
                    let smaller = s.below_u(mine, s.load_block::<ROWS>(payload, width));
                    wins = s.or_m(wins, s.and_m(ties, smaller));
                }
                s.blend_block::<ROWS>(nearness, width, wins, s.i_from_bits(near));
                s.blend_block::<ROWS>(payload, width, wins, mine);
            }
            for k in 0..3 {
                edges[k] = s.add_i(edges[k], step[k]);
            }
            py = s.add_d(py, s.splat_d(ROWS as f64));
            nearness = nearness.wrapping_add(ROWS * width);
            payload = payload.wrapping_add(ROWS * width);
        }
        true
    }
}
