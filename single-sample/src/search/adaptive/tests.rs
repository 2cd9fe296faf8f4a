//! Groups of pixels with values known on paper.

use super::*;

/// Samples `blocked(x, y)` from pixels a texel apart, where discs have a radius of `disc` texels.
/// Returns the values and how many were searched.
fn sample(
    grid: &Grid,
    disc: f32,
    object: impl Fn(usize, usize) -> u32,
    hard: Bits,
    blocked: impl Fn(f32, f32) -> f32,
) -> ([f32; COUNT], usize) {
    let mut samples = Samples::new();
    let mut receivers = Receivers::new();
    let (mut objects, mut needed) = ([0; COUNT], [0; TILE]);
    for i in 0..COUNT {
        let (x, y) = (i % TILE, i / TILE);
        (receivers.u[i], receivers.v[i]) = (x as f32, y as f32);
        objects[i] = object(x, y);
        needed[y] |= u16::from(x < grid.width && y < grid.height) << x;
    }
    let mut searched = 0;
    samples.begin(grid, &Keys { objects: &objects, hard, needed });
    loop {
        for i in 0..samples.wanted().len() {
            let pixel = usize::from(samples.wanted()[i]);
            let (x, y) = (pixel % TILE, pixel / TILE);
            samples.values[pixel] = blocked(x as f32, y as f32);
            samples.discs[pixel] = disc;
            searched += 1;
        }
        if !samples.refine(grid, &receivers) {
            let bits = samples.searched.iter().map(|row| row.count_ones() as usize);
            assert_eq!(bits.sum::<usize>(), searched, "no pixel is searched twice");
            return (samples.values, searched);
        }
    }
}

/// No pixel is in shadow by the hard shadow test.
const LIT: Bits = [0; TILE];

const GRID: Grid = Grid { width: TILE, height: TILE, group: 8, tolerance: 0.02 };

#[test]
fn a_parabola_is_interpolated_exactly() {
    let blocked = |x: f32, y: f32| 0.2 + 0.01 * x + 0.0003 * (x * x) + 0.02 * y;
    let (values, searched) = sample(&GRID, 100.0, |_, _| 7, LIT, blocked);
    for i in 0..COUNT {
        let exact = blocked((i % TILE) as f32, (i / TILE) as f32);
        assert!((values[i] - exact).abs() < 1e-6, "{i}: {} for {exact}", values[i]);
    }
    assert!(searched < COUNT / 8, "{searched} searches");
}

#[test]
fn every_pixel_is_searched_with_groups_of_one_or_objects_of_their_own() {
    let blocked = |x: f32, y: f32| (x * 0.37 + y * 0.11).fract();
    for (group, own) in [(1, false), (8, true), (15, true)] {
        let grid = Grid { width: 13, height: 7, group, ..GRID };
        let object = |x: usize, y: usize| if own { (y * TILE + x) as u32 } else { u32::MAX };
        let (values, searched) = sample(&grid, 100.0, object, LIT, blocked);
        assert_eq!(searched, 13 * 7);
        for (x, y) in (0..7).flat_map(|y| (0..13).map(move |x| (x, y))) {
            assert_eq!(values[y * TILE + x], blocked(x as f32, y as f32));
        }
    }
}

#[test]
fn a_stripe_narrower_than_a_group_is_found_if_discs_are_narrow() {
    let stripe = |at: f32| if (at - 5.5).abs() < 2.0 { 1.0 } else { 0.0 };
    for across in [true, false] {
        let blocked = |x: f32, y: f32| stripe(if across { x } else { y });
        let (values, _) = sample(&GRID, 1.0, |_, _| 1, LIT, blocked);
        let found = values.iter().filter(|&&value| value > 0.5).count();
        assert_eq!(found, 4 * TILE);
        let (values, _) = sample(&GRID, 20.0, |_, _| 1, LIT, blocked);
        assert!(values.iter().all(|value| (0.0..=1.0).contains(value)));
    }
}

#[test]
fn a_ridge_between_penumbrae_is_found_by_what_is_beyond_the_ends() {
    // Its middle is in the middle of a group, the ends of which are as high.
    let ridge = |at: f32| (1.0 - (at - 4.0).abs() * 0.06).max(0.0);
    for across in [true, false] {
        let blocked = |x: f32, y: f32| ridge(if across { x } else { y });
        let (values, _) = sample(&GRID, 100.0, |_, _| 1, LIT, blocked);
        let greatest = values.iter().fold(0.0, |all: f32, &one| all.max(one));
        assert!(greatest > 0.99, "{greatest}");
    }
}

#[test]
fn a_hard_edge_is_searched_for_unless_it_is_in_a_penumbra() {
    // All ends of groups are lit, and what blocks pixels 3 to 5 of a row is not in their reach.
    let spot = |x: f32, _: f32| if (3.0..=5.0).contains(&x) { 0.5 } else { 0.0 };
    let hard = [0b11_1000; TILE];
    for (disc, found) in [(f32::INFINITY, 3 * TILE), (1.0, 3 * TILE), (100.0, 0)] {
        let (values, _) = sample(&GRID, disc, |_, _| 1, hard, spot);
        assert_eq!(values.iter().filter(|&&value| value > 0.0).count(), found, "{disc}");
    }
}
