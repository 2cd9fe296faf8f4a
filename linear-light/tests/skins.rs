//! Visibility channels and their shading, against answers known on paper.

use glam::Vec3;
use linear_light::{
    SampleViews, SkinOptions, SkinShadow, Transition, VisibilityChannels, visibility,
};
use proptest::prelude::*;
use shadowmap_core::{Bias, Camera, DepthMap, Level, Surface, Surfaces, Threads, View, Window};

const SIZE: u32 = 256;

/// A light from (-1, 4, 0) to (1, 4, 0), seen through a window of 2 x 2 tangents.
fn views(samples: usize) -> SampleViews {
    let (a, b) = (Vec3::new(-1.0, 4.0, 0.0), Vec3::new(1.0, 4.0, 0.0));
    SampleViews::new(a, b, samples, Vec3::NEG_Y, Window::centered(1.0, 1.0), [SIZE; 2], 0.1)
}

/// A map of what `nearest` says of each ray from `view`: its hits' heights y, in a plane each.
fn map(view: &View, heights: impl Fn(Vec3) -> f32) -> Vec<f32> {
    let eye = view.eye();
    let eye = Vec3::new(eye[0], eye[1], eye[2]);
    (0..SIZE * SIZE)
        .map(|i| {
            let (x, y) = ((i % SIZE) as f32 + 0.5, (i / SIZE) as f32 + 0.5);
            // Ray parameter 1 is one metre down.
            let ray = view.world_from_texel(x, y, 1.0) - eye;
            1.0 / (4.0 - heights(ray))
        })
        .collect()
}

/// Maps of the half-plane x < 0 at height 2 above the ground y = 0.
fn half_plane(views: &SampleViews) -> Vec<Vec<f32>> {
    let hit = |view: &View| {
        let eye = view.eye()[0];
        map(view, |ray| if eye + 2.0 * ray.x < 0.0 { 2.0 } else { 0.0 })
    };
    views.views().iter().map(hit).collect()
}

fn borrowed(maps: &[Vec<f32>]) -> Vec<DepthMap<'_>> {
    maps.iter().map(|m| DepthMap::new(SIZE, SIZE, m, &[]).unwrap()).collect()
}

fn options(transition: Transition) -> SkinOptions {
    SkinOptions { transition, ..SkinOptions::default() }
}

/// What the ground at x sees past the edge (0, 2): the light's points right of -x.
fn on_paper(x: f32) -> f32 {
    ((1.0 + x) / 2.0).clamp(0.0, 1.0)
}

#[test]
fn half_plane_above_a_parallel_ground() {
    for samples in [2, 3, 5] {
        let views = views(samples);
        let maps = half_plane(&views);
        let maps = borrowed(&maps);
        for transition in [Transition::Linear, Transition::Rational] {
            let mut channels = VisibilityChannels::new();
            channels.draw_rectified(&views, &maps, &options(transition));
            let shadow = SkinShadow::rectified(&views, &maps, &channels, Bias::default());
            for i in 0..400 {
                let p = Vec3::new(i as f32 * 0.01 - 2.0, 0.0, 0.3);
                let seen = shadow.visibility(p, Vec3::Y);
                // Half a texel of a penumbra of 64.
                assert!((seen - on_paper(p.x)).abs() < 0.008, "{samples} {p} {seen}");
            }
        }
    }
}

#[test]
fn rational_is_exact_on_a_tilted_ground() {
    // The ground y = -x / 2 for x in front of the edge at the origin's height 2.
    let views = views(2);
    let maps: Vec<_> = views
        .views()
        .iter()
        .map(|view| {
            let eye = view.eye()[0];
            map(view, |ray| {
                if eye + 2.0 * ray.x < 0.0 {
                    2.0
                } else {
                    // (eye + s ray.x, 4 - s) with y = -x / 2.
                    4.0 - (4.0 + eye * 0.5) / (1.0 - ray.x * 0.5)
                }
            })
        })
        .collect();
    let maps = borrowed(&maps);
    let worst = [Transition::Linear, Transition::Rational].map(|transition| {
        let mut channels = VisibilityChannels::new();
        channels.draw_rectified(&views, &maps, &options(transition));
        let shadow = SkinShadow::rectified(&views, &maps, &channels, Bias::default());
        let normal = Vec3::new(0.5, 1.0, 0.0).normalize();
        (0..300)
            .map(|i| {
                let x = i as f32 * 0.01 - 1.5;
                let p = Vec3::new(x, -x * 0.5, 0.3);
                // The ray from p past (0, 2) meets y = 4 at x_l.
                let x_l = -x * 2.0 / (2.0 - p.y);
                let truth = ((1.0 - x_l) / 2.0).clamp(0.0, 1.0);
                (shadow.visibility(p, normal) - truth).abs()
            })
            .fold(0.0, f32::max)
    });
    assert!(worst[1] < 0.01, "{worst:?}");
    assert!(worst[0] > 4.0 * worst[1], "{worst:?}");
}

