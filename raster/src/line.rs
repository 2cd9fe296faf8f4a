//! Spans of texels in one row.

use crate::plain::is_nearer;
use crate::simd::Simd;

/// The part of a triangle in one row: its plane there is `a x + row`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) a: f64,
    pub(crate) row: f64,
    pub(crate) low: f32,
    pub(crate) high: f32,
    pub(crate) payload: u32,
}

impl Line {
    /// Fills the texels from `first` to before `end` of a row, which hold nothing yet.
    #[inline(always)]
    pub(crate) fn write<S: Simd>(
        self,
        s: S,
        nearness: &mut [f32],
        payload: &mut [u32],
        first: usize,
        end: usize,
    ) {
        if self.low > 0.0 && end - first >= S::LANES {
            let width = nearness.len();
            self.put(s, &mut nearness[first..], &mut payload[first..], centers(s, first));
            let aligned = next_window::<S>(nearness, first, end);
            let windows = (end - aligned) / S::LANES;
            let last = aligned + windows * S::LANES;
            let (mut px, step) = (centers(s, aligned), s.splat_d(S::LANES as f64));
            let middle = nearness[aligned..last].chunks_exact_mut(S::LANES);
            for (near, mine) in middle.zip(payload[aligned..last].chunks_exact_mut(S::LANES)) {
                s.prefetch(near.as_ptr().wrapping_add(width).cast());
                s.prefetch(mine.as_ptr().wrapping_add(width).cast());
                self.put(s, near, mine, px);
                px = s.add_d(px, step);
            }
            if last < end {
                let x = end - S::LANES;
                self.put(s, &mut nearness[x..], &mut payload[x..], centers(s, x));
            }
        } else {
            // It is short, or may be nothing at some texels.
            clear(s, nearness, payload, first, end);
            self.draw(s, nearness, payload, first, end);
        }
    }

    /// Fills the texels from `first` to before `end` of a row where nothing nearer is.
    #[inline(always)]
    pub(crate) fn draw<S: Simd>(
        self,
        s: S,
        nearness: &mut [f32],
        payload: &mut [u32],
        first: usize,
        end: usize,
    ) {
        let mine = s.splat_i(self.payload as i32);
        if end - first >= S::LANES {
            let all = s.greater_i(s.lanes(), s.splat_i(-1));
            let mut x = first;
            loop {
                let near = self.window(s, x);
                depth_test(s, &mut nearness[x..], &mut payload[x..], near, mine, all);
                if x + S::LANES >= end {
                    break;
                }
                x = next_window::<S>(nearness, x, end);
            }
        } else if nearness.len() >= S::LANES {
            // One window over the span and its surroundings.
            let x = first.min(nearness.len() - S::LANES);
            let (from, to) = ((first - x) as i32, (end - x) as i32);
            let inside = s.and_m(
                s.greater_i(s.lanes(), s.splat_i(from - 1)),
                s.greater_i(s.splat_i(to), s.lanes()),
            );
            let near = self.window(s, x);
            depth_test(s, &mut nearness[x..], &mut payload[x..], near, mine, inside);
        } else {
            for x in first..end {
                let near = (self.a * (x as f64 + 0.5) + self.row) as f32;
                let near = near.max(self.low).min(self.high);
                if is_nearer(near, self.payload, nearness[x], payload[x]) {
                    (nearness[x], payload[x]) = (near, self.payload);
                }
            }
        }
    }

    /// Nearness at the texels from `x` on.
    #[inline(always)]
    fn window<S: Simd>(self, s: S, x: usize) -> S::F {
        self.at(s, centers(s, x))
    }

    /// Fills the first window of the slices, whose texel centres are `px`.
    #[inline(always)]
    fn put<S: Simd>(self, s: S, nearness: &mut [f32], payload: &mut [u32], px: S::D) {
        s.store_f(nearness, self.at(s, px));
        s.store_u(payload, s.splat_i(self.payload as i32));
    }

    /// Nearness at the texel centres `px`.
    #[inline(always)]
    fn at<S: Simd>(self, s: S, px: S::D) -> S::F {
        let near = s.add_d(s.mul_d(s.splat_d(self.a), px), s.splat_d(self.row));
        clamp(s, s.f_from_d(near), s.splat_f(self.low), s.splat_f(self.high))
    }
}

/// The centres of the texels from `x` on.
#[inline(always)]
fn centers<S: Simd>(s: S, x: usize) -> S::D {
    s.add_d(s.d_from_f(s.f_from_i(s.lanes())), s.splat_d(x as f64 + 0.5))
}

/// Empties the texels from `first` to before `end` of a row. Faster than two `fill`s, since it
/// fetches the next row ahead.
#[inline(always)]
pub(crate) fn clear<S: Simd>(
    s: S,
    nearness: &mut [f32],
    payload: &mut [u32],
    first: usize,
    end: usize,
) {
    if end - first < S::LANES {
        nearness[first..end].fill(0.0);
        payload[first..end].fill(0);
        return;
    }
    let mut x = first;
    loop {
        prefetch_next_row(s, nearness, payload, x);
        s.store_f(&mut nearness[x..], s.splat_f(0.0));
        s.store_u(&mut payload[x..], s.splat_i(0));
        if x + S::LANES >= end {
            break;
        }
        x = next_window::<S>(nearness, x, end);
    }
}

/// Rows are filled from top to bottom: what lies below is soon to be written.
#[inline(always)]
fn prefetch_next_row<S: Simd>(s: S, nearness: &[f32], payload: &[u32], x: usize) {
    s.prefetch(nearness.as_ptr().wrapping_add(nearness.len() + x).cast());
    s.prefetch(payload.as_ptr().wrapping_add(payload.len() + x).cast());
}

/// Where the window after the one at `x` starts: aligned in memory, but inside of the span, so that
/// it may overlap the one before. That does no harm, since drawing the same twice changes nothing.
#[inline(always)]
fn next_window<S: Simd>(nearness: &[f32], x: usize, end: usize) -> usize {
    let misaligned = (nearness.as_ptr() as usize / size_of::<f32>() + x) % S::LANES;
    (x + S::LANES - misaligned).min(end - S::LANES)
}

#[inline(always)]
pub(crate) fn clamp<S: Simd>(s: S, value: S::F, low: S::F, high: S::F) -> S::F {
    s.min_f(s.max_f(value, low), high)
}

/// [`is_nearer`] for a window of texels, in the lanes that are `covered`.
#[inline(always)]
fn depth_test<S: Simd>(
    s: S,
    nearness: &mut [f32],
    payload: &mut [u32],
    near: S::F,
    mine: S::I,
    covered: S::M,
) {
    let old = s.load_f(nearness);
    let (mut wins, ties) = (s.less_f_in(covered, old, near), s.equal_f_in(covered, old, near));
    if s.bits(ties) != 0 {
        wins = s.or_m(wins, s.and_m(ties, s.below_u(mine, s.load_u(payload))));
    }
    if s.bits(wins) != 0 {
        s.blend_f(nearness, wins, near);
        s.blend_u(payload, wins, mine);
    }
}
