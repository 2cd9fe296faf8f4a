//! What `classify` promises of a region holds for every receiver in it.

mod common;

use common::{KINDS, Random, query, say_levels, storage, texels};
use shadowmap_core::{Level, LightPoint};
use simd_search::{Cone, IdTest, Key, Pyramid, Query, Reach, Receivers, Side, Verdict, naive};

#[test]
fn clear_and_covered_hold_for_every_receiver() {
    say_levels("regions");
    let mut seen = [0; 3];
    for seed in 0..600 {
        let mut random = Random(seed);
        let texels =
            texels(seed as u32 % KINDS, 1 + random.below(150), 1 + random.below(90), &mut random);
        let first = query(&texels, &mut random);
        let radius = first.radius * 0.5;
        let mut receivers = vec![];
        for _ in 0..1 + random.below(20) {
            let mut point = first.point;
            point.u += random.unit() * 8.0;
            point.v += random.unit() * 8.0;
            point.nearness += random.unit() * 0.01;
            receivers.push((point, first.offset));
        }
        let Some(mut reach) = around(&receivers, radius) else { continue };
        let mut key = Key::Distance;
        if let Key::Ratio { at_most } = first.key {
            let nearness = receivers.iter().map(|r| r.0.nearness).fold(f32::INFINITY, f32::min);
            reach.cone = Some(Cone { nearness, at_most });
            key = first.key;
        }
        let (mut nodes, mut ids) = storage(texels.width, texels.height);
        let map = texels.map();
        let pyramid = Pyramid::build(Level::SCALAR, map, &mut nodes, &mut ids).unwrap();
        let verdicts: Vec<_> =
            Level::available().map(|level| pyramid.classify(level, &reach, first.ids)).collect();
        assert!(verdicts.iter().all(|&verdict| verdict == verdicts[0]), "{verdicts:?}");
        seen[verdicts[0] as usize] += 1;
        for &(point, offset) in &receivers {
            let mut query = Query::new(point, offset, radius);
            query.jitter = first.jitter;
            match verdicts[0] {
                Verdict::Clear => {
                    (query.ids, query.key) = (first.ids, key);
                    assert_eq!(naive::nearest(map, &query), None, "seed {seed}");
                }
                Verdict::Covered => {
                    (query.side, query.ids) = (Side::Lit, IdTest::Any);
                    assert_eq!(naive::nearest(map, &query), None, "seed {seed}");
                }
                Verdict::Mixed => {}
            }
        }
    }
    println!("clear, covered, mixed: {seen:?}");
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn an_empty_or_impossible_region_is_none() {
    assert_eq!(around(&[], 1.0), None);
    let point = shadowmap_core::LightPoint::flat(f32::NAN, 0.0, 0.0);
    assert_eq!(around(&[(point, 0.0)], 1.0), None);
}

/// The reach of receivers, each with its offset.
fn around(receivers: &[(LightPoint, f32)], radius: f32) -> Option<Reach> {
    let column = |of: fn(&(LightPoint, f32)) -> f32| receivers.iter().map(of).collect::<Vec<_>>();
    let receivers = Receivers {
        u: &column(|r| r.0.u),
        v: &column(|r| r.0.v),
        nearness: &column(|r| r.0.nearness),
        slope_x: &column(|r| r.0.slope.x),
        slope_y: &column(|r| r.0.slope.y),
        offset: &column(|r| r.1),
    };
    Reach::around(&receivers, radius)
}
