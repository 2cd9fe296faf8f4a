//! Every path finds the texel that the definition names, with the same bits, at every level.

mod common;

use common::{KINDS, Random, Texels, check_all_paths, query, say_levels, texels};
use proptest::prelude::*;
use shadowmap_core::{Level, LightPoint};
use simd_search::{IdTest, Key, Query, Side};

#[test]
fn random_maps_and_queries() {
    say_levels("random maps and queries");
    for seed in 0..400 {
        let mut random = Random(seed);
        let (width, height) = match random.below(4) {
            0 => (1 + random.below(20), 1 + random.below(20)),
            1 => (1 + random.below(300), 1 + random.below(12)),
            _ => (1 + random.below(100), 1 + random.below(60)),
        };
        let texels = texels(seed as u32 % KINDS, width, height, &mut random);
        let queries: Vec<_> = (0..12).map(|_| query(&texels, &mut random)).collect();
        check_all_paths(&texels, &queries, random.below(3) == 0);
    }
}

/// Neighbours, which share one list of tiles: with planes that differ a little, and now and then
/// in side, ID test, key or radius.
#[test]
fn blocks_of_neighbours() {
    say_levels("blocks of neighbours");
    let mut found = 0;
    for seed in 0..200 {
        let mut random = Random(1000 + seed);
        let (width, height) = (30 + random.below(200), 20 + random.below(120));
        let texels = texels(seed as u32 % KINDS, width, height, &mut random);
        let mut first = query(&texels, &mut random);
        first.hint = None;
        let is_mixed = random.below(3) == 0;
        // As where the outline of an object runs through a block.
        let across = random.pick(&[0.0, 0.0, 130.0]);
        let queries: Vec<_> = (0..5 + random.below(80))
            .map(|i| {
                let mut query = first;
                query.point.u += (i % 8) as f32 * 0.7;
                query.point.v += (i / 8) as f32 * 0.9;
                query.point.u += if i % 8 > 4 { across } else { 0.0 };
                query.point.nearness += random.unit() * 0.002;
                query.point.slope.x += random.unit() * 0.0005;
                if is_mixed && random.below(6) == 0 {
                    query.side = random.pick(&[Side::Blocker, Side::Lit]);
                    query.ids = random.pick(&[IdTest::Any, IdTest::Differs(u32::MAX)]);
                    query.key = random.pick(&[Key::Distance, Key::Ratio { at_most: 900.0 }]);
                    query.radius = random.pick(&[0.0, 3.5, 40.0, -1.0]);
                }
                query
            })
            .collect();
        found += check_all_paths(&texels, &queries, random.below(4) == 0);
    }
    println!("{found} hits");
    assert!(found > 1000, "{found} hits");
}

/// Blocks of pixels on floors and on curved surfaces, in large maps and to their borders: most
/// texels are passed over for all receivers at once.
#[test]
fn blocks_that_look_far() {
    say_levels("blocks that look far");
    let mut found = 0;
    for seed in 0..24 {
        let mut random = Random(seed);
        let (width, height) = (150 + random.below(150), 90 + random.below(90));
        // A tilted floor, or a dome, with a bar, a disc and a few thorns above it.
        let (tilt, bend) = (random.unit() * 0.001, random.pick(&[0.0, 0.0, 2e-6, 2e-5]));
        let (bar, disc) = (random.below(width), [random.below(width), random.below(height)]);
        let ground = |x: f32, y: f32| 0.2 + tilt * (x - 0.5 * y) - bend * (x * x + y * y);
        let mut nearness = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let ground = ground(x as f32 + 0.5, y as f32 + 0.5);
                let [dx, dy] = [x.abs_diff(disc[0]), y.abs_diff(disc[1])];
                let is_raised = (bar..bar + 9).contains(&x)
                    || dx * dx + dy * dy < 300
                    || random.below(5000) == 0;
                let odd = random.pick(&[f32::NAN, f32::INFINITY]);
                let raised = if is_raised { ground + 0.05 } else { ground };
                nearness.push(if random.below(9000) == 0 { odd } else { raised });
            }
        }
        let ids = (0..width * height).map(|i| i % width / 40).collect();
        let texels = Texels { width, height, nearness, ids };
        let spacing = random.pick(&[0.4, 1.3, 3.1, 20.0]);
        let [left, top] = [width, height].map(|size| random.unit() * size as f32 - 4.0);
        let radius = random.pick(&[9.0, 40.0, 150.0]);
        let ids = random.pick(&[IdTest::Any, IdTest::Any, IdTest::Differs(1), IdTest::Equals(2)]);
        let queries: Vec<_> = (0..64_u32)
            .map(|i| {
                let (x, y) = (left + (i % 8) as f32 * spacing, top + (i / 8) as f32 * spacing);
                let mut point = LightPoint::flat(x, y, ground(x, y));
                point.slope.x = tilt - 2.0 * bend * x;
                point.slope.y = -0.5 * tilt - 2.0 * bend * y;
                let (column, row) = ((x.max(0.0) as u32), (y.max(0.0) as u32));
                let index = (row.min(height - 1) * width + column.min(width - 1)) as usize;
                let mut query = Query::new(point, 1e-4, radius);
                if texels.nearness[index] > point.nearness + 1e-3 {
                    query.side = Side::Lit;
                }
                Query { ids, ..query }
            })
            .collect();
        found += check_all_paths(&texels, &queries, false);
    }
    println!("{found} hits");
    assert!(found > 500, "{found} hits");
}

