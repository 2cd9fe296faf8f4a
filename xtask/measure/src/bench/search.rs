//! The search for the nearest blocker or lit texel: every level, in the box around the receiver and
//! with the pyramid, against the naive search; what is visited; what the pyramid costs.

use std::hint::black_box;

use glam::Vec3;
use raster::{DepthBuffer, Payload, Rasterizer};
use renderer::builtin;
use renderer::camera::{CameraOptions, choose, view};
use renderer::prepared::Prepared;
use renderer::scene::Scene;
use shadowmap_core::{
    Bias, DepthMap, HardShadow, Level, Light, LightPoint, Threads, View, hard_shadow,
};
use simd_search::{Hit, NodeGroup, Pyramid, Query, Side, Visits, naive, nearest};

use super::{Bench, Case, Group, Variant};

/// Pixels of the camera along either axis: its pixels are the receivers.
const CAMERA: u32 = 512;
/// Receivers are searched for in blocks of this many pixels squared.
const BLOCK: u32 = 8;
/// The radius of the light whose window the paper's search would look through, in metres.
const LIGHT_RADIUS: f32 = 0.4;
/// The side of the map that all receivers search.
const GROWTH: u32 = 1024;

/// The cases of this part.
pub fn cases(quick: bool) -> Vec<Case> {
    let (sizes, radii): (&[u32], &[u32]) = if quick {
        (&[1024], &[8, 32, 128])
    } else {
        (&[256, 1024, 4096], &[4, 8, 16, 32, 64, 128])
    };
    let mut cases = Vec::new();
    for name in ["torus", "crowded"] {
        for &size in sizes {
            let all_receivers = if size == GROWTH { radii.len() + 1 } else { 0 };
            let comparisons = 1 + radii.len() + all_receivers;
            cases.push(Case::new(comparisons, move |bench| one_map(bench, name, size, radii)));
        }
    }
    cases
}

/// Every comparison on the map of a scene.
fn one_map(bench: &mut Bench, name: &str, size: u32, radii: &[u32]) {
    let scene = builtin::scene(name).expect("a built-in scene");
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
        "{name} {size}, per query (texels of the box, compared texels, with the pyramid texels and \
         nodes): {}",
        visits.join("; ")
    ));
    if size == GROWTH {
        let all = if bench.quick() { 20_000 } else { usize::MAX };
        for &radius in radii {
            search.growth(bench, name, radius, &lit.blocks(all, |_| radius as f32));
        }
        search.window_of_the_light(bench, name, &lit, all);
    }
}

/// Neighbouring receivers.
type Block = Vec<Receiver>;

/// One receiver, and what it looks for.
#[derive(Clone, Copy)]
struct Receiver {
    point: LightPoint,
    offset: f32,
    side: Side,
    radius: f32,
}

impl Receiver {
    fn query(&self) -> Query {
        Query { side: self.side, ..Query::new(self.point, self.offset, self.radius) }
    }
}

