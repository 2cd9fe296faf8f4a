//! What a camera sees, receiver by receiver.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use shadowmap_core::{BandSlice, Camera, LightPoint, Surfaces, Threads, View, Warp, for_each_band};

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
        let row = y * width..(y + 1) * width;
        let nearness = &camera.map().nearness()[row.clone()];
        let ids = camera.map().ids().get(row).unwrap_or_default();
        let mut counters = ReceiverCounters::default();
        // The surface of the run, and its slope unless it faces away.
        let mut run = (None, None);
        for (x, out) in out.data.iter_mut().enumerate() {
            *out = 0.0;
            let n = nearness[x];
            if n.is_nan() || n <= 0.0 {
                run.0 = None;
                continue;
            }
            counters.receivers += 1;
            let id = ids.get(x).copied();
            if !flat || id.is_none() || run.0 != id {
                let plane = camera.plane(x as u32, y as u32, n).1;
                let sides = plane.side_of(camera.view().eye()) * plane.side_of(light.eye());
                run = (id, (sides >= 0.0).then(|| plane.slope_in(light)));
            }
            let Some(slope) = run.1 else { continue };
            let seen = warp.at(x as f32 + 0.5, y as f32 + 0.5, n);
            let inside = seen.filter(|seen| {
                seen.x >= 0.0 && seen.y >= 0.0 && seen.x < map_width && seen.y < map_height
            });
            *out = match inside {
                Some(seen) => {
                    let point = LightPoint { u: seen.x, v: seen.y, nearness: seen.z, slope };
                    look(&point, (y * width + x) as u32)
                }
                None => {
                    counters.outside += 1;
                    1.0
                }
            };
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
