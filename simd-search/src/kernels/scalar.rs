//! The kernels in plain Rust: what all others must equal bit for bit.

use crate::build::{Bounds, Family};
use crate::kernels::{Job, Kernels, Ops};
use crate::leaf::{Candidate, Leaf, Node, SiftTest, Tile};
use crate::leaves::{FIRST, Ranges, Slopes, Tiles};
use crate::map::{COLUMNS, ROWS, Row};
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{Boxes, GroupTest, Verdicts};
use crate::receivers::Seekers;
use crate::search::{RATIO_ROOM, TileTest};

pub(crate) fn run(job: Job<'_>) {
    job.run(&kernels());
}

/// The kernels themselves.
#[inline(always)]
pub(crate) fn kernels() -> impl Ops {
    Kernels { tile, sift, equal, group, leaves, parent, concerned, matters, ask_tile, ask }
}

fn tile(test: &TileTest, rows: [&Row; ROWS]) -> u128 {
    let mut all = 0;
    for row in 0..ROWS {
        let mut found = 0;
        for (column, &nearness) in rows[row].iter().enumerate() {
            let dx = (test.first + column as f32) - test.u;
            let plane = test.nearness + (test.slope[0] * dx + test.rise[row]);
            let blocks = nearness > plane + test.offset;
            let distance = dx * dx + test.dy_squared[row];
            let mut near = distance <= test.reach_squared;
            if let Some(key) = test.ratio {
                let nearer = nearness - test.nearness;
                let beyond = distance > (key * RATIO_ROOM) * (nearer * nearer);
                near = near && nearer > 0.0 && !beyond;
            }
            found |= u16::from(near && blocks != test.lit) << column;
        }
        all |= u128::from(found) << (COLUMNS * row);
    }
    all
}

fn sift(test: &SiftTest, rows: [&Row; ROWS]) -> [u128; 2] {
    let [mut may, mut sure] = [0; 2];
    for row in 0..ROWS {
        for (column, &nearness) in rows[row].iter().enumerate() {
            let x = test.first + column as f32;
            let dx = x - test.u;
            let (rise, margin) = (test.slope * dx, test.spread * dx.abs());
            let blocks_some = nearness > (rise - margin) + test.lower[row];
            let blocks_all = nearness > (rise + margin) + test.upper[row];
            let gap = gap(x, x, test.from, test.to);
            if gap * gap + test.dy_squared[row] <= test.reach_squared {
                let [some, all] =
                    if test.lit { [!blocks_all, !blocks_some] } else { [blocks_some, blocks_all] };
                may |= u128::from(some) << (COLUMNS * row + column);
                sure |= u128::from(all) << (COLUMNS * row + column);
            }
        }
    }
    [may, sure]
}

/// How far something from `low` to `high` is from receivers between `from` and `to`.
fn gap(low: f32, high: f32, from: f32, to: f32) -> f32 {
    let (before, after) = (low - to, from - high);
    let gap = if before > after { before } else { after };
    if gap > 0.0 { gap } else { 0.0 }
}

fn equal(numbers: &[u32; LANES], number: u32) -> u32 {
    (0..LANES).fold(0, |found, i| found | u32::from(numbers[i] == number) << i)
}

fn group(test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
    let mut verdicts = Verdicts { may_block: 0, may_be_lit: 0, keys: [0.0; LANES] };
    let plane = test.plane;
    for i in 0..LANES {
        let dx = gap(boxes.left[i], boxes.right[i], test.from[0], test.to[0]);
        let dy = gap(boxes.top[i], boxes.bottom[i], test.from[1], test.to[1]);
        let distance = dx * dx + dy * dy;
        let from_u = (boxes.left[i] + boxes.right[i]) * 0.5 - plane.u;
        let from_v = (boxes.top[i] + boxes.bottom[i]) * 0.5 - plane.v;
        let at_center = plane.nearness + (plane.slope.x * from_u + plane.slope.y * from_v);
        let half_x = (boxes.right[i] - boxes.left[i]) * 0.5;
        let half_y = (boxes.bottom[i] - boxes.top[i]) * 0.5;
        let tilt = |x: f32, y: f32| x * half_x + y * half_y;
        let steeper_x = (nodes.slope_x[i] - plane.slope.x).abs() + test.spread.x;
        let steeper_y = (nodes.slope_y[i] - plane.slope.y).abs() + test.spread.y;
        let away = test.spread.x * from_u.abs() + test.spread.y * from_v.abs();
        let spread = tilt(steeper_x, steeper_y) + away;
        let below = (nodes.high[i] + spread) - at_center <= test.least;
        let above = (nodes.low[i] - spread) - at_center > test.most;
        let (mut key, mut outside) = (distance, false);
        if let Some(cone) = test.cone {
            let most = nodes.high[i] + tilt(nodes.slope_x[i].abs(), nodes.slope_y[i].abs());
            let nearer = most - cone.nearness;
            key = distance / (nearer * nearer);
            outside = nearer <= 0.0 || key > cone.at_most;
        }
        let near = distance <= test.reach_squared;
        verdicts.keys[i] = key;
        verdicts.may_block |= u32::from(near && !below && !outside) << i;
        verdicts.may_be_lit |= u32::from(near && !above) << i;
    }
    verdicts
}

