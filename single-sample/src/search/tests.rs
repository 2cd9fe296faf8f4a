use std::{vec, vec::Vec};

use glam::Vec3;
use proptest::prelude::*;
use shadowmap_core::{
    Camera, DepthMap, Level, PackedMap, Surface, Surfaces, Threads, View, Window,
};
use simd_search::{NodeGroup, Pyramid};

use super::{Parameters, naive, visibility};
use crate::{Counters, Found, LightMap, Texels, Visibility};

const MAP: u32 = 40;
const IMAGE: [u32; 2] = [37, 21];

/// A light map, and a camera's map with a surface per pixel.
struct Maps {
    light: View,
    texels: Vec<f32>,
    camera: View,
    pixels: Vec<f32>,
    indices: Vec<u32>,
    surfaces: Vec<Surface>,
}

impl Maps {
    fn render<V: Visibility + Default>(
        &self,
        level: Level,
        threads: Threads,
        parameters: &Parameters,
        packed: bool,
    ) -> (Vec<V>, Counters) {
        self.with(packed, |camera, light| {
            let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(MAP, MAP)];
            let pyramid = match light.texels() {
                Texels::Plain(map) => Pyramid::build(level, map, &mut nodes, &mut []),
                Texels::Packed(map) => Pyramid::build(level, map, &mut nodes, &mut []),
            };
            let mut out = vec![V::default(); self.pixels.len()];
            let counters =
                visibility(level, threads, camera, light, &pyramid.unwrap(), parameters, &mut out);
            (out, counters)
        })
    }

    fn with<R>(&self, packed: bool, run: impl FnOnce(&Camera<'_>, &LightMap<'_>) -> R) -> R {
        let [width, height] = IMAGE;
        let map = DepthMap::new(width, height, &self.pixels, &self.indices).unwrap();
        let camera = Camera::new(&self.camera, map, Surfaces::Table(&self.surfaces)).unwrap();
        let pack = |&n: &f32| PackedMap::pack(n, self.light.max_nearness(), 0);
        let words: Vec<u32> = self.texels.iter().map(pack).collect();
        let texels = if packed {
            Texels::Packed(PackedMap::new(MAP, MAP, &words).unwrap())
        } else {
            Texels::Plain(DepthMap::new(MAP, MAP, &self.texels, &[]).unwrap())
        };
        run(&camera, &LightMap::new(&self.light, texels).unwrap())
    }
}

/// Boxes (in texels) at some height over a ground, seen from a light above it.
fn ground_and_plates(
    sun: bool,
    plates: &[([u32; 4], f32, f32)],
    eye: Vec3,
    bumps: &[(u32, f32, Vec3)],
) -> Maps {
    let axes = View::axes_towards(Vec3::new(0.1, -1.0, 0.2), Vec3::X);
    let light = if sun {
        let window = Window::centered(2.0, 2.0);
        View::orthographic_window(Vec3::Y * 4.0, axes, window, MAP, MAP, [0.5, 7.0])
    } else {
        let window = Window::centered(0.5, 0.6);
        View::perspective_window(Vec3::Y * 4.0, axes, window, MAP, MAP, 0.5)
    };
    // Whatever nearness it has, a plane is two slopes: this is the ground y = height.
    let plane_at = |height: f32, view: &View, x: u32, y: u32| {
        let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
        let [a, b] = [0.25, 0.5].map(|n| view.world_from_texel(x, y, n).as_dvec3());
        let t = (f64::from(height) - a.y) / (b.y - a.y);
        let hit = (a + (b - a) * t).as_vec3();
        view.texel_from_world(hit).map_or(0.0, |seen| seen.z.clamp(0.0, view.max_nearness()))
    };
    let texels = (0..MAP * MAP)
        .map(|i| {
            let (x, y) = (i % MAP, i / MAP);
            let ground = plane_at(0.0, &light, x, y);
            plates.iter().fold(ground, |nearest, &([x0, y0, w, h], height, lean)| {
                if (x0..x0 + w).contains(&x) && (y0..y0 + h).contains(&y) {
                    nearest.max(plane_at(height + lean * (x - x0) as f32, &light, x, y))
                } else {
                    nearest
                }
            })
        })
        .collect();
    let [width, height] = IMAGE;
    let camera = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.6, width, height, 0.1);
    let count = width * height;
    let mut pixels: Vec<f32> =
        (0..count).map(|i| plane_at(0.0, &camera, i % width, i / width)).collect();
    let mut indices = vec![1; count as usize];
    let mut surfaces = vec![Surface::UNKNOWN, Surface { normal: Vec3::Y, id: 1 }];
    for &(i, factor, normal) in bumps {
        let i = (i % count) as usize;
        pixels[i] *= factor;
        indices[i] = surfaces.len() as u32;
        surfaces.push(Surface { normal: normal.normalize_or_zero(), id: 2 });
    }
    Maps { light, texels, camera, pixels, indices, surfaces }
}

fn plate() -> impl Strategy<Value = ([u32; 4], f32, f32)> {
    ([0..MAP, 0..MAP, 1..20_u32, 1..20_u32], 0.0..3.4_f32, -0.05..0.05_f32)
}

