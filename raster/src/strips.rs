//! Small triangles that are several vectors wide.

use crate::band::Rows;
use crate::bins::{MAX_ROWS, Small};
use crate::coverage::SNAP_SHIFT;
use crate::line::clamp;
use crate::simd::{MAX_LANES, Simd};

/// What a small triangle covers of each row of a band, and its plane there: `a x + plane`.
#[derive(Clone, Debug)]
pub(crate) struct Strips {
    /// The last column before the span of each row, and the first one after it.
    before: [u32; MAX_ROWS],
    after: [u32; MAX_ROWS],
    plane: [f64; MAX_ROWS],
}

impl Strips {
    pub(crate) const EMPTY: Strips =
        Strips { before: [0; MAX_ROWS], after: [0; MAX_ROWS], plane: [0.0; MAX_ROWS] };

    /// Finds the spans of `count` rows from `first` on, as many rows at a time as a vector has
    /// lanes.
    #[inline(always)]
    fn find<S: Simd>(&mut self, s: S, small: &Small, first: i32, count: usize) {
        let (x, last_x) = (i32::from(small.x), i32::from(small.last_x));
        let (step_x, step_y) = (small.step_x(), small.step_y());
        let inverse = step_x.map(|step| match step {
            // A level edge excludes all of a row or nothing: what is half a unit or more, to either
            // side, becomes more than there are columns.
            0 => 4096.0,
            _ => 1.0 / step.unsigned_abs() as f32,
        });
        let half = step_x.map(|step| 0.5 - 0.5 * step.unsigned_abs() as f32);
        for chunk in (0..count).step_by(S::LANES) {
            let y = s.add_i(s.lanes(), s.splat_i(first + chunk as i32));
            let down = s.sub_i(y, s.splat_i(i32::from(small.y)));
            let (mut before, mut after) = (s.splat_i(x - 1), s.splat_i(last_x + 1));
            for k in 0..3 {
                let edge = s.add_i(s.splat_i(small.edges[k]), s.mul_i(down, s.splat_i(step_y[k])));
                // The greatest whole number q not above edge / step, both whole, |step| <= 2^14, by
                // rounding (edge + 1/2) / |step| - 1/2 to nearest: that is never closer to halfway
                // than 2^-15, and single precision errs by 2^-17 where q is a column at all.
                let quotient =
                    s.mul_f(s.add_f(s.f_from_i(edge), s.splat_f(half[k])), s.splat_f(inverse[k]));
                let quotient = clamp(s, quotient, s.splat_f(-1024.0), s.splat_f(1024.0));
                let quotient = s.sub_i(
                    s.i_from_bits(s.add_f(quotient, s.splat_f(SNAP_SHIFT))),
                    s.splat_i(SNAP_SHIFT.to_bits() as i32),
                );
                if step_x[k] > 0 {
                    before = s.max_i(before, s.sub_i(s.splat_i(x - 1), quotient));
                } else {
                    after = s.min_i(after, s.add_i(quotient, s.splat_i(x + 1)));
                }
            }
            s.store_u(&mut self.before[chunk..], before);
            s.store_u(&mut self.after[chunk..], after);
            let py = s.add_d(s.d_from_f(s.f_from_i(y)), s.splat_d(0.5));
            let plane = s.add_d(s.mul_d(s.splat_d(small.plane.b), py), s.splat_d(small.plane.c));
            let mut lanes = [0.0; MAX_LANES];
            s.store_d(&mut lanes, plane);
            self.plane[chunk..chunk + S::LANES].copy_from_slice(&lanes[..S::LANES]);
        }
    }

    /// The rows, from the first to before the last, that have something in the columns from `x` on
    /// that a vector holds.
    #[inline(always)]
    fn rows<S: Simd>(&self, s: S, x: i32, count: usize) -> core::ops::Range<usize> {
        let mut hit = 0_u64;
        for chunk in (0..count).step_by(S::LANES) {
            let starts =
                s.greater_i(s.splat_i(x + S::LANES as i32 - 1), s.load_u(&self.before[chunk..]));
            let ends = s.greater_i(s.load_u(&self.after[chunk..]), s.splat_i(x));
            hit |= u64::from(s.bits(s.and_m(starts, ends))) << chunk;
        }
        hit &= u64::MAX >> (64 - count);
        hit.trailing_zeros() as usize..64 - hit.leading_zeros() as usize
    }
}

impl Rows<'_> {
    #[inline(always)]
    pub(crate) fn strips<S: Simd>(&mut self, s: S, small: &Small) {
        let band = self.range();
        let first = i32::from(small.y).max(band.start);
        let end = (i32::from(small.last_y) + 1).min(band.end);
        if first >= end {
            return;
        }
        let count = (end - first) as usize;
        self.strips.find(s, small, first, count);
        let width = self.grid.width as usize;
        let plane = &small.plane;
        let (low, high) = (s.splat_f(plane.low), s.splat_f(plane.high));
        let mine = s.splat_i(small.payload as i32);
        let top = (first - band.start) as usize * width;
        // Windows that are aligned in memory touch one line of the cache, not two.
        let first_x = usize::from(small.x);
        let misaligned = (self.nearness.as_ptr() as usize / size_of::<f32>() + first_x) % S::LANES;
        let first_x = first_x.saturating_sub(misaligned);
        for x in (first_x..=usize::from(small.last_x)).step_by(S::LANES) {
            let x = x.min(width - S::LANES);
            let columns = s.add_i(s.lanes(), s.splat_i(x as i32));
            let px = s.add_d(s.d_from_f(s.f_from_i(columns)), s.splat_d(0.5));
            let along = s.mul_d(s.splat_d(plane.a), px);
            for row in self.strips.rows(s, x as i32, count) {
                let (before, after) = (self.strips.before[row], self.strips.after[row]);
                let covered = s.and_m(
                    s.greater_i(columns, s.splat_i(before as i32)),
                    s.greater_i(s.splat_i(after as i32), columns),
                );
                let near = s.f_from_d(s.add_d(along, s.splat_d(self.strips.plane[row])));
                let near = clamp(s, near, low, high);
                let start = top + row * width + x;
                let nearness = &mut self.nearness[start..][..S::LANES];
                let payload = &mut self.payload[start..][..S::LANES];
                let old = s.load_f(nearness);
                let mut wins = s.less_f_in(covered, old, near);
                let ties = s.equal_f_in(covered, old, near);
                if s.bits(ties) != 0 {
                    wins = s.or_m(wins, s.and_m(ties, s.below_u(mine, s.load_u(payload))));
                }
                s.blend_f(nearness, wins, near);
                s.blend_u(payload, wins, mine);
            }
        }
    }
}
