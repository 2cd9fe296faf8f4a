//! Pixels shared out among several views of one light.

use shadowmap_core::{BandSlice, Camera, Threads, View, Warp, for_each_band};

/// Copies the camera's nearness to `out` for the receivers that belong to view number `face` of a
/// light, and writes 0, nothing, for the others.
///
/// A receiver belongs to the view along whose axis it lies deepest; of equal ones the first.
///
/// # Panics
///
/// If `out` is not of the camera's size.
pub fn receivers_of(
    camera: &Camera<'_>,
    views: &[View],
    face: usize,
    threads: Threads,
    out: &mut [f32],
) {
    let nearness = camera.map().nearness();
    assert_eq!(out.len(), nearness.len(), "one nearness per pixel");
    let width = camera.map().width() as usize;
    // Depth along a view's axis, times a factor that all views of a light share.
    let depth = |view: &View| Warp::new(camera.view(), view).rows()[3];
    let mine = depth(&views[face]);
    let others: Vec<_> = views.iter().map(depth).collect();
    for_each_band(threads, BandSlice { data: out, len: width.max(1) }, &|y, out| {
        let row = &nearness[y * width..][..out.data.len()];
        for (x, (out, &n)) in out.data.iter_mut().zip(row).enumerate() {
            let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
            let at = |r: &[f32; 4]| ((r[0] * x + r[1] * y) + r[2] * n) + r[3];
            let depth = at(&mine);
            let deepest = others.iter().enumerate().all(|(i, other)| {
                let other = at(other);
                if i < face { depth > other } else { depth >= other }
            });
            *out = if deepest { n } else { 0.0 };
        }
    });
}
