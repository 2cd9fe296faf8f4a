//! Triangles to maps: what the camera's pass and the lights' maps share.

use raster::{DepthBuffer, Payload, Rasterizer, Target};
use shadowmap_core::{Level, Mesh, Threads, View};

use crate::prepared::Prepared;

/// The indices of a triangle that is not drawn but keeps its place: no vertex has them.
pub(crate) const HIDDEN: [u32; 3] = [u32::MAX; 3];

/// Who looks at a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Viewer {
    /// The camera, which sees single-sided materials from their front.
    Camera,
    /// A light, which every surface blocks.
    Light,
}

/// A rasterizer for a scene's meshes, alpha tests included.
#[derive(Debug)]
pub(crate) struct Drawing {
    rasterizer: Rasterizer,
    /// The scene's triangles but for those that are not drawn.
    triangles: Vec<[u32; 3]>,
}

impl Drawing {
    pub fn new(level: Level, threads: Threads) -> Drawing {
        Drawing { rasterizer: Rasterizer::new(level, threads), triangles: Vec::new() }
    }

    /// Draws one map per view, in one pass over the mesh. Returns how many triangles were drawn.
    pub fn draw(
        &mut self,
        prepared: &Prepared<'_>,
        viewer: Viewer,
        views: &[View],
        payload: Payload,
        maps: &mut [DepthBuffer],
    ) -> u64 {
        for (view, map) in views.iter().zip(maps.iter_mut()) {
            if (map.width(), map.height()) != (view.width(), view.height()) {
                *map = DepthBuffer::new(view.width(), view.height());
            }
        }
        let mut mesh = prepared.scene().mesh.as_mesh();
        let shown = match viewer {
            Viewer::Camera => prepared.front_faces(views, &mut self.triangles),
            Viewer::Light => prepared.solids().nearest(mesh.triangles, views, &mut self.triangles),
        };
        if let Some(triangles) = shown {
            mesh = Mesh { triangles, ..mesh };
        }
        let mut targets: Vec<Target<'_>> = maps.iter_mut().map(DepthBuffer::target).collect();
        let rasterizer = &mut self.rasterizer;
        let stats = prepared.with_alpha_mask(|mask| match mask {
            Some(mask) => rasterizer.draw_masked(views, &mesh, mask, payload, &mut targets),
            None => rasterizer.draw_many(views, &mesh, payload, &mut targets),
        });
        stats.drawn as u64
    }
}
