//! From the world to texel space.

use glam::Vec3;
use shadowmap_core::View;

/// Triangles whose vertices all lie within this many texels of the origin are not clipped against
/// the map's sides. It covers the largest map and keeps 24.8 fixed point within 2^22.
pub(crate) const GUARD: f32 = crate::MAX_SIZE as f32;

/// What of a view decides where vertices go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    pub(crate) rows: [[f32; 4]; 4],
    pub(crate) max_nearness: f32,
}

impl Projection {
    pub(crate) fn of(view: &View) -> Projection {
        Projection { rows: *view.rows(), max_nearness: view.max_nearness() }
    }

    /// Whether the two differ in the constant of U alone, bit for bit, as rectified views do.
    pub(crate) fn is_beside(&self, other: &Projection) -> bool {
        let bits = |projection: &Projection| {
            let mut rows = projection.rows;
            rows[0][3] = 0.0;
            (rows.map(|row| row.map(f32::to_bits)), projection.max_nearness.to_bits())
        };
        bits(self) == bits(other)
    }

    /// The homogeneous texel-space coordinates U, V, N, Q, in the order that
    /// [`View::rows`] documents.
    #[inline(always)]
    pub(crate) fn homogeneous(&self, p: Vec3) -> [f32; 4] {
        self.rows.map(|r| along(r, p) + r[3])
    }

    /// U without its constant: what views beside each other share.
    #[inline(always)]
    pub(crate) fn across(&self, p: Vec3) -> f32 {
        along(self.rows[0], p)
    }

    /// u, v and nearness, and whether the vertex needs no clipping. If it does, the three mean
    /// nothing. A vertex with a NaN or an infinity needs clipping.
    #[inline(always)]
    pub(crate) fn project(&self, [u, v, n, q]: [f32; 4]) -> ([f32; 3], bool) {
        let scale = 1.0 / q;
        let seen = [u * scale, v * scale, n * scale];
        let inside = (self.max_nearness * q - n >= 0.0)
            & (n >= 0.0)
            & (seen[0].abs() <= GUARD)
            & (seen[1].abs() <= GUARD);
        (seen, inside)
    }
}

/// A row of a matrix at `p`, without its constant.
#[inline(always)]
fn along(row: [f32; 4], p: Vec3) -> f32 {
    (row[0] * p.x + row[1] * p.y) + row[2] * p.z
}

#[cfg(test)]
mod tests {
    use shadowmap_core::Window;

    use super::*;

    #[test]
    fn views_are_beside_each_other_if_they_differ_in_one_constant() {
        let axes = View::axes_towards(Vec3::new(0.3, -1.0, 0.2), Vec3::X);
        let window = Window::centered(1.0, 1.0);
        let (first, size) = (Vec3::new(1.3, 4.1, 0.7), 64);
        let view = |eye: Vec3, near: f32| {
            let view = View::perspective_rectified(first, eye, axes, window, size, size, near);
            Projection::of(&view)
        };
        let here = view(first, 0.1);
        assert!(here.is_beside(&view(first + axes[0] * 1.7, 0.1)));
        assert!(!here.is_beside(&view(first + axes[0] * 1.7, 0.2)));
        let lower = View::perspective_window(first + axes[1], axes, window, size, size, 0.1);
        assert!(!here.is_beside(&Projection::of(&lower)));
    }
}
