//! Making the pyramid: planar bounds of texels, then of nodes.

use core::ops::Range;

use crate::Map;
use crate::kernels::Ops;
use crate::map::COLUMNS;
use crate::pyramid::{FAN, IdGroup, LANES, LEAF_HEIGHT, LEAF_WIDTH, Layout, NodeGroup};

/// Planar bounds of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub slope: [f32; 2],
    pub low: f32,
    pub high: f32,
}

/// What is measured of the texels of a leaf: the range of nearness minus a plane, NaN left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ranges {
    pub low: f32,
    pub high: f32,
    /// Whether there is a NaN.
    pub nan: bool,
}

/// The centre of a leaf's first texel seen from its own centre.
pub(crate) const FIRST: [f32; 2] =
    [-0.5 * (LEAF_WIDTH - 1) as f32, -0.5 * (LEAF_HEIGHT - 1) as f32];

/// Slopes beyond this are not followed, so that no product overflows.
const STEEPEST: f32 = 1e20;

/// Room for rounding, in the bounds themselves and where they are compared with a plane.
const ROOM: f32 = 1.0 / 1048576.0;

impl Bounds {
    /// Bounds of nothing.
    const NONE: Bounds = Bounds { slope: [0.0; 2], low: f32::INFINITY, high: f32::NEG_INFINITY };

    #[inline(always)]
    fn store(self, group: &mut NodeGroup, lane: usize) {
        [group.slope_x[lane], group.slope_y[lane]] = self.slope;
        (group.low[lane], group.high[lane]) = (self.low, self.high);
    }
}

