//! What the tests share: an oracle that shares no code with the crate, and maps full of traps.
#![allow(dead_code)]

use std::io::Write as _;

use shadowmap_core::{DepthMap, Level, LightPoint, PackedMap};
use simd_search::{Hit, IdGroup, IdTest, Key, NodeGroup, Pyramid, Query, Side, naive, nearest};

/// A map that owns its texels.
#[derive(Clone, Debug)]
pub struct Texels {
    pub width: u32,
    pub height: u32,
    pub nearness: Vec<f32>,
    pub ids: Vec<u32>,
}

impl Texels {
    pub fn map(&self) -> DepthMap<'_> {
        DepthMap::new(self.width, self.height, &self.nearness, &self.ids).unwrap()
    }

    /// The same in 24 + 8 bits, `unit` of nearness to a step.
    pub fn packed(&self) -> Vec<u32> {
        let id = |i| self.ids.get(i).copied().unwrap_or(0) & 0xff;
        (0..self.nearness.len()).map(|i| PackedMap::pack(self.nearness[i], 1.0, id(i))).collect()
    }
}

/// A small generator of numbers that look random.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as u32
    }
    pub fn below(&mut self, n: u32) -> u32 {
        self.bits() % n
    }
    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 7) as f32 / 16777216.0
    }
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u32) as usize]
    }
}

/// The kinds of map that [`texels`] makes.
pub const KINDS: u32 = 8;

/// A map of one kind: noise, planes, steps, mostly empty, few values (ties), and one with every
/// number that is not ordinary.
pub fn texels(kind: u32, width: u32, height: u32, random: &mut Random) -> Texels {
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 0.0, 1e30, -1e30, f32::MAX, 1e-40];
    let (sx, sy) = (random.unit() * 0.02 - 0.01, random.unit() * 0.02 - 0.01);
    let rare = 1 + random.below(400);
    let mut nearness = Vec::new();
    let mut ids = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let plane = 0.25 + sx * x as f32 + sy * y as f32;
            nearness.push(match kind % KINDS {
                0 => random.unit(),
                1 => plane,
                2 => plane + if random.below(rare) == 0 { 0.1 } else { 0.0 },
                3 => {
                    if (x / 9 + y / 7) % 3 == 0 {
                        0.75
                    } else {
                        plane
                    }
                }
                4 => {
                    if random.below(rare) == 0 {
                        0.5
                    } else {
                        0.0
                    }
                }
                5 => random.pick(&[0.25, 0.5]),
                6 => {
                    if random.below(6) == 0 {
                        random.pick(&odd)
                    } else {
                        random.unit()
                    }
                }
                _ => plane - 0.0001 * ((x as f32 - 20.0).powi(2) + (y as f32 - 10.0).powi(2)),
            });
            ids.push(match kind % 3 {
                0 => random.pick(&[0, 1, u32::MAX]),
                1 => {
                    if x < width / 2 {
                        u32::MAX
                    } else {
                        7
                    }
                }
                _ => 256 + (x / 16 + y / 8) % 3,
            });
        }
    }
    if random.below(5) == 0 {
        ids.clear();
    }
    Texels { width, height, nearness, ids }
}

/// A query of any kind around a map.
pub fn query(texels: &Texels, random: &mut Random) -> Query {
    let around = |random: &mut Random, size: u32| match random.below(8) {
        0 => random.below(size + 1) as f32,
        1 => random.below(size) as f32 + 0.5,
        2 => -20.0 * random.unit(),
        3 => size as f32 + 20.0 * random.unit(),
        _ => random.unit() * size as f32,
    };
    let mut point = LightPoint::flat(
        around(random, texels.width),
        around(random, texels.height),
        random.pick(&[0.0, 0.25, 0.3, 0.5, random.clone().unit()]),
    );
    if random.below(2) == 0 {
        point.slope.x = random.unit() * 0.02 - 0.01;
        point.slope.y = random.unit() * 0.02 - 0.01;
    }
    let offset = random.pick(&[0.0, 0.0, 1e-4, 0.01, -0.1]);
    let far = random.below(70) as f32 * 0.5 + random.pick(&[0.0, 0.25]);
    let mut query = Query::new(point, offset, far);
    query.side = random.pick(&[Side::Blocker, Side::Lit]);
    let id = random.pick(&[0, 1, 7, 257, u32::MAX]);
    query.ids = random.pick(&[IdTest::Any, IdTest::Any, IdTest::Differs(id), IdTest::Equals(id)]);
    query.key = random.pick(&[
        Key::Distance,
        Key::Distance,
        Key::Ratio { at_most: f32::INFINITY },
        Key::Ratio { at_most: 4000.0 },
    ]);
    query.jitter = random.pick(&[0.0, 0.0, 0.0, 0.5, 1.0]);
    query.hint = random.pick(&[None, Some([random.clone().below(99), random.clone().below(60)])]);
    query
}

