//! Skins between unrelated views: polygons (section 3.2).
//!
//! Between two neighbouring texels of the source's map that straddle a discontinuity, a silhouette
//! crosses; the four texels of a cell have up to four crossings, which are joined as marching
//! squares joins them, so that silhouettes are unbroken. Each piece of silhouette, from the
//! blocker's nearness to the receiver's, is a quadrilateral, warped vertex by vertex into the
//! destination's view and drawn there.
//!
//! On rectified maps this is what [`crate::skin_spans`] does, seen row by row.

use alloc::vec::Vec;

use glam::{Vec2, Vec3};
use raster::{SkinVertex, draw_skins};
use shadowmap_core::{DepthMap, View, Warp};

use crate::crossings::{Crossing, Crossings};
use crate::skins::Transition;
use crate::{SkinOptions, VisibilityChannels};

/// Memory that is kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct PolygonScratch {
    crossings: Crossings,
    skins: Vec<[SkinVertex; 3]>,
    nearness: Vec<f32>,
    limit: Vec<f32>,
    drawn: Vec<f32>,
}

impl VisibilityChannels {
    /// Makes the channels of maps from unrelated perspective views, one per sample, from the
    /// light's first end to its last at equal steps. All maps are of one size.
    ///
    /// For whoever has maps of their own; views that are rectified
    /// ([`VisibilityChannels::draw_rectified`]) give the same channels in a fraction of the time.
    /// It runs on one thread and in plain Rust; the level is what shading uses later.
    ///
    /// # Panics
    ///
    /// If there are fewer than two views or not as many maps as views, or they differ in size, or
    /// that is beyond [`raster::MAX_SIZE`].
    pub fn draw_unrelated(&mut self, views: &[View], maps: &[DepthMap<'_>], options: &SkinOptions) {
        let size = views.first().map_or([0; 2], |view| [view.width(), view.height()]);
        self.reset(views.len(), size, maps);
        self.level = options.level;
        let eye = |view: &View| Vec3::from_slice(&view.eye());
        let baseline = eye(&views[0]).distance(eye(&views[1]));
        self.texel_in_nearness = 1.0 / (views[0].focal().x * baseline);
        let mut scratch = core::mem::take(&mut self.polygons);
        for segment in 0..self.segments {
            for end in [0, 1] {
                let (from, to) = (segment + 1 - end, segment + end);
                let pair = Pair {
                    from: &maps[from],
                    to: &maps[to],
                    warp: Warp::new(&views[from], &views[to]),
                    back: Warp::new(&views[to], &views[from]),
                };
                pair.draw(options, &mut scratch);
                for (y, row) in scratch.drawn.chunks_exact(self.width.max(1)).enumerate() {
                    self.row_mut(segment, end, y).copy_from_slice(row);
                }
            }
        }
        self.polygons = scratch;
    }
}

/// A directed segment.
struct Pair<'a> {
    from: &'a DepthMap<'a>,
    to: &'a DepthMap<'a>,
    /// From the source's texel space to the destination's.
    warp: Warp,
    back: Warp,
}

