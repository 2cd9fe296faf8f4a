use alloc::{vec, vec::Vec};
use std::println;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use raster::{DepthBuffer, Payload, Rasterizer, Target};
use shadowmap_core::{Camera, Level, Mesh, Surface, Surfaces, Threads, View};

use super::*;
use crate::{RectifiedLight, SampleViews};

mod adaptive;
mod beside;
mod contacts;
mod cut;

const LIGHT: [Vec3; 2] = [Vec3::new(-1.0, 4.0, 0.0), Vec3::new(1.0, 4.0, 0.0)];

/// Triangles, and the normal of each.
struct Scene {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    ids: Vec<u32>,
    table: Vec<Surface>,
}

impl Scene {
    /// Quadrilaterals with the corners a, b, c and a + c - b.
    fn new(quads: &[[Vec3; 3]]) -> Scene {
        let mut scene = Scene {
            positions: Vec::new(),
            triangles: Vec::new(),
            ids: Vec::new(),
            table: vec![Surface::UNKNOWN],
        };
        for (i, &[a, b, c]) in quads.iter().enumerate() {
            let first = scene.positions.len() as u32;
            scene.positions.extend([a, b, c, a + c - b]);
            let normal = (b - a).as_dvec3().cross((c - a).as_dvec3());
            for corners in [[0, 1, 2], [0, 2, 3]] {
                scene.triangles.push(corners.map(|i: u32| first + i));
                scene.ids.push(i as u32 + 1);
                let normal = normal.normalize_or(DVec3::ZERO).as_vec3();
                scene.table.push(Surface { normal, id: i as u32 + 1 });
            }
        }
        scene
    }

    fn mesh(&self) -> Mesh<'_> {
        Mesh { positions: &self.positions, triangles: &self.triangles, ids: &self.ids }
    }

    fn draw(&self, views: &[View], payload: Payload) -> Vec<DepthBuffer> {
        let mut maps: Vec<_> =
            views.iter().map(|v| DepthBuffer::new(v.width(), v.height())).collect();
        let mut targets: Vec<Target<'_>> = maps.iter_mut().map(DepthBuffer::target).collect();
        let mut rasterizer = Rasterizer::new(Level::SCALAR, Threads::One);
        rasterizer.draw_many(views, &self.mesh(), payload, &mut targets);
        maps
    }
}

fn samples(maps: &[DepthBuffer]) -> Vec<SampleMap<'_>> {
    let last = (maps.len() - 1) as f32;
    maps.iter()
        .enumerate()
        .map(|(k, map)| SampleMap { t: k as f32 / last, map: map.as_depth_map() })
        .collect()
}

fn visibility(
    level: Level,
    threads: Threads,
    camera: &Camera<'_>,
    maps: FrustumMaps<'_>,
) -> Vec<f32> {
    let mut out = vec![f32::NAN; camera.map().nearness().len()];
    let mut intervals = IntervalVisibility::new(level, threads);
    intervals.prepare(&[maps]);
    intervals.visibility(camera, &[maps], INTERVAL_BIAS, &mut out);
    out
}

fn naive(camera: &Camera<'_>, maps: FrustumMaps<'_>) -> Vec<f32> {
    let bounds = vec![Bounds::default(); maps.samples.len()];
    let frame = frame(&bounds, camera, &[maps], INTERVAL_BIAS);
    naive::visibility(&frame)
}

/// A ground and a rectangle of 2 x 1 metres above it, seen from the side.
fn blocker() -> (Scene, View) {
    let v = Vec3::new;
    let scene = Scene::new(&[
        [v(-5.0, 0.0, -5.0), v(-5.0, 0.0, 5.0), v(5.0, 0.0, 5.0)],
        [v(-1.0, 1.5, -0.5), v(-1.0, 1.5, 0.5), v(1.0, 1.5, 0.5)],
    ]);
    let view = View::perspective(v(0.0, 6.0, 7.0), Vec3::ZERO, Vec3::Y, 0.7, 100, 90, 0.1);
    (scene, view)
}

