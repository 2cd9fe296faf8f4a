//! Interval visibility of any maps.

use linear_light::{FrustumMaps, IntervalVisibility, SampleMap};
use shadowmap_core::{Bias, Camera, Level, Surface, Surfaces, Threads};

use crate::any::{Bytes, Map, assert_same, assert_unit};
use crate::skins;

pub fn check(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let (samples, size) = (2 + bytes.up_to(2) as usize, bytes.size(28));
    let light = skins::light(bytes, samples, size);
    let maps: Vec<Vec<Map>> =
        light.frusta().iter().map(|frustum| bytes.maps_of(frustum.views())).collect();
    let size = bytes.size(20);
    let (view, map) = (bytes.view(size), bytes.map(size));
    let table: Vec<Surface> = (0..4).map(|id| Surface { normal: bytes.normal(), id }).collect();
    let surfaces = if bytes.flag() { Surfaces::FromDepth } else { Surfaces::Table(&table) };
    let camera = Camera::new(&view, map.as_depth_map(), surfaces).expect("one size");
    let (bias, level) = (bytes.bias(), bytes.level());

    let visibility = |level: Level, maps: &[Vec<Map>]| visible(level, &camera, &light, maps, bias);
    let one = visibility(Level::SCALAR, &maps);
    assert_unit(&one);
    assert_same(level.kind().name(), &visibility(level, &maps), &one);
    // A NaN never blocks, as what is infinitely far never does.
    let filled = |value: f32| -> Vec<Vec<Map>> {
        maps.iter().map(|maps| maps.iter().map(|map| map.filled(value)).collect()).collect()
    };
    let nan = visibility(level, &filled(f32::NAN));
    assert_same("NaN", &nan, &visibility(level, &filled(f32::NEG_INFINITY)));
}

fn visible(
    level: Level,
    camera: &Camera<'_>,
    light: &linear_light::RectifiedLight,
    maps: &[Vec<Map>],
    bias: Bias,
) -> Vec<f32> {
    let samples: Vec<Vec<SampleMap<'_>>> = (maps.iter())
        .map(|maps| {
            let last = (maps.len() - 1) as f32;
            let samples = maps.iter().enumerate();
            samples
                .map(|(k, map)| SampleMap { t: k as f32 / last, map: map.as_depth_map() })
                .collect()
        })
        .collect();
    let frusta: Vec<FrustumMaps<'_>> = (light.frusta().iter().zip(&samples))
        .map(|(views, samples)| FrustumMaps { views, samples })
        .collect();
    let mut out = vec![f32::NAN; camera.map().nearness().len()];
    let mut intervals = IntervalVisibility::new(level, Threads::One);
    intervals.prepare(&frusta);
    intervals.visibility(camera, &frusta, bias, &mut out);
    out
}
