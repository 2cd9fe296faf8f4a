//! The rasterizer that callers keep.

use alloc::vec::Vec;
use core::{iter, slice};

use shadowmap_core::{BandSlice, Bands, DepthMap, Level, Mesh, Threads, View, for_each_band};

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

/// The fewest triangles that are worth a part, which every band looks through.
const LEAST_CHUNK: usize = 2048;

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
        self.draw_views(views, mesh, None, payload, targets, nothing())
    }

    /// Draws the same mesh from several views, such as the samples of a linear light (Heidrich,
    /// Brabec and Seidel 2000, section 3). Returns the sum over all maps.
    ///
    /// Rectified views ([`View::perspective_rectified`]) that follow one another share one pass
    /// over the mesh: what they have in common, rows and nearness, is computed once. That shows in
    /// the time, and in up to four times the scratch memory.
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
        self.draw_views(views, mesh, None, payload, targets, nothing())
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
        self.draw_views(views, mesh, Some(mask), payload, targets, nothing())
    }

    /// Like [`Rasterizer::draw_masked`] or, without a `mask`, [`Rasterizer::draw_many`], and hands
    /// on the maps in bands of `rows` rows, each as soon as it is drawn. Its texels are in the
    /// thread's cache then: whoever reads the whole map anyway need not fetch them again.
    ///
    /// `finish` is called once for every band of every map, by several threads at a time. It gets
    /// the band as a map of its own, whose payload it takes for object IDs, and the same band of
    /// what lies `beside` the map, of which there is one for each view. The last band of a map may
    /// have fewer rows.
    ///
    /// # Panics
    ///
    /// As [`Rasterizer::draw_many`]; also if `rows` is not a multiple of [`Rasterizer::BAND`], or
    /// if there are fewer `beside` than views.
    pub fn draw_in_bands<B: Bands>(
        &mut self,
        views: &[View],
        mesh: &Mesh<'_>,
        mask: Option<&AlphaMask<'_>>,
        payload: Payload,
        targets: &mut [Target<'_>],
        rows: u32,
        beside: impl IntoIterator<Item = B>,
        finish: &(impl Fn(DepthMap<'_>, B) + Sync),
    ) -> DrawStats {
        assert!(
            rows > 0 && rows.is_multiple_of(Rasterizer::BAND),
            "bands of a multiple of 32 rows"
        );
        let then = Then { rows: rows as usize, beside: beside.into_iter(), finish };
        self.draw_views(views, mesh, mask, payload, targets, then)
    }

    /// [`Rasterizer::draw_in_bands`] takes multiples of this many rows.
    pub const BAND: u32 = MAX_ROWS as u32;

    fn draw_views<B: Bands>(
        &mut self,
        views: &[View],
        mesh: &Mesh<'_>,
        mask: Option<&AlphaMask<'_>>,
        payload: Payload,
        targets: &mut [Target<'_>],
        mut then: Then<'_, impl Iterator<Item = B>, impl Fn(DepthMap<'_>, B) + Sync>,
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
            let drawn = self.draw_beside(views, mesh, mask, payload, here, &mut then);
            stats.drawn += drawn.drawn;
            stats.clipped += drawn.clipped;
            stats.invalid += drawn.invalid;
            targets = rest;
        }
        stats
    }

    /// Draws views that lie beside each other, together.
    fn draw_beside<B: Bands>(
        &mut self,
        views: &[View],
        mesh: &Mesh<'_>,
        mask: Option<&AlphaMask<'_>>,
        payload: Payload,
        targets: &mut [Target<'_>],
        then: &mut Then<'_, impl Iterator<Item = B>, impl Fn(DepthMap<'_>, B) + Sync>,
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
            let parts = ((end - first) / LEAST_CHUNK).clamp(1, chunks);
            let per_chunk = (end - first).div_ceil(parts).next_multiple_of(64).max(64);
            let (vertices, projections) = (&self.vertices, &self.projections[..]);
            let source = Source { mesh: *mesh, mask, payload, views: projections, vertices, grid };
            // Few triangles need few parts, and each is looked through for every band.
            let used = (end - first).div_ceil(per_chunk);
            let chunks = BandSlice { data: &mut self.chunks[..used], len: 1 };
            for_each_band(threads, chunks, &|index, chunk| {
                let start = end.min(first + index * per_chunk);
                let [bins] = chunk.data else { return };
                let bins = &mut bins[..views.len()];
                bins.iter_mut().for_each(|bins| bins.clear(grid.bands()));
                bin(level, &source, start, end.min(start + per_chunk), bins);
            });
            for bins in self.chunks[..used].iter().flat_map(|bins| &bins[..views.len()]) {
                stats.drawn += bins.stats.drawn;
                stats.clipped += bins.stats.clipped;
                stats.invalid += bins.stats.invalid;
            }
            let is_last = end == mesh.triangles.len();
            for (view, target) in targets.iter_mut().enumerate() {
                let chunks = &self.chunks[..used];
                let binned = Binned { chunks, grid, view, mask, clear: first == 0 };
                if is_last {
                    let beside = then.beside.next().expect("one beside for each view");
                    self.draw_batch(binned, target, then.rows, beside, then.finish);
                } else {
                    self.draw_batch(binned, target, 0, Nothing, &ignore);
                }
            }
            if is_last {
                return stats;
            }
            first = end;
        }
    }

    /// Draws what is binned, in bands of at least `rows` rows.
    fn draw_batch<B: Bands>(
        &self,
        binned: Binned<'_>,
        target: &mut Target<'_>,
        rows: usize,
        beside: B,
        finish: &(impl Fn(DepthMap<'_>, B) + Sync),
    ) {
        if target.nearness.is_empty() {
            return;
        }
        let Binned { chunks, grid, view, mask, clear } = binned;
        // A band is drawn in as many steps as it takes to keep it in the nearest cache.
        let steps = (rows / grid.rows()).max(1);
        let step = grid.rows() * target.width as usize;
        let bands = (
            BandSlice { data: &mut *target.nearness, len: steps * step },
            BandSlice { data: &mut *target.payload, len: steps * step },
            beside,
        );
        for_each_band(self.threads, bands, &|index, (nearness, payload, beside)| {
            let (nearness, payload) = (nearness.data, payload.data);
            let parts = nearness.chunks_mut(step).zip(payload.chunks_mut(step));
            for (band, (nearness, payload)) in (index * steps..).zip(parts) {
                let kept = if clear { [0; 2] } else { [0, grid.width] };
                let (kept, strips) = ([kept; MAX_ROWS], Strips::EMPTY);
                let mut rows = Rows { grid, band, kept, strips, nearness, payload };
                draw_band(self.level, &mut rows, chunks, view, mask);
            }
            let height = nearness.len() as u32 / grid.width;
            let drawn = DepthMap::new(grid.width, height, nearness, payload);
            finish(drawn.expect("bands consist of whole rows"), beside);
        });
    }
}

/// What is binned for one view.
#[derive(Clone, Copy, Debug)]
struct Binned<'a> {
    chunks: &'a [Vec<Bins>],
    grid: Grid,
    view: usize,
    mask: Option<&'a AlphaMask<'a>>,
    /// Whether the map holds nothing yet.
    clear: bool,
}

/// What is to be done with each band of `rows` rows when it is drawn.
#[derive(Debug)]
struct Then<'f, I, F> {
    rows: usize,
    /// One for each view.
    beside: I,
    finish: &'f F,
}

/// Nothing is to be done.
fn nothing() -> Then<'static, impl Iterator<Item = Nothing>, impl Fn(DepthMap<'_>, Nothing) + Sync>
{
    Then { rows: 0, beside: iter::repeat(Nothing), finish: &ignore }
}

fn ignore(_: DepthMap<'_>, _: Nothing) {}

/// What lies beside a map for which nobody waits.
#[derive(Clone, Copy, Debug)]
struct Nothing;

impl Bands for Nothing {
    fn count(&self) -> usize {
        0
    }
    fn split_at(self, _: usize) -> (Nothing, Nothing) {
        (Nothing, Nothing)
    }
}
