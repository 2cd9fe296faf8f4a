//! Where the penumbra of a small roof over a tilted floor comes from.
//!
//! `cargo run --release -p simd-search --example nearest_blocker`

use shadowmap_core::{DepthMap, Level, LightPoint};
use simd_search::{NodeGroup, Pyramid, Query, Side, Visits, naive};

const SIZE: u32 = 256;

/// Nearness of the floor, which the light sees at an angle.
fn floor(x: f32, y: f32) -> f32 {
    0.1 + 0.0002 * x + 0.0001 * y
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let is_roof = |x, y| (100..160).contains(&x) && (100..140).contains(&y);
    let texels: Vec<f32> = (0..SIZE * SIZE)
        .map(|i| (i % SIZE, i / SIZE))
        .map(|(x, y)| if is_roof(x, y) { 0.25 } else { floor(x as f32 + 0.5, y as f32 + 0.5) })
        .collect();
    let map = DepthMap::new(SIZE, SIZE, &texels, &[])?;
    let level = Level::detect();
    let mut storage = vec![NodeGroup::default(); Pyramid::storage_len(SIZE, SIZE)];
    let pyramid = Pyramid::build(level, map, &mut storage, &mut [])?;

    println!("level {}, radius 24 texels, row 120", level.kind().name());
    println!("{:>6}  {:<8} {:>14}  {:>6} {:>6}", "u", "looks for", "found", "texels", "nodes");
    for u in [40.0, 70.3, 80.3, 90.3, 99.3, 104.3, 115.3, 130.0] {
        let mut point = LightPoint::flat(u, 120.5, floor(u, 120.5));
        (point.slope.x, point.slope.y) = (0.0002, 0.0001);
        let mut query = Query::new(point, 0.001, 24.0);
        if is_roof(u as u32, 120) {
            query.side = Side::Lit;
        }
        let hit = pyramid.nearest(level, map, &query);
        assert_eq!(hit, naive::nearest(map, &query));
        let found = match hit {
            Some(hit) => format!("{:.2} away", hit.distance_squared.sqrt()),
            None => "nothing".to_owned(),
        };
        let visits = Visits::of_pyramid(map, &pyramid, &[query], &mut [None]);
        let side = format!("{:?}", query.side);
        println!("{u:>6}  {side:<9} {found:>13}  {:>6} {:>6}", visits.texels, visits.nodes);
    }
    Ok(())
}
