//! How far receivers look.

use simd_search::Pyramid;

use super::geometry::Geometry;
use super::outline::Places;

/// The range of some receivers' places in the map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub u: [f32; 2],
    pub v: [f32; 2],
    /// The least of their nearness.
    pub nearness: f32,
}

/// The places that the receivers' discs reach, by the nearest depth there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    pub places: Places,
    /// Whether they go past the map's border.
    pub is_cut: bool,
}

impl Reach {
    /// `None` if nothing in reach is nearer to the light than the receivers. `greatest` is the
    /// nearest depth of the whole map.
    #[inline(always)]
    pub fn new(
        g: &Geometry,
        pyramid: &Pyramid<'_>,
        greatest: f32,
        [width, height]: [i32; 2],
        extent: &Extent,
    ) -> Option<Reach> {
        let (a, b) = (g.stretch(extent.u[0], extent.v[0]), g.stretch(extent.u[1], extent.v[1]));
        let stretch = [a[0].max(b[0]), a[1].max(b[1])];
        let mut greatest = greatest;
        let mut reach = Reach { places: Places { columns: [0; 2], rows: [0; 2] }, is_cut: false };
        // The first box is bounded by the nearest depth of all, the next by the nearest in it.
        for round in 0..3 {
            let nearer = greatest - extent.nearness;
            // False for NaN.
            let blockers_are_possible = nearer > 0.0;
            if !blockers_are_possible {
                return None;
            }
            let (columns, cut_u) = range(extent.u, nearer * (g.spread[0] * stretch[0]), width);
            let (rows, cut_v) = range(extent.v, nearer * (g.spread[1] * stretch[1]), height);
            if columns[0] >= columns[1] || rows[0] >= rows[1] {
                return None;
            }
            reach.places = Places { columns, rows };
            reach.is_cut = cut_u || cut_v;
            if round < 2 {
                let texels = |range: [i32; 2]| range[0].max(0) as u32..(range[1] + 1) as u32;
                greatest = greatest.min(pyramid.greatest(texels(columns), texels(rows)));
            }
        }
        Some(reach)
    }
}

/// The places within `radius` of \[from, to\] along one axis, in a map of `size` texels, and
/// whether its border cuts them. A place is that of the texel before it.
#[inline(always)]
fn range([from, to]: [f32; 2], radius: f32, size: i32) -> ([i32; 2], bool) {
    // One place more on both sides: pieces of the outline are half a place long. Casts saturate.
    let (first, end) = ((from - radius) - 2.5, (to + radius) + 2.5);
    let is_cut = first < -1.0 || end > size as f32 + 1.0;
    ([(first as i32).max(-1), (end as i32).min(size)], is_cut)
}
