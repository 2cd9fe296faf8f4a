//! Maps against a ray cast of the same texels, brute force in double precision.

mod support;

use glam::{DVec3, Vec3};
use raster::{DepthBuffer, Payload, Rasterizer};
use shadowmap_core::{Level, Threads, View};
use support::{Random, Soup, soup};

/// A ray through a texel centre.
struct Ray {
    origin: DVec3,
    direction: DVec3,
}

/// Distance along the ray (Möller and Trumbore 1997), `None` if it misses.
fn intersect(ray: &Ray, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let determinant = e1.dot(p);
    let s = ray.origin - a;
    let u = s.dot(p) / determinant;
    let q = s.cross(e1);
    let v = ray.direction.dot(q) / determinant;
    let t = e2.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then_some(t)
}

/// The nearest triangle (+ 1) and its nearness at every texel centre of a centred perspective view.
fn ray_cast(view: &View, soup: &Soup) -> (Vec<u32>, Vec<f64>) {
    let positions: Vec<DVec3> = soup.positions.iter().map(|p| p.as_dvec3()).collect();
    let [right, down, forward] = view.axes().map(|axis| axis.as_dvec3());
    let eye = Vec3::new(view.eye()[0], view.eye()[1], view.eye()[2]).as_dvec3();
    let focal = view.focal().as_dvec2();
    let [width, height] = [view.width(), view.height()];
    let (mut ids, mut nearness) = (Vec::new(), Vec::new());
    for y in 0..height {
        for x in 0..width {
            let u = (f64::from(x) + 0.5 - f64::from(width) * 0.5) / focal.x;
            let v = (f64::from(y) + 0.5 - f64::from(height) * 0.5) / focal.y;
            // Of unit length along the view axis, so that t is depth.
            let ray = Ray { origin: eye, direction: forward + right * u + down * v };
            let mut best = (0, 0.0);
            for (index, triangle) in soup.triangles.iter().enumerate() {
                let corners = triangle.map(|i| positions[i as usize]);
                if let Some(t) = intersect(&ray, corners)
                    && 1.0 / t > best.1
                    && 1.0 / t <= f64::from(view.max_nearness())
                {
                    best = (index as u32 + 1, 1.0 / t);
                }
            }
            ids.push(best.0);
            nearness.push(best.1);
        }
    }
    (ids, nearness)
}

#[test]
fn ids_and_depth_equal_a_ray_cast_away_from_edges() {
    let size = 128_i32;
    let view =
        View::perspective(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.2, size as u32, size as u32, 0.1);
    let mut scene = soup(&mut Random(21), 60, 1.5);
    scene.push(
        [Vec3::new(-40.0, -1.0, 5.0), Vec3::new(40.0, -1.0, 5.0), Vec3::new(0.0, -1.0, -90.0)],
        1,
    );
    let (ids, nearness) = ray_cast(&view, &scene);
    let mut map = DepthBuffer::new(size as u32, size as u32);
    let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
    rasterizer.draw(&view, &scene.mesh(), Payload::TriangleIndex, map.target());
    let (mut other, mut worst) = (0, 0.0_f64);
    for y in 0..size {
        for x in 0..size {
            let texel = (y * size + x) as usize;
            if map.payload[texel] != ids[texel] {
                other += 1;
                // One texel away there must be what the map holds here: an edge passes between.
                let at_edge = (-1..=1).any(|dy| {
                    (-1..=1).any(|dx| {
                        let (x, y) = (x + dx, y + dy);
                        let inside = (0..size).contains(&x) && (0..size).contains(&y);
                        inside && ids[(y * size + x) as usize] == map.payload[texel]
                    })
                });
                assert!(at_edge, "({x}, {y}): {} is {}", ids[texel], map.payload[texel]);
            } else if ids[texel] != 0 {
                let error = (f64::from(map.nearness[texel]) / nearness[texel] - 1.0).abs();
                worst = worst.max(error);
            }
        }
    }
    let share = f64::from(other) / f64::from(size * size);
    println!("other IDs at {other} texels ({share:.5}), depth within {worst:.2e}");
    assert!(ids.iter().filter(|&&id| id != 0).count() > 8000, "the scene fills the view");
    assert!(share < 1e-3, "{other} texels");
    assert!(worst < 1e-5, "{worst}");
}
