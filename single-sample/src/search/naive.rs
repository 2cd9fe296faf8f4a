//! The method without anything that makes it fast: for one pixel after another, all of the map.
//!
//! It is the specification of [`super::visibility`] without adaptive sampling, bit for bit.

use glam::Vec3;
use shadowmap_core::{Camera, Surface, Surfaces};

use super::cell::{CELL, CellBits, outline};
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::integral::{blocked_fraction, cell_of, contribution, hides_center};
use super::receiver::{Receiver, Seen, plane, receiver};
use super::segments::Segments;

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
    let seen = Seen::of(geometry, &receiver);
    let own_cell = cell_of(receiver.u, receiver.v);
    let mut sum = 0_i32;
    let mut is_hidden = false;
    let mut segments = Segments::new();
    for row in (-(CELL as i32)..field.height).step_by(CELL) {
        for column in (-(CELL as i32)..field.width).step_by(CELL) {
            let cell = [column, row];
            segments.truncate(0);
            outline(field, cell, &bits(field, &receiver, cell), &mut segments);
            for i in 0..segments.len() {
                sum = sum.wrapping_add(contribution(&seen, &segments.get(i)));
            }
            if cell == own_cell {
                is_hidden = hides_center(field, &receiver, &segments, 0..segments.len());
            }
        }
    }
    let visible = receiver.sky - blocked_fraction(is_hidden, sum);
    if visible > 0.0 { visible } else { 0.0 }
}

/// Which texels of a cell block the receiver.
fn bits<T: Texel>(field: &Field<'_, T>, receiver: &Receiver, [column, row]: [i32; 2]) -> CellBits {
    let mut bits = [0; CELL + 1];
    for (y, bits) in (row..).zip(&mut bits) {
        for (i, x) in (column..).take(CELL + 1).enumerate() {
            *bits |= u16::from(field.blocks([x, y], receiver)) << i;
        }
    }
    CellBits::new(bits)
}
