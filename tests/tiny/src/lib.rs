//! A render small enough for a microcontroller: a torus over the ground, a light's map of
//! 128 x 128 texels, and the mask of a 64 x 64 camera.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

use alloc::{vec, vec::Vec};
use core::f64::consts::TAU;

use glam::Vec3;
use raster::{DepthBuffer, Payload, Rasterizer};
use shadowmap_core::{Level, Mesh, Surface, Threads, View};
use single_sample::{Camera, LightMap, Surfaces, Texels, paper};

/// Texels along an edge of the light's map.
pub const MAP: u32 = 128;
/// Pixels along an edge of the mask.
pub const MASK: u32 = 64;

/// Draws the mask: one byte per pixel, 255 where the light is seen.
///
/// # Panics
///
/// Never: all sizes agree.
#[must_use]
pub fn mask(level: Level) -> Vec<u8> {
    let (positions, triangles, ids) = torus_over_ground();
    let mesh = Mesh { positions: &positions, triangles: &triangles, ids: &ids };
    let mut rasterizer = Rasterizer::new(level, Threads::One);

    let light_eye = Vec3::new(1.5, 6.0, 1.5);
    let light_view = View::perspective(light_eye, Vec3::ZERO, Vec3::NEG_Z, 1.2, MAP, MAP, 0.1);
    let mut light_map = DepthBuffer::new(MAP, MAP);
    rasterizer.draw(&light_view, &mesh, Payload::ObjectId, light_map.target());

    let camera_eye = Vec3::new(0.0, 5.0, 8.0);
    let target = Vec3::new(0.0, 0.8, 0.0);
    let camera_view = View::perspective(camera_eye, target, Vec3::Y, 0.7, MASK, MASK, 0.1);
    let mut camera_map = DepthBuffer::new(MASK, MASK);
    rasterizer.draw(&camera_view, &mesh, Payload::TriangleIndex, camera_map.target());

    let surface = |(&[a, b, c], &id): (&[u32; 3], &u32)| {
        let [a, b, c] = [a, b, c].map(|index| positions[index as usize]);
        Surface { normal: (b - a).cross(c - a).normalize_or_zero(), id }
    };
    // The camera's map holds triangle indices from 1.
    let mut surfaces = vec![Surface::UNKNOWN];
    surfaces.extend(triangles.iter().zip(&ids).map(surface));

    let camera = Camera::new(&camera_view, camera_map.as_depth_map(), Surfaces::Table(&surfaces));
    let light = LightMap::new(&light_view, Texels::Plain(light_map.as_depth_map()));
    let (camera, light) = (camera.expect("one size"), light.expect("one size"));
    let mut mask = vec![0; (MASK * MASK) as usize];
    let parameters = paper::Parameters { r_scale: 1.5, ..Default::default() };
    paper::visibility(&camera, &light, &parameters, Threads::One, &mut mask);
    mask
}

/// FNV-1a of the bytes.
#[must_use]
pub fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A torus of 24 x 12 cells, 1.5 m above the ground, which is two triangles.
fn torus_over_ground() -> (Vec<Vec3>, Vec<[u32; 3]>, Vec<u32>) {
    let mut positions = vec![
        Vec3::new(-5.0, 0.0, -5.0),
        Vec3::new(-5.0, 0.0, 5.0),
        Vec3::new(5.0, 0.0, 5.0),
        Vec3::new(5.0, 0.0, -5.0),
    ];
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    let (nu, nv) = (24, 12);
    for i in 0..nu {
        for j in 0..nv {
            let (u, v) = (TAU * f64::from(i) / f64::from(nu), TAU * f64::from(j) / f64::from(nv));
            let around = 1.0 + 0.35 * libm::cos(v);
            positions.push(Vec3::new(
                (around * libm::cos(u)) as f32,
                (1.5 + 0.35 * libm::sin(v)) as f32,
                (around * libm::sin(u)) as f32,
            ));
            let vertex = |i: i32, j: i32| (4 + (i % nu) * nv + j % nv) as u32;
            let (p00, p01) = (vertex(i, j), vertex(i, j + 1));
            let (p10, p11) = (vertex(i + 1, j), vertex(i + 1, j + 1));
            triangles.extend([[p00, p01, p11], [p00, p11, p10]]);
        }
    }
    let ids = (0..triangles.len()).map(|index| if index < 2 { 1 } else { 2 }).collect();
    (positions, triangles, ids)
}
