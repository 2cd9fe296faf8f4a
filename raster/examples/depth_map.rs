//! Draws a depth map of a tilted ring of boxes and writes it as a picture: light is near.
//!
//! `cargo run --release -p raster --example depth_map > depth.pgm`

use std::io::{self, Write};

use glam::{Quat, Vec3};
use raster::{DepthBuffer, Payload, Rasterizer};
use shadowmap_core::{Level, Mesh, Threads, View};

/// The corners of a box's faces, a bit per axis.
const FACES: [[usize; 4]; 6] =
    [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];

fn main() -> io::Result<()> {
    let (mut positions, mut triangles, mut ids) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..24 {
        let angle = k as f32 * std::f32::consts::TAU / 24.0;
        let turn = Quat::from_rotation_x(0.6) * Quat::from_rotation_y(angle);
        let first = positions.len() as u32;
        for corner in 0..8 {
            let sign = |axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let half = Vec3::new(0.5 * sign(0), 0.25 * sign(1), 0.15 * sign(2));
            positions.push(turn * (Vec3::X * 2.5 + half));
        }
        for [a, b, c, d] in FACES.map(|face| face.map(|corner| first + corner as u32)) {
            triangles.extend([[a, b, c], [a, c, d]]);
            ids.extend([k + 1; 2]);
        }
    }
    let mesh = Mesh { positions: &positions, triangles: &triangles, ids: &ids };
    let eye = Vec3::new(0.0, 3.0, 6.0);
    let view = View::perspective(eye, Vec3::ZERO, Vec3::Y, 0.9, 640, 480, 0.1);
    let mut map = DepthBuffer::new(view.width(), view.height());
    let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
    let stats = rasterizer.draw(&view, &mesh, Payload::ObjectId, map.target());
    eprintln!("{} of {} triangles in the map", stats.drawn, triangles.len());

    let nearest = map.nearness.iter().fold(0.0_f32, |a, &b| a.max(b));
    let grey: Vec<u8> = map.nearness.iter().map(|n| (n / nearest * 255.0) as u8).collect();
    let mut out = io::stdout().lock();
    writeln!(out, "P5 {} {} 255", map.width(), map.height())?;
    out.write_all(&grey)
}
