//! One tile of the image: decided as a whole where possible, else pixel by pixel.

use shadowmap_core::{Camera, Surfaces};
use simd_search::Pyramid;

use super::adaptive::{NO_KEY, Samples, TILE};
use super::field::{Field, Test, Texel};
use super::geometry::Geometry;
use super::integral::{blocked_fraction, sum};
use super::kernels::Ops;
use super::outline::{Outcome, outline};
use super::reach::{Extent, Reach};
use super::receiver::{Receiver, plane};
use super::segments::Segments;
use super::soa::Receivers;
use crate::{Counters, Visibility};

/// What all tiles of a call share.
pub(crate) struct Scene<'a, T> {
    pub camera: Camera<'a>,
    pub field: Field<'a, T>,
    pub pyramid: Pyramid<'a>,
    pub geometry: Geometry,
    /// The nearest depth of the whole map.
    pub greatest: f32,
    /// Pixels between searched columns.
    pub group: usize,
}

/// Memory for one tile at a time.
pub(crate) struct Scratch {
    receivers: Receivers,
    samples: Samples,
    own: Segments,
    ids: [u32; TILE * TILE],
}

impl Scratch {
    pub const fn new() -> Scratch {
        Scratch {
            receivers: Receivers::new(),
            samples: Samples::new(),
            own: Segments::new(),
            ids: [0; TILE * TILE],
        }
    }
}

/// Object ID and plane of pixel (x, y).
#[inline(always)]
pub(crate) fn surface_of(
    camera: &Camera<'_>,
    g: &Geometry,
    x: u32,
    y: u32,
    n: f32,
) -> (u32, [f32; 4]) {
    let id = camera.map().id(x, y);
    let (id, normal) = match camera.surfaces() {
        Surfaces::FromDepth => {
            let (id, plane) = camera.plane(x, y, n);
            return (id, plane.0);
        }
        Surfaces::Normals(normals) => {
            (id, normals[y as usize * camera.map().width() as usize + x as usize])
        }
        Surfaces::Table(table) => match table.get(id as usize) {
            Some(surface) => (surface.id, surface.normal),
            None => (0, glam::Vec3::ZERO),
        },
    };
    (id, plane(g, x as f32 + 0.5, y as f32 + 0.5, n, normal.to_array()))
}

/// Writes the visibility of the tile whose first pixel is (left, top) to `out`, rows of the
/// camera's whole width that begin with row `top`.
#[inline(always)]
pub(crate) fn tile<T: Texel, V: Visibility>(
    ops: &impl Ops,
    scene: &Scene<'_, T>,
    scratch: &mut Scratch,
    [left, top]: [u32; 2],
    out: &mut [V],
    counters: &mut Counters,
) {
    let image = scene.camera.map().width() as usize;
    let width = (image - left as usize).min(TILE);
    let height = (out.len() / image).min(TILE);
    set_receivers(scene, scratch, [left, top], [width, height], counters);
    let Scratch { receivers, samples, own, ids } = scratch;

    let mut extent = Extent {
        u: [f32::INFINITY, f32::NEG_INFINITY],
        v: [f32::INFINITY, f32::NEG_INFINITY],
        nearness: f32::INFINITY,
    };
    for row in 0..height {
        for i in row * TILE..row * TILE + width {
            if receivers.sky[i] > 0.0 {
                let (u, v) = (receivers.u[i], receivers.v[i]);
                extent.u = [extent.u[0].min(u), extent.u[1].max(u)];
                extent.v = [extent.v[0].min(v), extent.v[1].max(v)];
                extent.nearness = extent.nearness.min(receivers.nearness[i]);
            }
        }
    }
    let size = [scene.field.width, scene.field.height];
    let reach = Reach::new(&scene.geometry, &scene.pyramid, scene.greatest, size, &extent);
    counters.tiles += 1;
    if reach.is_some() {
        for row in 0..height {
            for i in row * TILE..row * TILE + width {
                samples.keys[i] = if receivers.sky[i] > 0.0 {
                    let hard = scene.field.hides_center(&receivers.get(i));
                    (u64::from(ids[i]) << 1 | u64::from(hard)) + 1
                } else {
                    NO_KEY
                };
            }
        }
        samples.fill(scene.group, width, height, |i| {
            counters.searches += 1;
            own_search(ops, scene, &receivers.get(i), own, counters)
        });
    } else {
        counters.decided_tiles += 1;
        samples.values = [0.0; TILE * TILE];
    }
    for row in 0..height {
        let out = &mut out[row * image + left as usize..][..width];
        for (i, out) in out.iter_mut().enumerate() {
            let k = row * TILE + i;
            let visible = receivers.sky[k] - samples.values[k];
            *out = V::from_unit(if visible > 0.0 { visible } else { 0.0 });
        }
    }
}

/// The blocked fraction of one receiver's disc, from an outline of its own.
#[inline(always)]
fn own_search<T: Texel>(
    ops: &impl Ops,
    scene: &Scene<'_, T>,
    receiver: &Receiver,
    segments: &mut Segments,
    counters: &mut Counters,
) -> f32 {
    let Receiver { u, v, nearness, .. } = *receiver;
    let extent = Extent { u: [u; 2], v: [v; 2], nearness };
    let size = [scene.field.width, scene.field.height];
    let Some(reach) = Reach::new(&scene.geometry, &scene.pyramid, scene.greatest, size, &extent)
    else {
        return 0.0;
    };
    counters.cut_by_border += u32::from(reach.is_cut);
    segments.len = 0;
    let mut total = 0_i32;
    let outcome = outline(ops, &scene.field, &Test::of(receiver), reach.places, segments, |full| {
        full.pad();
        total = total.wrapping_add(sum(receiver, full));
        full.len = 0;
    });
    debug_assert_eq!(outcome, Outcome::Complete);
    total = total.wrapping_add(sum(receiver, segments));
    blocked_fraction(scene.field.hides_center(receiver), total)
}

/// Sets receivers and IDs of a tile.
#[inline(always)]
fn set_receivers<T: Texel>(
    scene: &Scene<'_, T>,
    scratch: &mut Scratch,
    [left, top]: [u32; 2],
    [width, height]: [usize; 2],
    counters: &mut Counters,
) {
    let Scratch { receivers, ids, .. } = scratch;
    let (camera, g) = (&scene.camera, &scene.geometry);
    let image = camera.map().width() as usize;
    for row in 0..height {
        let y = top + row as u32;
        let mut nearness = [0.0; TILE];
        let mut planes = [[0.0; TILE]; 4];
        let start = y as usize * image + left as usize;
        nearness[..width].copy_from_slice(&camera.map().nearness()[start..][..width]);
        for i in 0..width {
            if nearness[i] > 0.0 {
                counters.receivers += 1;
                let (id, plane) = surface_of(camera, g, left + i as u32, y, nearness[i]);
                ids[row * TILE + i] = id;
                for (lane, value) in planes.iter_mut().zip(plane) {
                    lane[i] = value;
                }
            }
        }
        let first = [left as f32 + 0.5, y as f32 + 0.5];
        receivers.set_row(g, row, first, &nearness, &planes);
        for i in row * TILE..row * TILE + width {
            let (u, v) = (receivers.u[i], receivers.v[i]);
            let inside = u >= 0.0
                && v >= 0.0
                && u < scene.field.width as f32
                && v < scene.field.height as f32;
            counters.outside += u32::from(!inside && receivers.sky[i] > 0.0);
        }
    }
}
