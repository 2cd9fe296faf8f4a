//! The search for the nearest blocker or lit texel: every level, in the box around the receiver and
//! with the pyramid, against the naive search; what is visited; what the pyramid costs.

use std::hint::black_box;

use glam::Vec3;
use raster::{DepthBuffer, Payload, Rasterizer};
use renderer::prepared::Prepared;
use renderer::scene::Scene;
use shadowmap_core::{Bias, DepthMap, HardShadow, Level, LightPoint, Threads, View, hard_shadow};
use simd_search::{Hit, LeafBands, NodeGroup, Pyramid, Query, Side, Visits, naive, nearest};

use super::{Bench, Case, Group, Variant, setup};

/// Pixels of the camera along either axis: its pixels are the receivers.
const CAMERA: u32 = 512;
/// Receivers are searched for in blocks of this many pixels squared.
const BLOCK: u32 = 8;
/// The radius of the light whose window the paper's search would look through, in metres.
const LIGHT_RADIUS: f32 = 0.4;
/// Operations that compare a texel with the receiver's plane: the texel's distance, times the
/// slope, plus the row's nearness, and the comparison.
const PER_TEXEL: f64 = 4.0;
/// The side of the map that is searched through the light's window, too.
const WINDOWED: u32 = 1024;

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
            let comparisons = 2 + radii.len() + usize::from(size == WINDOWED);
            cases.push(Case::new(comparisons, move |bench| one_map(bench, name, size, radii)));
        }
    }
    cases
}

