//! Two triangles that share an edge cover each texel once, never twice, never none.

mod support;

use glam::Vec3;
use raster::{DepthBuffer, Payload, Rasterizer};
use shadowmap_core::{Level, Threads, View, Window};
use support::{Random, Soup};

#[test]
fn ten_thousand_random_adjacent_triangles_cover_each_texel_exactly_once() {
    // A grid whose vertices are shaken, but not so much that triangles turn over, seen straight on,
    // beyond the map on all sides. Some vertices fall on texel centres and on their rows.
    const CELLS: usize = 71;
    let mut random = Random(42);
    let mut soup = Soup::default();
    for j in 0..=CELLS {
        for i in 0..=CELLS {
            let (mut x, mut y) = (i as f32 * 2.0 - 7.0, j as f32 * 2.0 - 7.0);
            match random.below(4) {
                0 => (x, y) = (x.floor() + 0.5, y.floor() + 0.5),
                1 => y = y.floor() + 0.5,
                _ => (x, y) = (x + random.between(-0.45, 0.45), y + random.between(-0.45, 0.45)),
            }
            soup.positions.push(Vec3::new(x, -y, -1.0));
        }
    }
    let vertex = |i: usize, j: usize| (j * (CELLS + 1) + i) as u32;
    for j in 0..CELLS {
        for i in 0..CELLS {
            let [a, b] = [vertex(i, j), vertex(i + 1, j)];
            let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
            let quad =
                if random.below(2) == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            for mut triangle in quad {
                if random.below(2) == 0 {
                    triangle.swap(0, 1);
                }
                soup.triangles.push(triangle);
                soup.ids.push(1);
            }
        }
    }
    assert!(soup.triangles.len() >= 10_000);
    let size = 128;
    let axes = [Vec3::X, Vec3::NEG_Y, Vec3::NEG_Z];
    let window = Window { left: 0.0, top: 0.0, right: size as f32, bottom: size as f32 };
    let view = View::orthographic_window(Vec3::ZERO, axes, window, size, size, [0.0, 2.0]);
    for level in Level::available() {
        let mut rasterizer = Rasterizer::new(level, Threads::One);
        let mut counts = vec![0_i32; (size * size) as usize];
        let mut map = DepthBuffer::new(size, size);
        for triangle in &soup.triangles {
            let one = Soup {
                positions: triangle.map(|i| soup.positions[i as usize]).to_vec(),
                triangles: vec![[0, 1, 2]],
                ids: vec![1],
            };
            rasterizer.draw(&view, &one.mesh(), Payload::ObjectId, map.target());
            for (count, &id) in counts.iter_mut().zip(&map.payload) {
                *count += id as i32;
            }
        }
        assert!(counts.iter().all(|&count| count == 1), "{}", level.kind().name());
    }
}
