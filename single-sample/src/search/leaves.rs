//! Which parts of the map may hold blockers, by the bounds in the pyramid's leaves.

use simd_search::{NodeGroup, Pyramid};

use super::cell::{CELL, SAME_LAYER};
use super::geometry::Geometry;
use super::kernels::{Ops, Work};
use super::outline::Places;
use super::planes::Plane;
use super::reach::Extent;

const WIDTH: i32 = Pyramid::LEAF[0] as i32;
const HEIGHT: i32 = Pyramid::LEAF[1] as i32;
const GROUP: i32 = Pyramid::GROUP as i32;
const LANES: usize = (GROUP * GROUP) as usize;

/// Leaves along each side of [`Leaves`], at most.
const SIDE: usize = 64;
/// Columns and rows of places that surely fit.
const MOST_PLACES: [i32; 2] =
    [(SIDE as i32 - 2 * GROUP) * WIDTH, (SIDE as i32 - 2 * GROUP) * HEIGHT];

/// Column and row of each leaf in its group, in texels.
const CELLS: [[f32; LANES]; 2] = {
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

/// How far segments may run before the leaves that all of their blockers are in. Those lie along the
/// far sides of a cell, and segments that cut its corner are no longer than half of a side each way,
/// or else stray too far from a straight connection.
const BEFORE: f32 = CELL as f32 * 0.5;

/// What receivers ask of a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeafTest {
    /// Where they are, with room for rounding.
    u: [f32; 2],
    v: [f32; 2],
    /// Their least nearness, and the square of their disc's greatest radius per nearness above it.
    nearness: f32,
    spread_squared: f32,
    /// A plane below all of theirs: nearness at texel coordinates (0, 0), and slopes.
    plane: f32,
    slope: [f32; 2],
    /// A plane above all of theirs, with the same slopes, and their greatest nearness.
    above: f32,
    most: f32,
    /// The size of the map.
    size: [f32; 2],
}

impl LeafTest {
    /// For receivers in `extent`, whose planes lie between two of the same slope wherever they look,
    /// in a map of that size. If the planes are not finite, they count for nothing.
    #[inline(always)]
    pub fn new(
        g: &Geometry,
        extent: &Extent,
        [low, high]: &[Plane; 2],
        size: [i32; 2],
    ) -> LeafTest {
        let spread = g.spread[0].max(g.spread[1]) * g.greatest_stretch(extent);
        let Plane { origin, slope } = *low;
        let all = (slope[0].abs() + slope[1].abs()) + (origin.abs() + high.origin.abs());
        let is_usable = all < 1e9;
        LeafTest {
            u: [extent.u[0] - ROOM, extent.u[1] + ROOM],
            v: [extent.v[0] - ROOM, extent.v[1] + ROOM],
            nearness: extent.nearness[0],
            spread_squared: spread * spread,
            plane: if is_usable { origin } else { f32::NEG_INFINITY },
            slope: if is_usable { slope } else { [0.0; 2] },
            above: if is_usable { high.origin } else { f32::INFINITY },
            most: extent.nearness[1],
            size: [size[0] as f32, size[1] as f32],
        }
    }

    /// Which leaves of a group may hold blockers, and in which all texels block all receivers: of
    /// leaf i, bit i. `first` is the centre of the group's first texel.
    #[inline(always)]
    fn judge(&self, first: [f32; 2], nodes: &NodeGroup) -> [u32; 2] {
        let (last, half) = ([15.0, 7.0], [7.5, 3.5]);
        let (mut found, mut covered) = (0, 0);
        for i in 0..LANES {
            let (x, y) = (first[0] + CELLS[0][i], first[1] + CELLS[1][i]);
            let apart = |start: f32, last: f32, [from, to]: [f32; 2]| {
                let (before, after) = (from - (start + last), start - to);
                let apart = if before > after { before } else { after };
                if apart > 0.0 { apart } else { 0.0 }
            };
            let (dx, dy) = (
                apart(x - BEFORE, last[0] + (BEFORE + 1.0), self.u),
                apart(y - BEFORE, last[1] + (BEFORE + 1.0), self.v),
            );
            let (slope_x, slope_y) = (nodes.slope_x[i], nodes.slope_y[i]);
            let steep = slope_x.abs() * half[0] + slope_y.abs() * half[1];
            // A segment between this leaf's blocker and one of the next.
            let high = nodes.high[i] + steep;
            let nearer = (high + high.abs() * SAME_LAYER) - self.nearness;
            let is_near =
                (nearer > 0.0) & (dx * dx + dy * dy <= self.spread_squared * (nearer * nearer));
            let at_center =
                self.plane + (self.slope[0] * (x + half[0]) + self.slope[1] * (y + half[1]));
            let spread = (slope_x - self.slope[0]).abs() * half[0]
                + (slope_y - self.slope[1]).abs() * half[1];
            let is_above = nodes.high[i] + spread > at_center;
            found |= u32::from(is_near & is_above) << i;
            let is_inside = (x + last[0] < self.size[0]) & (y + last[1] < self.size[1]);
            let is_surely_above = nodes.low[i] - spread > at_center + (self.above - self.plane);
            let is_surely_nearer = nodes.low[i] - steep > self.most;
            covered |= u32::from(is_inside & is_surely_above & is_surely_nearer) << i;
        }
        [found, covered]
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
    count: usize,
}

impl Leaves {
    pub const fn new() -> Leaves {
        Leaves { first: [0; 2], rows: [0; SIDE], covered: [0; SIDE], count: 0 }
    }

    /// Finds the leaves of `places`, no more than [`MOST_PLACES`]; false if there are none.
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
            let (mut found, mut covered) = ([0_u64; GROUP as usize], [0_u64; GROUP as usize]);
            for x in columns.clone() {
                let Some(nodes) =
                    (x >= 0 && y >= 0).then(|| pyramid.leaves(x as u32, y as u32)).flatten()
                else {
                    continue;
                };
                let first = [x * GROUP * WIDTH, y * GROUP * HEIGHT].map(|at| at as f32 + 0.5);
                let leaves = test.judge(first, nodes);
                let shift = x * GROUP - self.first[0];
                for row in 0..GROUP as usize {
                    let part =
                        |leaves: u32| u64::from(leaves >> (row as i32 * GROUP) & 0xf) << shift;
                    found[row] |= part(leaves[0]);
                    covered[row] |= part(leaves[1]);
                }
            }
            for (found, covered) in found.into_iter().zip(covered) {
                any |= found;
                self.rows[self.count] = found;
                self.covered[self.count] = covered;
                self.count += 1;
            }
        }
        // Places of a leaf touch the texels of three others.
        for y in 0..self.count {
            let is_last = y + 1 == self.count;
            let below = if is_last { [0; 2] } else { [self.rows[y + 1], self.covered[y + 1]] };
            let (any, all) = (self.rows[y] | below[0], self.covered[y] & below[1]);
            self.rows[y] = (any | any >> 1) & !(all & all >> 1);
        }
        any != 0
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