/// Blocks of pixels on a folded roof with steep walls, far from the map's origin: many receivers on
/// each of a few planes, whose own texels are as near as the planes but for rounding.
#[test]
fn blocks_on_several_planes() {
    say_levels("blocks on several planes");
    let mut found = 0;
    for seed in 0..40 {
        let mut random = Random(seed);
        let (width, height) = (600 + random.below(900), 60 + random.below(40));
        let folds = 20.0 + random.unit() * 60.0;
        let slopes = [random.unit() * 0.004, -random.unit() * 0.01, 0.0];
        // Where x lies on which fold, and the nearness at its start.
        let fold = |x: f32| (x / folds) as usize;
        let slope = |x: f32| slopes[fold(x) % 3];
        let ground = |x: f32, y: f32| {
            let start: f32 = (0..fold(x)).map(|i| slopes[i % 3] * folds).sum();
            0.2 + start + slope(x) * (x - fold(x) as f32 * folds) + 1e-4 * y
        };
        let nearness = (0..width * height)
            .map(|i| {
                let raised = if random.below(3000) == 0 { 0.05 } else { 0.0 };
                ground((i % width) as f32 + 0.5, (i / width) as f32 + 0.5) + raised
            })
            .collect();
        let texels = Texels { width, height, nearness, ids: vec![] };
        let spacing = random.pick(&[0.7, 2.9, 9.0]);
        let left = random.unit() * (width as f32 - 8.0 * spacing);
        let top = random.unit() * 20.0;
        let radius = random.pick(&[9.0, 30.0, 90.0]);
        let offset = random.pick(&[0.0, 1e-6, 1e-4]);
        let steep = random.pick(&[0, 3, 20]);
        let queries: Vec<_> = (0..64_u32)
            .map(|i| {
                let (x, y) = (left + (i % 8) as f32 * spacing, top + (i / 8) as f32 * spacing);
                let mut point = LightPoint::flat(x, y, ground(x, y));
                (point.slope.x, point.slope.y) = (slope(x), 1e-4);
                if random.below(64) < steep {
                    point.slope.x += 0.3;
                }
                let side = if random.below(9) == 0 { Side::Lit } else { Side::Blocker };
                Query { side, ..Query::new(point, offset, radius) }
            })
            .collect();
        found += check_all_paths(&texels, &queries, false);
    }
    println!("{found} hits");
    assert!(found > 1000, "{found} hits");
}

/// Receivers between two tiles, whose planes differ, among texels of about their own nearness: of
/// those at one distance the first in row-major order is the answer, whichever tile is asked first.
#[test]
fn ties_between_tiles() {
    say_levels("ties between tiles");
    let mut found = 0;
    for seed in 0..100 {
        let mut random = Random(seed);
        let (width, height) = (64, 48);
        let often = random.pick(&[2, 6, 20]);
        let height_of = |random: &mut Random| 0.25 + random.unit() * 0.004;
        let nearness = (0..width * height)
            .map(|_| if random.below(often) == 0 { height_of(&mut random) } else { 0.2 })
            .collect();
        let texels = Texels { width, height, nearness, ids: vec![] };
        let side = random.pick(&[Side::Blocker, Side::Blocker, Side::Lit]);
        let [column, row] = [16 + 16 * random.below(3), 8 + 8 * random.below(5)];
        let queries: Vec<_> = (0..64)
            .map(|_| {
                let [x, y] = [(); 2].map(|()| random.pick(&[-1.0, -0.5, 0.0, 0.0, 0.5, 1.0]));
                let (u, v) = (column as f32 + x, row as f32 + y);
                let mut point = LightPoint::flat(u, v, height_of(&mut random));
                point.slope.x = random.unit() * 1e-5;
                Query { side, ..Query::new(point, 0.0, 12.0) }
            })
            .collect();
        found += check_all_paths(&texels, &queries, false);
    }
    println!("{found} hits");
    assert!(found > 4000, "{found} hits");
}

/// NaN is lit, also where receivers do not agree on the texels beside it.
#[test]
fn nan_among_blockers_is_lit_for_a_block() {
    let (width, height) = (64, 32);
    let mut texels = Texels { width, height, nearness: vec![0.5; 64 * 32], ids: vec![] };
    texels.nearness[10 * 64 + 20] = f32::NAN;
    // Lit for some of them only.
    texels.nearness[12 * 64 + 24] = 0.35;
    let queries: Vec<_> = (0..64)
        .map(|i| {
            let (u, v) = (10.0 + (i % 8) as f32 * 0.5, 8.0 + (i / 8) as f32 * 0.5);
            let point = LightPoint::flat(u, v, 0.3 + i as f32 * 0.0015);
            Query { side: Side::Lit, ..Query::new(point, 0.0, 30.0) }
        })
        .collect();
    assert_eq!(check_all_paths(&texels, &queries, false), 64);
}

