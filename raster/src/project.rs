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

    /// The homogeneous texel-space coordinates U, V, N, Q, in the order that
    /// [`View::rows`] documents.
    #[inline(always)]
    pub(crate) fn homogeneous(&self, p: Vec3) -> [f32; 4] {
        self.rows.map(|r| ((r[0] * p.x + r[1] * p.y) + r[2] * p.z) + r[3])
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
