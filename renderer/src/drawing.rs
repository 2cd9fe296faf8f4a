//! Triangles to maps: what the camera's pass and the lights' maps share.

use raster::{DepthBuffer, Payload, Rasterizer, Target};
use shadowmap_core::{Level, Mesh, Threads, View};

use crate::prepared::Prepared;

/// A rasterizer for a scene's meshes, alpha tests included.
#[derive(Debug)]
pub(crate) struct Drawing(Rasterizer);

impl Drawing {
    pub fn new(level: Level, threads: Threads) -> Drawing {
        Drawing(Rasterizer::new(level, threads))
    }

    /// Draws one map per view, in one pass over the mesh. Returns how many triangles were drawn.
    pub fn draw(
        &mut self,
        prepared: &Prepared<'_>,
        mesh: &Mesh<'_>,
        views: &[View],
        payload: Payload,
        maps: &mut [DepthBuffer],
    ) -> u64 {
        for (view, map) in views.iter().zip(maps.iter_mut()) {
            if (map.width(), map.height()) != (view.width(), view.height()) {
                *map = DepthBuffer::new(view.width(), view.height());
            }
        }
        let mut targets: Vec<Target<'_>> = maps.iter_mut().map(DepthBuffer::target).collect();
        let stats = prepared.with_alpha_mask(|mask| match mask {
            Some(mask) => self.0.draw_masked(views, mesh, mask, payload, &mut targets),
            None => self.0.draw_many(views, mesh, payload, &mut targets),
        });
        stats.drawn as u64
    }
}
