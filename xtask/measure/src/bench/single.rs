//! The shadow stage of the single sample search: every level, adaptive against every pixel, over
//! the radius of the light, the size of the map and the size of the image.

use raster::{DepthBuffer, Payload, Rasterizer};
use renderer::cover::Cover;
use renderer::light_views;
use renderer::prepared::Prepared;
use renderer::scene::Scene;
use shadowmap_core::{Camera, Level, Light, Surfaces, Threads, View};
use simd_search::{NodeGroup, Pyramid};
use single_sample::{Counters, LightMap, Texels, search};

use super::{Bench, Case, Group, Variant, count, on, setup};

/// The cases of this part.
pub fn cases(quick: bool) -> Vec<Case> {
    let radii: &[f32] = if quick { &[0.1, 1.0] } else { &[0.0, 0.1, 0.25, 0.5, 1.0] };
    let maps: &[u32] = if quick { &[256, 2048] } else { &[256, 512, 1024, 2048, 4096] };
    let images: &[u32] = if quick { &[512, 1024] } else { &[256, 512, 1024, 2048] };
    let mut cases = Vec::new();
    for name in ["torus", "crowded"] {
        cases.push(Case::new(2, move |bench| {
            let scene = setup::scene(name);
            let shot = Shot::new(&scene, 0.5, 512, 1024);
            levels(bench, name, &shot);
            adaptive(bench, name, &shot);
        }));
        let mut over = |x: (&'static str, f32), group: String, radius, image, map| {
            cases.push(Case::new(1, move |bench| {
                let scene = setup::scene(name);
                threads(bench, group, x, &Shot::new(&scene, radius, image, map));
            }));
        };
        for &radius in radii {
            let group = format!("{name}, radius {radius}");
            over(("radius of the light, metres", radius), group, radius, 512, 1024);
        }
        for &map in maps {
            over(("map side, texels", map as f32), format!("{name}, map {map}"), 0.5, 512, map);
        }
        for &image in images {
            let group = format!("{name}, camera {image}");
            over(("camera side, pixels", image as f32), group, 0.5, image, 1024);
        }
    }
    cases
}

/// A scene before its camera, and the map of its spherical light.
struct Shot<'a> {
    prepared: Prepared<'a>,
    camera: View,
    seen: DepthBuffer,
    light: View,
    map: DepthBuffer,
    nodes: Vec<NodeGroup>,
    parameters: search::Parameters,
}

impl<'a> Shot<'a> {
    fn new(scene: &'a Scene, radius: f32, image: u32, size: u32) -> Shot<'a> {
        let prepared = Prepared::new(scene);
        let mesh = scene.mesh.as_mesh();
        let center = setup::light(scene, false).light.center().expect("a sphere has one");
        let sphere = Light::Sphere { center, radius };
        let camera = setup::camera(scene, image);
        let cover = Cover::new(&prepared, &sphere, &camera);
        let light = light_views::fit(&sphere, None, None, size, &cover).remove(0);
        let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
        let mut seen = DepthBuffer::new(image, image);
        rasterizer.draw(&camera, &mesh, Payload::TriangleIndex, seen.target());
        let mut map = DepthBuffer::new(size, size);
        rasterizer.draw(&light, &mesh, Payload::ObjectId, map.target());
        let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(size, size)];
        let built = Pyramid::build(Level::detect(), map.as_depth_map(), &mut nodes, &mut []);
        built.expect("the storage is as long as asked");
        let parameters = search::Parameters::of(&sphere).expect("the search knows spheres");
        Shot { prepared, camera, seen, light, map, nodes, parameters }
    }