#[test]
fn channels_of_an_open_scene_add_up_to_one() {
    let views = views(4);
    let maps = vec![vec![0.25; (SIZE * SIZE) as usize]; 4];
    let maps = borrowed(&maps);
    let mut channels = VisibilityChannels::new();
    channels.draw_rectified(&views, &maps, &SkinOptions::default());
    let mut channel = vec![0.0; (SIZE * SIZE) as usize];
    for (k, expected) in [0.5, 1.0, 1.0, 0.5].into_iter().enumerate() {
        channels.channel(k, &mut channel);
        assert!(channel.iter().all(|&v| (v * 3.0 - expected).abs() < 1e-6));
    }
    let shadow = SkinShadow::rectified(&views, &maps, &channels, Bias::default());
    let mut shares = Vec::new();
    let seen = shadow.light(Vec3::ZERO, Vec3::Y, |k, v| shares.push((k, v)));
    assert!((seen - 1.0).abs() < 1e-6);
    assert_eq!(shares.len(), 4);
    assert!((shares[0].1 * 6.0 - 1.0).abs() < 1e-6 && (shares[1].1 * 3.0 - 1.0).abs() < 1e-6);
}

#[test]
fn the_horizon_cuts_the_light() {
    let views = views(3);
    let maps = vec![vec![0.0; (SIZE * SIZE) as usize]; 3];
    let maps = borrowed(&maps);
    let mut channels = VisibilityChannels::new();
    channels.draw_rectified(&views, &maps, &SkinOptions::default());
    let shadow = SkinShadow::rectified(&views, &maps, &channels, Bias::default());
    // A wall at x = -0.5 that faces x: it sees the light from there on, three quarters.
    let seen = shadow.visibility(Vec3::new(-0.5, 1.0, 0.0), Vec3::X);
    assert!((seen - 0.75).abs() < 1e-6, "{seen}");
    assert_eq!(shadow.visibility(Vec3::ZERO, Vec3::NEG_Y), 0.0);
    // Far outside every map.
    assert_eq!(shadow.visibility(Vec3::new(40.0, 0.0, 0.0), Vec3::Y), 1.0);
}

#[test]
fn levels_and_threads_give_the_same_bits() {
    let views = views(3);
    let maps = half_plane(&views);
    let maps = borrowed(&maps);
    let mut plain = VisibilityChannels::new();
    let scalar =
        SkinOptions { level: Level::SCALAR, threads: Threads::One, ..SkinOptions::default() };
    plain.draw_rectified(&views, &maps, &scalar);
    let pixels = |channels: &VisibilityChannels| {
        let mut out = vec![0.0_f32; (SIZE * SIZE) as usize];
        (0..3)
            .flat_map(|k| {
                channels.channel(k, &mut out);
                out.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
            })
            .collect::<Vec<_>>()
    };
    for level in Level::available() {
        let mut channels = VisibilityChannels::new();
        let options = SkinOptions { level, threads: Threads::default(), ..SkinOptions::default() };
        channels.draw_rectified(&views, &maps, &options);
        assert_eq!(pixels(&channels), pixels(&plain), "{}", level.kind().name());
    }
}

