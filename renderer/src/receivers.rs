//! What a camera sees, receiver by receiver.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use shadowmap_core::{
    BandSlice, Camera, Level, LightPoint, Surfaces, Threads, View, Warp, for_each_band,
};

use crate::light_block::{BLOCK, PADDING, warped};

/// What happened in one call of [`visibility`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReceiverCounters {
    /// Pixels where the camera sees something.
    pub receivers: u64,
    /// Receivers outside the light's map. They count as lit.
    pub outside: u64,
}

/// Writes what `look(point, pixel)` says of every receiver that lies in the map of `light` and does
/// not face away from the light's centre. Receivers outside the map get 1; those that face away,
/// and pixels that see nothing, get 0.
///
/// Neighbouring pixels on one surface of a table share its plane, and so the slope of its nearness
/// in the light's image: it is computed once per run of such pixels along a row.
///
/// # Panics
///
/// If `out` is not of the camera's size.
pub fn visibility(
    camera: &Camera<'_>,
    light: &View,
    level: Level,
    threads: Threads,
    out: &mut [f32],
    look: impl Fn(&LightPoint, u32) -> f32 + Sync,
) -> ReceiverCounters {
    assert_eq!(out.len(), camera.map().nearness().len(), "one visibility per pixel");
    let width = camera.map().width() as usize;
    let (map_width, map_height) = (light.width() as f32, light.height() as f32);
    let warp = Warp::new(camera.view(), light);
    // Entries of a table are flat.
    let flat = matches!(camera.surfaces(), Surfaces::Table(_));
    let [receivers, outside] = [AtomicU64::new(0), AtomicU64::new(0)];
    for_each_band(threads, BandSlice { data: out, len: width.max(1) }, &|y, out| {
        let mut counters = ReceiverCounters::default();
        // The surface of the run, and its slope unless it faces away.
        let mut run = (None, None);
        let mut nearness = [0.0; BLOCK + PADDING];
        let mut seen = [nearness; 3];
        for (block, out) in out.data.chunks_mut(BLOCK).enumerate() {
            let first = y * width + block * BLOCK;
            out.fill(0.0);
            nearness[..out.len()]
                .copy_from_slice(&camera.map().nearness()[first..first + out.len()]);
            nearness[out.len()..].fill(0.0);
            if nearness.iter().all(|&n| n == 0.0) {
                continue;
            }
            let x = (block * BLOCK) as u32;
            warped(level, &warp, x, y as u32, &nearness, &mut seen);
            for (i, out) in out.iter_mut().enumerate() {
                let n = nearness[i];
                if n.is_nan() || n <= 0.0 {
                    run.0 = None;
                    continue;
                }
                counters.receivers += 1;
                let id = camera.map().ids().get(first + i).copied();
                if !flat || id.is_none() || run.0 != id {
                    let plane = camera.plane(x + i as u32, y as u32, n).1;
                    let sides = plane.side_of(camera.view().eye()) * plane.side_of(light.eye());
                    run = (id, (sides >= 0.0).then(|| plane.slope_in(light)));
                }
                let Some(slope) = run.1 else { continue };
                let (u, v) = (seen[0][i], seen[1][i]);
                // Written so that NaN falls outside.
                let inside = u >= 0.0 && v >= 0.0 && u < map_width && v < map_height;
                *out = if inside {
                    let point = LightPoint { u, v, nearness: seen[2][i], slope };
                    look(&point, (first + i) as u32)
                } else {
                    counters.outside += 1;
                    1.0
                };
            }
        }
        receivers.fetch_add(counters.receivers, Ordering::Relaxed);
        outside.fetch_add(counters.outside, Ordering::Relaxed);
    });
    ReceiverCounters { receivers: receivers.into_inner(), outside: outside.into_inner() }
}

/// World positions and geometric unit normals, turned towards the viewer, of all pixels; both 0
/// where nothing is seen.
///
/// # Panics
///
/// If a slice is not of the camera's size.
pub fn world(camera: &Camera<'_>, threads: Threads, positions: &mut [Vec3], normals: &mut [Vec3]) {
    let width = camera.map().width() as usize;
    assert_eq!(positions.len(), camera.map().nearness().len(), "one position per pixel");
    assert_eq!(normals.len(), positions.len(), "one normal per pixel");
    let bands = (
        BandSlice { data: positions, len: width.max(1) },
        BandSlice { data: normals, len: width.max(1) },
    );
    for_each_band(threads, bands, &|y, (positions, normals)| {
        let nearness = &camera.map().nearness()[y * width..][..positions.data.len()];
        for (x, &n) in nearness.iter().enumerate() {
            let (mut position, mut normal) = (Vec3::ZERO, Vec3::ZERO);
            if n > 0.0 {
                let plane = camera.plane(x as u32, y as u32, n).1;
                let [a, b, c, _] = plane.0;
                normal = Vec3::new(a, b, c).normalize_or_zero();
                if plane.side_of(camera.view().eye()) < 0.0 {
                    normal = -normal;
                }
                position = camera.view().world_from_texel(x as f32 + 0.5, y as f32 + 0.5, n);
            }
            positions.data[x] = position;
            normals.data[x] = normal;
        }
    });
}
