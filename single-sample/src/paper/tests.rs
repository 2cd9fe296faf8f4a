use glam::Vec3;
use proptest::prelude::*;
use shadowmap_core::{DepthMap, PackedMap, Window};
use std::{vec, vec::Vec};

use super::*;
use crate::Surfaces;

const SIZE: u32 = 32;

/// Straight down from 4 m, 8 texels per metre on the ground, orthographic.
fn overhead() -> View {
    let axes = View::axes_towards(Vec3::NEG_Y, Vec3::NEG_Z);
    let window = Window::centered(2.0, 2.0);
    View::orthographic_window(Vec3::Y * 4.0, axes, window, SIZE, SIZE, [0.0, 4.0])
}

/// Light map: a blocker 1 m above the ground (ID 2) left of column 16, ground (ID 1) elsewhere.
fn half_plane() -> (Vec<f32>, Vec<u32>) {
    (0..SIZE * SIZE).map(|i| if i % SIZE < 16 { (1.0, 2) } else { (0.0, 1) }).unzip()
}

/// A camera like the light, but under the blocker: it sees the ground everywhere.
fn masks(parameters: &Parameters, packed: bool) -> Vec<f32> {
    let view = overhead();
    let (nearness, ids) = half_plane();
    let packed_texels: Vec<u32> =
        nearness.iter().zip(&ids).map(|(&n, &id)| PackedMap::pack(n, 4.0, id)).collect();
    let texels = if packed {
        Texels::Packed(PackedMap::new(SIZE, SIZE, &packed_texels).unwrap())
    } else {
        Texels::Plain(DepthMap::new(SIZE, SIZE, &nearness, &ids).unwrap())
    };
    let light = LightMap::new(&view, texels).unwrap();
    // Nearness 0 is "nothing", so that the ground lies a hair above the far plane.
    let (ground, ids) = (vec![1e-6; (SIZE * SIZE) as usize], vec![1; (SIZE * SIZE) as usize]);
    let map = DepthMap::new(SIZE, SIZE, &ground, &ids).unwrap();
    let camera = Camera::new(&view, map, Surfaces::FromDepth).unwrap();
    let mut out = vec![f32::NAN; ground.len()];
    let counters = visibility(&camera, &light, parameters, Threads::One, &mut out);
    assert_eq!(counters.receivers, SIZE * SIZE);
    out
}

#[test]
fn half_plane_falls_linearly_and_meets_at_one_half() {
    // r_max = (2 * 4) * (0.5 * 1) = 4 texels. Distances are between texel centres.
    let parameters = Parameters { r_scale: 2.0, r_shrink: 0.5, ..Parameters::default() };
    for packed in [false, true] {
        let out = masks(&parameters, packed);
        let row = &out[16 * SIZE as usize..][..SIZE as usize];
        let expected = |x: usize| match x {
            0..=12 => 0.0,
            13..=15 => 0.5 - 0.125 * (16 - x) as f32,
            16..=18 => 0.5 + 0.125 * (x - 15) as f32,
            _ => 1.0,
        };
        for (x, &v) in row.iter().enumerate() {
            assert!((v - expected(x)).abs() < 1e-5, "column {x}: {v}, packed {packed}");
        }
    }
}

#[test]
fn outer_only_falls_to_nothing_and_hard_is_binary() {
    let base = Parameters { r_scale: 2.0, r_shrink: 0.5, ..Parameters::default() };
    let outer = masks(&Parameters { penumbra: Penumbra::Outer, ..base }, false);
    assert!((outer[16] - 0.25).abs() < 1e-5);
    assert_eq!((outer[15], outer[19]), (0.0, 1.0));
    let hard = masks(&Parameters { penumbra: Penumbra::Hard, ..base }, false);
    assert_eq!((hard[15], hard[16]), (0.0, 1.0));
}

#[test]
fn printed_inner_width_is_the_ring() {
    let parameters = Parameters { inner_width: InnerWidth::LitTexel, ..Parameters::default() };
    // 0 / 0 on a flat receiver: no inner penumbra at all beside a soft outer one.
    assert_eq!(masks(&parameters, false)[15], 0.0);
}

#[test]
fn ids_are_compared_modulo_a_power_of_two() {
    // IDs 1 and 2 differ in their lowest bit, so that one bit suffices; none sees one object.
    let base = Parameters { r_scale: 2.0, r_shrink: 0.5, ..Parameters::default() };
    assert_eq!(masks(&Parameters { id_bits: 1, ..base }, false), masks(&base, false));
    assert_eq!(masks(&Parameters { id_bits: 0, ..base }, false)[16], 1.0);
}

proptest! {
    #[test]
    fn any_input_gives_a_visibility(
        nearness in proptest::collection::vec(any::<f32>(), (SIZE * SIZE) as usize),
        seen in proptest::collection::vec(any::<f32>(), (SIZE * SIZE) as usize),
        r_scale in any::<f32>(), r_bias in any::<f32>(), r_shrink in any::<f32>(),
        jitter in any::<f32>(), slope in any::<f32>(),
    ) {
        let view = overhead();
        let map = DepthMap::new(SIZE, SIZE, &nearness, &[]).unwrap();
        let light = LightMap::new(&view, Texels::Plain(map)).unwrap();
        let seen = DepthMap::new(SIZE, SIZE, &seen, &[]).unwrap();
        let camera = Camera::new(&view, seen, Surfaces::FromDepth).unwrap();
        let bias = Bias { slope, ..Bias::default() };
        let parameters =
            Parameters { r_scale, r_bias, r_shrink, jitter, bias, ..Parameters::default() };
        let mut out = [f32::NAN; (SIZE * SIZE) as usize];
        visibility(&camera, &light, &parameters, Threads::One, &mut out);
        prop_assert!(out.iter().all(|v| (0.0..=1.0).contains(v)));
    }
}
