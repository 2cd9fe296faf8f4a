//! Making the pyramid above its leaves: planar bounds of nodes.

use core::ops::Range;

use crate::Map;
use crate::kernels::Ops;
use crate::leaves::leaf_box;
use crate::map::COLUMNS;
use crate::pyramid::{FAN, IdGroup, LANES, LEAF_WIDTH, Layout, NodeGroup};

/// Planar bounds of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub slope: [f32; 2],
    pub low: f32,
    pub high: f32,
}

/// Room for rounding, in the bounds themselves and where they are compared with a plane.
const ROOM: f32 = 1.0 / 1048576.0;

impl Bounds {
    /// Bounds of nothing.
    pub const NONE: Bounds =
        Bounds { slope: [0.0; 2], low: f32::INFINITY, high: f32::NEG_INFINITY };

    /// Adds a texel that is so far above the plane. Comparisons pass over NaN.
    pub fn add(&mut self, above: f32) {
        self.low = if above < self.low { above } else { self.low };
        self.high = if above > self.high { above } else { self.high };
    }

    #[inline(always)]
    pub fn store(self, group: &mut NodeGroup, lane: usize) {
        [group.slope_x[lane], group.slope_y[lane]] = self.slope;
        (group.low[lane], group.high[lane]) = (self.low, self.high);
    }
}

/// Where the children of a node are: their centres as seen from its own, and how far a child's
/// outermost texels are from the child's centre.
pub(crate) struct Family {
    pub x: [f32; LANES],
    pub y: [f32; LANES],
    pub half: [f32; 2],
}

impl Family {
    /// That of the nodes of `level`.
    fn of(level: usize) -> Family {
        let [width, height] = Layout::node_size(level - 1).map(|size| size as f32);
        let half = [(width - 1.0) * 0.5, (height - 1.0) * 0.5];
        let mut family = Family { x: [0.0; LANES], y: [0.0; LANES], half };
        for i in 0..LANES {
            family.x[i] = ((i as u32 % FAN) as f32 - 0.5 * (FAN - 1) as f32) * width;
            family.y[i] = ((i as u32 / FAN) as f32 - 0.5 * (FAN - 1) as f32) * height;
        }
        family
    }

    /// The slopes that a node may have: none, and that of its first child.
    #[inline(always)]
    pub fn slopes(children: &NodeGroup) -> [[f32; 2]; 2] {
        [[0.0; 2], [children.slope_x[0], children.slope_y[0]]]
    }
}

/// The groups of a level whose texels are among the given ones: their columns and rows.
pub(crate) fn groups(level: usize, columns: &Range<u32>, rows: &Range<u32>) -> [Range<u32>; 2] {
    let [width, height] = Layout::node_size(level).map(|size| size * u64::from(FAN));
    let count = |range: &Range<u32>, size: u64| {
        (u64::from(range.start) / size) as u32..u64::from(range.end).div_ceil(size) as u32
    };
    [count(columns, width), count(rows, height)]
}

/// Makes the nodes above the leaves that depend on the given texels.
#[inline(always)]
pub(crate) fn build_upper(
    ops: &impl Ops,
    layout: &Layout,
    nodes: &mut [NodeGroup],
    ids: &mut [IdGroup],
    columns: Range<u32>,
    rows: Range<u32>,
) {
    for level in 1..layout.count {
        let [xs, ys] = groups(level, &columns, &rows);
        let first = layout.levels[level].first;
        let family = Family::of(level);
        let (lower, upper) = nodes.split_at_mut(first);
        for y in ys {
            for x in xs.clone() {
                let index = layout.levels[level].columns as usize * y as usize + x as usize;
                let child =
                    |lane: u32| layout.group(level - 1, x * FAN + lane % FAN, y * FAN + lane / FAN);
                for lane in 0..LANES as u32 {
                    let bounds = match child(lane) {
                        Some(child) => parent(ops, &lower[child], &family),
                        None => Bounds::NONE,
                    };
                    bounds.store(&mut upper[index], lane as usize);
                }
                make_room(&mut upper[index], level);
                if !ids.is_empty() {
                    let (lower, upper) = ids.split_at_mut(first);
                    upper[index] = IdGroup::default();
                    for lane in 0..LANES as u32 {
                        match child(lane) {
                            Some(child) => {
                                id_parent(&lower[child], &mut upper[index], lane as usize)
                            }
                            None => absent(&mut upper[index], lane as usize),
                        }
                    }
                }
            }
        }
    }
}

/// Widens the bounds of 16 nodes of `level` by room for rounding.
#[inline(always)]
pub(crate) fn make_room(group: &mut NodeGroup, level: usize) {
    let half = Layout::node_size(level).map(|size| (size as f32 - 1.0) * 0.5);
    for i in 0..LANES {
        let steep = group.slope_x[i].abs() * half[0] + group.slope_y[i].abs() * half[1];
        let (low, high) = (group.low[i], group.high[i]);
        // Infinities stay what they are. Adding 0 last makes every zero positive, whichever came
        // first.
        let room = [low, high].map(|bound| ROOM * (bound.abs() + steep));
        let low = if low.is_finite() { low - room[0] } else { low };
        let high = if high.is_finite() { high + room[1] } else { high };
        (group.low[i], group.high[i]) = (low + 0.0, high + 0.0);
    }
}

/// The bounds of a node, from its children, without room for rounding.
#[inline(always)]
fn parent(ops: &impl Ops, children: &NodeGroup, family: &Family) -> Bounds {
    let [flat, planar] = ops.parent(children, family);
    if planar.high - planar.low < flat.high - flat.low { planar } else { flat }
}

/// The ID marks of the 16 leaves of a group.
#[inline(always)]
pub(crate) fn id_leaves(map: &Map<'_>, group: &mut IdGroup, x: u32, y: u32) {
    *group = IdGroup::default();
    for lane in 0..LANES {
        let (left, top, columns, rows) =
            leaf_box(map, x * FAN + lane as u32 % FAN, y * FAN + lane as u32 / FAN);
        if columns == 0 || rows == 0 {
            absent(group, lane);
            continue;
        }
        let id = map.id(left, top);
        let mut differ = 0;
        if columns == LEAF_WIDTH {
            let mut bits = [0; COLUMNS];
            for y in top..top + rows {
                for (bits, other) in bits.iter_mut().zip(map.row_of_ids(left, y)) {
                    *bits |= other ^ id;
                }
            }
            differ = bits.into_iter().fold(0, |all, bits| all | bits);
        } else {
            for y in top..top + rows {
                for x in left..left + columns {
                    differ |= map.id(x, y) ^ id;
                }
            }
        }
        group.id[lane] = id;
        group.single |= u32::from(differ == 0) << lane;
    }
}

/// The ID mark of a node, from its children.
#[inline(always)]
fn id_parent(children: &IdGroup, group: &mut IdGroup, lane: usize) {
    let id = children.id[0];
    let mut single = true;
    for i in 0..LANES {
        single &= children.single >> i & 1 == 1 && children.id[i] == id;
    }
    group.id[lane] = id;
    group.single |= u32::from(single) << lane;
}

/// The ID mark of a node beyond the map's border: like that of child 0, which is never beyond it.
#[inline(always)]
fn absent(group: &mut IdGroup, lane: usize) {
    group.id[lane] = group.id[0];
    group.single |= 1 << lane;
}
