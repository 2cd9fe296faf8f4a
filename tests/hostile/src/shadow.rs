//! The single-sample method on any maps, from any views.

use glam::Vec3;
use shadowmap_core::{Bias, Level, PackedMap, Surface, Threads};
use simd_search::{NodeGroup, Pyramid};
use single_sample::paper::{InnerWidth, Penumbra};
use single_sample::{Camera, LightMap, Surfaces, Texels, paper, search};

use crate::any::{Bytes, Map, assert_same, assert_unit};

pub fn check(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let (sound, size) = (bytes.flag(), bytes.size(20));
    let camera_view = bytes.view_that(sound, size);
    let camera_map = bytes.map_that(sound, size);
    let normals: Vec<Vec3>;
    let table: Vec<Surface>;
    let surfaces = match bytes.byte() % 3 {
        0 => Surfaces::FromDepth,
        1 => {
            let normal = bytes.normal();
            normals = vec![normal; camera_map.nearness.len()];
            Surfaces::Normals(&normals)
        }
        _ => {
            let surface = |id| Surface { normal: bytes.normal(), id };
            table = (0..4).map(surface).collect();
            Surfaces::Table(&table)
        }
    };
    let camera = Camera::new(&camera_view, camera_map.as_depth_map(), surfaces);
    let camera = camera.expect("one size");
    let size = bytes.size(36);
    let light_view = bytes.view_that(sound, size);
    let light_map = bytes.map_that(sound, size);
    let pack = |(&nearness, &id)| PackedMap::pack(nearness, light_view.max_nearness(), id);
    let packed: Vec<u32> = light_map.nearness.iter().zip(&light_map.ids).map(pack).collect();
    let texels = if bytes.flag() {
        Texels::Plain(light_map.as_depth_map())
    } else {
        Texels::Packed(PackedMap::new(size[0], size[1], &packed).expect("one texel each"))
    };
    let light = LightMap::new(&light_view, texels).expect("one size");

    paper_method(bytes, &camera, &light);
    let parameters = search::Parameters {
        radius: if sound { 0.5 } else { bytes.number() },
        group: if bytes.flag() { 1 } else { bytes.word() },
        tolerance: if bytes.flag() { 1.0 / 16.0 } else { bytes.number() },
        bias: if sound { Bias::default() } else { bytes.bias() },
    };
    let one = visibility(Level::SCALAR, &camera, &light, &parameters);
    assert_unit(&one);
    let level = bytes.level();
    let other = visibility(level, &camera, &light, &parameters);
    assert_same(level.kind().name(), &other, &one);
    // Only of what is consistent: where numbers overflow, or normals contradict depth, the fast way
    // and the naive one are free to differ.
    let is_consistent = sound && matches!(surfaces, Surfaces::FromDepth);
    if is_consistent && parameters.group <= 1 && !one.is_empty() {
        for _ in 0..3 {
            let pixel = bytes.word() % one.len() as u32;
            let (x, y) = (pixel % camera_view.width(), pixel / camera_view.width());
            let naive = search::naive(&camera, &light, &parameters, x, y);
            assert_same("naive", &[naive], &[one[pixel as usize]]);
        }
    }
    // A NaN never blocks, as what is infinitely far never does.
    let [nan, far] = [f32::NAN, f32::NEG_INFINITY].map(|value| light_map.filled(value));
    let [nan, far] = [nan, far].each_ref().map(|map: &Map| {
        let light = LightMap::new(&light_view, Texels::Plain(map.as_depth_map()));
        visibility(level, &camera, &light.expect("one size"), &parameters)
    });
    assert_same("NaN", &nan, &far);
}

fn visibility(
    level: Level,
    camera: &Camera<'_>,
    light: &LightMap<'_>,
    parameters: &search::Parameters,
) -> Vec<f32> {
    let size = [light.view().width(), light.view().height()];
    let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(size[0], size[1])];
    let pyramid = match light.texels() {
        Texels::Plain(map) => Pyramid::build(level, map, &mut nodes, &mut []),
        Texels::Packed(map) => Pyramid::build(level, map, &mut nodes, &mut []),
    };
    let pyramid = pyramid.expect("as long as asked");
    let mut out = vec![f32::NAN; camera.map().nearness().len()];
    let threads = Threads::One;
    search::visibility(level, threads, camera, light, &pyramid, parameters, &mut out);
    out
}

fn paper_method(bytes: &mut Bytes<'_>, camera: &Camera<'_>, light: &LightMap<'_>) {
    let default = paper::Parameters::default();
    let sound = bytes.flag();
    let mut or = |value: f32| if sound { value } else { bytes.number() };
    let parameters = paper::Parameters {
        r_scale: or(default.r_scale),
        r_bias: or(default.r_bias),
        r_shrink: or(default.r_shrink),
        jitter: or(default.jitter),
        penumbra: [Penumbra::Hard, Penumbra::Outer, Penumbra::Both][usize::from(bytes.byte() % 3)],
        inner_width: [InnerWidth::Blocker, InnerWidth::LitTexel][usize::from(bytes.byte() % 2)],
        id_bits: bytes.up_to(40),
        bias: bytes.bias(),
    };
    let mut out = vec![f32::NAN; camera.map().nearness().len()];
    paper::visibility(camera, light, &parameters, Threads::One, &mut out);
    assert_unit(&out);
}
