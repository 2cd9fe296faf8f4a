//! One search under way: what is asked of each texel, and the best answer so far.

use core::ops::Range;

use crate::kernels::Ops;
use crate::map::WINDOW;
use crate::naive::reach;
use crate::{Hit, IdTest, Key, Map, Query, Side};

/// What the window kernels ask of the 16 texels from `first` on.
#[derive(Clone, Copy)]
pub(crate) struct WindowTest {
    /// Centre of the first texel along the row.
    pub first: f32,
    /// The receiver's place along the row, nearness, slope along the row, and offset.
    pub u: f32,
    pub nearness: f32,
    pub slope: f32,
    pub offset: f32,
    /// The row's squared distance, and what the slope down the map adds on this row.
    pub dy_squared: f32,
    pub rise: f32,
    /// Greatest squared distance that is of use.
    pub reach_squared: f32,
    /// For [`Key::Ratio`], the greatest key that is of use (rounded up).
    pub ratio: Option<f32>,
    /// All ones to find texels that do not block.
    pub flip: u32,
}

/// Where a search stands. The texels asked next must beat it.
pub(crate) struct Search<'a> {
    pub map: Map<'a>,
    pub query: &'a Query,
    pub best: Option<Hit>,
    /// Nothing at a greater squared distance is of use.
    pub reach_squared: f32,
    /// Nothing with a greater key is of use.
    pub key: f32,
    by_windows: bool,
}

impl<'a> Search<'a> {
    /// A search that has asked no texel but the hint.
    #[inline(always)]
    pub fn new(map: Map<'a>, query: &'a Query) -> Self {
        let at_most = match query.key {
            Key::Distance => f32::INFINITY,
            Key::Ratio { at_most } => at_most,
        };
        let mut search = Search {
            map,
            query,
            best: None,
            reach_squared: query.radius * query.radius,
            key: at_most,
            // Beyond 2^22 a texel's centre is no longer exact, so lanes would round differently.
            by_windows: map.width() >= WINDOW as u32
                && map.width() < 1 << 22
                && query.jitter_amplitude() == 0.0,
        };
        if let Some([x, y]) = query.hint
            && x < map.width()
            && y < map.height()
        {
            search.ask(x, y);
        }
        search
    }

    /// Asks one texel.
    #[inline(always)]
    pub fn ask(&mut self, x: u32, y: u32) {
        if let Some(hit) = self.query.candidate(&self.map, x, y)
            && self.best.is_none_or(|best| hit.precedes(&best))
        {
            self.best = Some(hit);
            self.key = hit.key;
            if self.query.key == Key::Distance {
                self.reach_squared = hit.distance_squared;
            }
        }
    }

    /// The columns and rows that can still hold the answer.
    #[inline(always)]
    pub fn window(&self) -> [Range<u32>; 2] {
        let radius = sqrt(self.reach_squared);
        [
            reach(self.query.point.u, radius, self.map.width()),
            reach(self.query.point.v, radius, self.map.height()),
        ]
    }

    /// Asks all texels of a row from `columns.start` to `columns.end` at least.
    #[inline(always)]
    pub fn ask_row(&mut self, ops: &impl Ops, columns: Range<u32>, y: u32) {
        if !self.by_windows {
            return columns.for_each(|x| self.ask(x, y));
        }
        let point = self.query.point;
        let dy = (y as f32 + 0.5) - point.v;
        let mut test = WindowTest {
            first: 0.0,
            u: point.u,
            nearness: point.nearness,
            slope: point.slope.x,
            offset: self.query.offset,
            dy_squared: dy * dy,
            rise: point.slope.y * dy,
            reach_squared: self.reach_squared,
            ratio: self.ratio(),
            flip: if self.query.side == Side::Blocker { 0 } else { 0xffff },
        };
        if test.dy_squared > self.reach_squared {
            return;
        }
        let last = self.map.width() - WINDOW as u32;
        let mut x = columns.start;
        while x < columns.end {
            let start = x.min(last);
            test.first = start as f32 + 0.5;
            let texels = self.map.nearness_window(start, y);
            let mut found = ops.window(&test, &texels);
            if found != 0 {
                found &= self.ids(ops, start, y);
                while found != 0 {
                    self.ask(start + found.trailing_zeros(), y);
                    found &= found - 1;
                }
                test.reach_squared = self.reach_squared;
                test.ratio = self.ratio();
            }
            x += WINDOW as u32;
        }
    }

    /// The window's texels that pass the ID test.
    #[inline(always)]
    fn ids(&self, ops: &impl Ops, x: u32, y: u32) -> u32 {
        let equal = |id| ops.equal(&self.map.id_window(x, y), id & self.map.id_mask());
        match self.query.ids {
            IdTest::Any => 0xffff,
            IdTest::Differs(id) => !equal(id),
            IdTest::Equals(id) => equal(id),
        }
    }

    /// The greatest key of use, rounded up so that no texel is missed by a kernel, which passes over
    /// those with `distance² > key * nearer²` instead of dividing.
    #[inline(always)]
    fn ratio(&self) -> Option<f32> {
        match self.query.key {
            Key::Distance => None,
            Key::Ratio { .. } => Some(self.key * (1.0 + 1.0 / 1048576.0)),
        }
    }

    /// Asks every texel that can hold the answer, the nearest rows first.
    #[inline(always)]
    pub fn ask_box(&mut self, ops: &impl Ops) {
        let [mut columns, rows] = self.window();
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        // This cast saturates.
        let middle = (self.query.point.v as u32).clamp(rows.start, rows.end - 1);
        let (mut above, mut below) = (middle, middle);
        while above > rows.start || below < rows.end {
            let reach_before = self.reach_squared;
            if below < rows.end {
                self.ask_row(ops, columns.clone(), below);
                below += 1;
            }
            if above > rows.start {
                above -= 1;
                self.ask_row(ops, columns.clone(), above);
            }
            if self.reach_squared < reach_before {
                let [fewer_columns, fewer_rows] = self.window();
                columns = fewer_columns;
                below = if below < fewer_rows.end { below } else { rows.end };
                above = if above > fewer_rows.start { above } else { rows.start };
            }
        }
    }
}

/// A number not below the square root of `x` by more than rounding, nor above by more than 1/800:
/// half of the exponent, then one step of Newton's method, which always ends above the root.
#[inline(always)]
fn sqrt(x: f32) -> f32 {
    let estimate = f32::from_bits((x.to_bits() >> 1) + 0x1fbd_1df5);
    0.5 * (estimate + x / estimate)
}