/// Makes the part of the pyramid that depends on the given texels.
#[inline(always)]
pub(crate) fn build(
    ops: &impl Ops,
    map: Map<'_>,
    layout: &Layout,
    nodes: &mut [NodeGroup],
    ids: &mut [IdGroup],
    columns: Range<u32>,
    rows: Range<u32>,
) {
    let groups = |level: usize| {
        let [width, height] = Layout::node_size(level).map(|size| size * u64::from(FAN));
        let count = |range: &Range<u32>, size: u64| {
            (u64::from(range.start) / size) as u32..u64::from(range.end).div_ceil(size) as u32
        };
        (count(&columns, width), count(&rows, height))
    };
    let (xs, ys) = groups(0);
    for y in ys {
        let first = layout.levels[0].columns as usize * y as usize;
        // Along whole rows of leaves, which memory likes better than group after group.
        for row in 0..FAN as usize {
            for x in xs.clone() {
                leaves(ops, &map, &mut nodes[first + x as usize], x, y, row);
            }
        }
        for x in xs.clone() {
            make_room(&mut nodes[first + x as usize], 0);
        }
        for x in xs.clone() {
            if let Some(group) = ids.get_mut(first + x as usize) {
                id_leaves(&map, group, x, y);
            }
        }
    }
    for level in 1..layout.count {
        let (xs, ys) = groups(level);
        let first = layout.levels[level].first;
        let (lower, upper) = nodes.split_at_mut(first);
        for y in ys {
            for x in xs.clone() {
                let index = layout.levels[level].columns as usize * y as usize + x as usize;
                let child =
                    |lane: u32| layout.group(level - 1, x * FAN + lane % FAN, y * FAN + lane / FAN);
                for lane in 0..LANES as u32 {
                    let bounds = match child(lane) {
                        Some(child) => parent(&lower[child], level),
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
fn make_room(group: &mut NodeGroup, level: usize) {
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

/// The four leaves of a row of a group, without room for rounding.
#[inline(always)]
fn leaves(ops: &impl Ops, map: &Map<'_>, group: &mut NodeGroup, x: u32, y: u32, row: usize) {
    for lane in row * FAN as usize..(row + 1) * FAN as usize {
        let (left, top, columns, rows) = leaf_box(map, x, y, lane);
        if columns == 0 || rows == 0 {
            Bounds::NONE.store(group, lane);
            continue;
        }
        let (slope, ranges) = if columns == LEAF_WIDTH && rows == LEAF_HEIGHT {
            map.with_tile(left, top, |rows| {
                let texel = |x: u32, y: u32| rows[y as usize][x as usize];
                let slope = leaf_slope(LEAF_WIDTH, LEAF_HEIGHT, texel);
                (slope, ops.leaf(rows, slope))
            })
        } else {
            let slope = leaf_slope(columns, rows, |x, y| map.nearness(left + x, top + y));
            (slope, ranges(map, left, top, columns, rows, slope))
        };
        let low = if ranges.nan { f32::NEG_INFINITY } else { ranges.low };
        Bounds { slope, low, high: ranges.high }.store(group, lane);
    }
}

/// The texels of a leaf that lie in the map: first column and row, and how many.
#[inline(always)]
fn leaf_box(map: &Map<'_>, x: u32, y: u32, lane: usize) -> (u32, u32, u32, u32) {
    let left = u64::from(x * FAN + lane as u32 % FAN) * u64::from(LEAF_WIDTH);
    let top = u64::from(y * FAN + lane as u32 / FAN) * u64::from(LEAF_HEIGHT);
    let columns = u64::from(map.width()).saturating_sub(left).min(u64::from(LEAF_WIDTH));
    let rows = u64::from(map.height()).saturating_sub(top).min(u64::from(LEAF_HEIGHT));
    (left as u32, top as u32, columns as u32, rows as u32)
}

/// The slope along the middle row and column of a leaf, whose texel (x, y) is `texel(x, y)`.
#[inline(always)]
fn leaf_slope(columns: u32, rows: u32, texel: impl Fn(u32, u32) -> f32) -> [f32; 2] {
    let (x, y) = (columns / 2, rows / 2);
    let middle = texel(x, y);
    let along_x = [texel(0, y), texel(columns - 1, y)];
    let along_y = [texel(x, 0), texel(x, rows - 1)];
    [slope_along(along_x, middle, x, columns - 1), slope_along(along_y, middle, y, rows - 1)]
}

/// The slope from the first to the last texel of a line, if both of its halves roughly have it.
/// Else there is an edge, or no slope to speak of, and bounds are better flat.
#[inline(always)]
fn slope_along([first, last]: [f32; 2], middle: f32, before: u32, length: u32) -> f32 {
    let (rise, total) = (middle - first, last - first);
    let slope = total / length.max(1) as f32;
    // False for NaN.
    let agrees = (rise - slope * before as f32).abs() <= 0.25 * total.abs();
    if agrees && slope.abs() < STEEPEST { slope } else { 0.0 }
}

/// The ranges of a leaf that the map cuts off, one texel after another.
#[inline(always)]
fn ranges(map: &Map<'_>, left: u32, top: u32, columns: u32, rows: u32, slope: [f32; 2]) -> Ranges {
    let mut ranges = Ranges::NONE;
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (FIRST[0] + column as f32, FIRST[1] + row as f32);
            let plane = slope[0] * x + slope[1] * y;
            ranges.add(map.nearness(left + column, top + row), plane);
        }
    }
    ranges
}

impl Ranges {
    /// The ranges of no texels.
    pub const NONE: Ranges = Ranges { low: f32::INFINITY, high: f32::NEG_INFINITY, nan: false };

    /// Adds a texel and the plane there. Comparisons pass over NaN.
    #[inline(always)]
    pub fn add(&mut self, nearness: f32, plane: f32) {
        let above = nearness - plane;
        self.low = if above < self.low { above } else { self.low };
        self.high = if above > self.high { above } else { self.high };
        self.nan |= nearness.is_nan();
    }
}

/// The bounds of a node of `level`, from its children, without room for rounding.
#[inline(always)]
fn parent(children: &NodeGroup, level: usize) -> Bounds {
    let [width, height] = Layout::node_size(level - 1).map(|size| size as f32);
    let half = [(width - 1.0) * 0.5, (height - 1.0) * 0.5];
    let range = |slope: [f32; 2]| {
        let (mut low, mut high) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let x = ((i as u32 % FAN) as f32 - 0.5 * (FAN - 1) as f32) * width;
            let y = ((i as u32 / FAN) as f32 - 0.5 * (FAN - 1) as f32) * height;
            let plane = slope[0] * x + slope[1] * y;
            let spread = (children.slope_x[i] - slope[0]).abs() * half[0]
                + (children.slope_y[i] - slope[1]).abs() * half[1];
            low[i] = (children.low[i] - spread) - plane;
            high[i] = (children.high[i] + spread) - plane;
        }
        [fold(low, f32::min), fold(high, f32::max)]
    };
    let slope = [children.slope_x[0], children.slope_y[0]];
    let (flat, planar) = (range([0.0; 2]), range(slope));
    let (slope, [low, high]) =
        if planar[1] - planar[0] < flat[1] - flat[0] { (slope, planar) } else { ([0.0; 2], flat) };
    Bounds { slope, low, high }
}

/// All lanes combined by a commutative and associative operation.
#[inline(always)]
fn fold(lanes: [f32; LANES], combine: impl Fn(f32, f32) -> f32) -> f32 {
    let mut lanes = lanes;
    let mut count = LANES / 2;
    while count > 0 {
        for i in 0..count {
            lanes[i] = combine(lanes[i], lanes[i + count]);
        }
        count /= 2;
    }
    lanes[0]
}

/// The ID marks of the 16 leaves of a group.
#[inline(always)]
fn id_leaves(map: &Map<'_>, group: &mut IdGroup, x: u32, y: u32) {
    *group = IdGroup::default();
    for lane in 0..LANES {
        let (left, top, columns, rows) = leaf_box(map, x, y, lane);
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