/// A scene as its spherical light sees it, and the receivers.
struct Lit {
    view: View,
    map: DepthBuffer,
    blocks: Vec<Block>,
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
            let offset = Bias::default().offset(&point);
            Some(Receiver { point, offset, side, radius: 0.0 })
        };
        let mut blocks = Vec::new();
        for top in (0..CAMERA).step_by(BLOCK as usize) {
            for left in (0..CAMERA).step_by(BLOCK as usize) {
                // In Morton order: 16 in sequence are a block as well.
                let even_bits = |i: u32| i & 1 | i >> 1 & 2 | i >> 2 & 4;
                let pixels =
                    (0..BLOCK * BLOCK).map(|i| (left + even_bits(i), top + even_bits(i >> 1)));
                let block: Block = pixels.filter_map(|(x, y)| receiver(x, y)).collect();
                if !block.is_empty() {
                    blocks.push(block);
                }
            }
        }
        Lit { view: view_of_light, map, blocks }
    }

    /// About `count` receivers, spread evenly over the picture, that look `radius` texels far.
    fn blocks(&self, count: usize, radius: impl Fn(&Receiver) -> f32) -> Vec<Block> {
        let all = self.blocks.len();
        let wanted = (count / (BLOCK * BLOCK) as usize).clamp(4, all);
        let chosen = (0..wanted).map(|i| &self.blocks[i * all / wanted]);
        chosen
            .map(|block| {
                let reaching = |one: &Receiver| Receiver { radius: radius(one), ..*one };
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
    /// Each way hands the hits of one block after the other to `take`, so that queries and hits
    /// stay in the cache, as they do where receivers are made just before.
    fn naive(&self, blocks: &[Block], take: impl FnMut(&[Option<Hit>])) {
        self.each(blocks, take, |query| naive::nearest(self.map, query));
    }

    fn in_box(&self, level: Level, blocks: &[Block], take: impl FnMut(&[Option<Hit>])) {
        self.each(blocks, take, |query| nearest(level, self.map, query));
    }

    fn each(
        &self,
        blocks: &[Block],
        mut take: impl FnMut(&[Option<Hit>]),
        search: impl Fn(&Query) -> Option<Hit>,
    ) {
        let mut hits = [None; (BLOCK * BLOCK) as usize];
        for block in blocks {
            for (receiver, hit) in block.iter().zip(&mut hits) {
                *hit = search(&receiver.query());
            }
            take(&hits[..block.len()]);
        }
    }

    fn in_pyramid(&self, level: Level, blocks: &[Block], mut take: impl FnMut(&[Option<Hit>])) {
        let mut queries = Vec::new();
        let mut hits = [None; (BLOCK * BLOCK) as usize];
        for block in blocks {
            queries.clear();
            queries.extend(block.iter().map(Receiver::query));
            let hits = &mut hits[..block.len()];
            self.pyramid.nearest_each(level, self.map, &queries, hits);
            take(hits);
        }
    }

    /// The naive search, and every level's with and without the pyramid.
    fn every_way(&self, bench: &mut Bench, name: String, radius: u32, blocks: &[Block]) {
        let expected = all_of(|take| self.naive(blocks, take));
        let mut variants = vec![Variant::new("naive", || self.naive(blocks, ignore))];
        for level in Level::available() {
            let kind = level.kind().name();
            let found = all_of(|take| self.in_box(level, blocks, take));
            assert!(found == expected, "{name}: {kind}, box differs from the naive search");
            variants.push(Variant::new(format!("{kind}, box"), move || {
                self.in_box(level, blocks, ignore);
            }));
            let found = all_of(|take| self.in_pyramid(level, blocks, take));
            assert!(found == expected, "{name}: {kind}, pyramid differs from the naive search");
            variants.push(Variant::new(format!("{kind}, pyramid"), move || {
                self.in_pyramid(level, blocks, ignore);
            }));
        }
        let work = Some((expected.len() as f64, "queries"));
        bench.compare(Group { name, x: Some(radius_of(radius)), work, bytes: None, variants });
    }

    /// The default path alone, from all receivers.
    fn growth(&self, bench: &mut Bench, scene: &str, radius: u32, blocks: &[Block]) {
        let level = Level::detect();
        let expected = all_of(|take| self.in_box(level, blocks, take));
        let found = all_of(|take| self.in_pyramid(level, blocks, take));
        assert!(found == expected, "{scene}, radius {radius}: the pyramid differs from the box");
        bench.compare(Group {
            name: format!("growth with radius, {scene} 1024: {radius}"),
            x: Some(radius_of(radius)),
            work: Some((expected.len() as f64, "queries")),
            bytes: None,
            variants: vec![Variant::new("pyramid", || self.in_pyramid(level, blocks, ignore))],
        });
    }

    /// The search as the paper has it for a light of [`LIGHT_RADIUS`]: each receiver looks as far
    /// as the nearest texel of the map could throw a penumbra on it.
    fn window_of_the_light(&self, bench: &mut Bench, scene: &str, lit: &Lit, receivers: usize) {
        let nearest_depth = self.map.nearness().iter().copied().fold(0.0, f32::max);
        let per_nearness = lit.view.focal().x * LIGHT_RADIUS;
        let blocks = lit.blocks(receivers, |receiver| {
            per_nearness * (nearest_depth - receiver.point.nearness).max(0.0)
        });
        let level = Level::detect();
        let expected = all_of(|take| self.naive(&blocks, take));
        let found = all_of(|take| self.in_pyramid(level, &blocks, take));
        assert!(found == expected, "{scene}: the pyramid differs from the naive search");
        bench.compare(Group {
            name: format!("{scene} 1024, window of a light of radius {LIGHT_RADIUS}"),
            x: None,
            work: Some((expected.len() as f64, "queries")),
            bytes: None,
            variants: vec![
                Variant::new("naive", || self.naive(&blocks, ignore)),
                Variant::new("pyramid", || self.in_pyramid(level, &blocks, ignore)),
            ],
        });
    }

    /// What is looked at per query.
    fn visits(&self, radius: u32, blocks: &[Block]) -> String {
        let count = blocks.iter().map(Vec::len).sum::<usize>() as f64;
        let queries = blocks.iter().flatten().map(Receiver::query);
        let in_box: u64 = queries.map(|query| Visits::of_box(self.map, &query).texels).sum();
        let in_box = in_box as f64 / count;
        let mut hits = vec![None; (BLOCK * BLOCK) as usize];
        let (mut texels, mut nodes) = (0, 0);
        for block in blocks {
            let hits = &mut hits[..block.len()];
            let block: Vec<Query> = block.iter().map(Receiver::query).collect();
            let visits = Visits::of_pyramid(self.map, self.pyramid, &block, hits);
            (texels, nodes) = (texels + visits.texels, nodes + visits.nodes);
        }
        let (texels, nodes) = (texels as f64 / count, nodes as f64 / count);
        let window = (2 * radius + 1) * (2 * radius + 1);
        format!("r {radius}: {window}, {in_box:.0}, {texels:.1} + {nodes:.1}")
    }
}

/// The hits that a way of searching hands out.
fn all_of(search: impl FnOnce(&mut dyn FnMut(&[Option<Hit>]))) -> Vec<Option<Hit>> {
    let mut all = Vec::new();
    search(&mut |hits| all.extend_from_slice(hits));
    all
}

/// Takes hits that are only searched for to be timed.
fn ignore(hits: &[Option<Hit>]) {
    black_box(hits);
}

/// The abscissa of plots.
fn radius_of(radius: u32) -> (&'static str, f64) {
    ("radius, texels", f64::from(radius))
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
        name: format!("making the pyramid, {name}"),
        x: Some(("map side, texels", f64::from(width))),
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
