//! Rectified views: one window, rows in common, frusta that leave no receiver out.

use glam::{Vec3, Vec3Swizzles};
use linear_light::{MAX_FRUSTA, RectifiedLight, SampleViews};
use proptest::prelude::*;
use shadowmap_core::{View, Window};

const GROUND: [Vec3; 4] = [
    Vec3::new(-5.0, 0.0, -5.0),
    Vec3::new(5.0, 0.0, -5.0),
    Vec3::new(5.0, 0.0, 5.0),
    Vec3::new(-5.0, 0.0, 5.0),
];

fn room() -> impl Iterator<Item = Vec3> + Clone {
    (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 6.0 - 3.0)
}

#[test]
fn a_point_moves_along_its_row_by_the_disparity() {
    let (a, b) = (Vec3::new(-1.0, 4.0, 0.5), Vec3::new(1.2, 4.3, 0.0));
    let light = RectifiedLight::fit(a, b, 4, [512, 256], GROUND.into_iter());
    assert_eq!(light.frusta().len(), 1);
    let views = &light.frusta()[0];
    for p in [Vec3::new(0.3, 1.0, -0.2), Vec3::new(-2.0, 0.0, 1.0), Vec3::new(4.0, 0.5, 3.0)] {
        let normal = Vec3::new(0.2, 0.9, -0.3).normalize();
        let first = views.light_point(p, normal).unwrap();
        for (k, view) in views.views().iter().enumerate() {
            let seen = view.light_point(p, normal).unwrap();
            let carried = views.in_sample(&first, k);
            assert!((seen.u - carried.u).abs() < 1e-3, "{seen:?} {carried:?}");
            assert!((seen.v - carried.v).abs() < 1e-3);
            assert!((seen.nearness - carried.nearness).abs() < 1e-6);
            assert!(seen.slope.distance(carried.slope) < 1e-6);
        }
    }
}

#[test]
fn views_differ_in_one_constant_alone() {
    // A skew light, where rounding would make every row a little different.
    let (a, b) = (Vec3::new(-1.3, 4.1, 0.7), Vec3::new(2.9, 5.3, -1.1));
    let light = RectifiedLight::fit(a, b, 5, [512, 256], GROUND.into_iter());
    let bits = |view: &View| view.rows().map(|row| row.map(f32::to_bits));
    for frustum in light.frusta() {
        let first = bits(&frustum.views()[0]);
        for view in &frustum.views()[1..] {
            let [u, v, n, q] = bits(view);
            assert_eq!((&u[..3], v, n, q), (&first[0][..3], first[1], first[2], first[3]));
            assert_ne!(u[3], first[0][3]);
        }
    }
}

#[test]
fn every_sample_sees_every_point() {
    let (a, b) = (Vec3::new(-1.0, 4.0, 0.0), Vec3::new(1.0, 4.0, 0.0));
    let points = GROUND.into_iter().chain([Vec3::new(-0.5, 3.0, 0.3), Vec3::new(0.7, 3.5, -0.2)]);
    let light = RectifiedLight::fit(a, b, 3, [512, 512], points.clone());
    let [views] = light.frusta() else { panic!("one frustum was enough") };
    assert_eq!(views.views()[0].eye(), [-1.0, 4.0, 0.0, 1.0]);
    assert_eq!(views.views()[1].eye(), [0.0, 4.0, 0.0, 1.0]);
    assert_eq!(views.views()[2].eye(), [1.0, 4.0, 0.0, 1.0]);
    for view in views.views() {
        for p in points.clone() {
            let seen = view.texel_from_world(p).unwrap();
            assert!(seen.x >= 0.0 && seen.x <= 512.0 && seen.y >= 0.0 && seen.y <= 512.0);
            assert!(seen.z < view.max_nearness());
        }
    }
}

/// Where the samples of its own frustum have `p`: whether all do inside their windows.
fn is_shown(light: &RectifiedLight, p: Vec3) -> bool {
    let views = &light.frusta()[light.frustum_of(p)];
    views.views().iter().all(|view| {
        let seen = view.texel_from_world(p).expect("in front of its own frustum");
        let (width, height) = (view.width() as f32, view.height() as f32);
        assert!(seen.y >= 0.0 && seen.y <= height, "{p} {seen}");
        assert!(seen.z < view.max_nearness());
        seen.x >= 0.0 && seen.x <= width
    })
}

