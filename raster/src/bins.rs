//! What the second stage leaves for the third: triangles sorted by the bands of rows they touch.

use alloc::vec::Vec;

use crate::DrawStats;
use crate::coverage::Triangle;
use crate::mask::Weights;
use crate::plane::Plane;
use crate::simd::{MAX_LANES, Simd};

/// The most rows that a band has.
pub(crate) const MAX_ROWS: usize = 32;

/// How a map is cut into bands of rows. A band is what one thread owns at a time, and small enough
/// to stay in its cache while it is cleared and drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// A band has `1 << shift` rows, the last one possibly fewer.
    pub(crate) shift: u32,
}

impl Grid {
    pub(crate) fn new(width: u32, height: u32) -> Grid {
        // 8 bytes per texel; a quarter of a megabyte per band, and not too few of them to share.
        let rows = (32768 / width.max(1)).min(height / 16).clamp(8, MAX_ROWS as u32);
        Grid { width, height, shift: rows.ilog2() }
    }

    pub(crate) fn rows(&self) -> usize {
        1 << self.shift
    }

    pub(crate) fn bands(&self) -> usize {
        (self.height as usize).div_ceil(self.rows())
    }
}

/// Texels of one band that tiny triangles cover, one triangle each.
#[derive(Debug, Default)]
pub(crate) struct Fragments {
    count: usize,
    /// Position in the band.
    texel: Vec<u32>,
    nearness: Vec<f32>,
    payload: Vec<u32>,
}

impl Fragments {
    /// Adds the lanes whose bits are set.
    #[inline(always)]
    pub(crate) fn push<S: Simd>(
        &mut self,
        s: S,
        bits: u32,
        texel: S::I,
        nearness: S::F,
        payload: S::I,
    ) {
        if self.texel.len() < self.count + MAX_LANES {
            self.grow();
        }
        s.compress_u(&mut self.texel[self.count..], bits, texel);
        s.compress_f(&mut self.nearness[self.count..], bits, nearness);
        s.compress_u(&mut self.payload[self.count..], bits, payload);
        self.count += bits.count_ones() as usize;
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self) {
        let len = (2 * self.texel.len()).max(4 * MAX_LANES);
        self.texel.resize(len, 0);
        self.nearness.resize(len, 0.0);
        self.payload.resize(len, 0);
    }

    /// Position in the band, nearness and payload of each.
    #[inline(always)]
    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, f32, u32)> + '_ {
        let texels = self.texel[..self.count].iter();
        texels.zip(&self.nearness).zip(&self.payload).map(|((&t, &n), &p)| (t, n, p))
    }
}

/// A triangle of less than 64 texels in width and height, set up.
///
/// Its edge functions are divided by 256, rounded down: they change by multiples of 256 from texel
/// to texel, so that no sign is lost.
///
/// One line of the cache: what is binned goes out to memory and comes back.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Small {
    /// First column and row of its bounds.
    pub(crate) x: u16,
    pub(crate) y: u16,
    /// Last column and row of its bounds.
    pub(crate) last_x: u16,
    pub(crate) last_y: u16,
    /// The edge functions at the centre of texel (x, y), less what excludes centres on edges that
    /// do not own them: covered is where none is negative.
    pub(crate) edges: [i32; 3],
    /// Change of the first two edge functions from one column to the next, and from one row to the
    /// next. The edges lead around the triangle: that of the third is what the two leave.
    pub(crate) steps: [[i16; 2]; 2],
    pub(crate) plane: Plane,
    pub(crate) payload: u32,
}

const _: () = assert!(size_of::<Small>() == 64);

impl Small {
    #[inline(always)]
    pub(crate) fn step_x(&self) -> [i32; 3] {
        around(self.steps[0])
    }

    #[inline(always)]
    pub(crate) fn step_y(&self) -> [i32; 3] {
        around(self.steps[1])
    }
}

#[inline(always)]
fn around(steps: [i16; 2]) -> [i32; 3] {
    let [a, b] = steps.map(i32::from);
    [a, b, -(a + b)]
}

/// A triangle of any size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Large {
    pub(crate) triangle: Triangle,
    pub(crate) plane: Plane,
    pub(crate) payload: u32,
}

/// A triangle with an alpha test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Masked {
    pub(crate) large: Large,
    pub(crate) index: usize,
    pub(crate) weights: Weights,
}

/// What touches one band.
#[derive(Debug, Default)]
pub(crate) struct Band {
    pub(crate) fragments: Fragments,
    pub(crate) small: Vec<Small>,
    /// Indices into [`Bins::large`].
    pub(crate) large: Vec<u32>,
    /// Indices into [`Bins::masked`].
    pub(crate) masked: Vec<u32>,
}

/// The triangles of one chunk of a mesh in one view. Reused between frames.
#[derive(Debug, Default)]
pub(crate) struct Bins {
    pub(crate) bands: Vec<Band>,
    pub(crate) large: Vec<Large>,
    pub(crate) masked: Vec<Masked>,
    pub(crate) stats: DrawStats,
}

impl Bins {
    /// Empties all bins, of which there are at least `bands` then. They keep their memory, also
    /// those that a smaller map has no use for.
    pub(crate) fn clear(&mut self, bands: usize) {
        self.bands.resize_with(bands.max(self.bands.len()), Band::default);
        for band in &mut self.bands {
            band.fragments.count = 0;
            band.small.clear();
            band.large.clear();
            band.masked.clear();
        }
        self.large.clear();
        self.masked.clear();
        self.stats = DrawStats::default();
    }

    /// Adds a triangle to the bands that its bounds touch; false if it misses the map.
    pub(crate) fn push_large(&mut self, large: Large, grid: &Grid) -> bool {
        let Some(bounds) = large.triangle.bounds(grid.width, grid.height) else { return false };
        let index = self.large.len() as u32;
        self.large.push(large);
        for band in bounds.y.0 >> grid.shift..=bounds.y.1 >> grid.shift {
            self.bands[band as usize].large.push(index);
        }
        true
    }

    /// Like [`Bins::push_large`], for a triangle with an alpha test.
    pub(crate) fn push_masked(&mut self, masked: Masked, grid: &Grid) -> bool {
        let bounds = masked.large.triangle.bounds(grid.width, grid.height);
        let Some(bounds) = bounds else { return false };
        let index = self.masked.len() as u32;
        self.masked.push(masked);
        for band in bounds.y.0 >> grid.shift..=bounds.y.1 >> grid.shift {
            self.bands[band as usize].masked.push(index);
        }
        true
    }
}
