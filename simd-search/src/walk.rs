//! Visiting all nodes that receivers can reach, from large to small.

use core::ops::Range;

use crate::IdTest;
use crate::kernels::Ops;
use crate::naive::reach as span;
use crate::pyramid::{FAN, Layout, MAX_LEVELS, Pyramid};
use crate::reach::{Boxes, GroupTest, Reach, Verdicts};

/// Beyond this many columns or rows, `f32` no longer holds texel centres exactly, which bounds on
/// distance rely on: such maps are searched without the pyramid.
pub(crate) const EXACT_EXTENT: u32 = 1 << 22;

/// A group of 16 nodes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Group {
    pub level: usize,
    pub x: u32,
    pub y: u32,
    /// Where it is stored.
    pub index: usize,
}

impl Group {
    /// The place of a node among all of its level.
    #[inline(always)]
    pub fn node(&self, lane: u32) -> [u32; 2] {
        [self.x * FAN + lane % FAN, self.y * FAN + lane / FAN]
    }
}

/// Calls `visit` with every group that receivers reach; it returns the nodes whose children are
/// to be visited next, or `None` to stop. False if it was stopped.
#[inline(always)]
pub(crate) fn walk(
    ops: &impl Ops,
    pyramid: &Pyramid<'_>,
    reach: &Reach,
    test: &GroupTest,
    mut visit: impl FnMut(&Group, &Verdicts) -> Option<u32>,
) -> bool {
    let layout = &pyramid.layout;
    let radius = reach.radius + 1.0; // Jitter moves texels by less.
    let around =
        |[from, to]: [f32; 2], size| span(from, radius, size).start..span(to, radius, size).end;
    let (columns, rows) = (around(reach.u, layout.width), around(reach.v, layout.height));
    let top = level_of(layout, &columns, &rows);
    let mut path = [(Group::default(), 0); MAX_LEVELS];
    let [xs, ys] = groups(&columns, &rows, top);
    for y in ys {
        for x in xs.clone() {
            let (mut level, mut next) = (top, [x, y]);
            loop {
                // Down to the group at `next`, then on to the next child that waits.
                let [x, y] = next;
                let mut waiting = 0;
                let mut group = Group { level, x, y, index: 0 };
                if let Some(index) = layout.group(level, x, y) {
                    group.index = index;
                    let boxes = Boxes::of_group(level, x, y);
                    let verdicts = ops.group(test, &boxes, &pyramid.nodes[index]);
                    match visit(&group, &verdicts) {
                        Some(nodes) => waiting = nodes,
                        None => return false,
                    }
                }
                path[level] = (group, waiting);
                while level < top && path[level].1 == 0 {
                    level += 1;
                }
                let (group, waiting) = &mut path[level];
                if *waiting == 0 || level == 0 {
                    break;
                }
                next = group.node(waiting.trailing_zeros());
                *waiting &= *waiting - 1;
                level -= 1;
            }
        }
    }
    true
}

/// The groups of a level that a box of texels meets: their columns and rows.
#[inline(always)]
pub(crate) fn groups(columns: &Range<u32>, rows: &Range<u32>, level: usize) -> [Range<u32>; 2] {
    if columns.is_empty() || rows.is_empty() {
        return [0..0, 0..0];
    }
    let [width, height] = group_size(level);
    let past = |range: &Range<u32>, size: u32| (range.end - 1) / size + 1;
    [columns.start / width..past(columns, width), rows.start / height..past(rows, height)]
}

/// The one to three numbers of a range, those closer to the middle of the texels that they are the
/// groups of first.
#[inline(always)]
pub(crate) fn nearer_first(groups: &Range<u32>, texels: &Range<u32>, size: u32) -> [u32; 3] {
    let first = (texels.start + (texels.end - texels.start) / 2) / size - groups.start;
    let (second, third) = [(1, 2), (0, 2), (1, 0)][first as usize % 3];
    [groups.start + first, groups.start + second, groups.start + third]
}

/// The level whose groups are at least as wide as a box, and half as high: it meets at most six of
/// them.
#[inline(always)]
pub(crate) fn level_of(layout: &Layout, columns: &Range<u32>, rows: &Range<u32>) -> usize {
    let mut level = 0;
    while level + 1 < layout.count {
        let [width, height] = group_size(level);
        if width as usize >= columns.len() && 2 * height as usize >= rows.len() {
            break;
        }
        level += 1;
    }
    level
}

/// Texels per group of a level, along each axis.
#[inline(always)]
pub(crate) fn group_size(level: usize) -> [u32; 2] {
    let [width, height] = Layout::node_size(level);
    let group = |size: u64| (size * u64::from(FAN)).min(1 << 31) as u32;
    [group(width), group(height)]
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
