//! The way down the pyramid for all receivers of a batch, and the texels that they ask.

use core::ops::Range;

use crate::descend::{Descent, Path, descend};
use crate::kernels::Ops;
use crate::leaf::{Candidate, Leaf, Node, SiftTest, Tile, larger};
use crate::map::{COLUMNS, ROWS, Row};
use crate::naive::reach as span;
use crate::precedence::{Sure, preceded};
use crate::pyramid::{LEAF_HEIGHT, LEAF_WIDTH, NodeGroup, Pyramid};
use crate::reach::{GroupTest, Reach};
use crate::receivers::{BATCH, Seekers, WINDOW};
use crate::search::passing;
use crate::walk::Group;
use crate::{IdTest, Map, Side};

/// Texels that are asked at once.
const ROOM: usize = 64;
/// As many texels of a tile take longer to be asked one after the other, by all receivers at once,
/// than the whole tile by one receiver after the other.
const MANY: u32 = 16;
/// As many receivers with different slopes have too little in common for texels to be sorted.
const SOME: u32 = 16;
/// The farthest a batch looks, in texels: squared distances that differ then differ after rounding
/// as well.
const FARTHEST: f32 = 1024.0;
/// In a box of more columns and rows than this, receivers differ in what they are close to.
const WIDE: f32 = 32.0;
/// Receivers in a box of more columns and rows than this have too little in common, and those on
/// one plane.
const APART: f32 = 96.0;
const APART_FLAT: f32 = 192.0;

/// The way down for all receivers of a batch.
struct Candidates<'a> {
    map: Map<'a>,
    ids: IdTest,
    reach: &'a Reach,
    seekers: &'a mut Seekers,
    /// Also knows how far the receivers still have to look.
    test: SiftTest,
    /// The receivers' planes, with room for rounding where leaves are compared with them.
    planes: GroupTest,
    /// Texels that wait to be asked, and by whom: bit i for receiver i.
    texels: [Candidate; ROOM],
    count: usize,
    lanes: u64,
    everyone: u64,
    /// The receivers' planes have different slopes, by more than rounding makes of equal ones...
    is_tilted: bool,
    /// ...or the receivers are not close to the same texels.
    differ: bool,
    /// A texel that counts for all receivers, close to all of them.
    sure: Option<Sure>,
}

/// Finds the answers of all receivers. False if they are better searched for one by one.
#[inline(always)]
pub(crate) fn ask_all(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    reach: &Reach,
    side: Side,
    ids: IdTest,
    seekers: &mut Seekers,
    path: &mut Path,
) -> bool {
    let size = (reach.u[1] - reach.u[0]) + (reach.v[1] - reach.v[0]);
    let test = GroupTest::new(reach, &pyramid.layout, 0.0);
    let is_tilted = (reach.spread.x + reach.spread.y) * (size + reach.radius) > test.room;
    let apart = if is_tilted { APART } else { APART_FLAT };
    if size > apart || reach.radius > FARTHEST || !test.is_tame() {
        return false;
    }
    let [columns, rows] = window(&map, reach);
    debug_assert!(columns.len() < WINDOW as usize && rows.len() < WINDOW as usize);
    seekers.origin = [columns.start, rows.start];
    let everyone = u64::MAX >> (BATCH - seekers.count.clamp(1, BATCH));
    let mut candidates = Candidates {
        map,
        ids,
        reach,
        seekers,
        test: SiftTest::new(reach, side),
        planes: test,
        texels: [Candidate::default(); ROOM],
        count: 0,
        lanes: everyone,
        everyone,
        is_tilted,
        differ: size > WIDE || is_tilted,
        sure: None,
    };
    descend(ops, pyramid, &mut candidates, test, path);
    candidates.ask(ops);
    true
}

/// The columns and rows in reach.
#[inline(always)]
fn window(map: &Map<'_>, reach: &Reach) -> [Range<u32>; 2] {
    let around = |[from, to]: [f32; 2], size| {
        span(from, reach.radius, size).start..span(to, reach.radius, size).end
    };
    [around(reach.u, map.width()), around(reach.v, map.height())]
}