/// Windows of 1 to 67 texels, around every texel's corner and centre, over the border as well.
#[test]
fn all_windows_around_all_centres() {
    say_levels("all windows");
    let mut random = Random(7);
    let (width, height) = (70, 9);
    let texels = texels(4, width, height, &mut random);
    for window in 1..=67 {
        let radius = window as f32 * 0.5;
        let queries: Vec<_> = (0..2 * width * height)
            .filter(|i| (i + window) % 5 == 0 || radius < 4.0)
            .map(|i| {
                let (x, y) = ((i % (2 * width)) as f32 * 0.5, (i / (2 * width)) as f32);
                Query::new(LightPoint::flat(x, y, 0.25), 0.0, radius)
            })
            .collect();
        check_all_paths(&texels, &queries, false);
    }
}

/// One texel that counts in the smallest map that kernels take, at every place, from every
/// corner and centre; then two, so that distances tie.
#[test]
fn exhaustive_in_one_tile() {
    say_levels("one tile");
    let (width, height) = (16, 8);
    for place in 0..width * height {
        for second in [place, width * height - 1 - place] {
            let mut texels = Texels { width, height, nearness: vec![0.0; 128], ids: vec![] };
            texels.nearness[place as usize] = 0.5;
            texels.nearness[second as usize] = 0.5;
            let queries: Vec<_> = (0..33 * 17)
                .filter(|i| (i + place) % 7 == 0)
                .map(|i| {
                    let (u, v) = ((i % 33) as f32 * 0.5, (i / 33) as f32 * 0.5);
                    let mut query = Query::new(LightPoint::flat(u, v, 0.25), 0.0, 9.0);
                    query.side = if i % 3 == 0 { Side::Lit } else { Side::Blocker };
                    query
                })
                .collect();
            check_all_paths(&texels, &queries, false);
        }
    }
}

/// Every map of 3 x 3 texels with two depths, smaller than any kernel's tile.
#[test]
fn exhaustive_in_small_maps() {
    for bits in 0..512_u32 {
        let nearness = (0..9).map(|i| if bits >> i & 1 == 1 { 0.5 } else { 0.125 }).collect();
        let texels = Texels { width: 3, height: 3, nearness, ids: vec![] };
        let queries: Vec<_> = (0..49)
            .map(|i| {
                let (u, v) = ((i % 7) as f32 * 0.5, (i / 7) as f32 * 0.5);
                let radius = [0.0, 0.5, 1.0, 1.6, 9.0][(i as usize + bits as usize) % 5];
                let mut query = Query::new(LightPoint::flat(u, v, 0.25), 0.0, radius);
                query.side = if i % 2 == 0 { Side::Lit } else { Side::Blocker };
                query
            })
            .collect();
        check_all_paths(&texels, &queries, false);
    }
}

fn any_query() -> impl Strategy<Value = Query> {
    let number = || prop_oneof![any::<f32>(), -8.0_f32..40.0, 0.0_f32..1.0];
    let side = prop_oneof![Just(Side::Blocker), Just(Side::Lit)];
    let ids = prop_oneof![
        Just(IdTest::Any),
        any::<u32>().prop_map(IdTest::Differs),
        prop_oneof![Just(0), Just(u32::MAX)].prop_map(IdTest::Equals),
    ];
    let key = prop_oneof![Just(Key::Distance), number().prop_map(|at_most| Key::Ratio { at_most })];
    let point = (number(), number(), number(), number(), number());
    let hint = prop_oneof![Just(None), any::<[u32; 2]>().prop_map(Some), Just(Some([3, 3]))];
    (point, number(), number(), side, ids, key, number(), hint).prop_map(
        |((u, v, nearness, x, y), offset, radius, side, ids, key, jitter, hint)| {
            let mut point = LightPoint::flat(u, v, nearness);
            (point.slope.x, point.slope.y) = (x, y);
            Query { point, offset, radius, side, ids, key, jitter, hint }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// Any numbers whatsoever, in the map and in the query.
    #[test]
    fn any_numbers(
        (width, height) in (1_u32..40, 1_u32..20),
        special in any::<[f32; 6]>(),
        seed in any::<u64>(),
        queries in prop::collection::vec(any_query(), 1..9),
    ) {
        let mut random = Random(seed);
        let mut texels = texels(seed as u32 % KINDS, width, height, &mut random);
        for number in special {
            texels.nearness[random.below(width * height) as usize] = number;
        }
        check_all_paths(&texels, &queries, seed % 4 == 0);
    }
}

#[test]
fn a_map_of_no_texels_holds_nothing() {
    for (width, height) in [(0, 0), (0, 5), (5, 0)] {
        let texels = Texels { width, height, nearness: vec![], ids: vec![] };
        let query = Query::new(LightPoint::flat(0.5, 0.5, 0.0), 0.0, f32::INFINITY);
        assert_eq!(check_all_paths(&texels, &[query], false), 0);
    }
    assert!(Level::available().count() > 0);
}
