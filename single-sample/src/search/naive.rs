//! The method without anything that makes it fast: for one pixel after another, all of the map.
//!
//! It is the specification of [`super::visibility`] without adaptive sampling, bit for bit.

use glam::Vec3;
use shadowmap_core::{Camera, Surface, Surfaces};

use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::integral::{blocked_fraction, contribution};
use super::receiver::{Receiver, plane, receiver};
use super::segments::PIECES;

/// The visibility at pixel (x, y).
pub(crate) fn visibility<T: Texel>(
    camera: &Camera<'_>,
    field: &Field<'_, T>,
    geometry: &Geometry,
    x: u32,
    y: u32,
) -> f32 {
    let index = y as usize * camera.map().width() as usize + x as usize;
    let n = camera.map().nearness()[index];
    let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
    let through = |normal: Vec3| plane(geometry, px, py, n, normal.to_array());
    let plane = match camera.surfaces() {
        Surfaces::FromDepth => camera.plane(x, y, n).1.0,
        Surfaces::Normals(normals) => through(normals[index]),
        Surfaces::Table(table) => {
            let surface = table.get(camera.map().id(x, y) as usize);
            through(surface.unwrap_or(&Surface::UNKNOWN).normal)
        }
    };
    let receiver = receiver(geometry, px, py, n, plane);
    if receiver.sky <= 0.0 {
        return 0.0;
    }
    let mut sum = 0_i32;
    for row in -1..field.height {
        for column in -1..field.width {
            sum = sum.wrapping_add(place(field, &receiver, column, row));
        }
    }
    let visible = receiver.sky - blocked_fraction(field.hides_center(&receiver), sum);
    if visible > 0.0 { visible } else { 0.0 }
}

/// What the outline between four texels contributes.
fn place<T: Texel>(field: &Field<'_, T>, receiver: &Receiver, column: i32, row: i32) -> i32 {
    let (pieces, count) = &PIECES[field.corner(receiver, column, row)];
    let mut sum = 0_i32;
    for piece in &pieces[..*count] {
        let [a, b] = piece
            .blockers
            .map(|[dx, dy]| field.nearness(column + i32::from(dx), row + i32::from(dy)));
        let x = (column as f32 + 0.5) + piece.middle[0];
        let y = (row as f32 + 0.5) + piece.middle[1];
        let [half_x, half_y] = piece.half;
        sum = sum.wrapping_add(contribution(receiver, x, y, half_x, half_y, (a + b) * 0.5));
    }
    sum
}