impl Candidates<'_> {
    /// The texels of a tile that pass the ID test, of those in `texels`.
    #[inline(always)]
    fn passing(&self, ops: &impl Ops, [x, y]: [u32; 2], mut texels: u128) -> u128 {
        if self.ids != IdTest::Any {
            for row in 0..ROWS as u32 {
                let others = !passing(ops, &self.map, self.ids, x, y + row);
                texels &= !(u128::from(others) << (row * COLUMNS as u32));
            }
        }
        texels
    }

    /// Adds the texels of a tile that can be the answer to those that wait. `sure` count for all
    /// receivers in reach of them.
    #[inline(always)]
    fn add(
        &mut self,
        ops: &impl Ops,
        [x, y]: [u32; 2],
        rows: &[&Row; ROWS],
        may: u128,
        sure: u128,
    ) {
        let mut rest = may;
        if sure != 0 {
            rest &= !preceded(self.reach, x, y, sure);
        }
        // In halves, for shifts of longer words are slow.
        for half in 0..2 {
            let shift = half * u64::BITS;
            let (mut rest, sure) = ((rest >> shift) as u64, (sure >> shift) as u64);
            while rest != 0 {
                let bit = rest.trailing_zeros();
                rest &= rest - 1;
                let (column, row) = (bit % COLUMNS as u32, (shift + bit) / COLUMNS as u32);
                if self.count == ROOM {
                    self.ask(ops);
                }
                let texel = Candidate {
                    x: (x + column) as f32 + 0.5,
                    y: (y + row) as f32 + 0.5,
                    nearness: rows[row as usize % ROWS][column as usize],
                    order: self.seekers.order(x + column, y + row),
                };
                self.texels[self.count % ROOM] = texel;
                self.count += 1;
                if sure >> bit & 1 == 1 {
                    self.add_sure(texel.x, texel.y);
                }
            }
        }
    }

    /// Takes note of a texel that counts for all receivers.
    #[inline(always)]
    fn add_sure(&mut self, x: f32, y: f32) {
        let ([left, right], [top, bottom]) = (self.reach.u, self.reach.v);
        let dx = larger(x - left, right - x);
        let dy = larger(y - top, bottom - y);
        // No receiver has its answer farther away than that.
        let farthest = dx * dx + dy * dy;
        if farthest < self.test.reach_squared {
            self.test.reach_squared = farthest;
            self.sure = Some(Sure::new(self.reach, x, y));
        }
    }

    /// Lets each of the receivers in `lanes` ask a whole tile, of which the texels in `sure` count
    /// for all receivers in reach of them.
    #[inline(always)]
    fn ask_tile(&mut self, ops: &impl Ops, tile: &Tile<'_>, lanes: u64, sure: u128) {
        let [x, y] = tile.first;
        ops.ask_tile(tile, self.seekers, lanes, self.test.lit);
        self.test.reach_squared = self.test.reach_squared.min(self.seekers.farthest());
        let mut sure = sure & !preceded(self.reach, x, y, sure);
        while sure != 0 {
            let bit = sure.trailing_zeros();
            sure &= sure - 1;
            let (column, row) = (bit % COLUMNS as u32, bit / COLUMNS as u32);
            self.add_sure((x + column) as f32 + 0.5, (y + row) as f32 + 0.5);
        }
    }

    /// Asks the texels that wait.
    #[inline(always)]
    fn ask(&mut self, ops: &impl Ops) {
        let count = self.count.min(ROOM);
        self.count = 0;
        if count > 0 {
            ops.ask(&self.texels[..count], self.seekers, self.lanes, self.test.lit);
            self.test.reach_squared = self.test.reach_squared.min(self.seekers.farthest());
        }
    }
}

impl Descent for Candidates<'_> {
    #[inline(always)]
    fn side(&self) -> Side {
        if self.test.lit { Side::Lit } else { Side::Blocker }
    }

    #[inline(always)]
    fn ids(&self) -> IdTest {
        self.ids
    }

    #[inline(always)]
    fn window(&self) -> [Range<u32>; 2] {
        window(&self.map, self.reach)
    }

    #[inline(always)]
    fn narrow(&self, test: &mut GroupTest) {
        test.reach_squared = self.test.reach_squared;
    }

    #[inline(always)]
    fn bound(&self) -> f32 {
        self.test.reach_squared
    }

    #[inline(always)]
    fn concerned(
        &mut self,
        ops: &impl Ops,
        group: &Group,
        nodes: &NodeGroup,
        lane: u32,
        among: u64,
    ) -> u64 {
        let is_leaf = group.level == 0;
        if !self.differ && !is_leaf {
            return among;
        }
        let node = Node::new(group, nodes, lane, self.planes.room);
        if is_leaf && self.sure.is_some_and(|sure| sure.precedes_box(node.u, node.v)) {
            return 0;
        }
        if !self.differ {
            return self.everyone;
        }
        let among = among & self.everyone;
        // Nobody may be concerned, although the planes of all together are.
        self.ask(ops);
        ops.concerned(&node, self.seekers, among, self.test.lit)
    }

    #[inline(always)]
    fn leaf(
        &mut self,
        ops: &impl Ops,
        group: &Group,
        nodes: &NodeGroup,
        lane: u32,
        concerned: u64,
    ) {
        let [x, y] = group.node(lane);
        let x = (x * LEAF_WIDTH).min(self.map.width() - COLUMNS as u32);
        let y = (y * LEAF_HEIGHT).min(self.map.height() - ROWS as u32);
        let (map, mut unpacked) = (self.map, [[0.0; COLUMNS]; ROWS]);
        let rows = map.tile(x, y, &mut unpacked);
        if self.is_tilted && self.ids == IdTest::Any && concerned.count_ones() <= SOME {
            self.ask_tile(ops, &Tile { first: [x, y], rows }, concerned, 0);
            return;
        }
        self.test.place(self.reach, &self.planes, x, y);
        let [may, sure] = ops.sift(&self.test, rows);
        if may == sure {
            let sure = self.passing(ops, [x, y], sure);
            self.add(ops, [x, y], &rows, sure, sure);
            return;
        }
        // Some texels lie between the planes of the receivers: each compares with its own.
        self.ask(ops);
        let mut leaf = Leaf::new([x, y], nodes, lane, self.planes.room);
        for row in 0..ROWS {
            leaf.rows |= u32::from((may >> (row * COLUMNS)) as u16 != 0) << row;
        }
        let lanes = ops.matters(&leaf, rows, self.seekers, concerned, self.test.lit);
        if lanes == 0 {
            return;
        }
        if self.ids == IdTest::Any && may.count_ones() >= MANY {
            self.ask_tile(ops, &Tile { first: [x, y], rows }, lanes, sure);
            return;
        }
        let may = self.passing(ops, [x, y], may);
        self.lanes = lanes;
        self.add(ops, [x, y], &rows, may, may & sure);
        self.ask(ops);
        self.lanes = self.everyone;
    }
}
