//! The tiles of a map that can matter to a batch of receivers.

use shadowmap_core::LightPoint;

use crate::batch::Batch;
use crate::descend::{group_test, narrow, next_node};
use crate::kernels::Ops;
use crate::pyramid::{LANES, LEAF_HEIGHT, LEAF_WIDTH, NodeGroup, Pyramid};
use crate::reach::{Boxes, GroupTest, Reach};
use crate::search::{Search, TileTest};
use crate::walk::{Group, failing, walk};
use crate::{Map, Side};

/// Room for this many tiles, in chunks of [`LANES`].
const CHUNKS: usize = 8;

/// Tiles that may hold an answer for some receiver of a batch.
pub(crate) struct Tiles {
    chunks: [Chunk; CHUNKS],
    pub count: usize,
}

/// Sixteen of them: the parts of them that may count, the bounds there, and their first texels.
#[derive(Clone, Copy)]
struct Chunk {
    boxes: Boxes,
    nodes: NodeGroup,
    first: [[u32; 2]; LANES],
}

impl Tiles {
    /// The most that can be listed.
    pub const ROOM: usize = CHUNKS * LANES;

    pub fn new() -> Self {
        let boxes = Boxes {
            left: [0.0; LANES],
            right: [0.0; LANES],
            top: [0.0; LANES],
            bottom: [0.0; LANES],
        };
        let chunk = Chunk { boxes, nodes: NodeGroup::default(), first: [[0; 2]; LANES] };
        Tiles { chunks: [chunk; CHUNKS], count: 0 }
    }

    /// Lists the tiles for all of a batch. False if there are more of them than `room`.
    #[inline(always)]
    pub fn list(
        &mut self,
        ops: &impl Ops,
        map: &Map<'_>,
        pyramid: &Pyramid<'_>,
        batch: &Batch<'_>,
        room: usize,
    ) -> bool {
        self.count = 0;
        let Some(reach) = batch.reach() else { return false };
        let (side, ids) = (batch.first.side, batch.ids());
        let test = GroupTest::new(&reach, &pyramid.layout, 0.0);
        let mut texels = tile_test(&reach, &test, side);
        walk(ops, pyramid, &reach, &test, |group, verdicts| {
            let mut nodes = match side {
                Side::Blocker => verdicts.may_block,
                Side::Lit => verdicts.may_be_lit,
            };
            if nodes != 0 {
                nodes &= !failing(ops, pyramid, group.index, ids);
            }
            if group.level > 0 {
                return Some(nodes);
            }
            while nodes != 0 {
                let lane = nodes.trailing_zeros();
                nodes &= nodes - 1;
                if !self.add(ops, map, pyramid, group, lane, &mut texels, room) {
                    return None;
                }
            }
            Some(0)
        })
    }

    /// Adds one tile, if it can matter. False if there is no room.
    #[inline(always)]
    fn add(
        &mut self,
        ops: &impl Ops,
        map: &Map<'_>,
        pyramid: &Pyramid<'_>,
        group: &Group,
        lane: u32,
        test: &mut TileTest,
        room: usize,
    ) -> bool {
        let [x, y] = group.node(lane);
        let [x, y] = [x * LEAF_WIDTH, y * LEAF_HEIGHT];
        // Where planes are steeper than numbers can say, nodes past the map's end pass as well.
        if x >= map.width() || y >= map.height() {
            return true;
        }
        // The outermost texels that may count: those of the map...
        let (mut left, mut right) = (x, (x + LEAF_WIDTH).min(map.width()) - 1);
        let (mut top, mut bottom) = (y, (y + LEAF_HEIGHT).min(map.height()) - 1);
        // ...or fewer, if a look at the texels tells.
        if right - left == LEAF_WIDTH - 1 && bottom - top == LEAF_HEIGHT - 1 {
            test.place(x, y);
            let found = map.with_tile(x, y, |rows| ops.tile(test, rows));
            if found == 0 {
                return true;
            }
            let all = found | found >> 64;
            let all = all | all >> 32;
            let columns = (all | all >> 16) as u16;
            right = left + 15 - columns.leading_zeros();
            left += columns.trailing_zeros();
            bottom = top + (127 - found.leading_zeros()) / LEAF_WIDTH;
            top += found.trailing_zeros() / LEAF_WIDTH;
        }
        if self.count == room {
            return false;
        }
        let (chunk, i) = (&mut self.chunks[self.count / LANES], self.count % LANES);
        self.count += 1;
        let center = |low: u32, high: u32| (low as f32 + high as f32) * 0.5 + 0.5;
        chunk.boxes.left[i] = left as f32 + 0.5;
        chunk.boxes.right[i] = right as f32 + 0.5;
        chunk.boxes.top[i] = top as f32 + 0.5;
        chunk.boxes.bottom[i] = bottom as f32 + 0.5;
        chunk.first[i] = [x, y];
        let (nodes, lane) = (&pyramid.nodes[group.index], lane as usize);
        let (slope_x, slope_y) = (nodes.slope_x[lane], nodes.slope_y[lane]);
        // From the centre of the node to that of its part.
        let rise = slope_x * (center(left, right) - center(x, x + LEAF_WIDTH - 1))
            + slope_y * (center(top, bottom) - center(y, y + LEAF_HEIGHT - 1));
        chunk.nodes.slope_x[i] = slope_x;
        chunk.nodes.slope_y[i] = slope_y;
        chunk.nodes.low[i] = nodes.low[lane] + rise;
        chunk.nodes.high[i] = nodes.high[lane] + rise;
        true
    }

    /// Brings the search of one of the queries to its end.
    #[inline(always)]
    pub fn search(&self, ops: &impl Ops, pyramid: &Pyramid<'_>, search: &mut Search<'_>) {
        let mut test = group_test(search, pyramid);
        let mut rest = self.count;
        for chunk in &self.chunks {
            if rest == 0 {
                return;
            }
            let used = u32::MAX >> (32 - rest.min(LANES) as u32);
            rest = rest.saturating_sub(LANES);
            narrow(&mut test, search);
            let verdicts = ops.group(&test, &chunk.boxes, &chunk.nodes);
            let mut nodes = used
                & match search.query.side {
                    Side::Blocker => verdicts.may_block,
                    Side::Lit => verdicts.may_be_lit,
                };
            while let Some(lane) = next_node(&mut nodes, &verdicts.keys, search) {
                let [x, y] = chunk.first[lane as usize % LANES];
                search.ask_tile(ops, x, y);
            }
        }
    }
}

/// A test that every texel passes that may count for one of the receivers.
#[inline(always)]
fn tile_test(reach: &Reach, test: &GroupTest, side: Side) -> TileTest {
    let u = (reach.u[0] + reach.u[1]) * 0.5;
    let v = (reach.v[0] + reach.v[1]) * 0.5;
    let nearness = reach.plane.plane_at(u, v);
    let plane = LightPoint { u, v, nearness, slope: reach.plane.slope };
    // A circle around all of theirs, and what rounds off the edges of it.
    let radius = reach.radius + ((reach.u[1] - u) + (reach.v[1] - v));
    let offset = if side == Side::Blocker { test.least } else { test.most };
    TileTest::new(&plane, offset, radius * (1.0 + 1.0 / 1048576.0), side)
}
