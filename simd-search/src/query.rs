//! What is searched for, and what is found.

use shadowmap_core::LightPoint;

use crate::Map;
use crate::jitter::jitter;

/// Which texels a receiver looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Side {
    /// Texels in front of the receiver's plane: the search for the *outer* penumbra, from a
    /// receiver that sees the centre of the light.
    #[default]
    Blocker,
    /// Texels not in front of the receiver's plane: the search for the *inner* penumbra, from a
    /// receiver that does not. A texel that is NaN is among them, for it never blocks.
    Lit,
}

/// Which object IDs count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum IdTest {
    /// All.
    #[default]
    Any,
    /// All but this one: blockers other than the receiver's own object.
    Differs(u32),
    /// Only this one: lit texels of the receiver's own object.
    Equals(u32),
}

/// What the search minimises.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Key {
    /// The squared distance, in texels².
    #[default]
    Distance,
    /// The squared distance divided by the square of how far the texel is nearer than the
    /// receiver: `distance² / (nearness - point.nearness)²`.
    ///
    /// The penumbra of a spherical light has the radius `k (nearness - point.nearness)` texels (`k`
    /// is the light's radius times the focal length), so this is the square of `k r / r_max`. It
    /// changes continuously when the nearest blocker gives way to one of another layer, where
    /// `r / r_max` of the nearest texel jumps. Texels not nearer than the receiver do not count:
    /// no line from the receiver to the light meets them.
    Ratio {
        /// Texels with a greater key do not count; with `k²` those outside the cone from the
        /// receiver to the light. `f32::INFINITY` counts all.
        at_most: f32,
    },
}

/// One search: where from, what for, how far.
///
/// ```
/// use shadowmap_core::{DepthMap, Level, LightPoint};
/// use simd_search::{Query, nearest};
/// let nearness = [0.0, 0.0, 0.0, 0.9, 0.0];
/// let map = DepthMap::new(5, 1, &nearness, &[]).unwrap();
/// let query = Query::new(LightPoint::flat(1.25, 0.5, 0.5), 0.0, 8.0);
/// let hit = nearest(Level::detect(), map, &query).unwrap();
/// assert_eq!((hit.x, hit.y), (3, 0));
/// assert_eq!(hit.distance_squared, 2.25 * 2.25);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The receiver: where the search starts, and the plane that texels are compared with.
    pub point: LightPoint,
    /// A texel blocks if its nearness exceeds the receiver's plane at the texel's centre by more
    /// than this (`shadowmap_core::Bias::offset`).
    pub offset: f32,
    /// Texels whose centre is at most this far from (u, v) count, in texels. Nothing counts if it
    /// is negative or NaN.
    pub radius: f32,
    /// Which texels are looked for.
    pub side: Side,
    /// Which object IDs count.
    pub ids: IdTest,
    /// What is minimised. Of texels with equal keys the first in row-major order is found.
    pub key: Key,
    /// Moves each texel's centre, for its distance only, by a hash of (x, y), by at most half this
    /// much along each axis; in texels from 0 (the default; NaN counts as 0) to 1. Breaks up the
    /// stairs of maps of very low resolution (Brabec and Seidel 2002, section 4.3).
    pub jitter: f32,
    /// A texel that may be the answer, such as the neighbouring receiver's hit. It narrows the
    /// search, and whatever it is the answer stays the same.
    pub hint: Option<[u32; 2]>,
}

/// A texel that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Column of the texel.
    pub x: u32,
    /// Row of the texel.
    pub y: u32,
    /// Squared distance from the receiver to the texel's (jittered) centre, in texels².
    pub distance_squared: f32,
    /// Nearness of the texel.
    pub nearness: f32,
    /// What was minimised ([`Query::key`]).
    pub key: f32,
}

impl Query {
    /// The search for the nearest blocker, whatever its object ID.
    #[must_use]
    pub fn new(point: LightPoint, offset: f32, radius: f32) -> Query {
        Query {
            point,
            offset,
            radius,
            side: Side::Blocker,
            ids: IdTest::Any,
            key: Key::Distance,
            jitter: 0.0,
            hint: None,
        }
    }

    /// Texel (x, y) of the map as a hit, `None` if it does not count. This *is* the search:
    /// everything else in this crate only decides which texels need not be asked.
    ///
    /// # Panics
    ///
    /// If the texel lies outside the map.
    #[inline(always)]
    #[must_use]
    pub fn candidate(&self, map: &Map<'_>, x: u32, y: u32) -> Option<Hit> {
        let LightPoint { u, v, nearness: from, slope } = self.point;
        let (dx, dy) = ((x as f32 + 0.5) - u, (y as f32 + 0.5) - v);
        let [shift_x, shift_y] = jitter(x, y, self.jitter_amplitude());
        let (px, py) = (dx + shift_x, dy + shift_y);
        let distance_squared = px * px + py * py;
        if self.radius.is_nan()
            || self.radius < 0.0
            || distance_squared.is_nan()
            || distance_squared > self.radius * self.radius
        {
            return None;
        }
        let nearness = map.nearness(x, y);
        let blocks = nearness > (from + (slope.x * dx + slope.y * dy)) + self.offset;
        if blocks != (self.side == Side::Blocker) || !self.ids.accepts(map, x, y) {
            return None;
        }
        let key = match self.key {
            Key::Distance => distance_squared,
            Key::Ratio { at_most } => {
                let nearer = nearness - from;
                let key = distance_squared / (nearer * nearer);
                if nearer > 0.0 && key <= at_most { key } else { return None }
            }
        };
        // Distances and nearness beyond the range of f32 have no order.
        (key < f32::INFINITY).then_some(Hit { x, y, distance_squared, nearness, key })
    }

    /// [`Query::jitter`], brought into its range.
    #[inline(always)]
    pub(crate) fn jitter_amplitude(&self) -> f32 {
        if self.jitter > 0.0 { self.jitter.min(1.0) } else { 0.0 }
    }
}

impl IdTest {
    #[inline(always)]
    fn accepts(self, map: &Map<'_>, x: u32, y: u32) -> bool {
        match self {
            IdTest::Any => true,
            IdTest::Differs(id) => map.id(x, y) != id & map.id_mask(),
            IdTest::Equals(id) => map.id(x, y) == id & map.id_mask(),
        }
    }
}

impl Hit {
    /// Whether this hit is the answer rather than `other`: the smaller key, of equal keys the
    /// first in row-major order.
    #[inline(always)]
    pub(crate) fn precedes(&self, other: &Hit) -> bool {
        self.key < other.key || (self.key == other.key && (self.y, self.x) < (other.y, other.x))
    }
}
