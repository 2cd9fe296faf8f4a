//! Down the pyramid, from the nearest node to the farthest.

use core::ops::Range;

use crate::kernels::Ops;
use crate::pyramid::{LANES, MAX_LEVELS, NodeGroup, Pyramid};
use crate::reach::{Boxes, GroupTest};
use crate::walk::{Group, failing, group_size, groups, level_of, nearer_first};
use crate::{IdTest, Side};

/// Who goes down: one search, or a batch of receivers.
pub(crate) trait Descent {
    /// Which texels are looked for.
    fn side(&self) -> Side;
    fn ids(&self) -> IdTest;
    /// The columns and rows that can hold an answer.
    fn window(&self) -> [Range<u32>; 2];
    /// Brings what nodes are asked up to date with what is known so far.
    fn narrow(&self, test: &mut GroupTest);
    /// Nodes with greater keys are of no use.
    fn bound(&self) -> f32;
    /// Those of the receivers in `among`, bit i for receiver i, that a node may hold the answer
    /// for: one of the nodes of a group. They alone go into it.
    fn concerned(
        &mut self,
        ops: &impl Ops,
        group: &Group,
        nodes: &NodeGroup,
        lane: u32,
        among: u64,
    ) -> u64;
    /// Lets receivers ask the texels of a leaf.
    fn leaf(&mut self, ops: &impl Ops, group: &Group, nodes: &NodeGroup, lane: u32, concerned: u64);
}

/// A group on the way down, of which some nodes wait to be visited.
#[derive(Clone, Copy)]
struct Frame {
    group: Group,
    /// The bits of the keys of those nodes, which are in the order of the keys, for none of them is
    /// negative, the last of them replaced by the node's number; [`NEVER`] of the others.
    keys: [u32; LANES],
    /// Nodes before this have been visited.
    from: u32,
    /// The receivers that go down here.
    concerned: u64,
}

/// After all keys.
const NEVER: u32 = u32::MAX;
/// The bits of a key that are a node's number.
const NUMBER: u32 = LANES as u32 - 1;

/// The groups on the way down, one for each level.
pub(crate) struct Path([Frame; MAX_LEVELS]);

impl Path {
    pub fn new() -> Self {
        let group = Group { level: 0, x: 0, y: 0, index: 0 };
        Path([Frame { group, keys: [NEVER; LANES], from: 0, concerned: 0 }; MAX_LEVELS])
    }
}

/// Visits all leaves that can hold an answer.
#[inline(always)]
pub(crate) fn descend(
    ops: &impl Ops,
    pyramid: &Pyramid<'_>,
    descent: &mut impl Descent,
    mut test: GroupTest,
    path: &mut Path,
) {
    let [columns, rows] = descent.window();
    if columns.is_empty() || rows.is_empty() {
        return;
    }
    let top = level_of(&pyramid.layout, &columns, &rows);
    let [xs, ys] = groups(&columns, &rows, top);
    let [width, height] = group_size(top);
    let x_order = nearer_first(&xs, &columns, width);
    let y_order = nearer_first(&ys, &rows, height);
    for i in 0..xs.len() * ys.len() {
        let (x, y) = (x_order[i % xs.len() % 3], y_order[i / xs.len() % 3]);
        let mut level = top;
        let group = Group { level, x, y, index: 0 };
        path.0[level] = visit(ops, descent, pyramid, &mut test, group, u64::MAX);
        loop {
            let frame = &mut path.0[level];
            let Some(lane) = next_node(frame, descent.bound()) else {
                level += 1;
                if level > top {
                    break;
                }
                continue;
            };
            let nodes = &pyramid.nodes[frame.group.index];
            let concerned = descent.concerned(ops, &frame.group, nodes, lane, frame.concerned);
            if concerned == 0 {
                continue;
            }
            if level == 0 {
                descent.leaf(ops, &frame.group, nodes, lane, concerned);
            } else {
                let [x, y] = frame.group.node(lane);
                level -= 1;
                let group = Group { level, x, y, index: 0 };
                path.0[level] = visit(ops, descent, pyramid, &mut test, group, concerned);
            }
        }
    }
}

/// Takes the node with the smallest key, if any can still hold an answer.
#[inline(always)]
fn next_node(frame: &mut Frame, bound: f32) -> Option<u32> {
    // Nodes that have been visited come last, for the difference wraps around: nothing is written
    // to the keys, which would have to arrive in memory before they could be read as vectors again.
    let mut least = frame.keys;
    for i in 0..LANES {
        least[i] = least[i].wrapping_sub(frame.from);
    }
    let mut count = LANES / 2;
    while count > 0 {
        for i in 0..count {
            least[i] = if least[i + count] < least[i] { least[i + count] } else { least[i] };
        }
        count /= 2;
    }
    let key = least[0].wrapping_add(frame.from);
    if least[0] > f32::INFINITY.to_bits() | NUMBER || f32::from_bits(key & !NUMBER) > bound {
        return None;
    }
    frame.from = key + 1;
    Some(key & NUMBER)
}

/// The nodes of a group that can hold an answer.
#[inline(always)]
fn visit(
    ops: &impl Ops,
    descent: &impl Descent,
    pyramid: &Pyramid<'_>,
    test: &mut GroupTest,
    group: Group,
    concerned: u64,
) -> Frame {
    let Group { level, x, y, .. } = group;
    let mut frame = Frame { group, keys: [NEVER; LANES], from: 0, concerned };
    let Some(index) = pyramid.layout.group(level, x, y) else { return frame };
    frame.group.index = index;
    descent.narrow(test);
    let verdicts = ops.group(test, &Boxes::of_group(level, x, y), &pyramid.nodes[index]);
    let mut nodes = verdicts.of(descent.side());
    if nodes != 0 {
        nodes &= !failing(ops, pyramid, index, descent.ids());
        for i in 0..LANES {
            let key = verdicts.keys[i];
            // A NaN, which does not bound, comes first.
            let key = if key.is_nan() { 0 } else { key.to_bits() & !NUMBER };
            frame.keys[i] = if nodes >> i & 1 == 1 { key | i as u32 } else { NEVER };
        }
    }
    frame
}