#[test]
fn the_frusta_of_a_light_in_a_room_share_the_room_out() {
    let (a, b) = (Vec3::new(-0.5, 0.2, 0.1), Vec3::new(0.5, 0.2, 0.1));
    let light = RectifiedLight::fit(a, b, 2, [256, 256], room());
    assert_eq!(light.frusta().len(), MAX_FRUSTA);
    let mut unseen = 0;
    for i in 0..4096 {
        let p = Vec3::new((i % 16) as f32, (i / 16 % 16) as f32, (i / 256) as f32) * 0.39 - 2.9;
        if !is_shown(&light, p) {
            // Only what is right beside the light itself.
            assert!(p.x.abs() <= 0.5 && p.yz().distance(a.yz()) < 0.5, "{p}");
            unseen += 1;
        }
    }
    assert!(unseen < 10, "{unseen}");
}

#[test]
fn a_light_that_points_at_the_ground_shows_all_of_it_but_a_quarter_of_a_degree() {
    let (a, b) = (Vec3::new(0.1, 4.0, -0.2), Vec3::new(0.4, 3.0, 0.3));
    let light = RectifiedLight::fit(a, b, 2, [256, 256], GROUND.into_iter());
    // Four faces, with two frusta beyond the lower end each.
    assert_eq!(light.frusta().len(), 12);
    let axis = (b - a).normalize();
    let mut unseen = 0;
    for i in 0..10_000 {
        let p = Vec3::new((i % 100) as f32 * 0.1 - 4.95, 0.0, (i / 100) as f32 * 0.1 - 4.95);
        if !is_shown(&light, p) {
            assert!((p - a).normalize().cross(axis).length() < 0.005, "{p}");
            unseen += 1;
        }
    }
    assert!(unseen < 10, "{unseen}");
}

#[test]
fn only_the_end_that_receivers_lie_beyond_has_a_frustum_of_its_own() {
    let (a, b) = (Vec3::new(-1.0, 0.6, 0.0), Vec3::new(1.0, 0.6, 0.0));
    let whole = RectifiedLight::fit(a, b, 2, [256, 256], GROUND.into_iter());
    // Two faces for more than 120 degrees, both ends.
    assert_eq!(whole.frusta().len(), 6);
    assert!(!whole.is_complete());
    for i in 0..400 {
        let p = Vec3::new((i % 20) as f32 * 0.5 - 4.95, 0.0, (i / 20) as f32 * 0.5 - 4.75);
        assert!(is_shown(&whole, p), "{p}");
    }
    let half = GROUND.map(|p| p.max(Vec3::new(-1.0, 0.0, -9.0)));
    let half =
        RectifiedLight::fit_around(a, b, 2, [256, 256], GROUND.into_iter(), half.into_iter());
    assert_eq!(half.frusta().len(), 4);
}

#[test]
fn a_sample_in_between_and_other_counts_keep_the_window() {
    let window = Window { left: -1.0, top: -0.5, right: 2.0, bottom: 0.7 };
    let (a, b) = (Vec3::new(0.0, 4.0, 0.0), Vec3::new(2.0, 4.0, 0.0));
    let three = SampleViews::new(a, b, 3, Vec3::NEG_Y, window, [64, 64], 0.1);
    assert_eq!(three.view_at(0.5), three.views()[1]);
    let five = three.with_samples(5);
    assert_eq!(five.views()[2], three.views()[1]);
    assert_eq!(five.disparity(), three.disparity() * 0.5);
}

proptest! {
    #[test]
    fn any_floats(
        v in proptest::array::uniform12(any::<f32>()),
        samples in 2_usize..5,
    ) {
        let p = [Vec3::from_slice(&v[6..]), Vec3::from_slice(&v[9..])];
        let (a, b) = (Vec3::from_slice(&v), Vec3::from_slice(&v[3..]));
        let light = RectifiedLight::fit(a, b, samples, [16, 16], p.into_iter());
        prop_assert!(light.frustum_of(p[0]) < light.frusta().len());
        if let Some(point) = light.frusta()[0].light_point(p[0], p[1]) {
            let _ = light.frusta()[0].in_sample(&point, samples - 1);
        }
    }
}
