//! Which of many receivers are searched for together.

use core::mem::take;

use crate::Query;
use crate::reach::Reach;
use crate::receivers::BATCH;

/// Receivers on several planes are divided by plane if they look farther than this, in texels...
const FAR: f32 = 24.0;
/// ...or lie in a box of more columns and rows than this...
const LARGE: f32 = 96.0;
/// ...and one of the planes has as many of them.
const MANY: u32 = 8;
/// Planes that are found, at most, and planes with fewer receivers, after which no others are
/// looked for.
const PLANES: usize = 4;
const MISSES: u32 = 3;
/// Slopes that differ by a smaller share are the same.
const SAME: f32 = 1.0 / 4096.0;
/// Receivers that are searched for together where more have too little in common, and how far they
/// are from the first of them at most, in texels along each axis.
const NEIGHBOURS: u32 = 16;
const NEAR: f32 = 24.0;

/// Queries that wait to be answered, in parts: bit i for query i.
pub(crate) struct Parts {
    all: u64,
    /// Those whose receivers lie on one plane, for several planes, and the others.
    planes: [u64; PLANES + 1],
    count: usize,
    /// Those that have too little in common.
    apart: u64,
}

/// Queries to be answered together.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub some: u64,
    /// Nothing has been divided yet...
    pub is_all: bool,
    /// ...or nothing can be any further.
    pub is_last: bool,
}

impl Parts {
    /// All in one part.
    #[inline(always)]
    pub fn of(all: u64) -> Parts {
        Parts { all, planes: [0; PLANES + 1], count: 0, apart: 0 }
    }

    /// The part that is to be answered next.
    #[inline(always)]
    pub fn next(&mut self, queries: &[Query]) -> Option<Part> {
        let part = |some| Part { some, is_all: false, is_last: false };
        if self.all != 0 {
            return Some(Part { is_all: true, ..part(take(&mut self.all)) });
        }
        if self.count > 0 {
            self.count -= 1;
            return Some(part(self.planes[self.count % self.planes.len()]));
        }
        if self.apart != 0 {
            let some = neighbours(queries, self.apart);
            self.apart &= !some;
            return Some(Part { is_last: true, ..part(some) });
        }
        None
    }

    /// Divides a part into neighbours.
    #[inline(always)]
    pub fn divide(&mut self, some: u64) {
        self.apart |= some;
    }

    /// Divides a part by the planes that many of the receivers lie on. False if there are none.
    #[inline(always)]
    pub fn divide_by_plane(&mut self, queries: &[Query], some: u64) -> bool {
        let (mut left, mut others, mut misses) = (some, 0, 0);
        while left != 0 && misses < MISSES && self.count < PLANES {
            let plane = on_one_plane(queries, left);
            left &= !plane;
            if plane.count_ones() < MANY {
                others |= plane;
                misses += 1;
            } else {
                self.planes[self.count] = plane;
                self.count += 1;
            }
        }
        others |= left;
        if self.count == 0 {
            return false;
        }
        if others != 0 {
            self.planes[self.count] = others;
            self.count += 1;
        }
        true
    }
}

/// Whether receivers lie on several planes, and so far apart or from what they look at that those
/// on one have more in common.
#[inline(always)]
pub(crate) fn is_wide(reach: &Reach) -> bool {
    let Reach { u, v, radius, plane, spread, .. } = *reach;
    let size = (u[1] - u[0]) + (v[1] - v[0]);
    (radius > FAR || size > LARGE)
        && spread.x + spread.y > SAME * (plane.slope.x.abs() + plane.slope.y.abs())
}

/// The first of the queries in `left`, and all of them whose receivers lie on planes with the same
/// slope.
#[inline(always)]
fn on_one_plane(queries: &[Query], left: u64) -> u64 {
    let slope = queries[left.trailing_zeros() as usize % BATCH].point.slope;
    let most = SAME * (slope.x.abs() + slope.y.abs());
    let mut differ = 0;
    for i in 0..queries.len() {
        let other = queries[i].point.slope;
        let differs = (other.x - slope.x).abs() + (other.y - slope.y).abs() > most;
        differ |= u64::from(differs) << (i % BATCH);
    }
    left & !differ
}

/// The first of the queries in `left` and up to 15 more whose receivers are close to its own.
#[inline(always)]
fn neighbours(queries: &[Query], left: u64) -> u64 {
    let first = &queries[left.trailing_zeros() as usize % BATCH].point;
    let (mut part, mut rest) = (0_u64, left);
    while rest != 0 && part.count_ones() < NEIGHBOURS {
        let i = rest.trailing_zeros() as usize;
        let point = &queries[i % BATCH].point;
        // A NaN is close only to itself.
        let is_near = (point.u - first.u).abs() <= NEAR && (point.v - first.v).abs() <= NEAR;
        if part == 0 || is_near {
            part |= 1 << i;
        }
        rest &= rest - 1;
    }
    part
}
