//! What a batch of receivers asks of a leaf of the pyramid and of its texels.

use crate::Side;
use crate::map::ROWS;
use crate::pyramid::{LANES, LEAF_HEIGHT, LEAF_WIDTH, NodeGroup};
use crate::reach::{GroupTest, Reach};

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

/// A leaf of the pyramid, as each receiver compares it with its own plane.
pub(crate) struct Leaf {
    /// Centres of the outermost texels.
    pub u: [f32; 2],
    pub v: [f32; 2],
    pub slope: [f32; 2],
    /// Bounds at the centre of the leaf, with room for all rounding.
    pub low: f32,
    pub high: f32,
    /// That room.
    pub room: f32,
    /// Centre of the first texel of the tile that is asked for the leaf: at the end of the map
    /// one that starts before it.
    pub first: [f32; 2],
    /// The tile's rows that may matter: bit i for row i.
    pub rows: u32,
}

impl Leaf {
    #[inline(always)]
    pub fn new(first: [u32; 2], tile: [u32; 2], nodes: &NodeGroup, lane: u32, room: f32) -> Leaf {
        let lane = lane as usize % LANES;
        let (u, v) = (first[0] as f32 + 0.5, first[1] as f32 + 0.5);
        Leaf {
            u: [u, u + (LEAF_WIDTH - 1) as f32],
            v: [v, v + (LEAF_HEIGHT - 1) as f32],
            slope: [nodes.slope_x[lane], nodes.slope_y[lane]],
            low: nodes.low[lane] - room,
            high: nodes.high[lane] + room,
            room,
            first: [tile[0] as f32 + 0.5, tile[1] as f32 + 0.5],
            rows: 0,
        }
    }

    /// Whether comparisons may pass over a texel that counts: NaN is lit.
    #[inline(always)]
    pub fn holds_unknown(&self, lit: bool) -> bool {
        lit && self.low == f32::NEG_INFINITY
    }
}

/// What may matter of a tile.
#[derive(Clone, Copy, Default)]
pub(crate) struct Matter {
    /// To whom: bit i for receiver i.
    pub lanes: u64,
    /// Which rows: bit i for row i.
    pub rows: u32,
}

/// What the kernels that sift ask of 16 x 8 texels.
pub(crate) struct SiftTest {
    /// Centre of the first column.
    pub first: f32,
    /// Receivers are between these, along a row.
    pub from: f32,
    pub to: f32,
    /// Greatest squared distance from them that is of use.
    pub reach_squared: f32,
    /// A plane, and by how much it must be exceeded by what blocks any of them and all of them,
    pub u: f32,
    pub nearness: f32,
    pub slope: f32,
    pub least: f32,
    pub most: f32,
    /// less or more by this for each texel away from u.
    pub spread: f32,
    /// Look for texels that do not block.
    pub lit: bool,
    /// For each row, what the plane gains down the map, what `spread` adds up to, and the squared
    /// distance.
    pub rise: [f32; ROWS],
    pub margin: [f32; ROWS],
    pub dy_squared: [f32; ROWS],
}

impl SiftTest {
    /// To be placed by [`SiftTest::place`].
    #[inline(always)]
    pub fn new(reach: &Reach, test: &GroupTest, side: Side) -> SiftTest {
        SiftTest {
            first: 0.0,
            from: reach.u[0],
            to: reach.u[1],
            reach_squared: test.reach_squared,
            u: reach.plane.u,
            nearness: reach.plane.nearness,
            slope: reach.plane.slope.x,
            least: test.least,
            most: test.most,
            spread: reach.spread.x,
            lit: side == Side::Lit,
            rise: [0.0; ROWS],
            margin: [0.0; ROWS],
            dy_squared: [0.0; ROWS],
        }
    }

    /// Places the test at the tile whose first texel is (x, y).
    #[inline(always)]
    pub fn place(&mut self, reach: &Reach, x: u32, y: u32) {
        self.first = x as f32 + 0.5;
        let top = y as f32 + 0.5;
        for row in 0..ROWS {
            let y = top + row as f32;
            let dy = y - reach.plane.v;
            let gap = (y - reach.v[1]).max(reach.v[0] - y).max(0.0);
            self.rise[row] = reach.plane.slope.y * dy;
            self.margin[row] = reach.spread.y * dy.abs();
            self.dy_squared[row] = gap * gap;
        }
    }
}
