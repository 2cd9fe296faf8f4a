//! Third stage: draws what is binned into one band of rows.

use crate::AlphaMask;
use crate::bins::{Chunk, Fragment, Grid, Large, MAX_ROWS, Masked, Small};
use crate::kernel::kernel;
use crate::plain::is_nearer;
use crate::span::Spans;

/// Texels per step of a fill.
const LANES: usize = 16;

/// The rows of a map that one thread owns.
#[derive(Debug)]
pub(crate) struct Rows<'a> {
    pub(crate) grid: Grid,
    pub(crate) band: usize,
    /// The columns of each row that hold something to keep, first and end; what lies outside is
    /// written before it is read.
    pub(crate) kept: [[u32; 2]; MAX_ROWS],
    pub(crate) nearness: &'a mut [f32],
    pub(crate) payload: &'a mut [u32],
}

kernel! {
    /// Draws one band from the bins that all chunks have for `view`.
    fn draw_band(
        rows: &mut Rows<'_>,
        chunks: &[Chunk],
        view: usize,
        mask: Option<&AlphaMask<'_>>,
    ) = draw_band_body
}

#[inline(always)]
fn draw_band_body(
    rows: &mut Rows<'_>,
    chunks: &[Chunk],
    view: usize,
    mask: Option<&AlphaMask<'_>>,
) {
    let bins = || chunks.iter().map(|chunk| &chunk.views[view]);
    // Large triangles first: they need not clear the rows that they are the first to touch.
    for bins in bins() {
        for &index in &bins.bands[rows.band].large {
            rows.large(&bins.large[index as usize]);
        }
    }
    rows.clear_rest();
    for bins in bins() {
        let band = &bins.bands[rows.band];
        rows.fragments(&band.fragments);
        for small in &band.small {
            rows.small(small);
        }
        if let Some(mask) = mask {
            for &index in &band.masked {
                rows.masked(&bins.masked[index as usize], mask);
            }
        }
    }
}

