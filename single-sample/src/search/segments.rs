//! Straight segments of an outline, as structures of arrays.

use super::receiver::Seen;

/// A point of the outline, in texel coordinates, and the nearness of the blocker there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vertex {
    pub x: f32,
    pub y: f32,
    pub nearness: f32,
}

/// A straight part of the outline, blockers to its right (seen down the map).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    pub from: Vertex,
    pub to: Vertex,
}

impl Segment {
    /// One that counts for nothing.
    pub const NONE: Segment = {
        let vertex = Vertex { x: 0.0, y: 0.0, nearness: 0.0 };
        Segment { from: vertex, to: vertex }
    };

    #[inline(always)]
    fn of([x, y, nearness, to_x, to_y, to_nearness]: [f32; 6]) -> Segment {
        Segment {
            from: Vertex { x, y, nearness },
            to: Vertex { x: to_x, y: to_y, nearness: to_nearness },
        }
    }
}

/// How many segments [`Segments`] holds: no power of two, which would put what is read together
/// in the same few lines of a cache. Few in tests, for some outlines to be too long.
const CAPACITY: usize = if cfg!(test) { 448 } else { 6144 + 48 };
/// The most that one cell adds.
pub(crate) const CELL_MOST: usize = 128;
/// Segments that are visited at a time.
pub(crate) const LANES: usize = 16;

/// Segments of the outline in the map.
pub(crate) struct Segments {
    /// x, y and nearness of the first vertex, then of the second.
    values: [[f32; CAPACITY]; 6],
    len: usize,
    bounds: [Bounds; CAPACITY / LANES],
}

/// Where a group of segments and their blockers lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    u: [f32; 2],
    v: [f32; 2],
    pub nearness: [f32; 2],
}

impl Bounds {
    pub const EMPTY: Bounds = Bounds {
        u: [f32::INFINITY, f32::NEG_INFINITY],
        v: [f32::INFINITY, f32::NEG_INFINITY],
        nearness: [f32::INFINITY, f32::NEG_INFINITY],
    };

    pub fn include(&mut self, Segment { from, to }: &Segment) {
        let add = |[low, high]: [f32; 2], a: f32, b: f32| {
            let (least, most) = if a < b { (a, b) } else { (b, a) };
            [if least < low { least } else { low }, if most > high { most } else { high }]
        };
        self.u = add(self.u, from.x, to.x);
        self.v = add(self.v, from.y, to.y);
        self.nearness = add(self.nearness, from.nearness, to.nearness);
    }

    /// Whether the segments may reach into a receiver's disc.
    #[inline(always)]
    pub fn are_in_reach(&self, r: &Seen) -> bool {
        self.are_around(r, 0.0)
    }

    /// Whether they may, or would if they were so many texels closer.
    #[inline(always)]
    pub fn are_around(&self, r: &Seen, texels: f32) -> bool {
        let apart = |at: f32, [low, high]: [f32; 2]| {
            let (before, after) = (low - at, at - high);
            let apart = if before > after { before } else { after };
            if apart > 0.0 { apart } else { 0.0 }
        };
        let (dx, dy) = (apart(r.u, self.u), apart(r.v, self.v));
        r.reaches(dx, dy, self.nearness[1] - r.nearness, texels)
    }
}

impl Segments {
    pub const fn new() -> Segments {
        Segments { values: [[0.0; CAPACITY]; 6], len: 0, bounds: [Bounds::EMPTY; CAPACITY / LANES] }
    }

    /// Forgets all segments but the first `len`.
    pub fn truncate(&mut self, len: usize) {
        self.len = len;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the segments of so many more cells, and those that fill up the last group, fit.
    pub fn has_room(&self, cells: usize) -> bool {
        self.len + cells * CELL_MOST + LANES <= CAPACITY
    }

    #[inline(always)]
    pub fn push(&mut self, Segment { from, to }: Segment) {
        let values = [from.x, from.y, from.nearness, to.x, to.y, to.nearness];
        for (lane, value) in self.values.iter_mut().zip(values) {
            lane[self.len] = value;
        }
        self.len += 1;
    }

    /// Finds the bounds of a group of lanes, which is full.
    #[inline(always)]
    pub fn bound(&mut self, group: usize) {
        let range = |from: usize, to: usize| {
            let from: &[f32; LANES] = &self.values[from].as_chunks().0[group];
            let to: &[f32; LANES] = &self.values[to].as_chunks().0[group];
            let (mut low, mut high) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                low[i] = if from[i] < to[i] { from[i] } else { to[i] };
                high[i] = if from[i] > to[i] { from[i] } else { to[i] };
            }
            let mut half = LANES / 2;
            while half > 0 {
                for i in 0..half {
                    low[i] = if low[i] < low[i + half] { low[i] } else { low[i + half] };
                    high[i] = if high[i] > high[i + half] { high[i] } else { high[i + half] };
                }
                half /= 2;
            }
            [low[0], high[0]]
        };
        self.bounds[group] = Bounds { u: range(0, 3), v: range(1, 4), nearness: range(2, 5) };
    }

    /// Of a group of lanes, once they are found.
    #[inline(always)]
    pub fn bounds(&self, group: usize) -> &Bounds {
        &self.bounds[group]
    }

    #[inline(always)]
    pub fn get(&self, i: usize) -> Segment {
        let [x, y, nearness, to_x, to_y, to_nearness] = &self.values;
        Segment::of([x[i], y[i], nearness[i], to_x[i], to_y[i], to_nearness[i]])
    }

    #[inline(always)]
    pub fn group(&self, i: usize) -> Group<'_> {
        let [a, b, c, d, e, f] = &self.values;
        Group([
            &a.as_chunks().0[i],
            &b.as_chunks().0[i],
            &c.as_chunks().0[i],
            &d.as_chunks().0[i],
            &e.as_chunks().0[i],
            &f.as_chunks().0[i],
        ])
    }

    /// Fills up the last group of lanes with segments that count for nothing. Returns the number of
    /// groups.
    #[inline(always)]
    pub fn pad(&mut self) -> usize {
        if !self.len.is_multiple_of(LANES) {
            let end = self.get(self.len - 1).to;
            let values = [end.x, end.y, end.nearness, end.x, end.y, end.nearness];
            for (lane, value) in self.values.iter_mut().zip(values) {
                lane[self.len..][..LANES].fill(value);
            }
            self.len = self.len.next_multiple_of(LANES);
        }
        self.len / LANES
    }
}

/// Segments side by side.
pub(crate) struct Group<'a>([&'a [f32; LANES]; 6]);

impl Group<'_> {
    #[inline(always)]
    pub fn get(&self, i: usize) -> Segment {
        let [x, y, nearness, to_x, to_y, to_nearness] = self.0;
        Segment::of([x[i], y[i], nearness[i], to_x[i], to_y[i], to_nearness[i]])
    }
}