/// What a point of the ground sees past the rectangle.
fn blocker_on_paper(x: f32, z: f32) -> f32 {
    if (0.625 * z).abs() >= 0.5 {
        return 1.0;
    }
    let a = ((-1.0 - 0.625 * x) / 0.375).max(-1.0);
    let b = ((1.0 - 0.625 * x) / 0.375).min(1.0);
    1.0 - (b - a).max(0.0) / 2.0
}

#[test]
fn a_rectangle_above_a_ground_is_right_on_paper() {
    let (scene, view) = blocker();
    for count in [2, 3, 5] {
        let light = RectifiedLight::fit(
            LIGHT[0],
            LIGHT[1],
            count,
            [512; 2],
            scene.positions.iter().copied(),
        );
        let views = &light.frusta()[0];
        let maps = scene.draw(views.views(), Payload::ObjectId);
        let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
        let camera =
            Camera::new(&view, camera_map[0].as_depth_map(), Surfaces::Table(&scene.table))
                .unwrap();
        let samples = samples(&maps);
        let out = visibility(
            Level::detect(),
            Threads::default(),
            &camera,
            FrustumMaps { views, samples: &samples },
        );
        let (mut ground, mut penumbra) = (0, 0);
        for (i, &v) in out.iter().enumerate() {
            let (x, y) = ((i % 100) as f32 + 0.5, (i / 100) as f32 + 0.5);
            let p = view.world_from_texel(x, y, camera_map[0].nearness[i]);
            if p.y.abs() > 0.01 || (p.z.abs() - 0.8).abs() < 0.04 {
                continue; // Not on the ground, or where the rows of the blocker's edges are.
            }
            let expected = blocker_on_paper(p.x, p.z);
            assert!((v - expected).abs() < 0.02, "{p}: {v} instead of {expected}");
            ground += 1;
            penumbra += usize::from(expected > 0.0 && expected < 1.0);
        }
        assert!(ground > 4000 && penumbra > 200, "{ground} pixels, {penumbra} in penumbra");
    }
}

#[test]
fn what_lies_below_the_horizon_is_not_seen() {
    // A wall whose plane cuts the light in its middle, and nothing else.
    let v = Vec3::new;
    let scene = Scene::new(&[[v(0.0, 0.0, -2.0), v(0.0, 0.0, 2.0), v(0.0, 2.0, 2.0)]]);
    for (eye, x) in [(v(6.0, 1.0, 0.0), 1.0), (v(-6.0, 1.0, 0.0), -1.0)] {
        let view = View::perspective(eye, v(0.0, 1.0, 0.0), Vec3::Y, 0.4, 33, 17, 0.1);
        let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
        let camera =
            Camera::new(&view, camera_map[0].as_depth_map(), Surfaces::Table(&scene.table))
                .unwrap();
        for (light, expected) in [
            ([v(-1.0, 4.0, 0.0), v(1.0, 4.0, 0.0)], 0.5),
            ([v(-3.0, 4.0, 0.0), v(1.0, 4.0, 0.0)], if x > 0.0 { 0.25 } else { 0.75 }),
            ([v(1.0, 4.0, 0.0), v(3.0, 4.0, 0.0)], if x > 0.0 { 1.0 } else { 0.0 }),
        ] {
            let [a, b] = light;
            let views = RectifiedLight::fit(a, b, 2, [128; 2], scene.positions.iter().copied());
            let maps = scene.draw(views.frusta()[0].views(), Payload::ObjectId);
            let samples = samples(&maps);
            let maps = FrustumMaps { views: &views.frusta()[0], samples: &samples };
            let out = visibility(Level::detect(), Threads::One, &camera, maps);
            for (v, n) in out.iter().zip(camera.map().nearness()) {
                let expected = if *n > 0.0 { expected } else { 0.0 };
                assert!((v - expected).abs() < 1e-5, "{v} instead of {expected}");
            }
        }
    }
}

