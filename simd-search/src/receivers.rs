//! The receivers of a batch, side by side for kernels.

use crate::Query;
use crate::pyramid::LANES;

/// Receivers in a batch.
pub(crate) const BATCH: usize = 64;

/// Columns and rows of the part of the map that a batch looks at, at most: places in row-major
/// order are exact.
pub(crate) const WINDOW: u32 = 4096;

/// Receivers of one side and what is found for them, one in each lane.
#[derive(Clone, Copy)]
pub(crate) struct Seekers {
    pub u: [f32; BATCH],
    pub v: [f32; BATCH],
    pub nearness: [f32; BATCH],
    pub slope_x: [f32; BATCH],
    pub slope_y: [f32; BATCH],
    pub offset: [f32; BATCH],
    /// Squared distance of the best texel so far, at first of the farthest that counts.
    pub distance: [f32; BATCH],
    /// Its place in row-major order, infinite if there is none.
    pub order: [f32; BATCH],
    /// The texel that is the first in that order.
    pub origin: [u32; 2],
    pub count: usize,
}

impl Seekers {
    /// Nobody.
    #[inline(always)]
    pub fn new() -> Seekers {
        let zero = [0.0; BATCH];
        Seekers {
            u: zero,
            v: zero,
            nearness: zero,
            slope_x: zero,
            slope_y: zero,
            offset: zero,
            distance: zero,
            order: zero,
            origin: [0; 2],
            count: 0,
        }
    }

    /// Starts over with nobody.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
        self.order = [f32::INFINITY; BATCH];
        // Nothing counts in the lanes that fill up a vector.
        self.distance = [-1.0; BATCH];
    }

    /// Adds a receiver for which nothing is found yet.
    #[inline(always)]
    pub fn push(&mut self, query: &Query) {
        let i = self.count % BATCH;
        self.count += 1;
        self.u[i] = query.point.u;
        self.v[i] = query.point.v;
        self.nearness[i] = query.point.nearness;
        self.slope_x[i] = query.point.slope.x;
        self.slope_y[i] = query.point.slope.y;
        self.offset[i] = query.offset;
        // Nothing counts for a radius that is negative or NaN.
        self.distance[i] = if query.radius >= 0.0 { query.radius * query.radius } else { -1.0 };
    }

    /// The place of a texel in row-major order.
    #[inline(always)]
    pub fn order(&self, x: u32, y: u32) -> f32 {
        ((y - self.origin[1]) * WINDOW + (x - self.origin[0])) as f32
    }

    /// The texel found for receiver `i`, and its squared distance.
    #[inline(always)]
    pub fn found(&self, i: usize) -> Option<([u32; 2], f32)> {
        let (order, distance) = (self.order[i % BATCH], self.distance[i % BATCH]);
        // This cast is exact.
        let place = order as u32;
        let [x, y] = self.origin;
        let texel = [x + place % WINDOW, y + place / WINDOW];
        if order < f32::INFINITY { Some((texel, distance)) } else { None }
    }

    /// The greatest squared distance that is still of use to one of them.
    #[inline(always)]
    pub fn farthest(&self) -> f32 {
        let mut most = [-1.0_f32; LANES];
        for chunk in self.distance[..self.count.next_multiple_of(LANES)].as_chunks::<LANES>().0 {
            for i in 0..LANES {
                most[i] = if chunk[i] > most[i] { chunk[i] } else { most[i] };
            }
        }
        let mut count = LANES / 2;
        while count > 0 {
            for i in 0..count {
                most[i] = if most[i + count] > most[i] { most[i + count] } else { most[i] };
            }
            count /= 2;
        }
        most[0]
    }
}
