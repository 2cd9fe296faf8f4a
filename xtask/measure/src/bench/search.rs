//! The search for the nearest blocker or lit texel: every level, in the box around the receiver and
//! with the pyramid, against the naive search; what is visited; what the pyramid costs.

use glam::Vec3;
use raster::{DepthBuffer, Payload, Rasterizer};
use renderer::builtin;
use renderer::camera::{CameraOptions, choose, view};
use renderer::prepared::Prepared;
use renderer::scene::Scene;
use shadowmap_core::{Bias, DepthMap, HardShadow, Level, Light, Threads, View, hard_shadow};
use simd_search::{Hit, NodeGroup, Pyramid, Query, Side, Visits, naive, nearest};

use super::{Bench, Group, Variant};

/// Pixels of the camera along either axis: its pixels are the receivers.
const CAMERA: u32 = 512;
/// Receivers are searched for in blocks of this many pixels squared.
const BLOCK: u32 = 8;
/// The radius of the light whose window the paper's search would look through, in metres.
const LIGHT_RADIUS: f32 = 0.4;

/// Runs the part.
pub fn run(bench: &mut Bench) {
    let levels: Vec<&str> = Level::available().map(|level| level.kind().name()).collect();
    bench.note(format!("each level was checked against the naive search: {}", levels.join(", ")));
    let (sizes, radii): (&[u32], &[u32]) = if bench.quick() {
        (&[1024], &[8, 32, 128])
    } else {
        (&[256, 1024, 4096], &[4, 8, 16, 32, 64, 128])
    };
    for name in ["torus", "crowded"] {
        let scene = builtin::scene(name).expect("a built-in scene");
        for &size in sizes {
            let lit = Lit::new(&scene, size);
            let map = lit.map.as_depth_map();
            let mut storage = vec![NodeGroup::default(); Pyramid::storage_len(size, size)];
            build(bench, &format!("{name} {size}"), &scene, &lit.view, map);
            let pyramid = Pyramid::build(Level::detect(), map, &mut storage, &mut []);
            let pyramid = pyramid.expect("the storage is as long as asked");
            let search = Searched { map, pyramid: &pyramid };
            let mut visits = Vec::new();
            for &radius in radii {
                let texels = (2 * radius + 1) * (2 * radius + 1);
                let budget = if bench.quick() { 5_000_000 } else { 20_000_000 };
                let blocks = lit.blocks((budget / texels) as usize, |_| radius as f32);
                search.every_way(bench, format!("{name} {size}, radius {radius}"), radius, &blocks);
                visits.push(search.visits(radius, &blocks));
            }
            bench.note(format!(
                "{name} {size}, per query (texels of the box, compared texels, with the pyramid \
                 texels and nodes): {}",
                visits.join("; ")
            ));
            if size == 1024 {
                let all = if bench.quick() { 20_000 } else { usize::MAX };
                for &radius in radii {
                    search.growth(bench, name, radius, &lit.blocks(all, |_| radius as f32));
                }
                search.window_of_the_light(bench, name, &lit, all);
            }
        }
    }
}

/// A scene as its spherical light sees it, and the receivers.
struct Lit {
    view: View,
    map: DepthBuffer,
    /// Blocks of neighbouring receivers, each with the side that it searches for.
    blocks: Vec<Vec<Query>>,
}