impl Rows<'_> {
    fn first_row(&self) -> i32 {
        (self.band << self.grid.shift) as i32
    }

    /// The rows of the map that lie in the band.
    fn range(&self) -> core::ops::Range<i32> {
        self.first_row()..self.first_row() + self.grid.rows() as i32
    }

    #[inline(always)]
    fn row(&mut self, y: i32) -> (&mut [f32], &mut [u32]) {
        let width = self.grid.width as usize;
        let start = (y - self.first_row()) as usize * width;
        (&mut self.nearness[start..][..width], &mut self.payload[start..][..width])
    }

    #[inline(always)]
    fn clear_rest(&mut self) {
        let width = self.grid.width as usize;
        let rows = self.nearness.chunks_exact_mut(width).zip(self.payload.chunks_exact_mut(width));
        for ((nearness, payload), kept) in rows.zip(&self.kept) {
            let [start, end] = kept.map(|x| x as usize);
            nearness[..start].fill(0.0);
            payload[..start].fill(0);
            nearness[end..].fill(0.0);
            payload[end..].fill(0);
        }
    }

    #[inline(always)]
    fn fragments(&mut self, fragments: &[Fragment]) {
        for fragment in fragments {
            let texel = fragment.texel as usize;
            let (nearness, payload) = (&mut self.nearness[texel], &mut self.payload[texel]);
            let wins = is_nearer(fragment.nearness, fragment.payload, *nearness, *payload);
            *nearness = if wins { fragment.nearness } else { *nearness };
            *payload = if wins { fragment.payload } else { *payload };
        }
    }

    #[inline(always)]
    fn small(&mut self, small: &Small) {
        match small.last_x - small.x {
            0..4 => self.narrow::<4>(small),
            4..8 => self.narrow::<8>(small),
            _ => self.narrow::<16>(small),
        }
    }

    /// Draws a triangle of at most `W` columns, a row at a time.
    #[inline(always)]
    fn narrow<const W: usize>(&mut self, small: &Small) {
        let small = *small;
        let (plane, width) = (small.plane, self.grid.width as usize);
        let range = self.range();
        let first = i32::from(small.y).max(range.start);
        let last = i32::from(small.last_y).min(range.end - 1);
        // At the right side of the map the window also holds columns left of the bounds.
        let x = usize::from(small.x).min(width - W);
        let (right, down) = (x as i32 - i32::from(small.x), first - i32::from(small.y));
        let mut edges = [[0_i32; W]; 3];
        for ((edge, start), (step_x, step_y)) in
            edges.iter_mut().zip(small.edges).zip(small.step_x.into_iter().zip(small.step_y))
        {
            let start = start + right * step_x + down * step_y;
            for (l, edge) in edge.iter_mut().enumerate() {
                *edge = start + l as i32 * step_x;
            }
        }
        let mut along = [0.0_f64; W];
        for (l, along) in along.iter_mut().enumerate() {
            *along = plane.a * ((x + l) as f64 + 0.5);
        }
        let mut py = f64::from(first) + 0.5;
        let start = (first - range.start) as usize * width + x;
        let rows = self.nearness[start..].chunks_mut(width);
        let rows = rows.zip(self.payload[start..].chunks_mut(width));
        for (nearness, payload) in rows.take((last - first + 1) as usize) {
            let (Some(nearness), Some(payload)) =
                (nearness.first_chunk_mut::<W>(), payload.first_chunk_mut::<W>())
            else {
                return;
            };
            let row = plane.b * py + plane.c;
            py += 1.0;
            let (mut new_nearness, mut new_payload) = (*nearness, *payload);
            for l in 0..W {
                let covered = (edges[0][l] | edges[1][l] | edges[2][l]) >= 0;
                let near = bounded(along[l] + row, plane.low, plane.high);
                let (old, old_payload) = (new_nearness[l], new_payload[l]);
                let wins = covered & is_nearer(near, small.payload, old, old_payload);
                new_nearness[l] = if wins { near } else { old };
                new_payload[l] = if wins { small.payload } else { old_payload };
            }
            (*nearness, *payload) = (new_nearness, new_payload);
            for (edge, step_y) in edges.iter_mut().zip(small.step_y) {
                for edge in edge {
                    *edge += step_y;
                }
            }
        }
    }

    #[inline(always)]
    fn large(&mut self, large: &Large) {
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
            let kept = &mut self.kept[(y - (self.band << self.grid.shift) as i32) as usize];
            let [start, end] = kept.map(|x| x as usize);
            let (first, last) = (first as usize, last as usize + 1);
            *kept = if start == end {
                [first as u32, last as u32]
            } else {
                [start.min(first) as u32, end.max(last) as u32]
            };
            let (nearness, payload) = self.row(y);
            if start == end {
                line.write(nearness, payload, first, last);
                continue;
            }
            if first < start {
                line.write(nearness, payload, first, last.min(start));
                if last < start {
                    nearness[last..start].fill(0.0);
                    payload[last..start].fill(0);
                }
            }
            if last > end {
                line.write(nearness, payload, first.max(end), last);
                if first > end {
                    nearness[end..first].fill(0.0);
                    payload[end..first].fill(0);
                }
            }
            let (first, last) = (first.max(start), last.min(end));
            if first < last {
                line.draw(nearness, payload, first, last);
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

/// The part of a triangle in one row.
#[derive(Clone, Copy, Debug)]
struct Line {
    a: f64,
    row: f64,
    low: f32,
    high: f32,
    payload: u32,
}

impl Line {
    /// Fills texels that hold nothing yet.
    #[inline(always)]
    fn write(self, nearness: &mut [f32], payload: &mut [u32], first: usize, end: usize) {
        if self.low <= 0.0 {
            // It may be nothing at some texels.
            nearness[first..end].fill(0.0);
            payload[first..end].fill(0);
            return self.draw(nearness, payload, first, end);
        }
        let (nearness, payload) = (&mut nearness[first..end], &mut payload[first..end]);
        payload.fill(self.payload);
        let mut px = first as f64 + 0.5;
        let (nearness, rest) = nearness.as_chunks_mut::<LANES>();
        for nearness in nearness {
            for (l, near) in nearness.iter_mut().enumerate() {
                *near = bounded(self.a * (px + l as f64) + self.row, self.low, self.high);
            }
            px += LANES as f64;
        }
        for near in rest {
            *near = bounded(self.a * px + self.row, self.low, self.high);
            px += 1.0;
        }
    }

    /// Fills texels where nothing nearer is.
    #[inline(always)]
    fn draw(self, nearness: &mut [f32], payload: &mut [u32], first: usize, end: usize) {
        let (nearness, payload) = (&mut nearness[first..end], &mut payload[first..end]);
        let mut px = first as f64 + 0.5;
        let (nearness, rest_nearness) = nearness.as_chunks_mut::<LANES>();
        let (payload, rest_payload) = payload.as_chunks_mut::<LANES>();
        for (nearness, payload) in nearness.iter_mut().zip(payload) {
            for l in 0..LANES {
                let near = bounded(self.a * (px + l as f64) + self.row, self.low, self.high);
                let wins = is_nearer(near, self.payload, nearness[l], payload[l]);
                nearness[l] = if wins { near } else { nearness[l] };
                payload[l] = if wins { self.payload } else { payload[l] };
            }
            px += LANES as f64;
        }
        for (nearness, payload) in rest_nearness.iter_mut().zip(rest_payload) {
            let near = bounded(self.a * px + self.row, self.low, self.high);
            px += 1.0;
            if is_nearer(near, self.payload, *nearness, *payload) {
                (*nearness, *payload) = (near, self.payload);
            }
        }
    }
}

#[inline(always)]
fn bounded(value: f64, low: f32, high: f32) -> f32 {
    let value = value as f32;
    let value = if value > low { value } else { low };
    if value < high { value } else { high }
}
