//! Where samples are added.

use super::*;

/// A board at the bottom of a shaft: only the middle of the light shines on it.
fn shaft() -> Scene {
    let v = Vec3::new;
    Scene::new(&[
        [v(-4.0, 0.0, -4.0), v(-4.0, 0.0, 4.0), v(4.0, 0.0, 4.0)],
        [v(-0.3, 0.0, -1.0), v(-0.3, 0.0, 1.0), v(-0.3, 2.5, 1.0)],
        [v(0.3, 0.0, -1.0), v(0.3, 0.0, 1.0), v(0.3, 2.5, 1.0)],
        [v(-0.15, 0.5, -0.5), v(-0.15, 0.5, 0.5), v(0.15, 0.5, 0.5)],
    ])
}

#[test]
fn a_sample_is_added_where_neither_end_sees_the_blocker() {
    let (v, ends) = (Vec3::new, [Vec3::new(-2.0, 4.0, 0.0), Vec3::new(2.0, 4.0, 0.0)]);
    let beside = View::perspective(v(0.0, 1.0, 6.0), v(0.0, 0.0, 0.0), Vec3::Y, 0.08, 96, 96, 0.1);
    let (plain, plain_view) = blocker();
    // What the middle of the picture sees: with samples at the ends alone, and with all.
    for (scene, view, splits, expected) in
        [(shaft(), beside, true, [0.24, 0.0]), (plain, plain_view, false, [0.0, 0.0])]
    {
        let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
        let camera =
            Camera::new(&view, camera_map[0].as_depth_map(), Surfaces::Table(&scene.table))
                .unwrap();
        let points = scene.positions.iter().copied();
        let light = RectifiedLight::fit(ends[0], ends[1], 2, [256; 2], points);
        let views = &light.frusta()[0];
        let mut maps = scene.draw(views.views(), Payload::ObjectId);
        let options = AdaptiveOptions { stride: 4, ..AdaptiveOptions::default() };
        let mut adaptive = AdaptiveSamples::new(options);
        let all = |maps: &[DepthBuffer], parameters: &[f32]| {
            let samples: Vec<_> = parameters
                .iter()
                .zip(maps)
                .map(|(&t, map)| SampleMap { t, map: map.as_depth_map() })
                .collect();
            let maps = FrustumMaps { views, samples: &samples };
            let out = visibility(Level::SCALAR, Threads::One, &camera, maps);
            out[out.len() / 2 + view.width() as usize / 2]
        };
        let before = all(&maps, adaptive.parameters());
        while let Some((segment, t)) = adaptive.trial() {
            let trial = scene.draw(&[views.trial_view(t, [256; 2])], Payload::ObjectId);
            let parameters = adaptive.parameters().iter();
            let samples: Vec<_> = parameters
                .zip(&maps)
                .map(|(&t, map)| SampleMap { t, map: map.as_depth_map() })
                .collect();
            let frusta = [FrustumMaps { views, samples: &samples }];
            let trial = trial[0].as_depth_map();
            let found = disagreement(&camera, &frusta, 0, segment, t, &trial, &options);
            assert!(found.receivers > 20, "{found:?}");
            if adaptive.answer(found) {
                maps.insert(
                    segment + 1,
                    scene.draw(&[views.view_at(t)], Payload::ObjectId).remove(0),
                );
            }
        }
        let after = all(&maps, adaptive.parameters());
        println!("{:?}: {before} becomes {after}", adaptive.parameters());
        assert_eq!(adaptive.parameters().len() > 2, splits);
        assert!(adaptive.parameters().len() <= options.most_samples);
        assert_eq!(maps.len(), adaptive.parameters().len());
        for (found, expected) in [before, after].into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.02, "{found} instead of {expected}");
        }
    }
}

/// A shadow of 18 by 18 pixels in a picture of 512 by 512, as one behind a column in a room.
#[test]
fn a_shadow_that_can_be_seen_adds_a_sample() {
    let mut adaptive = AdaptiveSamples::new(AdaptiveOptions::default());
    let found = |disagreeing: u32| Disagreement { receivers: 2578, disagreeing };
    assert!(adaptive.answer(found(5)));
    assert!(!adaptive.answer(found(1)));
}
