//! Where silhouettes cross between neighbouring texels of a map.

use alloc::vec::Vec;

use glam::{Vec2, Vec3};
use shadowmap_core::{DepthMap, Warp};

use crate::Discontinuity;
use crate::discontinuity::{EdgeFilter, Side, depth_step, laplacian, zero_crossing};
use crate::silhouette::{mean_of_rows, of_both};

/// A silhouette between two texels of the source's map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Where in the source's map.
    pub position: Vec2,
    /// The way from the receiver's texel to the blocker's.
    pub to_blocker: Vec2,
    /// Nearness of the blocker and of the receiver in the source's map.
    edge: f32,
    far: f32,
    /// The ends of the skin, in the destination's texel space.
    pub blocker: Vec3,
    pub receiver: Vec3,
}

impl Crossing {
    /// Nearness of the blocker's edge in the source's map.
    pub fn edge(&self) -> f32 {
        self.edge
    }

    /// The same skin at another place of the source's map.
    pub fn moved_to(&self, position: Vec2, warp: &Warp) -> Option<Crossing> {
        let blocker = warp.at(position.x, position.y, self.edge)?;
        let receiver = warp.at(position.x, position.y, self.far)?;
        Some(Crossing { position, blocker, receiver, ..*self })
    }
}

/// All crossings of a map.
#[derive(Clone, Debug, Default)]
pub(crate) struct Crossings {
    width: usize,
    height: usize,
    list: Vec<Crossing>,
    /// For each texel, the place in the list, + 1, of the crossing on the way to the next texel
    /// to the right.
    to_right: Vec<u32>,
    /// The same on the way to the next texel below.
    below: Vec<u32>,
}

/// The two ways from a texel to a neighbour.
#[derive(Clone, Copy)]
enum Way {
    Right,
    Below,
}

impl Crossings {
    /// Finds the crossings of `from` whose skins show in `to`.
    pub fn find(
        &mut self,
        from: &DepthMap<'_>,
        to: &DepthMap<'_>,
        warp: &Warp,
        discontinuity: &Discontinuity,
    ) {
        let (width, height) = (from.width() as usize, from.height() as usize);
        (self.width, self.height) = (width, height);
        self.list.clear();
        let search = Search { from, to, warp, discontinuity };
        for (way, found) in [(Way::Right, &mut self.to_right), (Way::Below, &mut self.below)] {
            found.clear();
            found.resize(width * height, 0);
            let (columns, rows) = match way {
                Way::Right => (width.saturating_sub(1), height),
                Way::Below => (width, height.saturating_sub(1)),
            };
            for y in 0..rows {
                for x in 0..columns {
                    if let Some(crossing) = search.crossing(x, y, way) {
                        self.list.push(crossing);
                        found[y * width + x] = self.list.len() as u32;
                    }
                }
            }
        }
    }

    /// The crossings around the cell whose lower right texel is (x, y): top, right, bottom, left.
    /// Texels outside the map have none.
    pub fn around(&self, x: usize, y: usize) -> [Option<&Crossing>; 4] {
        let get = |table: &[u32], x: usize, y: usize| {
            let inside = x < self.width && y < self.height;
            let index = if inside { table[y * self.width + x] } else { 0 };
            self.list.get((index as usize).wrapping_sub(1))
        };
        let (left, above) = (x.wrapping_sub(1), y.wrapping_sub(1));
        [
            get(&self.to_right, left, above),
            get(&self.below, x, above),
            get(&self.to_right, left, y),
            get(&self.below, left, above),
        ]
    }
}

struct Search<'a> {
    from: &'a DepthMap<'a>,
    to: &'a DepthMap<'a>,
    warp: &'a Warp,
    discontinuity: &'a Discontinuity,
}