#[test]
fn a_light_in_the_plane_of_a_wall_is_not_seen_from_there() {
    let v = Vec3::new;
    for (cos, sin) in [(1.0, 0.0), (0.96, 0.28), (0.8, 0.6), (0.28, -0.96)] {
        // The wall's plane turns around the y axis, and the camera and the light with it.
        let at = |along: f32, y: f32, off: f32| {
            v(cos * along - sin * off, y, sin * along + cos * off) + v(0.7, 0.0, 1.3)
        };
        let scene = Scene::new(&[[at(-2.0, 0.0, 0.0), at(-2.0, 3.0, 0.0), at(2.0, 3.0, 0.0)]]);
        let eye = at(0.5, 2.0, 8.0);
        let view = View::perspective(eye, at(0.0, 1.5, 0.0), Vec3::Y, 0.4, 65, 49, 0.1);
        let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
        let surfaces = Surfaces::Table(&scene.table);
        let camera = Camera::new(&view, camera_map[0].as_depth_map(), surfaces).unwrap();
        for (off, expected) in [(-0.001, 0.0), (0.0, 0.0), (0.001, 1.0)] {
            let [a, b] = [at(3.0, 0.5, off), at(3.0, 4.0, off)];
            let views = RectifiedLight::fit(a, b, 2, [128; 2], scene.positions.iter().copied());
            let maps = scene.draw(views.frusta()[0].views(), Payload::ObjectId);
            let samples = samples(&maps);
            let maps = FrustumMaps { views: &views.frusta()[0], samples: &samples };
            let out = visibility(Level::detect(), Threads::One, &camera, maps);
            let seen = out.iter().zip(camera.map().nearness()).filter(|(_, n)| **n > 0.0);
            assert!(seen.clone().count() > 1000);
            let wrong = seen.filter(|(seen, _)| **seen != expected).count();
            assert_eq!(wrong, 0, "turned by ({cos}, {sin}), light {off} m in front");
        }
    }
}

/// Slats at many heights and angles above a ground.
fn slats() -> Scene {
    let v = Vec3::new;
    let mut quads = vec![[v(-3.0, 0.0, -3.0), v(-3.0, 0.0, 3.0), v(3.0, 0.0, 3.0)]];
    for i in 0..24 {
        let i = i as f32;
        let center = v((i * 1.7) % 4.0 - 2.0, (i * 0.37) % 2.0, (i * 2.3) % 4.0 - 2.0);
        let along = v(0.5, ((i * 0.9) % 1.0) - 0.5, ((i * 0.7) % 1.0) - 0.5);
        let across = v(((i * 0.3) % 0.4) - 0.2, 0.2, 0.3);
        quads.push([center - along, center - along + across, center + along + across]);
    }
    Scene::new(&quads)
}

#[test]
fn every_way_equals_the_naive_one() {
    let scene = slats();
    let view = View::perspective(Vec3::new(1.0, 5.0, 6.0), Vec3::ZERO, Vec3::Y, 0.8, 121, 93, 0.1);
    let camera_map = scene.draw(core::slice::from_ref(&view), Payload::TriangleIndex);
    let normals: Vec<Vec3> =
        camera_map[0].payload.iter().map(|&p| scene.table[p as usize].normal).collect();
    let points = scene.positions.iter().copied();
    for (count, size) in [(2, [300, 200]), (4, [130, 260])] {
        // Not parallel to the ground, so that no row has constant nearness.
        let light = RectifiedLight::fit(
            Vec3::new(-1.0, 5.0, 0.3),
            Vec3::new(0.8, 4.0, -0.4),
            count,
            size,
            points.clone(),
        );
        let views = &light.frusta()[0];
        let maps = scene.draw(views.views(), Payload::ObjectId);
        let samples = samples(&maps);
        let maps = FrustumMaps { views, samples: &samples };
        for surfaces in
            [Surfaces::Table(&scene.table), Surfaces::Normals(&normals), Surfaces::FromDepth]
        {
            let camera = Camera::new(&view, camera_map[0].as_depth_map(), surfaces).unwrap();
            let expected = naive(&camera, maps);
            let scalar = visibility(Level::SCALAR, Threads::One, &camera, maps);
            let (mut sum, mut worst) = (0.0, 0.0_f32);
            for (a, b) in scalar.iter().zip(&expected) {
                worst = worst.max((a - b).abs());
                sum += (a - b).abs();
            }
            let mean = sum / expected.len() as f32;
            println!("{count} samples: mean difference {mean:.6}, worst {worst:.4}");
            // Planes derived from depth differ between the pixels of a group, and so, slightly, do
            // tolerances: whether a blocker stands on the plane may hang on them.
            let limits = match surfaces {
                Surfaces::FromDepth => [3e-3, 1.0],
                _ => [1e-4, 0.15],
            };
            assert!(mean < limits[0] && worst <= limits[1], "mean {mean}, worst {worst}");
            for level in Level::available() {
                let other = visibility(level, Threads::default(), &camera, maps);
                assert!(other == scalar, "{level:?} differs");
            }
        }
    }
}

