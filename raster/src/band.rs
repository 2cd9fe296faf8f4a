//! Third stage: draws what is binned into one band of rows.

use alloc::vec::Vec;
use core::ops::Range;

use crate::AlphaMask;
use crate::ahead::Ahead;
use crate::bins::{Bins, Fragments, Grid, Large, MAX_ROWS, Masked};
use crate::line::{Line, clear};
use crate::plain::is_nearer;
use crate::simd::{Simd, kernel};
use crate::span::Spans;
use crate::strips::Strips;

/// The rows of a map that one thread owns.
#[derive(Debug)]
pub(crate) struct Rows<'a> {
    pub(crate) grid: Grid,
    pub(crate) band: usize,
    /// The columns of each row that hold something to keep, first and end; what lies outside is
    /// written before it is read.
    pub(crate) kept: [[u32; 2]; MAX_ROWS],
    pub(crate) strips: Strips,
    pub(crate) nearness: &'a mut [f32],
    pub(crate) payload: &'a mut [u32],
}

kernel! {
    /// Draws one band from the bins that all chunks have for a view.
    fn draw_band(
        rows: &mut Rows<'_>,
        chunks: &[Vec<Bins>],
        view: usize,
        mask: Option<&AlphaMask<'_>>,
    ) = draw_band_body
}

#[inline(always)]
fn draw_band_body<S: Simd>(
    s: S,
    rows: &mut Rows<'_>,
    chunks: &[Vec<Bins>],
    view: usize,
    mask: Option<&AlphaMask<'_>>,
) {
    // Large triangles first: where they are the first to touch a texel, it need not be cleared.
    for bins in chunks.iter().map(|bins| &bins[view]) {
        for &index in &bins.bands[rows.band].large {
            rows.large(s, &bins.large[index as usize]);
        }
    }
    rows.clear_rest(s);
    let small = |bins: &Vec<Bins>| bins[view].bands[rows.band].small.len();
    let mut ahead = Ahead::of(rows, chunks.iter().map(small).sum());
    for bins in chunks.iter().map(|bins| &bins[view]) {
        let band = &bins.bands[rows.band];
        rows.fragments(&band.fragments);
        for small in &band.small {
            rows.small(s, small);
            ahead.fetch(s);
        }
        if let Some(mask) = mask {
            for &index in &band.masked {
                rows.masked(&bins.masked[index as usize], mask);
            }
        }
    }
}

impl Rows<'_> {
    /// The rows of the map that lie in the band.
    #[inline(always)]
    pub(crate) fn range(&self) -> Range<i32> {
        let first = self.band << self.grid.shift;
        first as i32..(first + self.grid.rows()).min(self.grid.height as usize) as i32
    }

    #[inline(always)]
    fn row(&mut self, y: i32) -> (&mut [f32], &mut [u32]) {
        let width = self.grid.width as usize;
        let start = (y - self.range().start) as usize * width;
        (&mut self.nearness[start..][..width], &mut self.payload[start..][..width])
    }

    #[inline(always)]
    fn clear_rest<S: Simd>(&mut self, s: S) {
        let width = self.grid.width as usize;
        let rows = self.nearness.chunks_exact_mut(width).zip(self.payload.chunks_exact_mut(width));
        for ((nearness, payload), kept) in rows.zip(&self.kept) {
            let [start, end] = kept.map(|x| x as usize);
            clear(s, nearness, payload, 0, start);
            clear(s, nearness, payload, end, width);
        }
    }

    #[inline(always)]
    fn fragments(&mut self, fragments: &Fragments) {
        for (texel, near, mine) in fragments.iter() {
            let (Some(nearness), Some(payload)) =
                (self.nearness.get_mut(texel as usize), self.payload.get_mut(texel as usize))
            else {
                return;
            };
            if is_nearer(near, mine, *nearness, *payload) {
                (*nearness, *payload) = (near, mine);
            }
        }
    }

    #[inline(always)]
    fn large<S: Simd>(&mut self, s: S, large: &Large) {
        let (grid, plane) = (self.grid, &large.plane);
        let Some(spans) = Spans::new(&large.triangle, grid.width, grid.height, self.range()) else {
            return;
        };
        for (y, first, last) in spans {
            let line = Line {
                a: plane.a,
                row: plane.b * (f64::from(y) + 0.5) + plane.c,
                low: plane.low,
                high: plane.high,
                payload: large.payload,
            };
            let kept = &mut self.kept[(y - (self.band << grid.shift) as i32) as usize];
            let [start, end] = kept.map(|x| x as usize);
            let (first, last) = (first as usize, last as usize + 1);
            *kept = if start == end {
                [first as u32, last as u32]
            } else {
                [start.min(first) as u32, end.max(last) as u32]
            };
            let (nearness, payload) = self.row(y);
            if start == end {
                line.write(s, nearness, payload, first, last);
                continue;
            }
            if first < start {
                line.write(s, nearness, payload, first, last.min(start));
                if last < start {
                    clear(s, nearness, payload, last, start);
                }
            }
            if last > end {
                line.write(s, nearness, payload, first.max(end), last);
                if first > end {
                    clear(s, nearness, payload, end, first);
                }
            }
            let (first, last) = (first.max(start), last.min(end));
            if first < last {
                line.draw(s, nearness, payload, first, last);
            }
        }
    }

    #[inline(always)]
    fn masked(&mut self, masked: &Masked, mask: &AlphaMask<'_>) {
        let (grid, large) = (self.grid, &masked.large);
        let Some(spans) = Spans::new(&large.triangle, grid.width, grid.height, self.range()) else {
            return;
        };
        for (y, first, last) in spans {
            let (nearness, payload) = self.row(y);
            for x in first..=last {
                let [b1, b2] = masked.weights.at(x, y);
                let near = large.plane.at(x, y);
                let (nearness, payload) = (&mut nearness[x as usize], &mut payload[x as usize]);
                if is_nearer(near, large.payload, *nearness, *payload)
                    && (mask.keep)(masked.index, b1, b2)
                {
                    (*nearness, *payload) = (near, large.payload);
                }
            }
        }
    }
}