impl Search<'_> {
    /// The texel `along` a way and `across` it from texel (x, y); that of the border beyond it.
    fn texel(&self, x: usize, y: usize, way: Way, along: isize, across: isize) -> f32 {
        let (dx, dy) = match way {
            Way::Right => (along, across),
            Way::Below => (across, along),
        };
        let (width, height) = (self.from.width() as usize, self.from.height() as usize);
        let x = x.saturating_add_signed(dx).min(width - 1);
        let y = y.saturating_add_signed(dy).min(height - 1);
        self.from.nearness()[y * width + x]
    }

    fn crossing(&self, x: usize, y: usize, way: Way) -> Option<Crossing> {
        let row = |across| [-1, 0, 1, 2].map(|along| self.texel(x, y, way, along, across));
        let four = row(0);
        let pair @ [b, c] = [four[1], four[2]];
        let (side, edge, far) = if b > c { (Side::Left, b, c) } else { (Side::Right, c, b) };
        // Most pairs are of one surface: nothing that small is worth a warp.
        if edge.is_nan() || far.is_nan() || edge - far <= 1e-5 * edge {
            return None;
        }
        let step = match way {
            Way::Right => Vec2::X,
            Way::Below => Vec2::Y,
        };
        let first = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let middle = first + step * 0.5;
        let [near_end, far_end] = [edge, far].map(|n| self.warp.at(middle.x, middle.y, n));
        let length = (near_end? - far_end?).truncate().length();
        let threshold = self.discontinuity.threshold;
        if length.is_nan() || length < threshold {
            return None;
        }
        let least = threshold * (edge - far) / length;
        let found = match self.discontinuity.filter {
            EdgeFilter::DepthStep => depth_step(four, side, least),
            EdgeFilter::Laplacian => {
                let three = |along: isize, across: isize| {
                    [-1, 0, 1].map(|d| self.texel(x, y, way, along + d, across))
                };
                let response =
                    |along| laplacian(three(along, -1), three(along, 0), three(along, 1));
                zero_crossing(pair, [response(0), response(1)], side, least)
            }
        };
        if !found {
            return None;
        }
        let offset = mean_of_rows(pair, [row(-1), row(1)], side);
        let disparity = length / (edge - far);
        let there = self.in_destination(middle, step, offset, edge, side, disparity);
        // Between the two texels' centres, so that silhouettes do not fold.
        let offset = of_both(offset, there).clamp(-0.49, 0.49);
        let crossing = Crossing {
            position: middle,
            to_blocker: step * -side.sign(),
            edge,
            far,
            blocker: Vec3::ZERO,
            receiver: Vec3::ZERO,
        };
        crossing.moved_to(middle + step * offset, self.warp)
    }

    /// How far from `middle` along `step` the destination's map has a blocker's edge that the
    /// source has at `offset`; `offset` itself if it does not show it within a texel.
    fn in_destination(
        &self,
        middle: Vec2,
        step: Vec2,
        offset: f32,
        edge: f32,
        side: Side,
        disparity: f32,
    ) -> f32 {
        const TRIES: u8 = 16;
        let end = |offset: f32| {
            let p = middle + step * offset;
            self.warp.at(p.x, p.y, edge)
        };
        let sign = side.sign();
        let (Some(first), Some(last)) = (end(offset - sign), end(offset + sign)) else {
            return offset;
        };
        let (width, height) = (self.to.width() as usize, self.to.height() as usize);
        // From the blocker outwards, over two texels.
        let mut on_blocker = false;
        for i in 0..=TRIES {
            let t = f32::from(i) / f32::from(TRIES);
            let p = first + (last - first) * t;
            let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < width as f32 && p.y < height as f32;
            if !inside {
                break;
            }
            let n = self.to.nearness()[p.y as usize * width + p.x as usize];
            if on_blocker && (p.z - n) * disparity > 1.0 {
                let between = t - 0.5 / f32::from(TRIES);
                return offset + sign * (between * 2.0 - 1.0);
            }
            on_blocker = (n - p.z).abs() * disparity < 1.0;
        }
        offset
    }
}