impl Pair<'_> {
    /// Draws the channel into `scratch.drawn`.
    fn draw(&self, options: &SkinOptions, scratch: &mut PolygonScratch) {
        let PolygonScratch { crossings, skins, nearness, limit, drawn } = scratch;
        let (width, height) = (self.to.width(), self.to.height());
        crossings.find(self.from, self.to, &self.warp, &options.discontinuity);
        skins.clear();
        // Cells have texels for corners; those of the border lie half outside.
        for y in 0..=height as usize {
            for x in 0..=width as usize {
                self.push_cell(crossings, [x, y], options.transition, skins);
            }
        }
        // Up to half a texel of the source's map, skin and surface may be the same thing.
        limit.clear();
        let texels = self.to.nearness().iter().enumerate();
        limit.extend(texels.map(|(i, &n)| {
            let (x, y) = (i as u32 % width, i as u32 / width);
            n + 0.5 / self.back.disparity(x as f32 + 0.5, y as f32 + 0.5, n)
        }));
        nearness.clone_from(limit);
        drawn.clear();
        drawn.resize(nearness.len(), 1.0);
        draw_skins(skins, width, height, nearness, drawn)
            .expect("all slices are of the maps' size");
        if options.transition == Transition::Rational {
            self.resolve(limit, nearness, drawn);
        }
    }

    /// Turns what rational skins have carried, their edge's nearness, into visibility.
    fn resolve(&self, limit: &[f32], nearness: &[f32], drawn: &mut [f32]) {
        let width = self.to.width();
        for (i, seen) in drawn.iter_mut().enumerate() {
            // Where a skin is nearer than it had to be.
            if nearness[i] > limit[i] {
                let (x, y) = (i as u32 % width, i as u32 / width);
                let skin = self.back.at(x as f32 + 0.5, y as f32 + 0.5, nearness[i]);
                let along = skin.map_or(1.0, |skin| (skin.z / *seen).clamp(0.0, 1.0));
                // The ray from the receiver past the edge, the source's ray along the skin and the
                // light are in one plane: where the first meets the light follows from how far
                // along the others the skin is (Menelaus).
                let t = (1.0 - along) * nearness[i] / (nearness[i] - along * self.to.nearness()[i]);
                *seen = if t > 0.0 { t.min(1.0) } else { 0.0 };
            }
        }
    }

    /// Appends the skins of the cell whose lower right texel is (x, y).
    fn push_cell(
        &self,
        crossings: &Crossings,
        [x, y]: [usize; 2],
        transition: Transition,
        skins: &mut Vec<[SkinVertex; 3]>,
    ) {
        let [top, right, bottom, left] = crossings.around(x, y);
        let mut join = |a: &Crossing, b: &Crossing| self.push_quad(a, b, transition, skins);
        match [top, right, bottom, left] {
            [None, None, None, None] => {}
            [Some(a), Some(b), None, None]
            | [Some(a), None, Some(b), None]
            | [Some(a), None, None, Some(b)]
            | [None, Some(a), Some(b), None]
            | [None, Some(a), None, Some(b)]
            | [None, None, Some(a), Some(b)] => join(a, b),
            [Some(top), Some(right), Some(bottom), Some(left)] => {
                // Two silhouettes; the nearer texels are blockers on their own.
                let texel =
                    |x: usize, y: usize| self.from.nearness()[y * self.from.width() as usize + x];
                let falling = texel(x - 1, y - 1) + texel(x, y);
                if falling > texel(x, y - 1) + texel(x - 1, y) {
                    join(top, left);
                    join(right, bottom);
                } else {
                    join(top, right);
                    join(left, bottom);
                }
            }
            some => {
                // A silhouette that ends here, or several that meet: each goes on to the middle.
                let middle = Vec2::new(x as f32, y as f32);
                for (i, crossing) in some.into_iter().enumerate() {
                    let Some(crossing) = crossing else { continue };
                    let end = match i {
                        0 | 2 => Vec2::new(crossing.position.x, middle.y),
                        _ => Vec2::new(middle.x, crossing.position.y),
                    };
                    if let Some(end) = crossing.moved_to(end, &self.warp) {
                        join(crossing, &end);
                    }
                }
            }
        }
    }

    /// Appends the skin along the silhouette from `a` to `b`, if the destination sees its front.
    fn push_quad(
        &self,
        a: &Crossing,
        b: &Crossing,
        transition: Transition,
        skins: &mut Vec<[SkinVertex; 3]>,
    ) {
        // On which side of the silhouette the blocker is, and the skin. If that is the same one,
        // the skin is behind the blocker.
        let blocker = (b.position - a.position).perp_dot(a.to_blocker);
        let along = b.blocker.truncate() - a.blocker.truncate();
        let down = (a.receiver - a.blocker) + (b.receiver - b.blocker);
        let facing = along.perp_dot(down.truncate()) * blocker < 0.0;
        if !facing {
            return;
        }
        let vertex = |at: Vec3, linear: f32, edge: f32| SkinVertex {
            u: at.x,
            v: at.y,
            nearness: at.z,
            visibility: match transition {
                Transition::Linear => linear,
                Transition::Rational => edge,
            },
        };
        let [a_near, a_far] = [vertex(a.blocker, 0.0, a.edge()), vertex(a.receiver, 1.0, a.edge())];
        let [b_near, b_far] = [vertex(b.blocker, 0.0, b.edge()), vertex(b.receiver, 1.0, b.edge())];
        skins.extend([[a_near, b_near, b_far], [a_near, b_far, a_far]]);
    }
}

#[cfg(test)]
mod tests {
    use shadowmap_core::Level;

    use super::*;

    #[test]
    fn channels_are_shaded_with_the_level_they_are_drawn_with() {
        let view = |x: f32| {
            let eye = Vec3::new(x, 4.0, 0.0);
            View::perspective(eye, eye - Vec3::Y, Vec3::Z, 1.0, 8, 8, 0.1)
        };
        let texels = [0.25; 64];
        let map = DepthMap::new(8, 8, &texels, &[]).unwrap();
        let mut channels = VisibilityChannels::new();
        for level in Level::available() {
            let options = SkinOptions { level, ..SkinOptions::default() };
            channels.draw_unrelated(&[view(0.0), view(1.0)], &[map; 2], &options);
            assert_eq!(channels.level, level);
        }
    }
}
