//! Which parts of the map may hold blockers, by the bounds in the pyramid's leaves.

use simd_search::{NodeGroup, Pyramid};

use super::cell::{CELL, SAME_LAYER};
use super::facing::close_to;
use super::geometry::Geometry;
use super::kernels::{Ops, Work};
use super::outline::Places;
use super::planes::Planes;
use super::reach::Extent;

const WIDTH: i32 = Pyramid::LEAF[0] as i32;
const HEIGHT: i32 = Pyramid::LEAF[1] as i32;
const GROUP: i32 = Pyramid::GROUP as i32;
const LANES: usize = (GROUP * GROUP) as usize;

/// Leaves along each side of [`Leaves`], at most. Few in tests, for small maps to have several
/// parts.
const SIDE: usize = if cfg!(test) { 12 } else { 64 };
/// Columns and rows of places that surely fit.
const MOST_PLACES: [i32; 2] =
    [(SIDE as i32 - 2 * GROUP) * WIDTH, (SIDE as i32 - 2 * GROUP) * HEIGHT];

/// Column and row of each leaf in its group, in texels.
pub(crate) const CELLS: [[f32; LANES]; 2] = {
    let mut cells = [[0.0; LANES]; 2];
    let mut i = 0;
    while i < LANES {
        cells[0][i] = (i as i32 % GROUP * WIDTH) as f32;
        cells[1][i] = (i as i32 / GROUP * HEIGHT) as f32;
        i += 1;
    }
    cells
};

/// Room for rounding, in texels.
const ROOM: f32 = 0.5;

/// How far segments may run before the leaves that all of their blockers are in. Those lie along
/// the far sides of a cell, and segments that cut its corner are no longer than half of a side each
/// way, or else stray too far from a straight connection.
const BEFORE: f32 = CELL as f32 * 0.5;

/// What receivers ask of a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafTest {
    /// Where they are.
    u: [f32; 2],
    v: [f32; 2],
    /// Their least nearness, and the square of their disc's greatest radius per nearness above it.
    nearness: f32,
    spread_squared: f32,
    /// Bounds on their planes, and their greatest nearness.
    planes: Planes,
    most: f32,
    /// The size of the map.
    size: [f32; 2],
    /// See [`close_to`].
    close: f32,
}

impl LeafTest {
    /// For receivers in `extent` with these planes, in a map of that size.
    #[inline(always)]
    pub fn new(g: &Geometry, extent: &Extent, planes: &Planes, size: [i32; 2]) -> LeafTest {
        let spread = g.spread[0].max(g.spread[1]) * g.greatest_stretch(extent);
        LeafTest {
            u: extent.u,
            v: extent.v,
            nearness: extent.nearness[0],
            spread_squared: spread * spread,
            planes: *planes,
            most: extent.nearness[1],
            size: [size[0] as f32, size[1] as f32],
            close: close_to(g.contact, extent.nearness[1]),
        }
    }

