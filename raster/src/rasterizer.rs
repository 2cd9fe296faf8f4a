//! The rasterizer that callers keep.

use alloc::vec::Vec;
use core::slice;

use shadowmap_core::{BandSlice, Level, Mesh, Threads, View, for_each_band};

use crate::band::{Rows, draw_band};
use crate::binning::{Source, bin};
use crate::bins::{Bins, Grid, MAX_ROWS};
use crate::project::Projection;
use crate::strips::Strips;
use crate::vertices::Vertices;
use crate::{AlphaMask, DrawStats, Payload, Target};

/// Draws maps. Keep one and reuse it: it owns the scratch memory, 16 bytes per vertex and, per
/// texel of the maps drawn at once, of which there are at most four, about a hundred; after the
/// first frame of a scene nothing is allocated.
///
/// Its results equal [`crate::draw_plain`]'s bit for bit at every [`Level`], with any number of
/// threads and in any order of the triangles.
#[derive(Debug)]
pub struct Rasterizer {
    level: Level,
    threads: Threads,
    projections: Vec<Projection>,
    vertices: Vertices,
    /// The bins of each chunk, one for each view.
    chunks: Vec<Vec<Bins>>,
}

/// Parts that a batch of triangles is binned in, to share among threads.
const CHUNKS: usize = 48;

/// The most views that share a pass over the mesh. More would share little more, and each has
/// scratch memory of its own.
const MOST_BESIDE: usize = 4;

/// The fewest triangles that are worth a part.
const LEAST_CHUNK: usize = 1024;

impl Rasterizer {
    /// A rasterizer that uses the instructions of `level` and runs on `threads`.
    #[must_use]
    pub fn new(level: Level, threads: Threads) -> Rasterizer {
        Rasterizer {
            level,
            threads,
            projections: Vec::new(),
            vertices: Vertices::default(),
            chunks: Vec::new(),
        }
    }

    /// Draws one map of a mesh. The target is cleared first: nearness 0 and payload 0 where there
    /// is nothing.
    ///
    /// # Panics
    ///
    /// If the target has another size than the view, or one beyond [`crate::MAX_SIZE`].
    pub fn draw(
        &mut self,
        view: &View,
        mesh: &Mesh<'_>,
        payload: Payload,
        mut target: Target<'_>,
    ) -> DrawStats {
        let (views, targets) = (slice::from_ref(view), slice::from_mut(&mut target));
        self.draw_views(views, mesh, None, payload, targets)
    }