#[test]
fn nothing_is_done_where_there_is_nothing() {
    let view = View::perspective(Vec3::Y, Vec3::ZERO, Vec3::Z, 1.0, 3, 2, 0.1);
    let nothing = [0.0; 6];
    let camera_map = shadowmap_core::DepthMap::new(3, 2, &nothing, &[]).unwrap();
    let camera = Camera::new(&view, camera_map, Surfaces::FromDepth).unwrap();
    let light = RectifiedLight::fit(LIGHT[0], LIGHT[1], 2, [2, 3], core::iter::once(Vec3::ZERO));
    let map = shadowmap_core::DepthMap::new(2, 3, &nothing, &[]).unwrap();
    let samples = [SampleMap { t: 0.0, map }, SampleMap { t: 1.0, map }];
    let maps = FrustumMaps { views: &light.frusta()[0], samples: &samples };
    assert_eq!(visibility(Level::detect(), Threads::One, &camera, maps), [0.0; 6]);
}

/// Any float, and often one that could be a nearness.
fn any_nearness() -> impl Strategy<Value = f32> {
    prop_oneof![any::<f32>(), 0.0_f32..0.5, Just(0.25), Just(0.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn arbitrary_numbers_neither_panic_nor_leave_the_range(
        texels in prop::collection::vec(any_nearness(), 2 * 40 * 19),
        pixels in prop::collection::vec(any_nearness(), 20 * 9),
        ids in prop::collection::vec(0_u32..4, 20 * 9),
        ends in prop::array::uniform6(prop_oneof![any::<f32>(), -3.0_f32..3.0]),
        normal in prop::array::uniform3(any::<f32>()),
        by_table in any::<bool>(),
    ) {
        let view = View::perspective(Vec3::new(0.0, 5.0, 5.0), Vec3::ZERO, Vec3::Y, 0.8, 20, 9, 0.1);
        let camera_map = shadowmap_core::DepthMap::new(20, 9, &pixels, &ids).unwrap();
        let table = [
            Surface::UNKNOWN,
            Surface { normal: Vec3::Y, id: 1 },
            Surface { normal: Vec3::from_array(normal), id: 2 },
        ];
        let surfaces = if by_table { Surfaces::Table(&table) } else { Surfaces::FromDepth };
        let camera = Camera::new(&view, camera_map, surfaces).unwrap();
        let [a, b] = [0, 3].map(|i| Vec3::new(ends[i], ends[i + 1], ends[i + 2]));
        let window = shadowmap_core::Window::centered(1.0, 1.0);
        let views = SampleViews::new(a, b, 2, Vec3::NEG_Y, window, [40, 19], 0.1);
        let (first, second) = texels.split_at(40 * 19);
        let map = |texels| shadowmap_core::DepthMap::new(40, 19, texels, &[]).unwrap();
        let samples = [
            SampleMap { t: 0.0, map: map(first) },
            SampleMap { t: 1.0, map: map(second) },
        ];
        let maps = FrustumMaps { views: &views, samples: &samples };
        let scalar = visibility(Level::SCALAR, Threads::One, &camera, maps);
        prop_assert!(scalar.iter().all(|v| (0.0..=1.0).contains(v)));
        for level in Level::available() {
            let other = visibility(level, Threads::One, &camera, maps);
            prop_assert_eq!(&other, &scalar);
        }
    }
}
