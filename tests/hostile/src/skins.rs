//! Visibility channels of any maps, and what receivers anywhere see by them.

use glam::Vec3;
use linear_light::{
    Discontinuity, EdgeFilter, RectifiedLight, SampleViews, SkinOptions, SkinShadow, Transition,
    VisibilityChannels, diffuse, lines, visibility,
};
use shadowmap_core::{Camera, DepthMap, Level, Light, Surfaces, Threads, View};

use crate::any::{Bytes, Map, assert_same, assert_unit};

/// The two ends of a light; every other one hangs over the scene.
pub fn ends(bytes: &mut Bytes<'_>) -> [Vec3; 2] {
    if bytes.flag() {
        return [Vec3::new(-1.0, 5.0, 0.2), Vec3::new(1.0, 5.0, 0.0)];
    }
    [bytes.vector(), bytes.vector()]
}

/// Sample views through any window, or fitted to any points.
pub fn light(bytes: &mut Bytes<'_>, samples: usize, size: [u32; 2]) -> RectifiedLight {
    let [a, b] = ends(bytes);
    if bytes.flag() {
        let points: Vec<Vec3> = (0..bytes.up_to(6)).map(|_| bytes.vector()).collect();
        return RectifiedLight::fit(a, b, samples, size, points.iter().copied());
    }
    let towards = if bytes.flag() { Vec3::NEG_Y } else { bytes.vector() };
    let (window, near) = (bytes.window(), bytes.number());
    RectifiedLight::from_frustum(SampleViews::new(a, b, samples, towards, window, size, near))
}

pub fn check(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let (samples, size) = (2 + bytes.up_to(2) as usize, bytes.size(40));
    let options = SkinOptions {
        transition: if bytes.flag() { Transition::Linear } else { Transition::Rational },
        discontinuity: Discontinuity {
            filter: if bytes.flag() { EdgeFilter::DepthStep } else { EdgeFilter::Laplacian },
            threshold: if bytes.flag() { 1.0 } else { bytes.number() },
        },
        level: Level::SCALAR,
        threads: Threads::One,
    };
    let level = bytes.level();
    areas(bytes);
    let is_rectified = bytes.flag();
    let light = light(bytes, samples, size);
    let frusta = if is_rectified { light.frusta() } else { &light.frusta()[..1] };
    let maps: Vec<Vec<Map>> = frusta.iter().map(|frustum| bytes.maps_of(frustum.views())).collect();
    let maps: Vec<Vec<DepthMap<'_>>> =
        maps.iter().map(|maps| maps.iter().map(Map::as_depth_map).collect()).collect();
    let views: Vec<View> = (0..samples).map(|_| bytes.view(size)).collect();
    let channels = |level: Level| -> Vec<VisibilityChannels> {
        let options = SkinOptions { level, ..options };
        let each = light.frusta().iter().zip(&maps).map(|(frustum, maps)| {
            let mut channels = VisibilityChannels::new();
            if is_rectified {
                channels.draw_rectified(frustum, maps, &options);
            } else {
                channels.draw_unrelated(&views, maps, &options);
            }
            channels
        });
        each.collect()
    };
    let drawn = channels(Level::SCALAR);
    for ((a, b), maps) in drawn.iter().zip(&channels(level)).zip(&maps) {
        let mut out = [(); 2].map(|()| vec![f32::NAN; maps[0].nearness().len()]);
        for k in 0..samples {
            a.channel(k, &mut out[0]);
            b.channel(k, &mut out[1]);
            assert_same(level.kind().name(), &out[1], &out[0]);
            assert_unit(&out[0]);
        }
    }
    let bias = bytes.bias();
    let shadows: Vec<SkinShadow<'_>> = (light.frusta().iter().zip(&maps).zip(&drawn))
        .map(|((frustum, maps), channels)| match is_rectified {
            true => SkinShadow::rectified(frustum, maps, channels, bias),
            false => SkinShadow::unrelated(&views, maps, channels, bias),
        })
        .collect();
    for _ in 0..4 {
        let (position, normal) = (bytes.vector(), bytes.normal());
        let frustum = if is_rectified { light.frustum_of(position) } else { 0 };
        let seen = shadows[frustum].visibility(position, normal);
        let mut sum = 0.0;
        shadows[frustum].light(position, normal, |_, part| sum += part);
        assert_unit(&[seen]);
        assert!((sum - seen).abs() < 1e-5, "samples add up to {sum}, not {seen}");
    }
    let size = bytes.size(32);
    let (view, map) = (bytes.view(size), bytes.map(size));
    let camera = Camera::new(&view, map.as_depth_map(), Surfaces::FromDepth).expect("one size");
    let mut out = vec![f32::NAN; map.nearness.len()];
    visibility(&camera, &shadows, Threads::One, &mut out);
    assert_unit(&out);
}

/// Lines that stand for any light with an area, and the light that they give.
fn areas(bytes: &mut Bytes<'_>) {
    let [a, b, c] = [bytes.vector(), bytes.vector(), bytes.vector()];
    for light in [Light::Triangle { a, b, c }, Light::Rectangle { corner: a, edge_u: b, edge_v: c }]
    {
        let lines = lines(&light, 1 + bytes.up_to(7) as usize).expect("a light with an area");
        assert!(!lines.is_empty() && lines.iter().all(|line| line.weight >= 0.0), "{lines:?}");
        let sum: f32 = lines.iter().map(|line| line.weight).sum();
        assert!((sum - 1.0).abs() < 1e-4, "weights add up to {sum}");
    }
    let received = diffuse(a, bytes.normal(), b, c);
    let finite = [a, b, c].iter().all(|p| p.is_finite());
    assert!(!finite || received >= 0.0, "{received} of light");
}
