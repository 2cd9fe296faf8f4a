//! One search, down the pyramid from the nearest node to the farthest.

use crate::kernels::Ops;
use crate::pyramid::{LANES, LEAF_HEIGHT, LEAF_WIDTH, MAX_LEVELS, Pyramid};
use crate::reach::{Boxes, Cone, GroupTest, Reach};
use crate::search::Search;
use crate::walk::{Group, failing, groups, level_of};
use crate::{Key, Side};

/// A group on the way down, of which some nodes wait to be visited.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    group: Group,
    pub nodes: u32,
    pub keys: [f32; LANES],
}

/// The groups on the way down, one for each level.
pub(crate) struct Path([Frame; MAX_LEVELS]);

impl Path {
    pub fn new() -> Self {
        let group = Group { level: 0, x: 0, y: 0, index: 0 };
        Path([Frame { group, nodes: 0, keys: [0.0; LANES] }; MAX_LEVELS])
    }
}

/// Brings a search to its end.
#[inline(always)]
pub(crate) fn descend(
    ops: &impl Ops,
    pyramid: &Pyramid<'_>,
    search: &mut Search<'_>,
    path: &mut Path,
) {
    let [columns, rows] = search.window();
    let mut test = group_test(search, pyramid);
    let top = level_of(&pyramid.layout, &columns, &rows);
    for (x, y) in groups(&columns, &rows, top) {
        let mut level = top;
        path.0[level] = visit(ops, search, pyramid, &mut test, Group { level, x, y, index: 0 });
        loop {
            let frame = &mut path.0[level];
            let Some(lane) = next_node(&mut frame.nodes, &frame.keys, search) else {
                level += 1;
                if level > top {
                    break;
                }
                continue;
            };
            let [x, y] = frame.group.node(lane);
            if level == 0 {
                search.ask_tile(ops, x * LEAF_WIDTH, y * LEAF_HEIGHT);
            } else {
                level -= 1;
                let group = Group { level, x, y, index: 0 };
                path.0[level] = visit(ops, search, pyramid, &mut test, group);
            }
        }
    }
}

/// The test of nodes for one search.
#[inline(always)]
pub(crate) fn group_test(search: &Search<'_>, pyramid: &Pyramid<'_>) -> GroupTest {
    let query = search.query;
    let mut reach = Reach::of(query.point, query.offset, query.radius);
    if let Key::Ratio { .. } = query.key {
        reach.cone = Some(Cone { nearness: query.point.nearness, at_most: search.key });
    }
    GroupTest::new(&reach, &pyramid.layout, query.jitter_amplitude())
}

/// Narrows a test to what is still of use.
#[inline(always)]
pub(crate) fn narrow(test: &mut GroupTest, search: &Search<'_>) {
    test.reach_squared = search.test.reach_squared;
    if let Some(cone) = &mut test.cone {
        cone.at_most = search.key;
    }
}

/// Takes the node with the smallest key, if any can still hold the answer.
#[inline(always)]
pub(crate) fn next_node(nodes: &mut u32, keys: &[f32; LANES], search: &Search<'_>) -> Option<u32> {
    let mut rest = *nodes;
    if rest == 0 {
        return None;
    }
    let mut lane = rest.trailing_zeros();
    rest &= rest - 1;
    while rest != 0 {
        let other = rest.trailing_zeros();
        if keys[other as usize % LANES] < keys[lane as usize % LANES] {
            lane = other;
        }
        rest &= rest - 1;
    }
    let bound = match search.query.key {
        Key::Distance => search.test.reach_squared,
        Key::Ratio { .. } => search.key,
    };
    // A NaN, which does not bound, comes first or has no texel that counts.
    if keys[lane as usize % LANES] > bound {
        *nodes = 0;
        return None;
    }
    *nodes &= !(1 << lane);
    Some(lane)
}

/// The nodes of a group that can hold the answer.
#[inline(always)]
fn visit(
    ops: &impl Ops,
    search: &Search<'_>,
    pyramid: &Pyramid<'_>,
    test: &mut GroupTest,
    group: Group,
) -> Frame {
    let Group { level, x, y, .. } = group;
    let mut frame = Frame { group, nodes: 0, keys: [0.0; LANES] };
    let Some(index) = pyramid.layout.group(level, x, y) else { return frame };
    narrow(test, search);
    let verdicts = ops.group(test, &Boxes::of_group(level, x, y), &pyramid.nodes[index]);
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
