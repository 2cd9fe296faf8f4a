//! A tube light above a board, its maps drawn by a callback: your rasterizer goes there. Writes the
//! light that the ground receives as a PGM picture:
//! `cargo run --release -p linear-light --example tube_light > tube.pgm`

use std::io::Write;

use glam::Vec3;
use linear_light::{DrawnLight, RectifiedLight, SkinOptions, diffuse};
use shadowmap_core::{Bias, View};

/// Fills a map with what its view sees: a board 2 m by 1 m at 1.5 m, and the ground.
fn draw(view: &View, nearness: &mut [f32]) {
    let [x, y, z, _] = view.eye();
    let eye = Vec3::new(x, y, z);
    let width = view.width() as usize;
    for (i, texel) in nearness.iter_mut().enumerate() {
        let (u, v) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
        // The point of the texel's ray at depth 1.
        let ray = view.world_from_texel(u, v, 1.0) - eye;
        let hit = |height: f32| (height - eye.y) / ray.y;
        let board = eye + ray * hit(1.5);
        let on_board = board.x.abs() < 1.0 && board.z.abs() < 0.5;
        *texel = 1.0 / if on_board { hit(1.5) } else { hit(0.0) };
    }
}

fn main() -> std::io::Result<()> {
    let (a, b) = (Vec3::new(-1.0, 4.0, 0.0), Vec3::new(1.0, 4.0, 0.0));
    let ground = [(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)];
    let corners = ground.map(|(x, z)| Vec3::new(x, 0.0, z));
    let fitted = RectifiedLight::fit(a, b, 3, [512, 512], corners.into_iter());
    let mut light = DrawnLight::new(fitted);
    light.draw(&SkinOptions::default(), draw);

    let size = 512;
    let mut picture = Vec::with_capacity(size * size);
    light.with_shadows(Bias::default(), |shadows| {
        for i in 0..size * size {
            let at = |i: usize| (i as f32 + 0.5) * (8.0 / size as f32) - 4.0;
            let p = Vec3::new(at(i % size), 0.0, at(i / size));
            let seen = shadows[light.light().frustum_of(p)].visibility(p, Vec3::Y);
            let brightness = 16.0 * seen * diffuse(p, Vec3::Y, a, b);
            picture.push((brightness.sqrt() * 255.0) as u8);
        }
    });
    let mut out = std::io::stdout().lock();
    writeln!(out, "P5 {size} {size} 255")?;
    out.write_all(&picture)
}