    /// Gives `run` what draws the shadow with a level, on some threads, searching every `group`-th
    /// column.
    fn with<R>(
        &self,
        run: impl FnOnce(&(dyn Fn(Level, Threads, u32, &mut [f32]) -> Counters + Sync)) -> R,
    ) -> R {
        const SIZES_AGREE: &str = "maps are drawn in the size of their view";
        let surfaces = Surfaces::Table(self.prepared.surfaces());
        let camera = Camera::new(&self.camera, self.seen.as_depth_map(), surfaces);
        let camera = camera.expect(SIZES_AGREE);
        let map = self.map.as_depth_map();
        let light = LightMap::new(&self.light, Texels::Plain(map)).expect(SIZES_AGREE);
        // Nothing changes but the way it is held: an update of no texel.
        let mut nodes = self.nodes.clone();
        let pyramid = Pyramid::update(Level::detect(), map, &mut nodes, &mut [], 0..0, 0..0);
        let pyramid = pyramid.expect("the storage is as long as asked");
        run(&|level, threads, group, out| {
            let parameters = search::Parameters { group, ..self.parameters };
            search::visibility(level, threads, &camera, &light, &pyramid, &parameters, out)
        })
    }

    /// What is read of the camera's pass and written to the mask.
    fn bytes(&self) -> f64 {
        12.0 * self.seen.nearness.len() as f64
    }

    fn mask(&self) -> Vec<f32> {
        vec![0.0; self.seen.nearness.len()]
    }
}

/// Every level on one thread, which must agree to the bit.
fn levels(bench: &mut Bench, name: &str, shot: &Shot<'_>) {
    let group = shot.parameters.group;
    shot.with(|draw| {
        let mut expected = shot.mask();
        draw(Level::SCALAR, Threads::One, group, &mut expected);
        let mut variants = Vec::new();
        for level in Level::available() {
            let mut out = shot.mask();
            draw(level, Threads::One, group, &mut out);
            let name = level.kind().name();
            assert!(out == expected, "{name} differs from plain Rust");
            let run = move || {
                draw(level, Threads::One, group, &mut out);
            };
            variants.push(Variant::new(name, run).moving(shot.bytes()));
        }
        bench.compare(Group {
            name: format!("{name}, levels"),
            x: None,
            work: Some((expected.len() as f64, "pixels")),
            variants,
        });
    });
}

/// Every pixel searched against groups that may be interpolated.
fn adaptive(bench: &mut Bench, name: &str, shot: &Shot<'_>) {
    let level = Level::detect();
    shot.with(|draw| {
        let (mut every, mut some) = (shot.mask(), shot.mask());
        let all = draw(level, Threads::One, 1, &mut every);
        let few = draw(level, Threads::One, shot.parameters.group, &mut some);
        let squares = every.iter().zip(&some).map(|(a, b)| f64::from(a - b).powi(2));
        let rmse = (squares.sum::<f64>() / every.len() as f64).sqrt();
        assert!(rmse < 0.005, "interpolation is off by {rmse}");
        bench.note(format!(
            "{name}: {} searches instead of {}, RMSE {rmse:.5}, {} of {} tiles decided as a whole",
            few.searches, all.searches, few.decided_tiles, few.tiles
        ));
        let variants = vec![
            Variant::new("every pixel", || {
                draw(level, Threads::One, 1, &mut every);
            }),
            Variant::new("adaptive", || {
                draw(level, Threads::One, shot.parameters.group, &mut some);
            }),
        ];
        let work = Some((f64::from(all.searches), "searches"));
        let name = format!("{name}, adaptive");
        bench.compare(Group { name, x: None, work, variants });
    });
}

/// One thread against two, which must agree to the bit.
fn threads(bench: &mut Bench, name: String, (over, x): (&'static str, f32), shot: &Shot<'_>) {
    let (level, group) = (Level::detect(), shot.parameters.group);
    shot.with(|draw| {
        let (mut one, mut two) = (shot.mask(), shot.mask());
        draw(level, Threads::One, group, &mut one);
        on(Threads::Pool, || draw(level, Threads::Pool, group, &mut two));
        assert!(one == two, "{name} differs between threads");
        let work = Some((one.len() as f64, "pixels"));
        let variants = vec![
            Variant::on(Threads::One, count(Threads::One), || {
                draw(level, Threads::One, group, &mut one);
            })
            .moving(shot.bytes()),
            Variant::on(Threads::Pool, count(Threads::Pool), || {
                draw(level, Threads::Pool, group, &mut two);
            })
            .moving(shot.bytes()),
        ];
        bench.compare(Group { name, x: Some((over, f64::from(x))), work, variants });
    });
}
