//! Percentage-closer filtering and soft shadows where the answer is known.

use std::f64::consts::PI;

use glam::Vec3;
use reference::{Pcf, Pcss};
use shadowmap_core::{Bias, DepthMap, Light, LightPoint, View, Window};

const SIZE: u32 = 128;

/// A map whose columns from `edge` on hold `near`, the others nothing.
fn half_map(edge: u32, near: f32) -> Vec<f32> {
    (0..SIZE * SIZE).map(|i| if i % SIZE < edge { 0.0 } else { near }).collect()
}

fn map(nearness: &[f32]) -> DepthMap<'_> {
    DepthMap::new(SIZE, SIZE, nearness, &[]).unwrap()
}

#[test]
fn a_filter_of_a_straight_edge_is_a_ramp() {
    let nearness = half_map(64, 0.5);
    for (radius, samples) in [(1.0, 64), (4.0, 256), (9.5, 1024)] {
        let pcf = Pcf { radius, samples };
        for distance in [-12.0, -4.0, -3.1, -0.5, 0.0, 0.25, 2.0, 8.0, 11.0_f32] {
            let point = LightPoint::flat(64.0 - distance, 60.3, 0.25);
            let exact = (0.5 + distance / (2.0 * radius)).clamp(0.0, 1.0);
            let found = pcf.visibility(&map(&nearness), &point, Bias::default(), 3);
            // One column of strata straddles the edge.
            let columns = (samples as f32).sqrt();
            assert!(
                (found - exact).abs() < 1.0 / columns,
                "{radius} {distance}: {found}, not {exact}"
            );
        }
    }
}

#[test]
fn nothing_in_front_is_lit_and_everything_is_dark() {
    let point = LightPoint::flat(64.0, 64.0, 0.25);
    for (value, exact) in [(0.0, 1.0), (0.2, 1.0), (0.25, 1.0), (0.3, 0.0), (f32::NAN, 1.0)] {
        let nearness = vec![value; (SIZE * SIZE) as usize];
        let map = map(&nearness);
        assert_eq!(Pcf::default().visibility(&map, &point, Bias::default(), 0), exact);
        let view = View::perspective(Vec3::ZERO, Vec3::NEG_Y, Vec3::Z, 1.5, SIZE, SIZE, 0.1);
        let light = Light::Sphere { center: Vec3::ZERO, radius: 0.05 };
        let pcss = Pcss::new(&light, &view, &map).unwrap();
        assert_eq!(pcss.visibility(&view, &map, &point, Bias::default(), 0), exact);
        // Outside the map is lit.
        let outside = LightPoint::flat(-900.0, f32::NAN, 0.25);
        assert_eq!(Pcf::default().visibility(&map, &outside, Bias::default(), 0), 1.0);
        assert_eq!(pcss.visibility(&view, &map, &outside, Bias::default(), 0), 1.0);
    }
}

/// A receiver's own plane, however steep, does not block it.
#[test]
fn a_steep_plane_does_not_shadow_itself() {
    let slope = 0.004;
    let plane = |i: u32| 0.1 + slope * ((i % SIZE) as f32 + 0.5);
    let nearness: Vec<f32> = (0..SIZE * SIZE).map(plane).collect();
    let mut point = LightPoint::flat(40.0, 40.0, 0.1 + slope * 40.0);
    point.slope.x = slope;
    let pcf = Pcf { radius: 20.0, samples: 256 };
    assert_eq!(pcf.visibility(&map(&nearness), &point, Bias::default(), 0), 1.0);
}

/// One straight edge at one depth is the case that the three steps get right.
#[test]
fn soft_shadows_of_a_straight_edge_are_a_disc_cut_by_a_line() {
    let sphere = Light::Sphere { center: Vec3::ZERO, radius: 0.1 };
    let looking_down = View::axes_towards(Vec3::NEG_Y, Vec3::Z);
    let perspective = View::perspective_window(
        Vec3::ZERO,
        looking_down,
        Window::centered(0.5, 0.5),
        SIZE,
        SIZE,
        0.1,
    );
    let sun = Light::Sun { direction: Vec3::NEG_Y, angle: 0.2 };
    let orthographic = View::orthographic_window(
        Vec3::ZERO,
        looking_down,
        Window::centered(2.0, 2.0),
        SIZE,
        SIZE,
        [0.0, 6.0],
    );
    // Blocker 2 m and receiver 4 m from the light's centre; and 3 m above the receiver.
    let cases = [
        (sphere, perspective, 0.5, 0.25, 0.1 * 128.0 * 0.25),
        (sun, orthographic, 5.0, 2.0, 32.0 * 0.1_f32.tan() * 3.0),
    ];
    for (light, view, blocker, receiver, radius) in cases {
        let nearness = half_map(64, blocker);
        let map = map(&nearness);
        let pcss = Pcss { filter_samples: 1024, ..Pcss::new(&light, &view, &map).unwrap() };
        for s in [-1.2, -0.8, -0.3, 0.0, 0.4, 0.9, 1.3_f32] {
            let point = LightPoint::flat(64.0 - s * radius, 64.0, receiver);
            let found = pcss.visibility(&view, &map, &point, Bias::default(), 5);
            let s = f64::from(s).clamp(-1.0, 1.0);
            let exact = 0.5 + (s.asin() + s * (1.0 - s * s).sqrt()) / PI;
            assert!((f64::from(found) - exact).abs() < 0.02, "s {s}: {found}, not {exact}");
        }
    }
    assert_eq!(Pcss::new(&sun, &perspective, &map(&half_map(1, 1.0))), None);
}