    /// Which leaves of a group may hold blockers, in which all texels block all receivers, which
    /// are likely to hold any that block all, and which may hold blockers that are close to
    /// receivers: of leaf i, bit i. `first` is the centre of the group's first texel.
    #[inline(always)]
    fn judge(&self, first: [f32; 2], nodes: &NodeGroup) -> [u32; 4] {
        // Two answers in one number: their bits are brought together only once.
        let two = |a: bool, b: bool| u32::from(a) | u32::from(b) << LANES;
        let (mut found_covered, mut plain_close) = (0, 0);
        for i in 0..LANES {
            let (x, y) = (first[0] + CELLS[0][i], first[1] + CELLS[1][i]);
            let slope = [nodes.slope_x[i], nodes.slope_y[i]];
            let is_near = self.is_near([x, y], slope, nodes.high[i], self.u, self.v, self.nearness);
            let p = &self.planes;
            let (u, v) = (
                Chord::both(p.hu, x - p.at[0], Self::LAST[0]),
                Chord::both(p.hv, y - p.at[1], Self::LAST[1]),
            );
            // What blocks is nearer than the least nearness.
            let most =
                p.hn[1] * ((if p.hn[1] > 0.0 { nodes.high[i] } else { nodes.low[i] }) - p.nearness);
            let tilt = Self::tilt(slope.map(|slope| slope * p.hn[1]), [u[1].slope, v[1].slope]);
            let is_above = (most + (u[1].middle + v[1].middle)) + tilt > p.above[0];
            let is_inside = (x + Self::LAST[0] < self.size[0]) & (y + Self::LAST[1] < self.size[1]);
            let ends = [nodes.low[i], nodes.high[i]];
            let [least, most] = if p.hn[0] > 0.0 { ends } else { [ends[1], ends[0]] };
            let at =
                |nearness: f32| p.hn[0] * (nearness - p.nearness) + (u[0].middle + v[0].middle);
            let tilt = Self::tilt(slope.map(|slope| slope * p.hn[0]), [u[0].slope, v[0].slope]);
            let is_surely_above = at(least) - tilt > p.above[1];
            let nearer = (nodes.low[i] - Self::tilt(slope, [0.0; 2])) - self.most;
            let is_surely_nearer = nearer > 0.0;
            let is_close = (nearer <= self.close) & is_above;
            let is_plain = at(most) + tilt > p.above[1];
            // Texels of close leaves may face receivers.
            let is_covered = is_inside & is_surely_above & is_surely_nearer & !is_close;
            found_covered |= two(is_near & is_above, is_covered) << i;
            plain_close |= two(is_plain, is_close) << i;
        }
        let first = |two: u32| two & ((1 << LANES) - 1);
        let second = |two: u32| two >> LANES;
        [first(found_covered), second(found_covered), first(plain_close), second(plain_close)]
    }

    /// From the first texel of a leaf to its last.
    pub const LAST: [f32; 2] = [WIDTH as f32 - 1.0, HEIGHT as f32 - 1.0];

    /// How far the sum of two slopes leads up from a leaf's middle.
    #[inline(always)]
    pub fn tilt(slope: [f32; 2], other: [f32; 2]) -> f32 {
        let [half_x, half_y] = Self::LAST.map(|last| last * 0.5);
        (slope[0] + other[0]).abs() * half_x + (slope[1] + other[1]).abs() * half_y
    }

    /// Whether segments in the leaf with its first texel at (x, y), this slope and this upper bound
    /// in its middle may reach into the disc of a receiver at u, v with at least that nearness.
    #[inline(always)]
    pub fn is_near(
        &self,
        [x, y]: [f32; 2],
        slope: [f32; 2],
        high: f32,
        u: [f32; 2],
        v: [f32; 2],
        nearness: f32,
    ) -> bool {
        let apart = |start: f32, last: f32, [from, to]: [f32; 2]| {
            let (before, after) = (from - (start + last), start - to);
            let apart = if before > after { before } else { after };
            if apart > 0.0 { apart } else { 0.0 }
        };
        let dx = apart(x - (BEFORE + ROOM), Self::LAST[0] + (BEFORE + 1.0 + 2.0 * ROOM), u);
        let dy = apart(y - (BEFORE + ROOM), Self::LAST[1] + (BEFORE + 1.0 + 2.0 * ROOM), v);
        // A segment between this leaf's blocker and one of the next.
        let high = high + Self::tilt(slope, [0.0; 2]);
        let nearer = (high + high.abs() * SAME_LAYER) - nearness;
        (nearer > 0.0) & (dx * dx + dy * dy <= self.spread_squared * (nearer * nearer))
    }
}

/// A linear function of one coordinate, over a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chord {
    pub middle: f32,
    pub slope: f32,
}

