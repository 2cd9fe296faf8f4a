//! Building and rebuilding.

mod common;

use common::{KINDS, Random, say_levels, storage, texels};
use shadowmap_core::{Bands, DepthMap, Level, LightPoint, Threads, for_each_band};
use simd_search::{LeafBands, NodeGroup, Pyramid, Query, Visits};

/// The storage after an update is that of a new pyramid, which is the same at every level.
#[test]
fn an_update_equals_a_new_pyramid() {
    say_levels("update");
    for seed in 0..120 {
        let mut random = Random(seed);
        let (width, height) = (1 + random.below(300), 1 + random.below(200));
        let mut texels = texels(seed as u32 % KINDS, width, height, &mut random);
        let (mut nodes, mut ids) = storage(width, height);
        Pyramid::build(Level::SCALAR, texels.map(), &mut nodes, &mut ids).unwrap();
        let (x, y) = (random.below(width), random.below(height));
        let columns = x..x + random.below(80);
        let rows = y..y + random.below(60);
        for y in rows.start..rows.end.min(height) {
            for x in columns.start..columns.end.min(width) {
                let index = (y * width + x) as usize;
                texels.nearness[index] = random.pick(&[random.clone().unit(), f32::NAN, 0.0]);
                if let Some(id) = texels.ids.get_mut(index) {
                    *id = random.below(3);
                }
            }
        }
        let (mut fresh_nodes, mut fresh_ids) = storage(width, height);
        Pyramid::build(Level::SCALAR, texels.map(), &mut fresh_nodes, &mut fresh_ids).unwrap();
        for level in Level::available() {
            let (mut nodes, mut ids) = (nodes.clone(), ids.clone());
            let map = texels.map();
            Pyramid::update(level, map, &mut nodes, &mut ids, columns.clone(), rows.clone())
                .unwrap();
            assert!(nodes == fresh_nodes, "seed {seed}, update at {}", level.kind().name());
            assert!(ids == fresh_ids, "seed {seed}, update at {}", level.kind().name());
            Pyramid::build(level, map, &mut nodes, &mut ids).unwrap();
            assert!(nodes == fresh_nodes, "seed {seed}, build at {}", level.kind().name());
            assert!(ids == fresh_ids, "seed {seed}, build at {}", level.kind().name());
        }
    }
}

/// Leaves that are built band by band, from maps of the bands alone, make the same pyramid.
#[test]
fn bands_make_the_same_pyramid() {
    say_levels("bands");
    for seed in 0..60 {
        let mut random = Random(seed);
        let (width, height) = (random.below(200), random.below(300));
        let texels = texels(seed as u32 % KINDS, width, height, &mut random);
        let map = texels.map();
        let (mut nodes, mut ids) = storage(width, height);
        Pyramid::build(Level::SCALAR, map, &mut nodes, &mut ids).unwrap();
        let rows = LeafBands::ROWS * (1 + random.below(4));
        for level in Level::available() {
            let (mut found_nodes, mut found_ids) = storage(width, height);
            if random.below(2) == 0 {
                found_ids.clear();
            }
            let bands = LeafBands::new(width, height, rows, &mut found_nodes, &mut found_ids);
            let bands = bands.unwrap();
            assert_eq!(bands.count(), if width > 0 { height.div_ceil(rows) as usize } else { 0 });
            for_each_band(Threads::One, bands, &|index, band| {
                let first = index as u32 * rows;
                let rows = rows.min(height - first);
                let texels = (first * width) as usize..((first + rows) * width) as usize;
                let ids = map.ids().get(texels.clone()).unwrap_or_default();
                let part = DepthMap::new(width, rows, &map.nearness()[texels], ids).unwrap();
                band.build(level, part);
            });
            Pyramid::finish(level, map, &mut found_nodes, &mut found_ids).unwrap();
            let name = level.kind().name();
            assert!(found_nodes == nodes, "seed {seed}, {rows} rows at {name}");
            assert!(found_ids.is_empty() || found_ids == ids, "seed {seed}, {rows} rows at {name}");
        }
    }
}

#[test]
#[should_panic(expected = "the rows of the band")]
fn a_band_of_other_rows_is_refused() {
    let texels = [0.0; 64 * 64];
    let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(64, 96)];
    let bands = LeafBands::new(64, 96, LeafBands::ROWS, &mut nodes, &mut []).unwrap();
    bands.build(Level::SCALAR, DepthMap::new(64, 64, &texels, &[]).unwrap());
}

#[test]
fn storage_of_another_length_is_an_error() {
    let texels = [0.0; 64 * 64];
    let map = DepthMap::new(64, 64, &texels, &[]).unwrap();
    let length = Pyramid::storage_len(64, 64);
    let mut nodes = vec![NodeGroup::default(); length + 1];
    let error = Pyramid::build(Level::SCALAR, map, &mut nodes, &mut []).unwrap_err();
    assert_eq!(
        error.to_string(),
        format!("nodes has {} groups, the map's pyramid needs {length}", length + 1)
    );
    assert_eq!(Pyramid::storage_len(0, 7), 0);
}

#[test]
#[should_panic(expected = "the pyramid is of a map of another size")]
fn a_pyramid_of_another_map_is_refused() {
    let texels = [0.0; 64 * 32];
    let map = DepthMap::new(64, 32, &texels, &[]).unwrap();
    let other = DepthMap::new(32, 64, &texels, &[]).unwrap();
    let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(64, 32)];
    let pyramid = Pyramid::build(Level::SCALAR, map, &mut nodes, &mut []).unwrap();
    let query = Query::new(LightPoint::flat(1.0, 1.0, 0.0), 0.0, 1.0);
    let _ = pyramid.nearest(Level::SCALAR, other, &query);
}

#[test]
#[should_panic(expected = "one hit per query")]
fn visits_want_as_many_hits_as_queries() {
    let texels = [0.0; 64 * 32];
    let map = DepthMap::new(64, 32, &texels, &[]).unwrap();
    let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(64, 32)];
    let pyramid = Pyramid::build(Level::SCALAR, map, &mut nodes, &mut []).unwrap();
    let query = Query::new(LightPoint::flat(1.0, 1.0, 0.0), 0.0, 1.0);
    let _ = Visits::of_pyramid(map, &pyramid, &[query], &mut []);
}
