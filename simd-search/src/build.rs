//! Making the pyramid: planar bounds of texels, the leaves, then of nodes.

use core::ops::Range;

use crate::Map;
use crate::kernels::Ops;
use crate::map::{COLUMNS, ROWS};
use crate::pyramid::{FAN, IdGroup, LANES, LEAF_HEIGHT, LEAF_WIDTH, Layout, NodeGroup};

/// Planar bounds of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub slope: [f32; 2],
    pub low: f32,
    pub high: f32,
}

/// Leaves of a row of a group, which are measured together, and a row of their texels.
pub(crate) const SIDE_BY_SIDE: usize = FAN as usize;
pub(crate) type WideRow = [f32; SIDE_BY_SIDE * COLUMNS];

/// What is measured of the texels of leaves side by side: the range of nearness minus a plane, NaN
/// left out, but then without a lower end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ranges {
    pub low: [f32; SIDE_BY_SIDE],
    pub high: [f32; SIDE_BY_SIDE],
}

impl Ranges {
    /// The ranges of no texels.
    pub const NONE: Ranges =
        Ranges { low: [f32::INFINITY; SIDE_BY_SIDE], high: [f32::NEG_INFINITY; SIDE_BY_SIDE] };

    /// Adds a texel of a leaf that is so far above the plane. Comparisons pass over NaN.
    pub fn add(&mut self, leaf: usize, above: f32) {
        let (low, high) = (&mut self.low[leaf], &mut self.high[leaf]);
        *low = if above < *low { above } else { *low };
        *high = if above > *high { above } else { *high };
    }
}

/// Slopes of leaves side by side, along x and along y.
pub(crate) type Slopes = [[f32; SIDE_BY_SIDE]; 2];

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

    /// Adds a texel that is so far above the plane. Comparisons pass over NaN.
    fn add(&mut self, above: f32) {
        self.low = if above < self.low { above } else { self.low };
        self.high = if above > self.high { above } else { self.high };
    }

    #[inline(always)]
    fn store(self, group: &mut NodeGroup, lane: usize) {
        [group.slope_x[lane], group.slope_y[lane]] = self.slope;
        (group.low[lane], group.high[lane]) = (self.low, self.high);
    }
}

/// The groups of a level whose texels are among the given ones: their columns and rows.
fn groups(level: usize, columns: &Range<u32>, rows: &Range<u32>) -> [Range<u32>; 2] {
    let [width, height] = Layout::node_size(level).map(|size| size * u64::from(FAN));
    let count = |range: &Range<u32>, size: u64| {
        (u64::from(range.start) / size) as u32..u64::from(range.end).div_ceil(size) as u32
    };
    [count(columns, width), count(rows, height)]
}