impl Chord {
    /// What all slopes in a range rise by over `from` to `from + length` is no less than the first
    /// and no more than the second.
    #[inline(always)]
    pub fn both([least, most]: [f32; 2], from: f32, length: f32) -> [Chord; 2] {
        let range = |from: f32| {
            let (a, b) = (least * from, most * from);
            if a < b { [a, b] } else { [b, a] }
        };
        let (start, end) = (range(from), range(from + length));
        let chord = |bound: usize| Chord {
            middle: (start[bound] + end[bound]) * 0.5,
            slope: (end[bound] - start[bound]) * (1.0 / length),
        };
        [chord(0), chord(1)]
    }
}

impl Places {
    /// The places in parts that [`Leaves`] holds.
    #[inline(always)]
    pub fn parts(self) -> impl Iterator<Item = Places> {
        let cut = |[from, end]: [i32; 2], most: i32| {
            (from..end).step_by(most as usize).map(move |from| [from, (from + most).min(end)])
        };
        let rows = cut(self.rows, MOST_PLACES[1]);
        rows.flat_map(move |rows| {
            cut(self.columns, MOST_PLACES[0]).map(move |columns| Places { columns, rows })
        })
    }
}

/// The leaves that may hold blockers, and with them the places that may hold an outline.
pub(crate) struct Leaves {
    /// The first leaf, as column and row of leaves; negative outside the map.
    first: [i32; 2],
    /// Bit x of row y: whether places of that leaf may hold an outline.
    rows: [u64; SIDE],
    /// The same for leaves that surely hold nothing but blockers.
    covered: [u64; SIDE],
    /// The same for leaves that are likely to hold what blocks all receivers.
    plain: [u64; SIDE],
    /// The same for leaves that touch texels that may be close to receivers.
    close: [u64; SIDE],
    count: usize,
}

impl Leaves {
    pub const fn new() -> Leaves {
        Leaves {
            first: [0; 2],
            rows: [0; SIDE],
            covered: [0; SIDE],
            plain: [0; SIDE],
            close: [0; SIDE],
            count: 0,
        }
    }

    /// Finds the leaves of `places`, no more than [`MOST_PLACES`], that may hold blockers of some
    /// of the receivers, given all at once and maybe in parts; false if there are none.
    #[inline(always)]
    pub fn find(&mut self, pyramid: &Pyramid<'_>, test: &LeafTest, places: Places) -> bool {
        // Places of a leaf touch the texels of the next leaf, too.
        let groups = |[from, end]: [i32; 2], size: i32| {
            from.div_euclid(size * GROUP)..=end.div_euclid(size * GROUP)
        };
        let (columns, rows) = (groups(places.columns, WIDTH), groups(places.rows, HEIGHT));
        self.first = [columns.start() * GROUP, rows.start() * GROUP];
        self.count = 0;
        let mut any = 0;
        for y in rows {
            let mut found = [[0_u64; 4]; GROUP as usize];
            for x in columns.clone() {
                let Some(nodes) =
                    (x >= 0 && y >= 0).then(|| pyramid.leaves(x as u32, y as u32)).flatten()
                else {
                    continue;
                };
                let first = [x * GROUP * WIDTH, y * GROUP * HEIGHT].map(|at| at as f32 + 0.5);
                let leaves = test.judge(first, nodes);
                let shift = x * GROUP - self.first[0];
                for (row, found) in found.iter_mut().enumerate() {
                    for (found, leaves) in found.iter_mut().zip(leaves) {
                        *found |= u64::from(leaves >> (row as i32 * GROUP) & 0xf) << shift;
                    }
                }
            }
            for [found, covered, plain, close] in found {
                any |= found;
                self.rows[self.count] = found;
                self.covered[self.count] = covered;
                self.plain[self.count] = plain;
                self.close[self.count] = close;
                self.count += 1;
            }
        }
        // Places of a leaf touch the texels of three others.
        for y in 0..self.count {
            let below = |rows: &[u64; SIDE]| if y + 1 == self.count { 0 } else { rows[y + 1] };
            let any = self.rows[y] | below(&self.rows);
            let all = self.covered[y] & below(&self.covered);
            let plain = self.plain[y] | below(&self.plain);
            let close = self.close[y] | below(&self.close);
            self.rows[y] = (any | any >> 1) & !(all & all >> 1);
            self.plain[y] = plain | plain >> 1;
            self.close[y] = close | close >> 1;
        }
        any != 0
    }

