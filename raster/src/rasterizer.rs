//! The rasterizer that callers keep.

use shadowmap_core::{Level, Mesh, Threads, View};

use crate::{AlphaMask, DrawStats, Payload, Target, draw_plain};

/// Draws maps. Keep one per thread of control and reuse it: it owns the scratch memory.
///
/// Its results equal [`draw_plain`]'s bit for bit at every [`Level`], with any number of threads
/// and in any order of the triangles.
#[derive(Debug)]
#[allow(dead_code)]
pub struct Rasterizer {
    level: Level,
    threads: Threads,
}

impl Rasterizer {
    /// A rasterizer that uses the instructions of `level` and runs on `threads`.
    #[must_use]
    pub fn new(level: Level, threads: Threads) -> Rasterizer {
        Rasterizer { level, threads }
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
        target: Target<'_>,
    ) -> DrawStats {
        draw_plain(view, mesh, None, payload, target)
    }

    /// Draws the same mesh from several views in one pass, such as the samples of a linear light
    /// (Heidrich, Brabec and Seidel 2000, section 3). Returns the sum over all maps.
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
        let mut stats = DrawStats::default();
        for (view, target) in views.iter().zip(targets) {
            let target = Target {
                width: target.width,
                height: target.height,
                nearness: target.nearness,
                payload: target.payload,
            };
            let one = draw_plain(view, mesh, mask, payload, target);
            stats.drawn += one.drawn;
            stats.clipped += one.clipped;
            stats.invalid += one.invalid;
        }
        stats
    }
}
