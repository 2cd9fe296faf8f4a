//! One search under way: what is asked of the texels, and the best answer so far.

use core::ops::Range;

use shadowmap_core::LightPoint;

use crate::descend::Descent;
use crate::kernels::Ops;
use crate::map::{COLUMNS, ROWS};
use crate::naive::reach;
use crate::pyramid::{LEAF_HEIGHT, LEAF_WIDTH, NodeGroup};
use crate::reach::{Cone, GroupTest, Reach};
use crate::walk::{EXACT_EXTENT, Group};
use crate::{Hit, IdTest, Key, Map, Pyramid, Query, Side};

/// What the tile kernels ask of 16 x 8 texels.
#[derive(Clone, Copy)]
pub(crate) struct TileTest {
    /// Centre of the first column.
    pub first: f32,
    /// The receiver and its plane, and by how much that must be exceeded.
    pub u: f32,
    pub v: f32,
    pub nearness: f32,
    pub slope: [f32; 2],
    pub offset: f32,
    /// Greatest squared distance that is of use.
    pub reach_squared: f32,
    /// For [`Key::Ratio`], the greatest key that is of use.
    pub ratio: Option<f32>,
    /// Look for texels that do not block.
    pub lit: bool,
    /// For each row, what the receiver's plane gains down the map, and the squared distance.
    pub rise: [f32; ROWS],
    pub dy_squared: [f32; ROWS],
}

impl TileTest {
    /// The test from one receiver, to be placed at a tile.
    #[inline(always)]
    pub fn new(point: &LightPoint, offset: f32, radius: f32, side: Side) -> TileTest {
        TileTest {
            first: 0.0,
            u: point.u,
            v: point.v,
            nearness: point.nearness,
            slope: point.slope.to_array(),
            offset,
            reach_squared: radius * radius,
            ratio: None,
            lit: side == Side::Lit,
            rise: [0.0; ROWS],
            dy_squared: [0.0; ROWS],
        }
    }

    /// Places the test at columns from `x` on.
    #[inline(always)]
    fn place_columns(&mut self, x: u32) {
        self.first = x as f32 + 0.5;
    }

    /// Places the test at rows from `y` on, the same for all tiles side by side.
    #[inline(always)]
    fn place_rows(&mut self, y: u32) {
        let top = y as f32 + 0.5;
        for row in 0..ROWS {
            let dy = (top + row as f32) - self.v;
            self.rise[row] = self.slope[1] * dy;
            self.dy_squared[row] = dy * dy;
        }
    }
}

/// Kernels do not divide: they pass over texels with `distance² > ratio * nearer²`, with the ratio
/// times this, so that rounding makes them miss none.
pub(crate) const RATIO_ROOM: f32 = 1.0 + 1.0 / 1048576.0;

/// Where a search stands. The texels asked next must beat it.
pub(crate) struct Search<'a> {
    pub map: Map<'a>,
    pub query: &'a Query,
    pub best: Option<Hit>,
    /// Nothing with a greater key is of use.
    pub key: f32,
    pub test: TileTest,
    by_tiles: bool,
}

impl<'a> Search<'a> {
    /// A search that has asked no texel but the hint.
    #[inline(always)]
    pub fn new(map: Map<'a>, query: &'a Query, hint: Option<[u32; 2]>) -> Self {
        let mut search = Search {
            map,
            query,
            best: None,
            key: f32::INFINITY,
            test: TileTest::new(&query.point, query.offset, query.radius, query.side),
            by_tiles: Search::is_tiled(&map) && query.jitter_amplitude() == 0.0,
        };
        if let Key::Ratio { at_most } = query.key {
            search.limit(at_most);
        }
        if let Some([x, y]) = hint
            && x < map.width()
            && y < map.height()
        {
            search.ask(x, y);
        }
        search
    }