/// Every comparison on the map of a scene.
fn one_map(bench: &mut Bench, name: &str, size: u32, radii: &[u32]) {
    let scene = setup::scene(name);
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
        let name = format!("{name} {size}, radius {radius}");
        visits.push(search.every_way(bench, name, radius, &blocks));
    }
    bench.table(
        format!("Looked at per query, {name} {size}; texels are compared 16 at a time"),
        &["radius", "texels of the window", "compared in it", "with the pyramid", "and nodes"],
        visits,
    );
    let all = if bench.quick() { 20_000 } else { usize::MAX };
    let all_blocks = radii.iter().map(|&radius| (radius, lit.blocks(all, |_| radius as f32)));
    search.growth(bench, format!("{name} {size}"), &all_blocks.collect::<Vec<_>>());
    if size == WINDOWED {
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
        let eye = setup::light(scene, false).light.center().expect("a sphere has one");
        let fov = 90_f32.to_radians();
        let view_of_light = View::perspective(eye, Vec3::ZERO, Vec3::NEG_Z, fov, size, size, 0.1);
        let mut map = DepthBuffer::new(size, size);
        rasterizer.draw(&view_of_light, &mesh, Payload::ObjectId, map.target());

        let camera = setup::camera(scene, CAMERA);
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

    /// The naive search, and every level's with and without the pyramid. Returns what they look at
    /// per query.
    fn every_way(
        &self,
        bench: &mut Bench,
        name: String,
        radius: u32,
        blocks: &[Block],
    ) -> Vec<String> {
        let expected = all_of(|take| self.naive(blocks, take));
        let queries = expected.len() as f64;
        let [in_box, in_pyramid] = self.visits(blocks);
        let window = f64::from((2 * radius + 1) * (2 * radius + 1));
        let naive = Variant::new("naive", || self.naive(blocks, ignore));
        let naive = naive.computing(PER_TEXEL * window * queries);
        let mut variants = vec![naive];
        for level in Level::available() {
            let kind = level.kind().name();
            let found = all_of(|take| self.in_box(level, blocks, take));
            assert!(found == expected, "{name}: {kind}, box differs from the naive search");
            let name_of = |way: &str| format!("{kind}, {way}");
            let run = move || self.in_box(level, blocks, ignore);
            variants.push(
                Variant::new(name_of("box"), run).computing(PER_TEXEL * in_box.texels as f64),
            );
            let found = all_of(|take| self.in_pyramid(level, blocks, take));
            assert!(found == expected, "{name}: {kind}, pyramid differs from the naive search");
            let run = move || self.in_pyramid(level, blocks, ignore);
            variants.push(
                Variant::new(name_of("pyramid"), run)
                    .computing(PER_TEXEL * in_pyramid.texels as f64),
            );
        }
        let work = Some((queries, "queries"));
        bench.compare(Group { name, x: Some(radius_of(radius)), work, variants });
        let per_query = |count: u64| count as f64 / queries;
        vec![
            radius.to_string(),
            window.to_string(),
            format!("{:.0}", per_query(in_box.texels)),
            format!("{:.1}", per_query(in_pyramid.texels)),
            format!("{:.1}", per_query(in_pyramid.nodes)),
        ]
    }

    /// The default path alone, from all receivers, with one radius after the other in turn.
    fn growth(&self, bench: &mut Bench, map: String, all: &[(u32, Vec<Block>)]) {
        let level = Level::detect();
        let mut queries = 0;
        let mut variants = Vec::new();
        for (radius, blocks) in all {
            let expected = all_of(|take| self.in_box(level, blocks, take));
            let found = all_of(|take| self.in_pyramid(level, blocks, take));
            assert!(found == expected, "{map}, radius {radius}: the pyramid differs from the box");
            queries = expected.len();
            let run = || self.in_pyramid(level, blocks, ignore);
            variants.push(Variant::new(format!("radius {radius}"), run));
        }
        let work = Some((queries as f64, "queries"));
        let name = format!("growth with radius, {map}");
        let ratios = bench.compare(Group { name, x: None, work, variants });
        let steps = (1..all.len()).map(|i| {
            let (from, to) = (all[i - 1].0, all[i].0);
            let doublings = (f64::from(to) / f64::from(from)).log2();
            let step = (ratios[i] / ratios[i - 1]).powf(1.0 / doublings);
            vec![format!("{from} to {to}"), format!("{step:.2}")]
        });
        let title = format!("What doubling the radius costs, {map}");
        bench.table(title, &["radius", "times the time, per doubling"], steps.collect());
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
            variants: vec![
                Variant::new("naive", || self.naive(&blocks, ignore)),
                Variant::new("pyramid", || self.in_pyramid(level, &blocks, ignore)),
            ],
        });
    }

    /// What is looked at in the box, and with the pyramid.
    fn visits(&self, blocks: &[Block]) -> [Visits; 2] {
        let mut all = [Visits::default(); 2];
        let mut add = |way: usize, visits: Visits| {
            all[way].texels += visits.texels;
            all[way].nodes += visits.nodes;
        };
        let mut hits = vec![None; (BLOCK * BLOCK) as usize];
        for block in blocks {
            let queries: Vec<Query> = block.iter().map(Receiver::query).collect();
            for query in &queries {
                add(0, Visits::of_box(self.map, query));
            }
            let hits = &mut hits[..block.len()];
            add(1, Visits::of_pyramid(self.map, self.pyramid, &queries, hits));
        }
        all
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

/// Making the pyramid, after the map or while it is drawn, and bringing a part of it up to date,
/// against drawing the map.
fn build(bench: &mut Bench, name: &str, scene: &Scene, view: &View, map: DepthMap<'_>) {
    let (width, height) = (map.width(), map.height());
    let mesh = scene.mesh.as_mesh();
    let level = Level::detect();
    let [mut alone, mut with_leaves] = [(); 2].map(|()| Rasterizer::new(level, Threads::One));
    let [mut drawn, mut copy] = [(); 2].map(|()| DepthBuffer::new(width, height));
    alone.draw(view, &mesh, Payload::ObjectId, drawn.target());
    assert!(drawn.nearness[..] == *map.nearness(), "{name}: the map is drawn differently again");
    let mut storage =
        [(); 4].map(|()| vec![NodeGroup::default(); Pyramid::storage_len(width, height)]);
    let [expected, whole, part, banded] = &mut storage;
    Pyramid::build(Level::SCALAR, map, expected, &mut []).expect("as long as asked");
    let build = |nodes: &mut [NodeGroup]| {
        Pyramid::build(level, map, nodes, &mut []).expect("as long as asked");
    };
    let update = |nodes: &mut [NodeGroup]| {
        let texels = width / 2..width / 2 + 64;
        let pyramid = Pyramid::update(level, map, nodes, &mut [], texels.clone(), texels);
        pyramid.expect("as long as asked");
    };
    let mut draw_with = |nodes: &mut [NodeGroup]| {
        let (rows, payload) = (LeafBands::ROWS, Payload::ObjectId);
        let leaves = LeafBands::new(width, height, rows, nodes, &mut []).expect("as long as asked");
        let (views, targets) = (std::slice::from_ref(view), &mut [copy.target()]);
        let build = |band: DepthMap<'_>, leaves: LeafBands<'_>| leaves.build(level, band);
        with_leaves.draw_in_bands(views, &mesh, None, payload, targets, rows, [leaves], &build);
        Pyramid::finish(level, copy.as_depth_map(), nodes, &mut []).expect("as long as asked");
    };
    build(whole);
    build(part);
    update(part);
    draw_with(banded);
    for (made, how) in [(&whole, "built"), (&part, "updated"), (&banded, "made while drawing")] {
        assert!(made == &expected, "{name}: the pyramid {how} differs from plain Rust's");
    }
    let texels = f64::from(width) * f64::from(height);
    let bytes = 4.0 * texels + size_of_val(&whole[..]) as f64;
    bench.compare(Group {
        name: format!("making the pyramid, {name}"),
        x: Some(("map side, texels", f64::from(width))),
        work: Some((texels, "texels")),
        variants: vec![
            Variant::new("draw the map", || {
                alone.draw(view, &mesh, Payload::ObjectId, drawn.target());
            }),
            Variant::new("draw the map with its pyramid", || draw_with(banded)),
            Variant::new("build", || build(whole)).moving(bytes),
            Variant::new("update 64 x 64 texels", || update(part)),
        ],
    });
}
