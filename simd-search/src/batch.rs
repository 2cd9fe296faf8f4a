//! Many searches at once: what the pyramid says of neighbouring receivers is asked once for all.

use shadowmap_core::{Level, LightPoint};

use crate::descend::{Path, descend, group_test, narrow, next_node};
use crate::kernels::{Job, Ops, run};
use crate::pyramid::{LANES, LEAF_HEIGHT, LEAF_WIDTH, NodeGroup, Pyramid};
use crate::reach::{Boxes, Cone, GroupTest, Reach, Receivers};
use crate::search::{Search, TileTest};
use crate::walk::{EXACT_EXTENT, Group, failing, walk};
use crate::{Hit, IdTest, Key, Map, Query, Side};

/// Receivers that share one list of tiles.
const BATCH: usize = 64;
/// Fewer are searched one by one.
const FEW: usize = 4;
/// Room for this many tiles, in chunks of [`LANES`].
const CHUNKS: usize = 8;

impl Pyramid<'_> {
    /// The answer to one query: what [`crate::naive::nearest`] gives.
    ///
    /// # Panics
    ///
    /// If the pyramid is of a map of another size.
    #[must_use]
    pub fn nearest<'m>(&self, level: Level, map: impl Into<Map<'m>>, query: &Query) -> Option<Hit> {
        let mut hit = [None];
        self.nearest_each(level, map, core::slice::from_ref(query), &mut hit);
        hit[0]
    }

    /// The answers to many queries, best to a block of neighbouring receivers in rows.
    ///
    /// Each search takes the hit of the one before (of the same side) as its hint, unless it
    /// brings its own. Up to 64 receivers in sequence share one look at the pyramid, which is of
    /// use if they lie close together and have the same ID test.
    ///
    /// # Panics
    ///
    /// If the pyramid is of a map of another size, or there are not as many `hits` as queries.
    pub fn nearest_each<'m>(
        &self,
        level: Level,
        map: impl Into<Map<'m>>,
        queries: &[Query],
        hits: &mut [Option<Hit>],
    ) {
        let map = map.into();
        self.check(&map);
        assert_eq!(queries.len(), hits.len(), "one hit per query");
        run(level, Job::InPyramid { map, pyramid: self, queries, hits });
    }
}

/// Tiles that may hold an answer for some receiver of a batch.
struct Tiles {
    chunks: [Chunk; CHUNKS],
    count: usize,
}

/// Sixteen of them: the parts of them that may count, the bounds there, and their first texels.
#[derive(Clone, Copy)]
struct Chunk {
    boxes: Boxes,
    nodes: NodeGroup,
    first: [[u32; 2]; LANES],
}

/// The answers to `queries`.
#[inline(always)]
pub(crate) fn each_in_pyramid(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    queries: &[Query],
    hits: &mut [Option<Hit>],
) {
    let mut path = Path::new();
    let mut tiles = Tiles::new();
    for (queries, hits) in queries.chunks(BATCH).zip(hits.chunks_mut(BATCH)) {
        for side in [Side::Blocker, Side::Lit] {
            let is_listed = tiles.gather(ops, &map, pyramid, queries, side);
            let mut last = None;
            for (query, hit) in queries.iter().zip(&mut *hits) {
                if query.side != side {
                    continue;
                }
                if is_listed && tiles.count == 0 {
                    *hit = None;
                    continue;
                }
                let mut search = Search::new(map, query, query.hint.or(last));
                if !(query.radius >= 0.0 && query.point.u.is_finite() && query.point.v.is_finite())
                {
                    // Nothing is within reach.
                } else if is_listed {
                    tiles.search(ops, pyramid, &mut search);
                } else if map.width() > EXACT_EXTENT || map.height() > EXACT_EXTENT {
                    search.ask_box(ops);
                } else {
                    descend(ops, pyramid, &mut search, &mut path);
                }
                *hit = search.best;
                last = hit.map(|hit| [hit.x, hit.y]).or(last);
            }
        }
    }
}

impl Tiles {
    fn new() -> Self {
        let boxes = Boxes {
            left: [0.0; LANES],
            right: [0.0; LANES],
            top: [0.0; LANES],
            bottom: [0.0; LANES],
        };
        let chunk = Chunk { boxes, nodes: NodeGroup::default(), first: [[0; 2]; LANES] };
        Tiles { chunks: [chunk; CHUNKS], count: 0 }
    }

    /// Lists the tiles for all queries of one side. False if the list would not be worth it, or
    /// has no room for them all: the queries are then to be searched one by one.
    #[inline(always)]
    fn gather(
        &mut self,
        ops: &impl Ops,
        map: &Map<'_>,
        pyramid: &Pyramid<'_>,
        queries: &[Query],
        side: Side,
    ) -> bool {
        self.count = 0;
        let mut columns = [[0.0; BATCH]; 6];
        let (mut first, mut count): (Option<&Query>, usize) = (None, 0);
        let (mut radius, mut alike, mut plain) = (0.0, true, true);
        let mut cone = Some(Cone { nearness: f32::INFINITY, at_most: 0.0 });
        for query in queries.iter().filter(|query| query.side == side) {
            let LightPoint { u, v, nearness, slope } = query.point;
            let row = [u, v, nearness, slope.x, slope.y, query.offset];
            for (column, value) in columns.iter_mut().zip(row) {
                column[count % BATCH] = value;
            }
            count += 1;
            radius = if query.radius > radius { query.radius } else { radius };
            alike &= query.ids == first.get_or_insert(query).ids;
            plain &= query.jitter_amplitude() == 0.0;
            cone = match (cone, query.key) {
                (Some(cone), Key::Ratio { at_most }) => Some(Cone {
                    nearness: cone.nearness.min(nearness),
                    at_most: cone.at_most.max(at_most),
                }),
                _ => None,
            };
        }
        let Some(first) = first else { return true };
        if count < FEW || !plain || !Search::is_tiled(map) {
            return false;
        }
        let [u, v, nearness, slope_x, slope_y, offset] =
            columns.each_ref().map(|column| &column[..count]);
        let receivers = Receivers { u, v, nearness, slope_x, slope_y, offset };
        let Some(mut reach) = Reach::around(&receivers, radius) else { return false };
        reach.cone = cone;
        let ids = if alike { first.ids } else { IdTest::Any };
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
                if !self.add(ops, map, pyramid, group, lane, &mut texels) {
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
        if self.count == CHUNKS * LANES {
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
    fn search(&self, ops: &impl Ops, pyramid: &Pyramid<'_>, search: &mut Search<'_>) {
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