    /// Whether a map can be asked in tiles: one that holds any, and whose texels' centres are
    /// exact, for else lanes would round differently.
    #[inline(always)]
    pub fn is_tiled(map: &Map<'_>) -> bool {
        (COLUMNS as u32..EXACT_EXTENT).contains(&map.width())
            && (ROWS as u32..EXACT_EXTENT).contains(&map.height())
    }

    /// Asks one texel. True if it is the best so far.
    #[inline(always)]
    pub fn ask(&mut self, x: u32, y: u32) -> bool {
        let Some(hit) = self.query.candidate(&self.map, x, y) else { return false };
        if self.best.is_some_and(|best| !hit.precedes(&best)) {
            return false;
        }
        self.best = Some(hit);
        self.limit(hit.key);
        true
    }

    /// From now on keys beyond this are of no use.
    #[inline(always)]
    fn limit(&mut self, key: f32) {
        self.key = key;
        match self.query.key {
            Key::Distance => self.test.reach_squared = key,
            Key::Ratio { .. } => self.test.ratio = Some(key),
        }
    }

    /// The columns that can still hold the answer in rows at least `dy` away.
    #[inline(always)]
    fn columns(&self, dy: f32) -> Range<u32> {
        let dy = (dy - self.query.jitter_amplitude()).max(0.0);
        // Room for rounding, here and in the texels' own distance.
        let room = self.test.reach_squared * (1.0 / 1048576.0);
        let left = (self.test.reach_squared - dy * dy) + room;
        if left < 0.0 {
            return 0..0;
        }
        let radius = sqrt(left) + self.query.jitter_amplitude();
        reach(self.query.point.u, radius, self.map.width())
    }

    /// The test of nodes.
    #[inline(always)]
    pub fn group_test(&self, pyramid: &Pyramid<'_>) -> GroupTest {
        let Query { point, offset, radius, .. } = *self.query;
        let mut reach = Reach::of(point, offset, radius);
        if let Key::Ratio { .. } = self.query.key {
            reach.cone = Some(Cone { nearness: point.nearness, at_most: self.key });
        }
        GroupTest::new(&reach, &pyramid.layout, self.query.jitter_amplitude())
    }

    /// Asks the texels of the tile that starts at (x, y), or one further left or up where that
    /// does not fit into the map.
    #[inline(always)]
    pub fn ask_tile(&mut self, ops: &impl Ops, x: u32, y: u32) {
        if !self.by_tiles {
            return self.ask_one_by_one(x, y);
        }
        let y = y.min(self.map.height() - ROWS as u32);
        self.test.place_rows(y);
        self.ask_in_rows(ops, x, y);
    }

    /// [`Search::ask_tile`] where the test is placed at its rows.
    #[inline(always)]
    fn ask_in_rows(&mut self, ops: &impl Ops, x: u32, y: u32) {
        let x = x.min(self.map.width() - COLUMNS as u32);
        self.test.place_columns(x);
        let mut all = u128::MAX;
        loop {
            // Again whenever the bound has changed, so that few texels are asked in vain.
            let mut found = all & self.map.with_tile(x, y, |rows| ops.tile(&self.test, rows));
            let mut better = false;
            while found != 0 && !better {
                let row = found.trailing_zeros() / COLUMNS as u32;
                let shift = row * COLUMNS as u32;
                let mut columns =
                    (found >> shift) as u16 & passing(ops, &self.map, self.query.ids, x, y + row);
                found &= !(0xffff << shift);
                all = found;
                while columns != 0 {
                    better |= self.ask(x + columns.trailing_zeros(), y + row);
                    columns &= columns - 1;
                }
            }
            if found == 0 {
                return;
            }
        }
    }

    #[inline(always)]
    fn ask_one_by_one(&mut self, x: u32, y: u32) {
        for y in y..y.saturating_add(ROWS as u32).min(self.map.height()) {
            for x in x..x.saturating_add(COLUMNS as u32).min(self.map.width()) {
                self.ask(x, y);
            }
        }
    }