fn leaves(tiles: &Tiles<'_>, slopes: &Slopes) -> Ranges {
    let mut ranges = Ranges::default();
    for leaf in 0..tiles.count {
        let [mut low, mut high] = [f32::INFINITY, f32::NEG_INFINITY];
        for column in 0..COLUMNS {
            let rise = slopes.x[leaf] * (FIRST[0] + column as f32);
            let texel = |row: usize| tiles.rows[row][leaf][column];
            for i in 0..ROWS / 2 {
                let (above, below) = (texel(ROWS / 2 - 1 - i), texel(ROWS / 2 + i));
                let down = slopes.down[i][leaf];
                for flat in [above + down, below - down] {
                    let height = flat - rise;
                    low = if height < low { height } else { low };
                    high = if height > high { height } else { high };
                    ranges.unknown |= u32::from(height.is_nan()) << leaf;
                }
            }
        }
        (ranges.low[leaf], ranges.high[leaf]) = (low, high);
    }
    ranges
}

fn parent(children: &NodeGroup, family: &Family) -> [Bounds; 2] {
    Family::slopes(children).map(|slope| {
        let mut bounds = Bounds { slope, ..Bounds::NONE };
        for i in 0..LANES {
            let plane = slope[0] * family.x[i] + slope[1] * family.y[i];
            let steeper_x = (children.slope_x[i] - slope[0]).abs();
            let steeper_y = (children.slope_y[i] - slope[1]).abs();
            let spread = steeper_x * family.half[0] + steeper_y * family.half[1];
            let low = (children.low[i] - spread) - plane;
            let high = (children.high[i] + spread) - plane;
            bounds.low = if low < bounds.low { low } else { bounds.low };
            bounds.high = if high > bounds.high { high } else { bounds.high };
        }
        bounds
    })
}

fn concerned(node: &Node, seekers: &Seekers, among: u64, lit: bool) -> u64 {
    let [middle_u, middle_v] = [node.u, node.v].map(|[from, to]| (from + to) * 0.5);
    let [half_u, half_v] = [node.u, node.v].map(|[from, to]| (to - from) * 0.5);
    let mut lanes = 0;
    for i in (0..seekers.count).filter(|i| among >> i & 1 == 1) {
        let (u, v) = (seekers.u[i], seekers.v[i]);
        let (dx, dy) = (gap(node.u[0], node.u[1], u, u), gap(node.v[0], node.v[1], v, v));
        let near = dx * dx + dy * dy <= seekers.distance[i];
        let (slope_x, slope_y) = (seekers.slope_x[i], seekers.slope_y[i]);
        let rise = slope_x * (middle_u - u) + slope_y * (middle_v - v);
        let plane = (seekers.nearness[i] + rise) + seekers.offset[i];
        let steeper_x = (node.slope[0] - slope_x).abs();
        let steeper_y = (node.slope[1] - slope_y).abs();
        let spread = steeper_x * half_u + steeper_y * half_v;
        let none = if lit { node.low - spread > plane } else { node.high + spread <= plane };
        lanes |= u64::from(near && !none) << i;
    }
    lanes
}

fn matters(leaf: &Leaf, rows: [&Row; ROWS], seekers: &Seekers, lanes: u64, lit: bool) -> u64 {
    if leaf.holds_unknown(lit) {
        return lanes;
    }
    let mut matters = 0;
    for i in (0..seekers.count).filter(|i| lanes >> i & 1 == 1) {
        matters |= u64::from(matters_to(leaf, rows, seekers, lit, i)) << i;
    }
    matters
}

fn matters_to(leaf: &Leaf, rows: [&Row; ROWS], seekers: &Seekers, lit: bool, i: usize) -> bool {
    let (slope_x, slope_y) = (seekers.slope_x[i], seekers.slope_y[i]);
    let rise = slope_x * (leaf.first[0] - seekers.u[i]) + slope_y * (leaf.first[1] - seekers.v[i]);
    let plane = (seekers.nearness[i] + seekers.offset[i]) + rise;
    rows.into_iter().zip(0u8..).filter(|(_, y)| leaf.rows >> y & 1 == 1).any(|(row, y)| {
        let plane = plane + slope_y * f32::from(y);
        let gaps = row.iter().zip(0u8..).map(|(texel, x)| slope_x * f32::from(x) - texel);
        if lit {
            let above =
                gaps.fold(f32::NEG_INFINITY, |most, gap| if gap > most { gap } else { most });
            above + plane >= -leaf.room
        } else {
            let below =
                gaps.fold(f32::INFINITY, |least, gap| if gap < least { gap } else { least });
            below + plane <= leaf.room
        }
    })
}

fn ask_tile(tile: &Tile<'_>, seekers: &mut Seekers, lanes: u64, lit: bool) {
    let Tile { first: [left, top], rows } = *tile;
    let mut texels = [Candidate::default(); ROWS * COLUMNS];
    let mut count = 0;
    for (row, y) in rows.into_iter().zip(top..) {
        for (&nearness, x) in row.iter().zip(left..) {
            // What lies before the first texel is out of reach.
            if x >= seekers.origin[0] && y >= seekers.origin[1] {
                let order = seekers.order(x, y);
                let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
                texels[count] = Candidate { x, y, nearness, order };
                count += 1;
            }
        }
    }
    ask(&texels[..count], seekers, lanes, lit);
}

fn ask(texels: &[Candidate], seekers: &mut Seekers, lanes: u64, lit: bool) {
    for i in (0..seekers.count).filter(|i| lanes >> i & 1 == 1) {
        for texel in texels {
            let (dx, dy) = (texel.x - seekers.u[i], texel.y - seekers.v[i]);
            let distance = dx * dx + dy * dy;
            let rise = seekers.slope_x[i] * dx + seekers.slope_y[i] * dy;
            let plane = (seekers.nearness[i] + rise) + seekers.offset[i];
            let counts = (texel.nearness > plane) != lit;
            let ties = distance == seekers.distance[i] && texel.order < seekers.order[i];
            if counts && (distance < seekers.distance[i] || ties) {
                (seekers.distance[i], seekers.order[i]) = (distance, texel.order);
            }
        }
    }
}
