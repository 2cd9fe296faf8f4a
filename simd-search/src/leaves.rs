//! The leaves of a pyramid: planar bounds of 16 x 8 texels.

use core::ops::Range;

use crate::Map;
use crate::build::{Bounds, groups, id_leaves, make_room};
use crate::kernels::Ops;
use crate::map::{COLUMNS, ROWS, Row};
use crate::pyramid::{FAN, IdGroup, LEAF_HEIGHT, LEAF_WIDTH, Layout, NodeGroup};

/// Leaves that are measured together, at most: a row of those of four groups.
pub(crate) const SIDE_BY_SIDE: usize = GROUPS * FAN as usize;
const GROUPS: usize = 4;
/// A number for each of them.
pub(crate) type Each = [f32; SIDE_BY_SIDE];

/// The texels of leaves side by side.
pub(crate) struct Tiles<'a> {
    pub rows: [&'a [Row; SIDE_BY_SIDE]; ROWS],
    /// How many there are; the others hold anything.
    pub count: usize,
}

/// Planes through the centres of leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slopes {
    pub x: Each,
    pub y: Each,
    /// What they gain from the centre to the rows below it.
    pub down: [Each; ROWS / 2],
}

impl Slopes {
    const FLAT: Slopes = Slopes {
        x: [0.0; SIDE_BY_SIDE],
        y: [0.0; SIDE_BY_SIDE],
        down: [[0.0; SIDE_BY_SIDE]; ROWS / 2],
    };
}

/// What is measured of the texels of leaves: the range of nearness minus a plane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ranges {
    pub low: Each,
    pub high: Each,
    /// Bit i: leaf i holds a NaN, and its range means nothing.
    pub unknown: u32,
}

/// The centre of a leaf's first texel seen from its own centre.
pub(crate) const FIRST: [f32; 2] =
    [-0.5 * (LEAF_WIDTH - 1) as f32, -0.5 * (LEAF_HEIGHT - 1) as f32];

/// Slopes beyond this are not followed, so that no product overflows.
const STEEPEST: f32 = 1e20;

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
    let mut copied = [[[0.0; COLUMNS]; SIDE_BY_SIDE]; ROWS];
    for y in ys {
        let first = Layout::columns(map.width()) as usize * y as usize;
        let range = first + xs.start as usize..first + xs.end as usize;
        let groups = &mut nodes[range.clone()];
        // Along whole rows of leaves, which memory likes better than group after group.
        for row in 0..FAN {
            for (x, groups) in xs.clone().step_by(GROUPS).zip(groups.chunks_mut(GROUPS)) {
                leaves(ops, &map, groups, [x * FAN, y * FAN + row], &mut copied);
            }
        }
        for group in groups {
            make_room(group, 0);
        }
        for (x, group) in xs.clone().zip(ids.get_mut(range).unwrap_or_default()) {
            id_leaves(&map, group, x, y);
        }
    }
}

/// A row of the leaves of up to four groups, of which (x, y) is the first, without room for
/// rounding.
#[inline(always)]
fn leaves(
    ops: &impl Ops,
    map: &Map<'_>,
    groups: &mut [NodeGroup],
    [x, y]: [u32; 2],
    copied: &mut [[Row; SIDE_BY_SIDE]; ROWS],
) {
    let row = (y % FAN) as usize;
    let count = groups.len() * FAN as usize;
    let whole = whole_leaves(map, x, y).min(count);
    let mut one_by_one = u32::MAX << whole & !(u32::MAX << count);
    if whole > 0 {
        let rows = map.tiles(x * LEAF_WIDTH, y * LEAF_HEIGHT, whole, copied);
        let tiles = Tiles { rows, count: whole };
        let slopes = slopes_of(&tiles);
        let ranges = ops.leaves(&tiles, &slopes);
        one_by_one |= ranges.unknown;
        store(groups, row, &slopes, &ranges);
    }
    while one_by_one != 0 {
        let leaf = one_by_one.trailing_zeros();
        let lane = row * FAN as usize + (leaf % FAN) as usize;
        one_leaf(map, x + leaf, y).store(&mut groups[(leaf / FAN) as usize], lane);
        one_by_one &= one_by_one - 1;
    }
}

