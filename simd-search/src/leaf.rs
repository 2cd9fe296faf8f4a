//! What a batch of receivers asks of a leaf of the pyramid and of its texels.

use crate::Side;
use crate::map::{ROWS, Row};
use crate::pyramid::{LANES, Layout, NodeGroup};
use crate::reach::{GroupTest, Reach};
use crate::walk::Group;

/// A texel that is asked by all receivers of a batch.
#[derive(Clone, Copy, Default)]
pub(crate) struct Candidate {
    /// Its centre.
    pub x: f32,
    pub y: f32,
    pub nearness: f32,
    /// Its place in row-major order, a whole number.
    pub order: f32,
}

/// A node of the pyramid, as each receiver compares it with its own plane.
pub(crate) struct Node {
    /// Centres of the outermost texels.
    pub u: [f32; 2],
    pub v: [f32; 2],
    pub slope: [f32; 2],
    /// Bounds at the centre of the node, with room for all rounding.
    pub low: f32,
    pub high: f32,
}

impl Node {
    /// One of the nodes of a group.
    #[inline(always)]
    pub fn new(group: &Group, nodes: &NodeGroup, lane: u32, room: f32) -> Node {
        let ([x, y], lane) = (group.node(lane), lane as usize % LANES);
        let [width, height] = Layout::node_size(group.level).map(|size| size as f32);
        let (u, v) = (x as f32 * width + 0.5, y as f32 * height + 0.5);
        Node {
            u: [u, u + (width - 1.0)],
            v: [v, v + (height - 1.0)],
            slope: [nodes.slope_x[lane], nodes.slope_y[lane]],
            low: nodes.low[lane] - room,
            high: nodes.high[lane] + room,
        }
    }
}

/// The tile of a leaf, as each receiver compares its texels with its own plane.
pub(crate) struct Leaf {
    /// Whether it holds a NaN.
    pub is_unknown: bool,
    /// Room for all rounding.
    pub room: f32,
    /// Centre of the first texel of the tile that is asked for the leaf: at the end of the map
    /// one that starts before it.
    pub first: [f32; 2],
    /// The tile's rows that may matter: bit i for row i.
    pub rows: u32,
}

impl Leaf {
    #[inline(always)]
    pub fn new(first: [u32; 2], nodes: &NodeGroup, lane: u32, room: f32) -> Leaf {
        Leaf {
            is_unknown: nodes.low[lane as usize % LANES] == f32::NEG_INFINITY,
            room,
            first: [first[0] as f32 + 0.5, first[1] as f32 + 0.5],
            rows: 0,
        }
    }

    /// Whether comparisons may pass over a texel that counts: NaN is lit.
    #[inline(always)]
    pub fn holds_unknown(&self, lit: bool) -> bool {
        lit && self.is_unknown
    }
}

/// A tile of the map.
pub(crate) struct Tile<'a> {
    /// Column and row of its first texel.
    pub first: [u32; 2],
    pub rows: [&'a Row; ROWS],
}

/// What the kernels that sift ask of 16 x 8 texels.
///
/// All planes of the receivers lie between a lower and an upper bound. Either is a number for
/// each row plus one for each column, and so is the squared distance.
pub(crate) struct SiftTest {
    /// Centre of the first column.
    pub first: f32,
    /// Receivers are between these, along a row.
    pub from: f32,
    pub to: f32,
    /// Greatest squared distance from them that is of use.
    pub reach_squared: f32,
    /// For a column, the bounds rise by `slope` times its distance from u, and part by `spread`
    /// times that.
    pub u: f32,
    pub slope: f32,
    pub spread: f32,
    /// What blocks any of the receivers exceeds the lower bound, what blocks all of them the upper.
    pub lower: [f32; ROWS],
    pub upper: [f32; ROWS],
    pub dy_squared: [f32; ROWS],
    /// Look for texels that do not block.
    pub lit: bool,
}

impl SiftTest {
    /// To be placed by [`SiftTest::place`].
    #[inline(always)]
    pub fn new(reach: &Reach, side: Side) -> SiftTest {
        SiftTest {
            first: 0.0,
            from: reach.u[0],
            to: reach.u[1],
            reach_squared: reach.radius * reach.radius,
            u: reach.plane.u,
            slope: reach.plane.slope.x,
            spread: reach.spread.x,
            lower: [0.0; ROWS],
            upper: [0.0; ROWS],
            dy_squared: [0.0; ROWS],
            lit: side == Side::Lit,
        }
    }

    /// Places the test at the tile whose first texel is (x, y).
    #[inline(always)]
    pub fn place(&mut self, reach: &Reach, test: &GroupTest, x: u32, y: u32) {
        self.first = x as f32 + 0.5;
        let top = y as f32 + 0.5;
        let plane = reach.plane;
        for row in 0..ROWS {
            let y = top + row as f32;
            let dy = y - plane.v;
            let gap = larger(larger(y - reach.v[1], reach.v[0] - y), 0.0);
            let at_u = plane.nearness + plane.slope.y * dy;
            let margin = reach.spread.y * dy.abs();
            self.lower[row] = (at_u + test.least) - margin;
            self.upper[row] = (at_u + test.most) + margin;
            self.dy_squared[row] = gap * gap;
        }
    }
}

/// `a > b ? a : b`: one instruction, where `f32::max` takes care of NaN.
#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