impl Lit {
    /// The light looks at the origin through a square window of 90 degrees.
    fn new(scene: &Scene, size: u32) -> Lit {
        let prepared = Prepared::new(scene);
        let mesh = scene.mesh.as_mesh();
        let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
        let spherical = |light: &Light| match *light {
            Light::Sphere { center, .. } => Some(center),
            _ => None,
        };
        let eye = scene.lights.iter().find_map(|light| spherical(&light.light));
        let (eye, half) = (eye.expect("the scene has a spherical light"), 90_f32.to_radians());
        let view_of_light = View::perspective(eye, Vec3::ZERO, Vec3::NEG_Z, half, size, size, 0.1);
        let mut map = DepthBuffer::new(size, size);
        rasterizer.draw(&view_of_light, &mesh, Payload::ObjectId, map.target());

        let camera = choose(scene, &CameraOptions::default()).expect("the scene has a camera");
        let camera = view(&camera, [CAMERA; 2], prepared.bounds());
        let mut seen = DepthBuffer::new(CAMERA, CAMERA);
        rasterizer.draw(&camera, &mesh, Payload::TriangleIndex, seen.target());
        let receiver = |x: u32, y: u32| {
            let pixel = (y * CAMERA + x) as usize;
            let normal = prepared.surfaces()[seen.payload[pixel] as usize].normal;
            let near = seen.nearness[pixel];
            let at = camera.world_from_texel(x as f32 + 0.5, y as f32 + 0.5, near);
            let point = view_of_light.light_point(at, normal).filter(|_| near > 0.0)?;
            let side = match hard_shadow(&map.as_depth_map(), &point, Bias::default()) {
                HardShadow::Lit => Side::Blocker,
                HardShadow::Blocked => Side::Lit,
                HardShadow::Outside => return None,
            };
            Some(Query { side, ..Query::new(point, Bias::default().offset(&point), 0.0) })
        };
        let mut blocks = Vec::new();
        for top in (0..CAMERA).step_by(BLOCK as usize) {
            for left in (0..CAMERA).step_by(BLOCK as usize) {
                let pixels = (0..BLOCK * BLOCK).map(|i| (left + i % BLOCK, top + i / BLOCK));
                let block: Vec<Query> = pixels.filter_map(|(x, y)| receiver(x, y)).collect();
                if !block.is_empty() {
                    blocks.push(block);
                }
            }
        }
        Lit { view: view_of_light, map, blocks }
    }

    /// About `count` receivers, spread evenly over the picture, that look `radius` texels far.
    fn blocks(&self, count: usize, radius: impl Fn(&Query) -> f32) -> Vec<Vec<Query>> {
        let all = self.blocks.len();
        let wanted = (count / (BLOCK * BLOCK) as usize).clamp(4, all);
        let chosen = (0..wanted).map(|i| &self.blocks[i * all / wanted]);
        chosen
            .map(|block| {
                let reaching = |query: &Query| Query { radius: radius(query), ..*query };
                block.iter().map(reaching).collect()
            })
            .collect()
    }
}

/// A map to search, and its pyramid.
#[derive(Clone, Copy)]
struct Searched<'a> {
    map: DepthMap<'a>,
    pyramid: &'a Pyramid<'a>,
}

