//! Places that look different to some receivers of a group.
//!
//! Each receiver finds its own outline there. But by the bounds on the texels in the leaves of the
//! pyramid, most are soon told to hold nothing that blocks it: on a curved surface each receiver's
//! own surroundings lie below its plane.

use simd_search::Pyramid;

use super::cell::CELL;
use super::facing::close_to;
use super::planes::ROUNDING;
use super::receiver::{Receiver, Seen};
use super::segments::LANES;

/// The most leaves there may be. Few in tests, for some outlines to be too long.
const CAPACITY: usize = if cfg!(test) { 32 } else { 1024 };

const WIDTH: i32 = Pyramid::LEAF[0] as i32;
const HEIGHT: i32 = Pyramid::LEAF[1] as i32;
const GROUP: i32 = Pyramid::GROUP as i32;

/// Cells of a leaf, which is one cell high.
const CELLS: i32 = WIDTH / CELL as i32;

/// From the middle of a leaf's places to their last texels.
const HALF: [f32; 2] = [WIDTH as f32 * 0.5, HEIGHT as f32 * 0.5];

/// A list of leaves of the pyramid, each with the texels that its places touch.
pub(crate) struct Disputed {
    /// The first texel of each.
    at: [[i32; 2]; CAPACITY],
    /// Which cells are disputed: of cell i, bit i.
    cells: [u8; CAPACITY],
    /// Middle of its places, in texels.
    x: [f32; CAPACITY],
    y: [f32; CAPACITY],
    /// All texels have a nearness from `low` to `high` in the middle, plus these slopes times their
    /// distance from it.
    low: [f32; CAPACITY],
    high: [f32; CAPACITY],
    slope_x: [f32; CAPACITY],
    slope_y: [f32; CAPACITY],
    len: usize,
}

/// Bounds on the texels of a leaf, around its middle.
#[derive(Clone, Copy)]
struct Node {
    slope: [f32; 2],
    low: f32,
    high: f32,
}

impl Node {
    /// The leaf in this column and row of leaves; `None` outside the map.
    #[inline(always)]
    fn of(pyramid: &Pyramid<'_>, [x, y]: [i32; 2]) -> Option<Node> {
        let [column, row] = [x, y].map(|at| u32::try_from(at).ok());
        let nodes = pyramid.leaves(column? / GROUP as u32, row? / GROUP as u32)?;
        let i = (y % GROUP * GROUP + x % GROUP) as usize;
        let slope = [nodes.slope_x[i], nodes.slope_y[i]];
        Some(Node { slope, low: nodes.low[i], high: nodes.high[i] })
    }
}

impl Disputed {
    pub const fn new() -> Disputed {
        let zero = [0.0; CAPACITY];
        Disputed {
            at: [[0; 2]; CAPACITY],
            cells: [0; CAPACITY],
            x: zero,
            y: zero,
            low: zero,
            high: zero,
            slope_x: zero,
            slope_y: zero,
            len: 0,
        }
    }

    /// Forgets all leaves but the first `len`.
    pub fn truncate(&mut self, len: usize) {
        self.len = len;
    }

    /// Whether so many more leaves fit, and those that fill up the last group of lanes.
    pub fn has_room(&self, leaves: usize) -> bool {
        self.len + leaves <= CAPACITY
    }

    pub fn len(&self) -> usize {
        self.len
    }

    /// Adds the cell whose first texel is `at`, after those of the same leaf if there are any since
    /// leaf `start`. There must be room.
    #[inline(always)]
    pub fn push(&mut self, pyramid: &Pyramid<'_>, [x, y]: [i32; 2], start: usize) {
        let leaf = [x.div_euclid(WIDTH), y.div_euclid(HEIGHT)];
        let first = [leaf[0] * WIDTH, leaf[1] * HEIGHT];
        let is_known = self.len > start && self.at[self.len - 1] == first;
        if !is_known {
            self.push_leaf(pyramid, leaf);
        }
        self.cells[self.len - 1] |= 1 << ((x - first[0]) / CELL as i32);
    }

