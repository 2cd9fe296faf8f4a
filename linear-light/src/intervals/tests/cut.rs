//! Windows that are cut: what lies close to the light is in no map, or in few.

use super::*;

const ENDS: [Vec3; 2] = [Vec3::new(-3.0, 2.0, 0.0), Vec3::new(3.0, 2.0, 0.0)];

/// What is seen of the light past `blocker` next to `at`, on a ground at its height; the same at
/// all levels, and as the naive way has it.
fn seen(at: Vec3, blocker: [Vec3; 3], count: usize) -> f32 {
    let v = Vec3::new;
    let ground = [v(-2.9, at.y, -1.5), v(-2.9, at.y, 1.5), v(2.9, at.y, 1.5)];
    let scene = Scene::new(&[ground, blocker]);
    let view = View::perspective(at + v(0.0, 1.0, 0.1), at, Vec3::Z, 0.2, 40, 30, 0.01);
    let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
    let camera =
        Camera::new(&view, camera_map[0].as_depth_map(), Surfaces::Table(&scene.table)).unwrap();
    let [receivers, blockers] =
        [0, 1].map(|quad: usize| scene.positions[4 * quad..][..4].iter().copied());
    let light = RectifiedLight::fit_around(
        ENDS[0],
        ENDS[1],
        count,
        [256, 128],
        blockers.chain(receivers.clone()),
        receivers,
    );
    let views = &light.frusta()[0];
    assert!(views.is_cut());
    let maps = scene.draw(views.views(), Payload::ObjectId);
    let samples = samples(&maps);
    let maps = FrustumMaps { views, samples: &samples };
    let out = visibility(Level::SCALAR, Threads::One, &camera, maps);
    for (a, b) in out.iter().zip(naive(&camera, maps)) {
        assert!((a - b).abs() < 0.01, "{a} instead of {b}");
    }
    for level in Level::available() {
        let other = visibility(level, Threads::default(), &camera, maps);
        assert!(other == out, "{level:?} differs");
    }
    out[out.len() / 2 + view.width() as usize / 2]
}

/// A board right below the light, as long as it. Each end sees half a metre of it.
#[test]
fn a_board_goes_on_between_the_windows() {
    let v = Vec3::new;
    let board = [v(-3.5, 1.87, -0.13), v(-3.5, 1.87, 0.13), v(3.5, 1.87, 0.13)];
    for count in [2, 3] {
        let seen = seen(v(0.0, 0.0, 0.1), board, count);
        assert!(seen < 0.01, "{count} samples: {seen} instead of 0");
    }
}

/// It hides a twelfth of the light and nothing else, though it is at the border of both windows.
#[test]
fn boards_across_the_light_do_not_go_on_along_it() {
    let v = Vec3::new;
    // The light goes through it.
    let plate = [v(2.5, 1.6, -0.4), v(2.5, 1.6, 0.4), v(2.5, 2.4, 0.4)];
    let seen = seen(v(0.0, 0.0, 0.1), plate, 2);
    assert!((0.91..0.95).contains(&seen), "{seen}");
}

/// The middle sample alone sees it, and its neighbours the ground right behind.
#[test]
fn a_board_ends_where_a_neighbour_shows_no_blocker() {
    let v = Vec3::new;
    let board = [v(-1.0, 1.84, -0.13), v(-1.0, 1.84, 0.13), v(1.0, 1.84, 0.13)];
    let seen = seen(v(-2.0, 1.8, 0.05), board, 3);
    assert!(seen > 0.95, "{seen} instead of 1");
}

#[test]
fn samples_are_spread_where_they_run_out() {
    let mut adaptive = AdaptiveSamples::new(AdaptiveOptions::default());
    while adaptive.trial().is_some() {
        assert!(adaptive.answer(Disagreement { receivers: 100, disagreeing: 100 }));
    }
    let eighths: Vec<f32> = (0..=8).map(|i| i as f32 / 8.0).collect();
    assert_eq!(adaptive.parameters(), eighths);
}

#[test]
fn a_light_is_asked_about_at_its_quarters_where_windows_are_cut() {
    for (half, expected) in [(1.0, &[0.5][..]), (4.0, &[0.5, 0.25, 0.75])] {
        let window = shadowmap_core::Window::centered(half, 1.0);
        let views = SampleViews::new(ENDS[0], ENDS[1], 2, Vec3::NEG_Y, window, [8; 2], 0.1);
        let options = AdaptiveOptions::default();
        let mut adaptive = AdaptiveSamples::new(options).through_windows_of(&views);
        let mut asked = Vec::new();
        while let Some((segment, t)) = adaptive.trial() {
            assert_eq!(segment, 0);
            asked.push(t);
            assert!(!adaptive.answer(Disagreement { receivers: 100, disagreeing: 0 }));
        }
        assert_eq!(asked, expected);
    }
}
