//! Descending the pyramid: single searches, and the judgement of a region.

use shadowmap_core::Level;

use crate::kernels::{Job, Ops, run};
use crate::pyramid::{FAN, LANES, LEAF_HEIGHT, LEAF_WIDTH, Layout, MAX_LEVELS, Pyramid};
use crate::reach::{Cone, GroupTest, Reach};
use crate::search::Search;
use crate::{Hit, IdTest, Key, Map, Query, Side};

/// Beyond this many columns or rows, `f32` no longer holds texel centres exactly, which bounds on
/// distance rely on: such maps are searched without the pyramid.
pub(crate) const EXACT_EXTENT: u32 = 1 << 22;

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

    /// The answers to many queries, best in an order in which neighbours follow each other: each
    /// takes the hit of the one before as its hint, unless it brings its own.
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

/// A group of nodes on the way down, of which some are still to be visited.
#[derive(Clone, Copy)]
struct Frame {
    x: u32,
    y: u32,
    nodes: u32,
    keys: [f32; LANES],
}

/// The groups on the way down, one for each level.
pub(crate) struct Path([Frame; MAX_LEVELS]);

impl Path {
    pub fn new() -> Self {
        Path([Frame { x: 0, y: 0, nodes: 0, keys: [0.0; LANES] }; MAX_LEVELS])
    }
}

/// The answers to `queries`, one after another.
#[inline(always)]
pub(crate) fn each_in_pyramid(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    queries: &[Query],
    hits: &mut [Option<Hit>],
) {
    let mut path = Path::new();
    let mut last = None;
    for (query, hit) in queries.iter().zip(hits) {
        let hinted = Query { hint: query.hint.or(last), ..*query };
        *hit = in_pyramid(ops, map, pyramid, &hinted, &mut path);
        last = hit.map(|hit| [hit.x, hit.y]).or(last);
    }
}

#[inline(always)]
fn in_pyramid(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    query: &Query,
    path: &mut Path,
) -> Option<Hit> {
    let mut search = Search::new(map, query);
    if map.width() > EXACT_EXTENT || map.height() > EXACT_EXTENT {
        search.ask_box(ops);
        return search.best;
    }
    let [columns, rows] = search.window();
    if columns.is_empty() || rows.is_empty() || query.radius.is_nan() || query.radius < 0.0 {
        return None;
    }
    let mut reach = Reach::of(query.point, query.offset, query.radius);
    if let Key::Ratio { .. } = query.key {
        reach.cone = Some(Cone { nearness: query.point.nearness, at_most: search.key });
    }
    let mut test = GroupTest::new(&reach, &pyramid.layout, query.jitter_amplitude());
    let top = level_of(&pyramid.layout, columns.end - columns.start, rows.end - rows.start);
    let [width, height] = group_size(top);
    for y in rows.start / height..=(rows.end - 1) / height {
        for x in columns.start / width..=(columns.end - 1) / width {
            descend(ops, &mut search, pyramid, &mut test, path, top, x, y);
        }
    }
    search.best
}

/// Texels per group of a level, along each axis.
#[inline(always)]
pub(crate) fn group_size(level: usize) -> [u32; 2] {
    Layout::node_size(level).map(|size| (size * u64::from(FAN)).min(1 << 31) as u32)
}

/// The level whose groups are at least as large as a box: it meets at most four of them.
#[inline(always)]
pub(crate) fn level_of(layout: &Layout, columns: u32, rows: u32) -> usize {
    let mut level = 0;
    while level + 1 < layout.count {
        let [width, height] = group_size(level);
        if width >= columns && height >= rows {
            break;
        }
        level += 1;
    }
    level
}

/// Searches one group of nodes, nearest first.
#[inline(always)]
fn descend(
    ops: &impl Ops,
    search: &mut Search<'_>,
    pyramid: &Pyramid<'_>,
    test: &mut GroupTest,
    path: &mut Path,
    top: usize,
    x: u32,
    y: u32,
) {
    let mut level = top;
    path.0[level] = visit(ops, search, pyramid, test, level, x, y);
    loop {
        let frame = &mut path.0[level];
        let Some(lane) = nearest_lane(frame, search) else {
            level += 1;
            if level > top {
                return;
            }
            continue;
        };
        let (x, y) = (frame.x * FAN + lane % FAN, frame.y * FAN + lane / FAN);
        if level == 0 {
            search.ask_tile(ops, x * LEAF_WIDTH, y * LEAF_HEIGHT);
        } else {
            level -= 1;
            path.0[level] = visit(ops, search, pyramid, test, level, x, y);
        }
    }
}

/// Takes the node with the smallest bound from a frame, if any can still hold the answer.
#[inline(always)]
fn nearest_lane(frame: &mut Frame, search: &Search<'_>) -> Option<u32> {
    if frame.nodes == 0 {
        return None;
    }
    let mut nodes = frame.nodes;
    let mut lane = nodes.trailing_zeros();
    nodes &= nodes - 1;
    while nodes != 0 {
        let other = nodes.trailing_zeros();
        if frame.keys[other as usize] < frame.keys[lane as usize] {
            lane = other;
        }
        nodes &= nodes - 1;
    }
    let bound = match search.query.key {
        Key::Distance => search.test.reach_squared,
        Key::Ratio { .. } => search.key,
    };
    // A NaN does not bound.
    if frame.keys[lane as usize] > bound {
        frame.nodes = 0;
        return None;
    }
    frame.nodes &= !(1 << lane);
    Some(lane)
}

/// The nodes of a group that can hold the answer.
#[inline(always)]
fn visit(
    ops: &impl Ops,
    search: &Search<'_>,
    pyramid: &Pyramid<'_>,
    test: &mut GroupTest,
    level: usize,
    x: u32,
    y: u32,
) -> Frame {
    let mut frame = Frame { x, y, nodes: 0, keys: [0.0; LANES] };
    let Some(index) = pyramid.layout.group(level, x, y) else { return frame };
    test.at(level, x, y);
    test.reach_squared = search.test.reach_squared;
    if let Some(cone) = &mut test.cone {
        cone.at_most = search.key;
    }
    let verdicts = ops.group(test, &pyramid.nodes[index]);
    frame.keys = verdicts.keys;
    frame.nodes = match search.query.side {
        Side::Blocker => verdicts.may_block,
        Side::Lit => verdicts.may_be_lit,
    };
    if frame.nodes != 0 {
        frame.nodes &= !failing(ops, pyramid, index, search.query.ids);
    }
    frame
}

/// The nodes of a group in which no texel passes an ID test.
#[inline(always)]
pub(crate) fn failing(ops: &impl Ops, pyramid: &Pyramid<'_>, index: usize, ids: IdTest) -> u32 {
    match (ids, pyramid.ids.get(index)) {
        (IdTest::Any, _) | (_, None) => 0,
        (IdTest::Differs(id), Some(group)) => {
            group.single & ops.equal(&group.id, id & pyramid.id_mask)
        }
        (IdTest::Equals(id), Some(group)) => {
            group.single & !ops.equal(&group.id, id & pyramid.id_mask)
        }
    }
}
