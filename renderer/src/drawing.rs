//! Triangles to maps: what the camera's pass and the lights' maps share.

use raster::{AlphaMask, DepthBuffer, DrawStats, Payload, Rasterizer, Target};
use shadowmap_core::{DepthMap, Level, Mesh, Threads, View};
use simd_search::{LeafBands, NodeGroup, Pyramid};

use crate::prepared::Prepared;
use crate::solids::Shown;

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
    level: Level,
    rasterizer: Rasterizer,
    /// The scene's triangles but for those that are not drawn, for the camera and for a light.
    triangles: Vec<[u32; 3]>,
    shown: Shown,
}

impl Drawing {
    pub fn new(level: Level, threads: Threads) -> Drawing {
        let rasterizer = Rasterizer::new(level, threads);
        Drawing { level, rasterizer, triangles: Vec::new(), shown: Shown::default() }
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
        self.with_mesh(
            prepared,
            viewer,
            views,
            payload,
            maps,
            |rasterizer, mesh, mask, payload, targets| match mask {
                Some(mask) => rasterizer.draw_masked(views, mesh, mask, payload, targets),
                None => rasterizer.draw_many(views, mesh, payload, targets),
            },
        )
    }

    /// Draws one map per view of a light and, while its texels are in the cache, the leaves of its
    /// pyramid, which [`Pyramid::finish`] finishes.
    pub fn draw_with_leaves(
        &mut self,
        prepared: &Prepared<'_>,
        views: &[View],
        maps: &mut [DepthBuffer],
        pyramids: &mut [Vec<NodeGroup>],
    ) -> u64 {
        let (level, rows) = (self.level, LeafBands::ROWS);
        let leaves = views.iter().zip(pyramids).map(|(view, nodes)| {
            let (width, height) = (view.width(), view.height());
            nodes.resize(Pyramid::storage_len(width, height), NodeGroup::default());
            LeafBands::new(width, height, rows, nodes, &mut []).expect("storage as long as asked")
        });
        let build = |band: DepthMap<'_>, leaves: LeafBands<'_>| leaves.build(level, band);
        self.with_mesh(
            prepared,
            Viewer::Light,
            views,
            Payload::ObjectId,
            maps,
            |rasterizer, mesh, mask, payload, targets| {
                rasterizer.draw_in_bands(views, mesh, mask, payload, targets, rows, leaves, &build)
            },
        )
    }

    /// Lets `draw` draw what a viewer is shown, into maps of the views' sizes.
    fn with_mesh(
        &mut self,
        prepared: &Prepared<'_>,
        viewer: Viewer,
        views: &[View],
        payload: Payload,
        maps: &mut [DepthBuffer],
        draw: impl FnOnce(
            &mut Rasterizer,
            &Mesh<'_>,
            Option<&AlphaMask<'_>>,
            Payload,
            &mut [Target<'_>],
        ) -> DrawStats,
    ) -> u64 {
        for (view, map) in views.iter().zip(maps.iter_mut()) {
            if (map.width(), map.height()) != (view.width(), view.height()) {
                *map = DepthBuffer::new(view.width(), view.height());
            }
        }
        let mesh = prepared.scene().mesh.as_mesh();
        let front = match viewer {
            Viewer::Camera => prepared.front_faces(views, &mut self.triangles),
            Viewer::Light => None,
        };
        let (mesh, payload) = if let Some(triangles) = front {
            (Mesh { triangles, ..mesh }, payload)
        } else {
            // The alpha test goes by the place.
            let keep_places = !prepared.masked().is_empty();
            let (level, shown) = (self.level, &mut self.shown);
            let nearest =
                prepared.solids().nearest(level, &mesh, views, payload, keep_places, shown);
            nearest.map_or((mesh, payload), |nearest| (nearest, Payload::ObjectId))
        };
        let mut targets: Vec<Target<'_>> = maps.iter_mut().map(DepthBuffer::target).collect();
        let rasterizer = &mut self.rasterizer;
        let stats =
            prepared.with_alpha_mask(|mask| draw(rasterizer, &mesh, mask, payload, &mut targets));
        stats.drawn as u64
    }
}
