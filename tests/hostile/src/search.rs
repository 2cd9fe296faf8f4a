//! Searches by every path against the naive one, on any map.

use shadowmap_core::{DepthMap, Level, PackedMap};
use simd_search::{
    Hit, IdGroup, IdTest, Key, Map, NodeGroup, Pyramid, Query, Reach, Side, Verdict, Visits, naive,
    nearest,
};

use crate::any::{Bytes, Map as Texels};

pub fn check(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let size = bytes.size(70);
    let texels = bytes.map(size);
    let level = bytes.level();
    if bytes.flag() {
        let ids = if bytes.flag() { &texels.ids[..] } else { &[] };
        let map = DepthMap::new(size[0], size[1], &texels.nearness, ids);
        searches(bytes, level, map.expect("one texel each").into(), 1.0);
        update(bytes, level, texels);
    } else {
        let pack = |(&nearness, &id)| PackedMap::pack(nearness, 1.0, id);
        let packed: Vec<u32> = texels.nearness.iter().zip(&texels.ids).map(pack).collect();
        let map = PackedMap::new(size[0], size[1], &packed).expect("one texel each");
        searches(bytes, level, map.into(), 16_777_215.0);
    }
}

fn query(bytes: &mut Bytes<'_>, size: [u32; 2], unit: f32) -> Query {
    let mut point = bytes.light_point(size);
    point.nearness *= unit;
    point.slope *= unit;
    let offset = if bytes.byte() < 200 { unit / 1024.0 } else { bytes.number() };
    let radius = if bytes.byte() < 200 { bytes.up_to(80) as f32 * 0.7 } else { bytes.number() };
    let id = bytes.byte().into();
    Query {
        side: if bytes.flag() { Side::Blocker } else { Side::Lit },
        ids: match bytes.byte() % 4 {
            0 => IdTest::Differs(id),
            1 => IdTest::Equals(id),
            _ => IdTest::Any,
        },
        key: match bytes.byte() % 3 {
            0 => Key::Ratio { at_most: bytes.number() },
            1 => Key::Ratio { at_most: f32::INFINITY },
            _ => Key::Distance,
        },
        jitter: if bytes.byte() < 200 { 0.0 } else { bytes.number() },
        hint: (bytes.byte() < 32).then(|| [bytes.up_to(80), bytes.word()]),
        ..Query::new(point, offset, radius)
    }
}

fn searches(bytes: &mut Bytes<'_>, level: Level, map: Map<'_>, unit: f32) {
    let size = [map.width(), map.height()];
    let queries: Vec<Query> = (0..=bytes.up_to(9)).map(|_| query(bytes, size, unit)).collect();
    let expected: Vec<_> = queries.iter().map(|q| bits(&naive::nearest(map, q))).collect();
    let groups = Pyramid::storage_len(size[0], size[1]);
    for level in [Level::SCALAR, level] {
        let mut nodes = vec![NodeGroup::default(); groups];
        let mut ids = vec![IdGroup::default(); if bytes.flag() { groups } else { 0 }];
        let pyramid = Pyramid::build(level, map, &mut nodes, &mut ids);
        let pyramid = pyramid.expect("as long as asked");
        let mut hits = vec![None; queries.len()];
        let _ = Visits::of_pyramid(map, &pyramid, &queries, &mut hits);
        assert_eq!(hits.iter().map(bits).collect::<Vec<_>>(), expected, "visits: {queries:?}");
        pyramid.nearest_each(level, map, &queries, &mut hits);
        for ((query, expected), hit) in queries.iter().zip(&expected).zip(&hits) {
            assert_eq!(bits(hit), *expected, "{}, many: {query:?}", level.kind().name());
            let one = pyramid.nearest(level, map, query);
            assert_eq!(bits(&one), *expected, "{}, one: {query:?}", level.kind().name());
            let boxed = nearest(level, map, query);
            assert_eq!(bits(&boxed), *expected, "{}, box: {query:?}", level.kind().name());
            judge(level, &pyramid, query, map);
            let _ = Visits::of_box(map, query);
        }
    }
}

/// A hit as numbers that are equal if their bits are: a lit texel may be NaN.
fn bits(hit: &Option<Hit>) -> Option<[u32; 5]> {
    let Hit { x, y, distance_squared, nearness, key } = (*hit)?;
    Some([x, y, distance_squared.to_bits(), nearness.to_bits(), key.to_bits()])
}

/// What a verdict says of all texels holds for each.
fn judge(level: Level, pyramid: &Pyramid<'_>, query: &Query, map: Map<'_>) {
    let reach = Reach::of(query.point, query.offset, query.radius);
    let found = |side, ids| {
        let plain = Query { side, ids, key: Key::Distance, jitter: 0.0, ..*query };
        naive::nearest(map, &plain)
    };
    match pyramid.classify(level, &reach, query.ids) {
        Verdict::Clear => assert!(found(Side::Blocker, query.ids).is_none(), "{query:?}"),
        Verdict::Covered => assert!(found(Side::Lit, IdTest::Any).is_none(), "{query:?}"),
        Verdict::Mixed => {}
    }
}

/// A pyramid that was updated where the map changed finds what a new one would.
fn update(bytes: &mut Bytes<'_>, level: Level, mut texels: Texels) {
    let size = texels.size;
    let groups = Pyramid::storage_len(size[0], size[1]);
    let (mut nodes, mut ids) =
        (vec![NodeGroup::default(); groups], vec![IdGroup::default(); groups]);
    let built = Pyramid::build(level, texels.as_depth_map(), &mut nodes, &mut ids);
    built.expect("as long as asked");
    let [x, y] = size.map(|side| bytes.up_to(side));
    let [columns, rows] = [x..x.saturating_add(bytes.up_to(20)), y..y + bytes.up_to(20)];
    let (value, id) = (bytes.number(), bytes.byte().into());
    for y in rows.start..rows.end.min(size[1]) {
        for x in columns.start..columns.end.min(size[0]) {
            let texel = y as usize * size[0] as usize + x as usize;
            (texels.nearness[texel], texels.ids[texel]) = (value, id);
        }
    }
    let map = texels.as_depth_map();
    let pyramid = Pyramid::update(level, map, &mut nodes, &mut ids, columns, rows);
    let pyramid = pyramid.expect("as long as asked");
    let query = query(bytes, size, 1.0);
    let (hit, expected) = (pyramid.nearest(level, map, &query), naive::nearest(map, &query));
    assert_eq!(bits(&hit), bits(&expected), "{query:?}");
}