    /// Draws the same mesh from several views, such as the samples of a linear light (Heidrich,
    /// Brabec and Seidel 2000, section 3). Returns the sum over all maps.
    ///
    /// Rectified views ([`View::perspective_rectified`]) that follow one another share one pass over
    /// the mesh: what they have in common, rows and nearness, is computed once. That shows in the
    /// time, and in up to four times the scratch memory.
    ///
    /// # Panics
    ///
    /// If there are not as many targets as views, or one is as in [`Rasterizer::draw`].
    pub fn draw_many(
        &mut self,
        views: &[View],
        mesh: &Mesh<'_>,
        payload: Payload,
        targets: &mut [Target<'_>],
    ) -> DrawStats {
        self.draw_views(views, mesh, None, payload, targets)
    }

    /// Like [`Rasterizer::draw_many`], with an alpha test for some of the triangles.
    ///
    /// # Panics
    ///
    /// As [`Rasterizer::draw_many`].
    pub fn draw_masked(
        &mut self,
        views: &[View],
        mesh: &Mesh<'_>,
        mask: &AlphaMask<'_>,
        payload: Payload,
        targets: &mut [Target<'_>],
    ) -> DrawStats {
        self.draw_views(views, mesh, Some(mask), payload, targets)
    }

    fn draw_views(
        &mut self,
        views: &[View],
        mesh: &Mesh<'_>,
        mask: Option<&AlphaMask<'_>>,
        payload: Payload,
        targets: &mut [Target<'_>],
    ) -> DrawStats {
        assert_eq!(views.len(), targets.len(), "one target per view");
        for (view, target) in views.iter().zip(targets.iter()) {
            target.check(view);
        }
        let mut stats = DrawStats::default();
        let is_beside = |a: &View, b: &View| {
            (a.width(), a.height()) == (b.width(), b.height())
                && Projection::of(a).is_beside(&Projection::of(b))
        };
        let mut targets = targets;
        let beside = views.chunk_by(is_beside);
        for views in beside.flat_map(|views| views.chunks(MOST_BESIDE)) {
            let (here, rest) = targets.split_at_mut(views.len());
            let drawn = self.draw_beside(views, mesh, mask, payload, here);
            stats.drawn += drawn.drawn;
            stats.clipped += drawn.clipped;
            stats.invalid += drawn.invalid;
            targets = rest;
        }
        stats
    }

    /// Draws views that lie beside each other, together.
    fn draw_beside(
        &mut self,
        views: &[View],
        mesh: &Mesh<'_>,
        mask: Option<&AlphaMask<'_>>,
        payload: Payload,
        targets: &mut [Target<'_>],
    ) -> DrawStats {
        let (level, threads) = (self.level, self.threads);
        let grid = Grid::new(views[0].width(), views[0].height());
        self.projections.clear();
        self.projections.extend(views.iter().map(Projection::of));
        self.vertices.transform(level, threads, &self.projections, mesh.positions);
        let chunks = if threads == Threads::One { 1 } else { CHUNKS };
        self.chunks.resize_with(chunks, Vec::new);
        for bins in &mut self.chunks {
            bins.resize_with(views.len().max(bins.len()), Bins::default);
        }
        // What is binned at a time bounds the scratch memory.
        let batch = targets[0].nearness.len().max(1 << 16);
        let mut stats = DrawStats::default();
        let mut first = 0;
        loop {
            let end = mesh.triangles.len().min(first + batch);
            let per_chunk = (end - first).div_ceil(chunks).next_multiple_of(64).max(LEAST_CHUNK);
            let (vertices, projections) = (&self.vertices, &self.projections[..]);
            let source = Source { mesh: *mesh, mask, payload, views: projections, vertices, grid };
            let chunks = BandSlice { data: &mut self.chunks, len: 1 };
            for_each_band(threads, chunks, &|index, chunk| {
                let start = end.min(first + index * per_chunk);
                let [bins] = chunk.data else { return };
                let bins = &mut bins[..views.len()];
                bins.iter_mut().for_each(|bins| bins.clear(grid.bands()));
                bin(level, &source, start, end.min(start + per_chunk), bins);
            });
            for bins in self.chunks.iter().flat_map(|bins| &bins[..views.len()]) {
                stats.drawn += bins.stats.drawn;
                stats.clipped += bins.stats.clipped;
                stats.invalid += bins.stats.invalid;
            }
            for (view, target) in targets.iter_mut().enumerate() {
                self.draw_batch(grid, view, target, mask, first == 0);
            }
            first = end;
            if first == mesh.triangles.len() {
                return stats;
            }
        }
    }

    /// Draws what is binned for one view.
    fn draw_batch(
        &self,
        grid: Grid,
        view: usize,
        target: &mut Target<'_>,
        mask: Option<&AlphaMask<'_>>,
        clear: bool,
    ) {
        if target.nearness.is_empty() {
            return;
        }
        let len = grid.rows() * target.width as usize;
        let bands = (
            BandSlice { data: &mut *target.nearness, len },
            BandSlice { data: &mut *target.payload, len },
        );
        for_each_band(self.threads, bands, &|band, (nearness, payload)| {
            let (nearness, payload) = (nearness.data, payload.data);
            let kept = if clear { [0; 2] } else { [0, grid.width] };
            let (kept, strips) = ([kept; MAX_ROWS], Strips::EMPTY);
            let mut rows = Rows { grid, band, kept, strips, nearness, payload };
            draw_band(self.level, &mut rows, &self.chunks, view, mask);
        });
    }
}
