//! [`Rasterizer`] equals [`draw_plain`] bit for bit: at every level, with any number of threads, in
//! any order of the triangles.

mod support;

use std::io::Write as _;

use raster::{AlphaMask, DepthBuffer, DrawStats, Payload, Rasterizer, draw_plain};
use shadowmap_core::{BandSlice, Level, Threads, View};
use support::{Random, Soup, rectified_views, soup, torture, views};

fn plain(
    view: &View,
    soup: &Soup,
    mask: Option<&AlphaMask<'_>>,
    payload: Payload,
) -> (DepthBuffer, DrawStats) {
    let mut map = DepthBuffer::new(view.width(), view.height());
    let stats = draw_plain(view, &soup.mesh(), mask, payload, map.target());
    (map, stats)
}

/// A map full of rubbish, which drawing must clear.
fn dirty(view: &View) -> DepthBuffer {
    let mut map = DepthBuffer::new(view.width(), view.height());
    map.nearness.fill(f32::MAX);
    map.payload.fill(77);
    map
}

fn assert_same(found: &DepthBuffer, expected: &DepthBuffer, what: &str) {
    let width = found.width() as usize;
    for texel in 0..expected.nearness.len() {
        let bits = |map: &DepthBuffer| (map.nearness[texel].to_bits(), map.payload[texel]);
        let (f, e) = (bits(found), bits(expected));
        assert_eq!(f, e, "{what}: texel ({}, {})", texel % width, texel / width);
    }
}

/// Compares everything there is to choose for one mesh.
fn compare(soup: &Soup, mask: Option<&AlphaMask<'_>>, what: &str) {
    for (view, payload) in
        views().iter().zip([Payload::ObjectId, Payload::TriangleIndex].into_iter().cycle())
    {
        let (expected, expected_stats) = plain(view, soup, mask, payload);
        for level in Level::available() {
            for threads in [Threads::One, Threads::Pool] {
                let mut rasterizer = Rasterizer::new(level, threads);
                let mut map = dirty(view);
                let (views, mesh) = (&[*view], &soup.mesh());
                let stats = match mask {
                    None => rasterizer.draw(view, mesh, payload, map.target()),
                    Some(m) => rasterizer.draw_masked(views, mesh, m, payload, &mut [map.target()]),
                };
                let what = format!("{what}, {}, {threads:?}", level.kind().name());
                assert_same(&map, &expected, &what);
                assert_eq!(stats, expected_stats, "{what}");
            }
        }
    }
}

#[test]
fn ordinary_triangles_of_every_size() {
    let levels: Vec<_> = Level::available().map(|level| level.kind().name()).collect();
    // Past the test harness, which swallows what passing tests print.
    let _ = writeln!(std::io::stderr(), "rasterizer: levels {}", levels.join(", "));
    for (size, count) in [(0.003, 3000), (0.02, 3000), (0.1, 2000), (0.5, 500), (4.0, 100)] {
        compare(&soup(&mut Random(7), count, size), None, &format!("size {size}"));
    }
}

#[test]
fn extraordinary_triangles() {
    for seed in 0..4 {
        compare(&torture(&mut Random(seed), 1500), None, &format!("seed {seed}"));
    }
}

#[test]
fn holes_that_an_alpha_test_makes() {
    let soup = torture(&mut Random(11), 600);
    let masked: Vec<bool> = (0..500).map(|i| i % 3 == 0).collect();
    let keep = |triangle: usize, b1: f32, b2: f32| ((b1 + b2) * 8.0) as usize % 2 == triangle % 2;
    compare(&soup, Some(&AlphaMask { masked: &masked, keep: &keep }), "masked");
}

#[test]
fn the_order_of_the_triangles_does_not_matter() {
    let mut random = Random(5);
    let original = torture(&mut random, 1200);
    let view = views()[0];
    let (expected, stats) = plain(&view, &original, None, Payload::ObjectId);
    for _ in 0..5 {
        let mut pairs: Vec<_> =
            original.triangles.iter().copied().zip(original.ids.iter().copied()).collect();
        random.shuffle(&mut pairs);
        let (triangles, ids) = pairs.into_iter().unzip();
        let shuffled = Soup { triangles, ids, ..original.clone() };
        assert_same(&plain(&view, &shuffled, None, Payload::ObjectId).0, &expected, "plain");
        for level in Level::available() {
            let mut map = dirty(&view);
            let mut rasterizer = Rasterizer::new(level, Threads::Pool);
            let mesh = shuffled.mesh();
            let found = rasterizer.draw(&view, &mesh, Payload::ObjectId, map.target());
            assert_same(&map, &expected, level.kind().name());
            assert_eq!(found, stats);
        }
    }
}

#[test]
fn any_number_of_threads() {
    let soup = torture(&mut Random(3), 3000);
    let view = views()[0];
    let (expected, _) = plain(&view, &soup, None, Payload::TriangleIndex);
    for threads in [1, 2, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut map = dirty(&view);
        pool.install(|| {
            Rasterizer::new(Level::detect(), Threads::Pool).draw(
                &view,
                &soup.mesh(),
                Payload::TriangleIndex,
                map.target(),
            )
        });
        assert_same(&map, &expected, &format!("{threads} threads"));
    }
}