/// Stores a row of leaves of groups side by side.
#[inline(always)]
fn store(groups: &mut [NodeGroup], row: usize, slopes: &Slopes, ranges: &Ranges) {
    let lanes = row * FAN as usize..(row + 1) * FAN as usize;
    for (i, group) in groups.iter_mut().enumerate().take(GROUPS) {
        let leaves = i * FAN as usize..(i + 1) * FAN as usize;
        group.slope_x[lanes.clone()].copy_from_slice(&slopes.x[leaves.clone()]);
        group.slope_y[lanes.clone()].copy_from_slice(&slopes.y[leaves.clone()]);
        group.low[lanes.clone()].copy_from_slice(&ranges.low[leaves.clone()]);
        group.high[lanes.clone()].copy_from_slice(&ranges.high[leaves]);
    }
}

/// How many leaves from (x, y) on lie side by side in the map with all their texels.
#[inline(always)]
fn whole_leaves(map: &Map<'_>, x: u32, y: u32) -> usize {
    let (columns, rows) = (map.width() / LEAF_WIDTH, map.height() / LEAF_HEIGHT);
    if y < rows { columns.saturating_sub(x) as usize } else { 0 }
}

/// The texels of a leaf that lie in the map: first column and row, and how many.
#[inline(always)]
pub(crate) fn leaf_box(map: &Map<'_>, x: u32, y: u32) -> (u32, u32, u32, u32) {
    let (left, top) = (u64::from(x) * u64::from(LEAF_WIDTH), u64::from(y) * u64::from(LEAF_HEIGHT));
    let columns = u64::from(map.width()).saturating_sub(left).min(u64::from(LEAF_WIDTH));
    let rows = u64::from(map.height()).saturating_sub(top).min(u64::from(LEAF_HEIGHT));
    (left as u32, top as u32, columns as u32, rows as u32)
}

/// The bounds of a leaf, one texel after another: one that may be cut off by the map's border, or
/// hold a NaN. Those are left out, but then there is no lower bound.
#[cold]
fn one_leaf(map: &Map<'_>, x: u32, y: u32) -> Bounds {
    let (left, top, columns, rows) = leaf_box(map, x, y);
    if columns == 0 || rows == 0 {
        return Bounds::NONE;
    }
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
            bounds.add((nearness - slope[1] * y) - slope[0] * x);
            nan |= nearness.is_nan();
        }
    }
    if nan { Bounds { low: f32::NEG_INFINITY, ..bounds } } else { bounds }
}

/// The slopes of whole leaves, along their middle rows and columns.
#[inline(always)]
fn slopes_of(tiles: &Tiles<'_>) -> Slopes {
    let rows = &tiles.rows;
    let across = rows[ROWS / 2];
    let [left, right] = [column(across, 0), column(across, COLUMNS - 1)];
    let middle = column(across, COLUMNS / 2);
    let [top, bottom] = [column(rows[0], COLUMNS / 2), column(rows[ROWS - 1], COLUMNS / 2)];
    let mut slopes = Slopes::FLAT;
    for i in 0..SIDE_BY_SIDE {
        let along_x = [left[i], right[i]];
        let along_y = [top[i], bottom[i]];
        slopes.x[i] = slope_along(along_x, middle[i], LEAF_WIDTH / 2, LEAF_WIDTH - 1);
        slopes.y[i] = slope_along(along_y, middle[i], LEAF_HEIGHT / 2, LEAF_HEIGHT - 1);
    }
    for row in 0..ROWS / 2 {
        for i in 0..SIDE_BY_SIDE {
            slopes.down[row][i] = slopes.y[i] * (0.5 + row as f32);
        }
    }
    slopes
}

/// One texel of each tile of a row.
#[inline(always)]
fn column(row: &[Row; SIDE_BY_SIDE], column: usize) -> Each {
    let mut texels = [0.0; SIDE_BY_SIDE];
    for i in 0..SIDE_BY_SIDE {
        texels[i] = row[i][column];
    }
    texels
}

/// The slope from the first to the last texel of a line, if both of its halves roughly have it.
/// Else there is an edge, or no slope to speak of, and bounds are better flat.
#[inline(always)]
fn slope_along([first, last]: [f32; 2], middle: f32, before: u32, length: u32) -> f32 {
    let (rise, total) = (middle - first, last - first);
    let slope = total * (1.0 / length.max(1) as f32);
    // False for NaN.
    let agrees = (rise - slope * before as f32).abs() <= 0.25 * total.abs();
    if agrees && slope.abs() < STEEPEST { slope } else { 0.0 }
}