/// The answer, from the definition: every texel of the map, in row-major order.
pub fn oracle(texels: &Texels, packed: bool, query: &Query) -> Option<Hit> {
    let words = texels.packed();
    let mut best: Option<Hit> = None;
    for y in 0..texels.height {
        for x in 0..texels.width {
            let i = (y * texels.width + x) as usize;
            let (mut nearness, mut id) =
                (texels.nearness[i], texels.ids.get(i).copied().unwrap_or(0));
            if packed {
                (nearness, id) = ((words[i] >> 8) as f32, words[i] & 0xff);
            }
            let is = |wanted: u32| if packed { id == wanted & 0xff } else { id == wanted };
            let (s, t) = (x as f32 + 0.5, y as f32 + 0.5);
            let blocks = nearness > query.point.plane_at(s, t) + query.offset;
            let found = match query.side {
                Side::Blocker => blocks,
                Side::Lit => !blocks,
            } && match query.ids {
                IdTest::Any => true,
                IdTest::Differs(other) => !is(other),
                IdTest::Equals(other) => is(other),
            };
            // The jitter is the crate's own: without it the place is the texel's centre.
            let (dx, dy) = (s - query.point.u, t - query.point.v);
            let distance_squared = dx * dx + dy * dy;
            let near = query.radius >= 0.0 && distance_squared <= query.radius * query.radius;
            let nearer = nearness - query.point.nearness;
            let (key, counts) = match query.key {
                Key::Distance => (distance_squared, true),
                Key::Ratio { at_most } => {
                    let key = distance_squared / (nearer * nearer);
                    (key, nearer > 0.0 && key <= at_most)
                }
            };
            if found && near && counts && key < f32::INFINITY && best.is_none_or(|b| key < b.key) {
                best = Some(Hit { x, y, distance_squared, nearness, key });
            }
        }
    }
    best
}

/// The place and the bits of a hit: NaN equals itself.
pub fn bits(hit: Option<Hit>) -> Option<[u32; 5]> {
    hit.map(|h| [h.x, h.y, h.distance_squared.to_bits(), h.nearness.to_bits(), h.key.to_bits()])
}

/// The pyramid's storage for a map of some size.
pub fn storage(width: u32, height: u32) -> (Vec<NodeGroup>, Vec<IdGroup>) {
    let length = Pyramid::storage_len(width, height);
    (vec![NodeGroup::default(); length], vec![IdGroup::default(); length])
}

/// All queries, answered in every way at every level that this machine has, must give what the
/// oracle gives (or, with jitter, the naive search). Returns how many are found.
pub fn check_all_paths(texels: &Texels, queries: &[Query], packed: bool) -> usize {
    let words = texels.packed();
    let map: simd_search::Map<'_> = if packed {
        PackedMap::new(texels.width, texels.height, &words).unwrap().into()
    } else {
        texels.map().into()
    };
    let queries = &queries.iter().map(|query| in_unit(query, packed)).collect::<Vec<_>>()[..];
    let expected: Vec<_> = queries
        .iter()
        .map(|query| {
            let naive = naive::nearest(map, query);
            if query.jitter.is_nan() || query.jitter <= 0.0 {
                let truth = oracle(texels, packed, query);
                assert_eq!(bits(naive), bits(truth), "naive search, {query:?}");
            }
            bits(naive)
        })
        .collect();
    for level in Level::available() {
        let name = level.kind().name();
        for (query, expected) in queries.iter().zip(&expected) {
            let found = bits(nearest(level, map, query));
            assert_eq!(found, *expected, "box at {name}, {query:?}");
        }
        for with_ids in [false, true] {
            let (mut nodes, mut ids) = storage(texels.width, texels.height);
            if !with_ids {
                ids.clear();
            }
            let pyramid = Pyramid::build(level, map, &mut nodes, &mut ids).unwrap();
            for (query, expected) in queries.iter().zip(&expected) {
                let found = bits(pyramid.nearest(level, map, query));
                assert_eq!(found, *expected, "pyramid at {name}, {query:?}");
            }
            let mut hits = vec![None; queries.len()];
            pyramid.nearest_each(level, map, queries, &mut hits);
            let found: Vec<_> = hits.into_iter().map(bits).collect();
            assert_eq!(found, expected, "batch at {name}");
        }
    }
    expected.iter().flatten().count()
}

/// A query in the unit of a packed map, if it is one.
fn in_unit(query: &Query, packed: bool) -> Query {
    let mut query = *query;
    if packed {
        let unit = 16_777_215.0;
        query.point.nearness *= unit;
        query.point.slope *= unit;
        query.offset *= unit;
        if let Key::Ratio { at_most } = &mut query.key {
            *at_most /= unit * unit;
        }
    }
    query
}

/// Says which levels a test covered, past the test harness, which swallows what passing tests
/// print.
pub fn say_levels(test: &str) {
    let names: Vec<_> = Level::available().map(|level| level.kind().name()).collect();
    let _ = writeln!(std::io::stderr(), "{test}: levels {}", names.join(", "));
}