#[test]
fn several_views_at_once_and_scratch_memory_used_before() {
    let soups = [soup(&mut Random(1), 900, 0.2), torture(&mut Random(2), 900), Soup::default()];
    for level in Level::available() {
        let mut rasterizer = Rasterizer::new(level, Threads::One);
        for soup in &soups {
            for views in [&views()[..], &views()[2..5], &[]] {
                let mut maps: Vec<_> = views.iter().map(dirty).collect();
                let mut targets: Vec<_> = maps.iter_mut().map(DepthBuffer::target).collect();
                rasterizer.draw_many(views, &soup.mesh(), Payload::ObjectId, &mut targets);
                for (view, map) in views.iter().zip(&maps) {
                    let (expected, _) = plain(view, soup, None, Payload::ObjectId);
                    assert_same(map, &expected, level.kind().name());
                }
            }
        }
    }
}

#[test]
fn views_beside_each_other() {
    let soups = [soup(&mut Random(1), 70_000, 0.05), torture(&mut Random(4), 1500)];
    let keep = |triangle: usize, b1: f32, b2: f32| ((b1 + b2) * 8.0) as usize % 2 == triangle % 2;
    let mask = AlphaMask { masked: &[true, false, false].repeat(400), keep: &keep };
    // Apart, not beside each other, all in one place.
    let apart: Vec<View> = views()[..2].iter().copied().chain(rectified_views()).collect();
    let one_place = vec![rectified_views()[2]; 3];
    for soup in &soups {
        for views in [rectified_views(), apart.clone(), one_place.clone()] {
            for mask in [None, Some(&mask)] {
                compare_at_once(soup, mask, &views);
            }
        }
    }
}

/// Compares maps drawn at once, at every level, with each drawn alone.
fn compare_at_once(soup: &Soup, mask: Option<&AlphaMask<'_>>, views: &[View]) {
    let payload = Payload::TriangleIndex;
    let expected: Vec<_> = views.iter().map(|view| plain(view, soup, mask, payload)).collect();
    for level in Level::available() {
        let mut rasterizer = Rasterizer::new(level, Threads::Pool);
        let mut maps: Vec<_> = views.iter().map(dirty).collect();
        let mut targets: Vec<_> = maps.iter_mut().map(DepthBuffer::target).collect();
        let found = match mask {
            None => rasterizer.draw_many(views, &soup.mesh(), payload, &mut targets),
            Some(m) => rasterizer.draw_masked(views, &soup.mesh(), m, payload, &mut targets),
        };
        let mut sum = DrawStats::default();
        for (index, (map, (expected, stats))) in maps.iter().zip(&expected).enumerate() {
            assert_same(map, expected, &format!("{} {index}", level.kind().name()));
            sum.drawn += stats.drawn;
            sum.clipped += stats.clipped;
            sum.invalid += stats.invalid;
        }
        assert_eq!(found, sum);
    }
}

#[test]
fn a_mesh_of_more_than_one_batch() {
    let soup = soup(&mut Random(9), 150_000, 0.05);
    let view = views()[0];
    let (expected, expected_stats) = plain(&view, &soup, None, Payload::TriangleIndex);
    let mut map = dirty(&view);
    let mut rasterizer = Rasterizer::new(Level::detect(), Threads::Pool);
    let stats = rasterizer.draw(&view, &soup.mesh(), Payload::TriangleIndex, map.target());
    assert_same(&map, &expected, "two batches");
    assert_eq!(stats, expected_stats);
}

/// Every band of every map is handed on once, as it is in the end, with what belongs to it.
#[test]
fn bands_are_handed_on_when_they_are_drawn() {
    // More triangles than there are texels: they are drawn in several batches.
    for (size, count) in [(0.1, 2000), (0.003, 90_000)] {
        let soup = soup(&mut Random(11), count, size);
        let views = [rectified_views(), views().to_vec()].concat();
        let mut expected: Vec<_> = views.iter().map(dirty).collect();
        let mut targets: Vec<_> = expected.iter_mut().map(DepthBuffer::target).collect();
        let mut rasterizer = Rasterizer::new(Level::SCALAR, Threads::One);
        rasterizer.draw_many(&views, &soup.mesh(), Payload::ObjectId, &mut targets);
        for (level, threads) in
            Level::available().flat_map(|level| [(level, Threads::One), (level, Threads::Pool)])
        {
            for rows in [Rasterizer::BAND, 3 * Rasterizer::BAND] {
                let mut maps: Vec<_> = views.iter().map(dirty).collect();
                let mut copies: Vec<_> = views.iter().map(dirty).collect();
                let beside = copies.iter_mut().map(|copy| {
                    let len = (rows * copy.width()) as usize;
                    (
                        BandSlice { data: &mut copy.nearness[..], len },
                        BandSlice { data: &mut copy.payload[..], len },
                    )
                });
                let mut targets: Vec<_> = maps.iter_mut().map(DepthBuffer::target).collect();
                let (mut rasterizer, mesh) = (Rasterizer::new(level, threads), soup.mesh());
                rasterizer.draw_in_bands(
                    &views,
                    &mesh,
                    None,
                    Payload::ObjectId,
                    &mut targets,
                    rows,
                    beside,
                    &|band, (nearness, payload)| {
                        assert_eq!(
                            band.height() as usize,
                            nearness.data.len() / band.width() as usize
                        );
                        nearness.data.copy_from_slice(band.nearness());
                        payload.data.copy_from_slice(band.ids());
                    },
                );
                let what = format!("{}, {threads:?}, {rows} rows", level.kind().name());
                for (copy, expected) in copies.iter().zip(&expected) {
                    assert_same(copy, expected, &what);
                }
                for (map, expected) in maps.iter().zip(&expected) {
                    assert_same(map, expected, &what);
                }
            }
        }
    }
}
