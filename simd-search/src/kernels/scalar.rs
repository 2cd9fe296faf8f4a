//! The kernels in plain Rust: what all others must equal bit for bit.

use crate::build::{FIRST, Ranges};
use crate::kernels::{Job, Kernels, Ops};
use crate::map::{COLUMNS, ROWS, Row};
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{Boxes, GroupTest, Verdicts};
use crate::search::{RATIO_ROOM, TileTest};

pub(crate) fn run(job: Job<'_>) {
    job.run(&kernels());
}

/// The kernels themselves.
#[inline(always)]
pub(crate) fn kernels() -> impl Ops {
    Kernels { tile, equal, group, leaf }
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

fn equal(numbers: &[u32; LANES], number: u32) -> u32 {
    (0..LANES).fold(0, |found, i| found | u32::from(numbers[i] == number) << i)
}

fn group(test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
    let mut verdicts = Verdicts { may_block: 0, may_be_lit: 0, keys: [0.0; LANES] };
    let plane = test.plane;
    for i in 0..LANES {
        let gap = |low: f32, high: f32, axis: usize| {
            let (before, after) = (low - test.to[axis], test.from[axis] - high);
            let gap = if before > after { before } else { after };
            if gap > 0.0 { gap } else { 0.0 }
        };
        let (dx, dy) =
            (gap(boxes.left[i], boxes.right[i], 0), gap(boxes.top[i], boxes.bottom[i], 1));
        let distance = dx * dx + dy * dy;
        let x = (boxes.left[i] + boxes.right[i]) * 0.5 - plane.u;
        let y = (boxes.top[i] + boxes.bottom[i]) * 0.5 - plane.v;
        let at_center = plane.nearness + (plane.slope.x * x + plane.slope.y * y);
        let half_x = (boxes.right[i] - boxes.left[i]) * 0.5;
        let half_y = (boxes.bottom[i] - boxes.top[i]) * 0.5;
        let tilt = |x: f32, y: f32| x.abs() * half_x + y.abs() * half_y;
        let spread = tilt(nodes.slope_x[i] - plane.slope.x, nodes.slope_y[i] - plane.slope.y);
        let below = (nodes.high[i] + spread) - at_center <= test.least;
        let above = (nodes.low[i] - spread) - at_center > test.most;
        let (mut key, mut outside) = (distance, false);
        if let Some(cone) = test.cone {
            let most = nodes.high[i] + tilt(nodes.slope_x[i], nodes.slope_y[i]);
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

fn leaf(rows: [&Row; ROWS], slope: [f32; 2]) -> Ranges {
    let mut ranges = Ranges::NONE;
    for (row, y) in rows.iter().zip(0u8..) {
        for (&nearness, x) in row.iter().zip(0u8..) {
            let (x, y) = (FIRST[0] + f32::from(x), FIRST[1] + f32::from(y));
            ranges.add(nearness, slope[0] * x + slope[1] * y);
        }
    }
    ranges
}