    /// Takes out the leaves whose places hardly hold what looks the same to all receivers. Gives
    /// `visit` the first texel of each of their cells in `places`.
    #[inline(always)]
    pub fn take_contested(&mut self, places: &Places, mut visit: impl FnMut([i32; 2])) {
        for y in 0..self.count {
            let mut contested = self.rows[y] & !self.plain[y];
            self.rows[y] &= self.plain[y];
            let top = (self.first[1] + y as i32) * HEIGHT;
            while contested != 0 {
                let left = (self.first[0] + contested.trailing_zeros() as i32) * WIDTH;
                contested &= contested - 1;
                for x in (left..left + WIDTH).step_by(CELL) {
                    if places.hold([x, top]) {
                        visit([x, top]);
                    }
                }
            }
        }
    }

    /// Whether a block with its first texel at (x, y) may hold texels that are close to receivers.
    #[inline(always)]
    pub fn are_close(&self, [x, y]: [i32; 2]) -> bool {
        let column = x.div_euclid(WIDTH) - self.first[0];
        let row = (y.div_euclid(HEIGHT) - self.first[1]) as usize;
        self.close[row] >> column & 1 == 1
    }

    /// Boxes that hold all of `places` where there may be an outline, each at most `most` columns
    /// wide and a leaf high.
    #[inline(always)]
    pub fn boxes(&self, places: Places, most: i32) -> Boxes<'_> {
        Boxes { leaves: self, places, most, next_row: 0, row: 0, columns: [0; 2], rows: [0; 2] }
    }
}

/// See [`Leaves::boxes`].
pub(crate) struct Boxes<'a> {
    leaves: &'a Leaves,
    places: Places,
    most: i32,
    next_row: usize,
    /// What is left of the present row of leaves, and of the present run of leaves in it.
    row: u64,
    columns: [i32; 2],
    rows: [i32; 2],
}

impl Iterator for Boxes<'_> {
    type Item = Places;

    #[inline(always)]
    fn next(&mut self) -> Option<Places> {
        let clip =
            |[from, end]: [i32; 2], [least, most]: [i32; 2]| [from.max(least), end.min(most)];
        let [left, top] = self.leaves.first;
        loop {
            let [x, right] = self.columns;
            if x < right {
                let end = (x + self.most).min(right);
                self.columns[0] = end;
                return Some(Places { columns: [x, end], rows: self.rows });
            }
            if self.row != 0 {
                let start = self.row.trailing_zeros();
                let run = (!(self.row >> start)).trailing_zeros();
                self.row &= !(u64::MAX >> (64 - run) << start);
                let x = (left + start as i32) * WIDTH;
                self.columns = clip([x, x + run as i32 * WIDTH], self.places.columns);
            } else if self.next_row < self.leaves.count {
                let y = (top + self.next_row as i32) * HEIGHT;
                self.rows = clip([y, y + HEIGHT], self.places.rows);
                let is_empty = self.rows[0] >= self.rows[1];
                self.row = if is_empty { 0 } else { self.leaves.rows[self.next_row] };
                self.next_row += 1;
            } else {
                return None;
            }
        }
    }
}

/// Finds whether some leaf may hold blockers.
pub(crate) struct FindBlockers<'a> {
    pub pyramid: &'a Pyramid<'a>,
    pub test: LeafTest,
    pub places: Places,
    pub found: &'a mut bool,
}

impl Work for FindBlockers<'_> {
    #[inline(always)]
    fn run(self, _: &impl Ops) {
        let mut leaves = Leaves::new();
        for part in self.places.parts() {
            *self.found |= leaves.find(self.pyramid, &self.test, part);
        }
    }
}
