//! How far receivers look.

use simd_search::Pyramid;

use super::cell::CELL;
use super::geometry::Geometry;
use super::outline::Places;
use super::receiver::Receiver;

/// Texels from any point of a cell to the texels of that cell, and more.
const ROOM: f32 = CELL as f32 + 2.0;

/// The range of some receivers' places in the map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub u: [f32; 2],
    pub v: [f32; 2],
    pub nearness: [f32; 2],
}

impl Extent {
    /// That of no receivers.
    pub const EMPTY: Extent = Extent {
        u: [f32::INFINITY, f32::NEG_INFINITY],
        v: [f32::INFINITY, f32::NEG_INFINITY],
        nearness: [f32::INFINITY, f32::NEG_INFINITY],
    };

    /// That of one receiver.
    #[inline(always)]
    pub fn of(r: &Receiver) -> Extent {
        Extent { u: [r.u; 2], v: [r.v; 2], nearness: [r.nearness; 2] }
    }

    /// The longer side, in texels.
    #[inline(always)]
    pub fn side(&self) -> f32 {
        (self.u[1] - self.u[0]).max(self.v[1] - self.v[0])
    }

    #[inline(always)]
    pub fn add(&mut self, u: f32, v: f32, nearness: f32) {
        self.u = [self.u[0].min(u), self.u[1].max(u)];
        self.v = [self.v[0].min(v), self.v[1].max(v)];
        self.nearness = [self.nearness[0].min(nearness), self.nearness[1].max(nearness)];
    }
}

/// The places that the receivers' discs reach, by the nearest depth there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub places: Places,
    /// Whether they go past the map's border.
    pub is_cut: bool,
    /// The nearest depth that was assumed.
    pub greatest: f32,
}

impl Reach {
    /// Where blockers no nearer than `greatest` can matter; `None` if nowhere.
    #[inline(always)]
    pub fn within(
        g: &Geometry,
        greatest: f32,
        [width, height]: [i32; 2],
        extent: &Extent,
    ) -> Option<Reach> {
        let nearer = greatest - extent.nearness[0];
        // False for NaN.
        let blockers_are_possible = nearer > 0.0;
        if !blockers_are_possible {
            return None;
        }
        // An infinite nearness has a place even where discs have no size.
        let nearer = nearer.min(f32::MAX);
        let (a, b) = (g.stretch(extent.u[0], extent.v[0]), g.stretch(extent.u[1], extent.v[1]));
        let stretch = [a[0].max(b[0]), a[1].max(b[1])];
        let (columns, cut_u) = range(extent.u, nearer * (g.spread[0] * stretch[0]), width);
        let (rows, cut_v) = range(extent.v, nearer * (g.spread[1] * stretch[1]), height);
        let is_empty = columns[0] >= columns[1] || rows[0] >= rows[1];
        let places = Places { columns, rows };
        (!is_empty).then_some(Reach { places, is_cut: cut_u || cut_v, greatest })
    }

    /// The same, with what the pyramid knows of the nearest depth. `greatest` is that of the
    /// whole map.
    pub fn new(
        g: &Geometry,
        pyramid: &Pyramid<'_>,
        greatest: f32,
        size: [i32; 2],
        extent: &Extent,
    ) -> Option<Reach> {
        let mut reach = Reach::within(g, greatest, size, extent)?;
        for _ in 0..2 {
            let texels = |range: [i32; 2]| range[0].max(0) as u32..(range[1] + 1) as u32;
            let (columns, rows) = (texels(reach.places.columns), texels(reach.places.rows));
            let nearest = pyramid.greatest(columns, rows);
            if nearest >= reach.greatest {
                break;
            }
            reach = Reach::within(g, reach.greatest.min(nearest), size, extent)?;
        }
        Some(reach)
    }
}

/// The places within `radius` of \[from, to\] along one axis, in a map of `size` texels, and
/// whether its border cuts them. Whole cells, with all blockers that the outline in any cell within
/// the radius may depend on.
#[inline(always)]
fn range([from, to]: [f32; 2], radius: f32, size: i32) -> ([i32; 2], bool) {
    const SIZE: i32 = CELL as i32;
    let (first, end) = (from - radius, to + radius);
    let is_cut = first < 1.5 || end > size as f32 - 1.5;
    // Casts saturate.
    let first = ((first - ROOM) as i32).clamp(-SIZE, size).div_euclid(SIZE) * SIZE;
    let end = (((end + ROOM) as i32).clamp(-SIZE, size) + SIZE - 1).div_euclid(SIZE) * SIZE;
    ([first, end], is_cut)
}