#[test]
fn an_image_is_shaded_as_its_receivers_are() {
    let views = views(3);
    let maps = half_plane(&views);
    let maps = borrowed(&maps);
    // The ground, seen from the side: one surface, and every fifth pixel another one, or none.
    let eye = Vec3::new(1.0, 3.0, 2.5);
    let camera = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.4, 75, 40, 0.1);
    let ids: Vec<u32> = (0..75 * 40).map(|i| if i > 1500 { 1 + (i % 5) / 4 } else { 1 }).collect();
    let nearness: Vec<f32> = (0..75 * 40)
        .map(|i| {
            let ray = camera.world_from_texel((i % 75) as f32 + 0.5, (i / 75) as f32 + 0.5, 1.0);
            if i % 77 == 0 { 0.0 } else { -(ray - eye).y / eye.y }
        })
        .collect();
    let table =
        [Surface::UNKNOWN, Surface { normal: Vec3::Y, id: 1 }, Surface { normal: Vec3::Y, id: 2 }];
    let map = DepthMap::new(75, 40, &nearness, &ids).unwrap();
    for surfaces in [Surfaces::Table(&table), Surfaces::FromDepth] {
        let seen_by = Camera::new(&camera, map, surfaces).unwrap();
        let mut expected = None;
        for level in Level::available() {
            let mut channels = VisibilityChannels::new();
            let options = SkinOptions { level, ..SkinOptions::default() };
            channels.draw_rectified(&views, &maps, &options);
            let shadow = SkinShadow::rectified(&views, &maps, &channels, Bias::default());
            let mut out = vec![f32::NAN; 75 * 40];
            let counters = visibility(&seen_by, &[shadow], Threads::default(), &mut out);
            assert_eq!(counters.receivers as usize, nearness.iter().filter(|n| **n > 0.0).count());
            let mut partly = 0;
            for (i, &v) in out.iter().enumerate() {
                let (x, y) = ((i % 75) as f32 + 0.5, (i / 75) as f32 + 0.5);
                let n = nearness[i];
                let position = camera.world_from_texel(x, y, n);
                let alone = if n > 0.0 { shadow.visibility(position, Vec3::Y) } else { 0.0 };
                // Planes beside nothing cannot be told from depth.
                let known = matches!(surfaces, Surfaces::Table(_));
                assert!(!known || (v - alone).abs() < 0.001, "pixel {i}: {v} instead of {alone}");
                partly += usize::from(v > 0.1 && v < 0.9);
            }
            assert!(partly > 500, "{partly} pixels in penumbra");
            assert_eq!(*expected.get_or_insert_with(|| out.clone()), out, "{level:?}");
        }
    }
}

proptest! {
    #[test]
    fn any_maps_and_receivers(
        texels in proptest::collection::vec(any::<f32>(), 2 * 8 * 6),
        receivers in proptest::collection::vec(any::<f32>(), 7 * 5),
        threshold in any::<f32>(),
        ends in proptest::array::uniform6(-1e3_f32..1e3),
    ) {
        let (a, b) = (Vec3::from_slice(&ends), Vec3::from_slice(&ends[3..]));
        let views =
            SampleViews::new(a, b, 2, Vec3::NEG_Y, Window::centered(1.0, 1.0), [8, 6], 0.1);
        let maps: Vec<_> =
            texels.chunks(48).map(|m| DepthMap::new(8, 6, m, &[]).unwrap()).collect();
        let mut channels = VisibilityChannels::new();
        let mut options = SkinOptions::default();
        options.discontinuity.threshold = threshold;
        channels.draw_rectified(&views, &maps, &options);
        let mut out = vec![0.0; 48];
        channels.channel(0, &mut out);
        prop_assert!(out.iter().all(|v| (0.0..=1.0).contains(v)));
        let shadow = SkinShadow::rectified(&views, &maps, &channels, Bias::default());
        let position = Vec3::from_slice(&receivers);
        let _ = shadow.visibility(position, Vec3::from_slice(&receivers[3..]));
        let eye = View::perspective(position, Vec3::ZERO, Vec3::Y, 1.0, 7, 5, 0.1);
        let map = DepthMap::new(7, 5, &receivers, &[]).unwrap();
        let camera = Camera::new(&eye, map, Surfaces::FromDepth).unwrap();
        let mut seen = vec![0.0; 35];
        visibility(&camera, &[shadow], Threads::default(), &mut seen);
        options.level = Level::SCALAR;
        channels.draw_rectified(&views, &maps, &options);
        let shadow = SkinShadow::rectified(&views, &maps, &channels, Bias::default());
        let mut plain = vec![0.0; 35];
        visibility(&camera, &[shadow], Threads::One, &mut plain);
        prop_assert_eq!(seen, plain);
    }
}
