//! The kernels in plain Rust: what all others must equal bit for bit.

use crate::build::{FIRST, Ranges};
use crate::kernels::{Job, Kernels, Ops};
use crate::map::{COLUMNS, ROWS, Row};
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{GroupTest, Verdicts};
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
            let plane = test.nearness + (test.slope * dx + test.rise[row]);
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

fn group(test: &GroupTest, nodes: &NodeGroup) -> Verdicts {
    let mut verdicts = Verdicts { may_block: 0, may_be_lit: 0, keys: test.distance };
    let slope = test.plane.slope;
    for i in 0..LANES {
        let tilt = |x: f32, y: f32| x.abs() * test.half[0] + y.abs() * test.half[1];
        let spread = tilt(nodes.slope_x[i] - slope.x, nodes.slope_y[i] - slope.y);
        let below = (nodes.high[i] + spread) - test.at_center[i] <= test.least;
        let above = (nodes.low[i] - spread) - test.at_center[i] > test.most;
        let mut outside = false;
        if let Some(cone) = test.cone {
            let most = nodes.high[i] + tilt(nodes.slope_x[i], nodes.slope_y[i]);
            let nearer = most - cone.nearness;
            verdicts.keys[i] = test.distance[i] / (nearer * nearer);
            outside = nearer <= 0.0 || verdicts.keys[i] > cone.at_most;
        }
        let near = test.distance[i] <= test.reach_squared;
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
