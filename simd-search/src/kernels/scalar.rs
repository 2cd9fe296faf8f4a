//! The kernels in plain Rust: what all others must equal bit for bit.

use crate::build::{FIRST, ROWS, Ranges};
use crate::kernels::{Job, Kernels, Ops};
use crate::map::WINDOW;
use crate::pyramid::LANES;
use crate::reach::group_scalar;
use crate::search::WindowTest;

pub(crate) fn run(job: Job<'_>) {
    job.run(&kernels());
}

/// The kernels themselves.
#[inline(always)]
pub(crate) fn kernels() -> impl Ops {
    Kernels {
        window: |test: &WindowTest, texels: &[f32; WINDOW]| {
            let mut found = 0;
            for (i, &nearness) in texels.iter().enumerate() {
                let dx = (test.first + i as f32) - test.u;
                let plane = test.nearness + (test.slope * dx + test.rise);
                let blocks = nearness > plane + test.offset;
                let distance = dx * dx + test.dy_squared;
                let near = match test.ratio {
                    None => distance <= test.reach_squared,
                    Some(key) => {
                        let nearer = nearness - test.nearness;
                        let beyond = distance > key * (nearer * nearer);
                        distance <= test.reach_squared && nearer > 0.0 && !beyond
                    }
                };
                found |= u32::from(near && blocks != (test.flip != 0)) << i;
            }
            found
        },
        equal: |numbers: &[u32; LANES], number| {
            (0..16).fold(0, |found, i| found | u32::from(numbers[i] == number) << i)
        },
        group: group_scalar,
        leaf: |texels: &[[f32; WINDOW]; ROWS], slope: [f32; 2]| {
            let mut ranges = Ranges::NONE;
            for (row, y) in texels.iter().zip(0u8..) {
                for (&nearness, x) in row.iter().zip(0u8..) {
                    let (x, y) = (FIRST[0] + f32::from(x), FIRST[1] + f32::from(y));
                    ranges.add(nearness, slope[0] * x + slope[1] * y);
                }
            }
            ranges
        },
    }
}