fn vector() -> impl Strategy<Value = Vec3> {
    [-1.0..1.0_f32, -1.0..1.0_f32, -1.0..1.0_f32].prop_map(Vec3::from)
}

#[test]
fn a_radius_that_is_no_number_counts_as_none() {
    let maps = ground_and_plates(false, &[([12, 12, 16, 16], 2.0, 0.0)], Vec3::Y * 3.0, &[]);
    let [none, nan] = [0.0, f32::NAN].map(|radius| {
        let parameters = Parameters { radius, ..Parameters::default() };
        maps.render::<f32>(Level::detect(), Threads::One, &parameters, false).0
    });
    assert!(none.contains(&0.0));
    assert_eq!(nan, none);
}

#[test]
#[should_panic(expected = "the pyramid is of a map of another size")]
fn a_pyramid_of_another_map_is_refused() {
    let maps = ground_and_plates(false, &[], Vec3::Y * 3.0, &[]);
    maps.with(false, |camera, light| {
        let texels = [0.25; 64];
        let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(8, 8)];
        let other = DepthMap::new(8, 8, &texels, &[]).unwrap();
        let pyramid = Pyramid::build(Level::SCALAR, other, &mut nodes, &mut []).unwrap();
        let mut out = vec![0.0_f32; maps.pixels.len()];
        let (level, threads) = (Level::SCALAR, Threads::One);
        visibility(level, threads, camera, light, &pyramid, &Parameters::default(), &mut out);
    });
}

#[test]
fn an_infinitely_near_texel_leaves_the_shadows_of_others() {
    // Under a point light, whose discs have no size.
    let mut maps = ground_and_plates(false, &[([12, 12, 16, 16], 2.0, 0.0)], Vec3::Y * 3.0, &[]);
    let parameters = Parameters { group: 1, ..Parameters::default() };
    let level = Level::detect();
    let (expected, _) = maps.render::<f32>(level, Threads::One, &parameters, false);
    assert!(expected.contains(&0.0));
    for near in [f32::INFINITY, f32::MAX] {
        maps.texels[0] = near;
        let (found, _) = maps.render::<f32>(level, Threads::One, &parameters, false);
        assert_eq!(found, expected, "{near}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn equals_the_naive_method_at_every_level(
        sun in any::<bool>(), packed in any::<bool>(), radius in 0.0..0.5_f32,
        plates in proptest::collection::vec(plate(), 0..5),
        eye in [-3.0..3.0_f32, 1.0..5.0_f32, 2.0..6.0_f32],
        bumps in proptest::collection::vec((any::<u32>(), 0.9..1.5_f32, vector()), 0..60),
    ) {
        let maps = ground_and_plates(sun, &plates, Vec3::from(eye), &bumps);
        let parameters = Parameters { radius, group: 1, ..Parameters::default() };
        let expected: Vec<f32> = maps.with(packed, |camera, light| {
            let [width, height] = IMAGE;
            (0..width * height)
                .map(|i| naive(camera, light, &parameters, i % width, i / width))
                .collect()
        });
        for level in Level::available() {
            let (found, _) =
                maps.render::<f32>(level, Threads::One, &parameters, packed);
            prop_assert_eq!(&found, &expected, "{:?}", level);
        }
    }

    #[test]
    fn what_is_not_interpolated_is_exact(
        radius in 0.0..0.5_f32, group in 2..8_u32,
        plates in proptest::collection::vec(plate(), 0..5),
        bumps in proptest::collection::vec((any::<u32>(), 0.9..1.5_f32, vector()), 0..60),
    ) {
        let maps = ground_and_plates(false, &plates, Vec3::new(0.0, 3.0, 3.0), &bumps);
        let render = |group| {
            let parameters = Parameters { radius, group, ..Parameters::default() };
            maps.render::<(f32, Found)>(Level::detect(), Threads::One, &parameters, false)
        };
        let ((every, _), (found, counters)) = (render(1), render(group));
        prop_assert!(every.iter().all(|pixel| pixel.1 != Found::Interpolated));
        for (pixel, every) in found.iter().zip(&every) {
            prop_assert!(pixel.1 == Found::Interpolated || pixel.0 == every.0);
        }
        let searched = found.iter().filter(|pixel| pixel.1 == Found::Searched).count();
        prop_assert_eq!(searched as u32, counters.searches);
    }

    #[test]
    fn any_input_gives_a_visibility(
        texels in proptest::collection::vec(any::<f32>(), (MAP * MAP) as usize),
        pixels in proptest::collection::vec(any::<f32>(), (IMAGE[0] * IMAGE[1]) as usize),
        radius in any::<f32>(), group in any::<u32>(), sun in any::<bool>(),
        normal in [any::<f32>(), any::<f32>(), any::<f32>()],
    ) {
        let mut maps = ground_and_plates(sun, &[], Vec3::new(0.0, 3.0, 3.0), &[]);
        (maps.texels, maps.pixels) = (texels, pixels);
        maps.surfaces[1].normal = Vec3::from(normal);
        let parameters = Parameters { radius, group, ..Parameters::default() };
        for level in Level::available() {
            let (out, _) = maps.render::<f32>(level, Threads::One, &parameters, false);
            prop_assert!(out.iter().all(|v| (0.0..=1.0).contains(v)));
        }
    }
}