    /// Adds a leaf without cells.
    #[inline(always)]
    fn push_leaf(&mut self, pyramid: &Pyramid<'_>, [column, row]: [i32; 2]) {
        let node = |x: i32, y: i32| Node::of(pyramid, [column + x, row + y]);
        let [half_x, half_y] = HALF;
        let (mut slope, mut low, mut high) = ([0.0; 2], f32::INFINITY, f32::NEG_INFINITY);
        if let Some(node) = node(0, 0) {
            slope = node.slope;
            let middle = 0.5 * (slope[0] + slope[1]);
            (low, high) = (node.low + middle, node.high + middle);
        }
        // Of the next leaves the first column, row, and texel: up to two texels of each, `inner`
        // from its own middle and `outer` from the middle of the places.
        let mut include = |node: Option<Node>, inner: [[f32; 2]; 2], outer: [[f32; 2]; 2]| {
            let Some(node) = node else { return };
            for ([x, y], [s, t]) in inner.into_iter().zip(outer) {
                let rise = (node.slope[0] * x + node.slope[1] * y) - (slope[0] * s + slope[1] * t);
                low = low.min(node.low + rise);
                high = high.max(node.high + rise);
            }
        };
        let (left, upper) = (0.5 - half_x, 0.5 - half_y);
        include(
            node(1, 0),
            [[left, upper], [left, -upper]],
            [[half_x, -half_y], [half_x, half_y - 1.0]],
        );
        include(
            node(0, 1),
            [[left, upper], [-left, upper]],
            [[-half_x, half_y], [half_x - 1.0, half_y]],
        );
        include(node(1, 1), [[left, upper]; 2], [HALF; 2]);
        let i = self.len;
        let at = [column * WIDTH, row * HEIGHT];
        self.at[i] = at;
        self.cells[i] = 0;
        self.x[i] = (at[0] as f32 + 0.5) + half_x;
        self.y[i] = (at[1] as f32 + 0.5) + half_y;
        [self.slope_x[i], self.slope_y[i]] = slope;
        let room = half_x * slope[0].abs() + half_y * slope[1].abs();
        self.low[i] = low - (low.abs() + room) * ROUNDING;
        self.high[i] = high + (high.abs() + room) * ROUNDING;
        self.len += 1;
    }

    /// Fills up the last group of lanes with what blocks nobody. Returns the number of groups.
    #[inline(always)]
    pub fn pad(&mut self) -> usize {
        while !self.len.is_multiple_of(LANES) {
            self.high[self.len] = f32::NEG_INFINITY;
            self.slope_x[self.len] = 0.0;
            self.slope_y[self.len] = 0.0;
            self.len += 1;
        }
        self.len / LANES
    }

    /// The first texels of a leaf's disputed cells.
    #[inline(always)]
    pub fn cells(&self, i: usize) -> impl Iterator<Item = [i32; 2]> {
        let ([x, y], cells) = (self.at[i], self.cells[i]);
        (0..CELLS)
            .filter(move |cell| cells >> cell & 1 == 1)
            .map(move |cell| [x + cell * CELL as i32, y])
    }

    /// In which leaves of a group of lanes something may block a receiver, and in which something
    /// may be so close to it that it is no more than `contact` nearer: of leaf i, bit i.
    #[inline(always)]
    pub fn blocking(&self, group: usize, r: &Receiver, seen: &Seen, contact: f32) -> [u32; 2] {
        let lanes = |values: &'_ [f32; CAPACITY]| -> [f32; LANES] { values.as_chunks().0[group] };
        let (x, y, low, high) =
            (lanes(&self.x), lanes(&self.y), lanes(&self.low), lanes(&self.high));
        let (slope_x, slope_y) = (lanes(&self.slope_x), lanes(&self.slope_y));
        let most = close_to(contact, r.nearness);
        let (mut found, mut close) = (0, 0);
        for i in 0..LANES {
            let apart = |from: f32, to: f32, half: f32| {
                let apart = (from - to).abs() - half;
                if apart > 0.0 { apart } else { 0.0 }
            };
            let (dx, dy) = (apart(x[i], r.u, HALF[0]), apart(y[i], r.v, HALF[1]));
            let steep = HALF[0] * slope_x[i].abs() + HALF[1] * slope_y[i].abs();
            let nearer = (high[i] + steep) - r.nearness;
            let is_near = (nearer > 0.0) & seen.reaches(dx, dy, nearer, 0.0);
            let height = r.hn * if r.hn > 0.0 { high[i] } else { low[i] };
            let along = (r.hu * x[i], r.hv * y[i]);
            let tilt = HALF[0] * (r.hu + r.hn * slope_x[i]).abs()
                + HALF[1] * (r.hv + r.hn * slope_y[i]).abs();
            let room = (r.above.abs() + height.abs()) + (along.0.abs() + along.1.abs());
            let greatest = (height + (along.0 + along.1)) + (tilt + room * ROUNDING);
            // False for NaN.
            let is_below = greatest <= r.above;
            found |= u32::from(is_near & !is_below) << i;
            close |= u32::from((low[i] - steep) - r.nearness <= most) << i;
        }
        [found, close]
    }
}