    /// Asks every texel that can hold the answer, the nearest rows first.
    #[inline(always)]
    pub fn ask_box(&mut self, ops: &impl Ops) {
        let [mut columns, mut rows] = self.window();
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        // This cast saturates.
        let middle = (self.query.point.v as u32).clamp(rows.start, rows.end - 1);
        let mut below = middle.saturating_sub(ROWS as u32 / 2).max(rows.start);
        let mut above = below;
        let mut downwards = false;
        while above > rows.start || below < rows.end {
            let before = self.test.reach_squared;
            downwards = if downwards { above <= rows.start } else { below < rows.end };
            let y = if downwards { below } else { above.saturating_sub(ROWS as u32) };
            self.ask_rows(ops, &columns, y);
            if downwards {
                below = y.saturating_add(ROWS as u32);
            } else {
                above = y;
            }
            if self.test.reach_squared < before {
                [columns, rows] = self.window();
            }
        }
    }

    /// Asks the texels of as many rows as a tile has, as far as they can hold the answer.
    #[inline(always)]
    fn ask_rows(&mut self, ops: &impl Ops, columns: &Range<u32>, y: u32) {
        let mut columns = columns.clone();
        if columns.len() > 3 * COLUMNS {
            // The corners of the box are out of reach.
            let (first, last) = (y as f32 + 0.5, y as f32 + (ROWS as f32 - 0.5));
            let v = self.query.point.v;
            columns = self.columns((first - v).max(v - last));
        }
        if !self.by_tiles {
            for x in columns.step_by(COLUMNS) {
                self.ask_one_by_one(x, y);
            }
            return;
        }
        let y = y.min(self.map.height() - ROWS as u32);
        self.test.place_rows(y);
        for x in columns.step_by(COLUMNS) {
            self.ask_in_rows(ops, x, y);
        }
    }
}

/// The texels of a tile's row that pass an ID test.
#[inline(always)]
pub(crate) fn passing(ops: &impl Ops, map: &Map<'_>, ids: IdTest, x: u32, y: u32) -> u16 {
    let equal = |id| ops.equal(&map.row_of_ids(x, y), id & map.id_mask()) as u16;
    match ids {
        IdTest::Any => 0xffff,
        IdTest::Differs(id) => !equal(id),
        IdTest::Equals(id) => equal(id),
    }
}

impl Descent for Search<'_> {
    #[inline(always)]
    fn side(&self) -> Side {
        self.query.side
    }

    #[inline(always)]
    fn ids(&self) -> IdTest {
        self.query.ids
    }

    #[inline(always)]
    fn window(&self) -> [Range<u32>; 2] {
        let radius = sqrt(self.test.reach_squared) + self.query.jitter_amplitude();
        [
            reach(self.query.point.u, radius, self.map.width()),
            reach(self.query.point.v, radius, self.map.height()),
        ]
    }

    #[inline(always)]
    fn narrow(&self, test: &mut GroupTest) {
        test.reach_squared = self.test.reach_squared;
        if let Some(cone) = &mut test.cone {
            cone.at_most = self.key;
        }
    }

    #[inline(always)]
    fn bound(&self) -> f32 {
        match self.query.key {
            Key::Distance => self.test.reach_squared,
            Key::Ratio { .. } => self.key,
        }
    }

    #[inline(always)]
    fn concerned(&mut self, _: &impl Ops, _: &Group, _: &NodeGroup, _: u32, among: u64) -> u64 {
        among
    }

    #[inline(always)]
    fn leaf(&mut self, ops: &impl Ops, group: &Group, _: &NodeGroup, lane: u32, _: u64) {
        let [x, y] = group.node(lane);
        self.ask_tile(ops, x * LEAF_WIDTH, y * LEAF_HEIGHT);
    }
}

/// A number not below the square root of `x` by more than rounding, nor above by more than 1/800:
/// half of the exponent, then one step of Newton's method, which always ends above the root.
#[inline(always)]
pub(crate) fn sqrt(x: f32) -> f32 {
    let estimate = f32::from_bits((x.to_bits() >> 1) + 0x1fbd_1df5);
    0.5 * (estimate + x / estimate)
}
