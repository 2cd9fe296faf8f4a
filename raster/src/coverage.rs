//! Which texel centres a triangle covers: exact, in integers.

/// Vertices are snapped to this many parts of a texel (24.8 fixed point).
pub(crate) const SUBTEXELS: i32 = 256;

/// 1.5 * 2^23.
pub(crate) const SNAP_SHIFT: f32 = 12_582_912.0;

/// Rounds a texel coordinate in ±16384 to 1/256 texel, ties to even.
///
/// Adding [`SNAP_SHIFT`] makes the unit of the sum's last place 1: the hardware's own rounding does
/// the work, with the same bits on every machine. A NaN becomes some number.
#[inline(always)]
pub(crate) fn snap(coordinate: f32) -> i32 {
    let shifted = coordinate * SUBTEXELS as f32 + SNAP_SHIFT;
    shifted.to_bits().wrapping_sub(SNAP_SHIFT.to_bits()) as i32
}

/// First and last texel, along one axis, whose centres lie between the two snapped coordinates;
/// none if the first is greater than the last.
#[inline(always)]
pub(crate) fn centers_between(low: i32, high: i32, size: i32) -> (i32, i32) {
    const HALF: i32 = SUBTEXELS / 2;
    (((low + HALF - 1) >> 8).max(0), ((high - HALF) >> 8).min(size - 1))
}

/// A snapped triangle, wound so that its edge functions are positive inside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) corners: [[i32; 2]; 3],
}

/// The texels that a triangle's bounds hold, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bounds {
    pub(crate) x: (i32, i32),
    pub(crate) y: (i32, i32),
}

impl Triangle {
    /// The triangle with these corners in texels, within ±16384; `None` if it has no area.
    pub(crate) fn new(corners: [[f32; 2]; 3]) -> Option<Triangle> {
        let [a, b, c] = corners.map(|p| p.map(snap));
        let edge = Edge::new(a, b);
        match edge.at(c) {
            0 => None,
            area if area > 0 => Some(Triangle { corners: [a, b, c] }),
            _ => Some(Triangle { corners: [a, c, b] }),
        }
    }

    /// The texels of a map that its bounds hold, `None` if there are none.
    pub(crate) fn bounds(&self, width: u32, height: u32) -> Option<Bounds> {
        let span = |axis: usize, size: u32| {
            let [a, b, c] = self.corners.map(|p| p[axis]);
            centers_between(a.min(b).min(c), a.max(b).max(c), size as i32)
        };
        let bounds = Bounds { x: span(0, width), y: span(1, height) };
        (bounds.x.0 <= bounds.x.1 && bounds.y.0 <= bounds.y.1).then_some(bounds)
    }

    /// The three edges.
    pub(crate) fn edges(&self) -> [Edge; 3] {
        let [a, b, c] = self.corners;
        [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)]
    }

    /// Calls `texel(x, y)` for each texel that the triangle covers.
    pub(crate) fn for_each_texel(&self, width: u32, height: u32, mut texel: impl FnMut(i32, i32)) {
        let Some(bounds) = self.bounds(width, height) else { return };
        let edges = self.edges();
        for y in bounds.y.0..=bounds.y.1 {
            for x in bounds.x.0..=bounds.x.1 {
                if edges.iter().all(|edge| edge.covers(x, y)) {
                    texel(x, y);
                }
            }
        }
    }
}

/// A directed edge. Coordinates lie within ±2^22, so that nothing here exceeds 2^48.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    from: [i64; 2],
    delta: [i64; 2],
}

impl Edge {
    fn new(from: [i32; 2], to: [i32; 2]) -> Edge {
        let (from, to) = (from.map(i64::from), to.map(i64::from));
        Edge { from, delta: [to[0] - from[0], to[1] - from[1]] }
    }

    /// Positive on the inner side: twice the area of the triangle with the edge.
    fn at(&self, point: [i32; 2]) -> i64 {
        let [x, y] = point.map(i64::from);
        self.delta[0] * (y - self.from[1]) - self.delta[1] * (x - self.from[0])
    }

    /// A texel centre on the edge belongs to the triangle whose top or left edge it is. With y
    /// downwards and the inside to the right of the edge, a left edge goes up, a top edge to the
    /// right.
    pub(crate) fn owns_its_centers(&self) -> bool {
        self.delta[1] < 0 || (self.delta[1] == 0 && self.delta[0] > 0)
    }

    /// For a row of texels: a number that is not negative where texel (0, y) is covered, and its
    /// change from one column, and one row, to the next.
    pub(crate) fn row(&self, y: i32) -> (i64, i64, i64) {
        let center = [SUBTEXELS / 2, y * SUBTEXELS + SUBTEXELS / 2];
        let step = i64::from(SUBTEXELS);
        let excluded = i64::from(!self.owns_its_centers());
        (self.at(center) - excluded, -self.delta[1] * step, self.delta[0] * step)
    }

    /// Whether the centre of texel (x, y) is on the inner side, or on the edge and owned by it.
    pub(crate) fn covers(&self, x: i32, y: i32) -> bool {
        let center = [x, y].map(|i| i * SUBTEXELS + SUBTEXELS / 2);
        let side = self.at(center);
        side > 0 || (side == 0 && self.owns_its_centers())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapping_rounds_to_the_nearest_subtexel_with_ties_to_even() {
        for (coordinate, snapped) in [
            (0.0, 0),
            (1.0, 256),
            (-1.0, -256),
            (0.5 / 256.0, 0),
            (1.5 / 256.0, 2),
            (-1.5 / 256.0, -2),
            (16384.0, 1 << 22),
            (-16384.0, -(1 << 22)),
            (1023.999, 262_144),
        ] {
            assert_eq!(snap(coordinate), snapped, "{coordinate}");
        }
    }

    #[test]
    fn bounds_hold_the_centres_between_the_corners() {
        // Centres are at 128, 384, 640, ...
        assert_eq!(centers_between(128, 384, 8), (0, 1));
        assert_eq!(centers_between(129, 383, 8), (1, 0));
        assert_eq!(centers_between(-5000, 5000, 8), (0, 7));
    }

    #[test]
    fn a_square_on_texel_centres_has_its_top_and_left_but_not_its_bottom_and_right() {
        let corners = [[0.5, 0.5], [2.5, 0.5], [2.5, 2.5], [0.5, 2.5]];
        let mut covered = alloc::vec::Vec::new();
        for [a, b, c] in [[0, 1, 2], [2, 3, 0]] {
            let triangle = Triangle::new([corners[a], corners[b], corners[c]]).unwrap();
            triangle.for_each_texel(8, 8, |x, y| covered.push((x, y)));
        }
        covered.sort_unstable();
        assert_eq!(covered, [(0, 0), (0, 1), (1, 0), (1, 1)]);
    }
}