/// Makes the leaves of a map that depend on the given texels.
#[inline(always)]
pub(crate) fn build_leaves(
    ops: &impl Ops,
    map: Map<'_>,
    nodes: &mut [NodeGroup],
    ids: &mut [IdGroup],
    columns: Range<u32>,
    rows: Range<u32>,
) {
    let [xs, ys] = groups(0, &columns, &rows);
    let mut unpacked = [[0.0; SIDE_BY_SIDE * COLUMNS]; ROWS];
    for y in ys {
        let first = Layout::columns(map.width()) as usize * y as usize;
        // Along whole rows of leaves, which memory likes better than group after group.
        for row in 0..FAN as usize {
            for x in xs.clone() {
                leaves(ops, &map, &mut nodes[first + x as usize], [x, y], row, &mut unpacked);
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
}

/// Makes the nodes above the leaves that depend on the given texels.
#[inline(always)]
pub(crate) fn build_upper(
    layout: &Layout,
    nodes: &mut [NodeGroup],
    ids: &mut [IdGroup],
    columns: Range<u32>,
    rows: Range<u32>,
) {
    for level in 1..layout.count {
        let [xs, ys] = groups(level, &columns, &rows);
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
fn leaves(
    ops: &impl Ops,
    map: &Map<'_>,
    group: &mut NodeGroup,
    [x, y]: [u32; 2],
    row: usize,
    unpacked: &mut [WideRow; ROWS],
) {
    let first = row * FAN as usize;
    let (left, top, _, rows) = leaf_box(map, x, y, first);
    if rows == LEAF_HEIGHT && map.width().saturating_sub(left) >= FAN * LEAF_WIDTH {
        let rows = map.block(left, top, unpacked);
        let slopes = slopes(&rows);
        let ranges = ops.leaves(&rows, &slopes);
        let lanes = first..first + SIDE_BY_SIDE;
        group.slope_x[lanes.clone()].copy_from_slice(&slopes[0]);
        group.slope_y[lanes.clone()].copy_from_slice(&slopes[1]);
        group.low[lanes.clone()].copy_from_slice(&ranges.low);
        group.high[lanes].copy_from_slice(&ranges.high);
        return;
    }
    for lane in first..first + SIDE_BY_SIDE {
        let bounds = match leaf_box(map, x, y, lane) {
            (_, _, 0, _) | (_, _, _, 0) => Bounds::NONE,
            (left, top, columns, rows) => cut_leaf(map, left, top, columns, rows),
        };
        bounds.store(group, lane);
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

/// The bounds of a leaf that may be cut off by the map's border, one texel after another.
fn cut_leaf(map: &Map<'_>, left: u32, top: u32, columns: u32, rows: u32) -> Bounds {
    let (x, y) = (columns / 2, rows / 2);
    let texel = |x: u32, y: u32| map.nearness(left + x, top + y);
    let middle = texel(x, y);
    let along_x = [texel(0, y), texel(columns - 1, y)];
    let along_y = [texel(x, 0), texel(x, rows - 1)];
    let slope =
        [slope_along(along_x, middle, x, columns - 1), slope_along(along_y, middle, y, rows - 1)];
    let mut bounds = Bounds { slope, ..Bounds::NONE };
    let mut nan = false;
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (FIRST[0] + column as f32, FIRST[1] + row as f32);
            let nearness = texel(column, row);
            bounds.add(nearness - (slope[0] * x + slope[1] * y));
            nan |= nearness.is_nan();
        }
    }
    if nan { Bounds { low: f32::NEG_INFINITY, ..bounds } } else { bounds }
}

/// The slopes of whole leaves, along their middle rows and columns.
#[inline(always)]
fn slopes(rows: &[&WideRow; ROWS]) -> Slopes {
    let each = |row: usize, x: usize| {
        let texel = |leaf: usize| rows[row][leaf * COLUMNS + x];
        [texel(0), texel(1), texel(2), texel(3)]
    };
    let middle = each(ROWS / 2, COLUMNS / 2);
    let [left, right] = [each(ROWS / 2, 0), each(ROWS / 2, COLUMNS - 1)];
    let [top, bottom] = [each(0, COLUMNS / 2), each(ROWS - 1, COLUMNS / 2)];
    let mut slopes = [[0.0; SIDE_BY_SIDE]; 2];
    for i in 0..SIDE_BY_SIDE {
        let along_x = [left[i], right[i]];
        let along_y = [top[i], bottom[i]];
        slopes[0][i] = slope_along(along_x, middle[i], LEAF_WIDTH / 2, LEAF_WIDTH - 1);
        slopes[1][i] = slope_along(along_y, middle[i], LEAF_HEIGHT / 2, LEAF_HEIGHT - 1);
    }
    slopes
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

/// The bounds of a node of `level`, from its children, without room for rounding.
#[inline(always)]
fn parent(children: &NodeGroup, level: usize) -> Bounds {
    let flat = bounds_along(children, level, [0.0; 2]);
    let planar = bounds_along(children, level, [children.slope_x[0], children.slope_y[0]]);
    if planar.high - planar.low < flat.high - flat.low { planar } else { flat }
}

/// The bounds of a node of `level` with the given slope, from its children.
#[inline(always)]
fn bounds_along(children: &NodeGroup, level: usize, slope: [f32; 2]) -> Bounds {
    let [width, height] = Layout::node_size(level - 1).map(|size| size as f32);
    let half = [(width - 1.0) * 0.5, (height - 1.0) * 0.5];
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
    let low = fold(low, |a, b| if a < b { a } else { b });
    Bounds { slope, low, high: fold(high, |a, b| if a > b { a } else { b }) }
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