impl Searched<'_> {
    fn naive(&self, blocks: &[Vec<Query>], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(blocks.iter().flatten().map(|query| naive::nearest(self.map, query)));
    }

    fn in_box(&self, level: Level, blocks: &[Vec<Query>], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(blocks.iter().flatten().map(|query| nearest(level, self.map, query)));
    }

    fn in_pyramid(&self, level: Level, blocks: &[Vec<Query>], hits: &mut Vec<Option<Hit>>) {
        hits.resize(blocks.iter().map(Vec::len).sum(), None);
        let mut rest = &mut hits[..];
        for block in blocks {
            let (these, others) = rest.split_at_mut(block.len());
            self.pyramid.nearest_each(level, self.map, block, these);
            rest = others;
        }
    }

    /// The naive search, and every level's with and without the pyramid.
    fn every_way(&self, bench: &mut Bench, name: String, radius: u32, blocks: &[Vec<Query>]) {
        let mut expected = Vec::new();
        self.naive(blocks, &mut expected);
        let mut variants = vec![Variant::new("naive", {
            let mut hits = Vec::new();
            move || self.naive(blocks, &mut hits)
        })];
        for level in Level::available() {
            let kind = level.kind().name();
            let mut hits = Vec::new();
            self.in_box(level, blocks, &mut hits);
            assert!(hits == expected, "{name}: {kind}, box differs from the naive search");
            variants.push(Variant::new(format!("{kind}, box"), move || {
                self.in_box(level, blocks, &mut hits);
            }));
            let mut hits = Vec::new();
            self.in_pyramid(level, blocks, &mut hits);
            assert!(hits == expected, "{name}: {kind}, pyramid differs from the naive search");
            variants.push(Variant::new(format!("{kind}, pyramid"), move || {
                self.in_pyramid(level, blocks, &mut hits);
            }));
        }
        let (x, work) = (Some(f64::from(radius)), Some((expected.len() as f64, "queries")));
        bench.compare(Group { name, x, work, bytes: None, variants });
    }

    /// The default path alone, from all receivers.
    fn growth(&self, bench: &mut Bench, scene: &str, radius: u32, blocks: &[Vec<Query>]) {
        let (mut expected, mut hits) = (Vec::new(), Vec::new());
        self.in_box(Level::detect(), blocks, &mut expected);
        self.in_pyramid(Level::detect(), blocks, &mut hits);
        assert!(hits == expected, "{scene}, radius {radius}: the pyramid differs from the box");
        bench.compare(Group {
            name: format!("growth with radius: {scene} 1024, {radius}"),
            x: Some(f64::from(radius)),
            work: Some((expected.len() as f64, "queries")),
            bytes: None,
            variants: vec![Variant::new("pyramid", || {
                self.in_pyramid(Level::detect(), blocks, &mut hits);
            })],
        });
    }

    /// The search as the paper has it for a light of [`LIGHT_RADIUS`]: each receiver looks as far
    /// as the nearest texel of the map could throw a penumbra on it.
    fn window_of_the_light(&self, bench: &mut Bench, scene: &str, lit: &Lit, receivers: usize) {
        let nearest_depth = self.map.nearness().iter().copied().fold(0.0, f32::max);
        let per_nearness = lit.view.focal().x * LIGHT_RADIUS;
        let blocks = lit.blocks(receivers, |query| {
            per_nearness * (nearest_depth - query.point.nearness).max(0.0)
        });
        let (mut expected, mut hits) = (Vec::new(), Vec::new());
        self.naive(&blocks, &mut expected);
        self.in_pyramid(Level::detect(), &blocks, &mut hits);
        assert!(hits == expected, "{scene}: the pyramid differs from the naive search");
        bench.compare(Group {
            name: format!("{scene} 1024, window of a light of radius {LIGHT_RADIUS}"),
            x: None,
            work: Some((expected.len() as f64, "queries")),
            bytes: None,
            variants: vec![
                Variant::new("naive", || self.naive(&blocks, &mut expected)),
                Variant::new("pyramid", || {
                    self.in_pyramid(Level::detect(), &blocks, &mut hits);
                }),
            ],
        });
    }

    /// What is looked at per query.
    fn visits(&self, radius: u32, blocks: &[Vec<Query>]) -> String {
        let count = blocks.iter().map(Vec::len).sum::<usize>() as f64;
        let texels = blocks.iter().flatten().map(|query| Visits::of_box(self.map, query).texels);
        let in_box = texels.sum::<u64>() as f64 / count;
        let mut hits = vec![None; (BLOCK * BLOCK) as usize];
        let (mut texels, mut nodes) = (0, 0);
        for block in blocks {
            let hits = &mut hits[..block.len()];
            let visits = Visits::of_pyramid(self.map, self.pyramid, block, hits);
            (texels, nodes) = (texels + visits.texels, nodes + visits.nodes);
        }
        let (texels, nodes) = (texels as f64 / count, nodes as f64 / count);
        let window = (2 * radius + 1) * (2 * radius + 1);
        format!("r {radius}: {window}, {in_box:.0}, {texels:.1} + {nodes:.1}")
    }
}

/// Making the pyramid, and bringing a part of it up to date, against drawing the map.
fn build(bench: &mut Bench, name: &str, scene: &Scene, view: &View, map: DepthMap<'_>) {
    let (width, height) = (map.width(), map.height());
    let mesh = scene.mesh.as_mesh();
    let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
    let mut drawn = DepthBuffer::new(width, height);
    let mut storage =
        [(); 2].map(|()| vec![NodeGroup::default(); Pyramid::storage_len(width, height)]);
    let [whole, part] = &mut storage;
    let level = Level::detect();
    Pyramid::build(level, map, part, &mut []).expect("the storage is as long as asked");
    bench.compare(Group {
        name: format!("{name}, making the pyramid"),
        x: Some(f64::from(width)),
        work: Some((f64::from(width) * f64::from(height), "texels")),
        bytes: None,
        variants: vec![
            Variant::new("draw the map", || {
                rasterizer.draw(view, &mesh, Payload::ObjectId, drawn.target());
            }),
            Variant::new("build", || {
                Pyramid::build(level, map, whole, &mut []).expect("as above");
            }),
            Variant::new("update 64 x 64 texels", || {
                let texels = width / 2..width / 2 + 64;
                let pyramid = Pyramid::update(level, map, part, &mut [], texels.clone(), texels);
                pyramid.expect("as above");
            }),
        ],
    });
}
