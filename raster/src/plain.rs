//! The specification: what [`crate::Rasterizer`] must equal bit for bit.

use shadowmap_core::{Mesh, View};

use crate::clip::{Clipped, SetUp};
use crate::mask::Weights;
use crate::project::Projection;
use crate::{AlphaMask, DrawStats, Payload, Target};

/// Draws one map in the most obvious way: triangle by triangle, texel by texel, three integer edge
/// functions each. Slow, and kept for ever as the oracle of [`crate::Rasterizer`].
///
/// The target is cleared first: nearness 0 and payload 0 where there is nothing.
///
/// # Panics
///
/// If the target has another size than the view, or one beyond [`crate::MAX_SIZE`].
pub fn draw_plain(
    view: &View,
    mesh: &Mesh<'_>,
    mask: Option<&AlphaMask<'_>>,
    payload: Payload,
    target: Target<'_>,
) -> DrawStats {
    target.check(view);
    let Target { width, height, nearness, payload: payloads } = target;
    nearness.fill(0.0);
    payloads.fill(0);
    let projection = Projection::of(view);
    let mut stats = DrawStats::default();
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        let Some(vertices) = vertices(&projection, mesh, *triangle) else {
            stats.invalid += 1;
            continue;
        };
        let set_up = match SetUp::of(&projection, vertices) {
            Clipped::Whole(set_up) => set_up,
            Clipped::Cut(set_up) => {
                stats.clipped += 1;
                set_up
            }
            Clipped::Gone => {
                stats.clipped += 1;
                continue;
            }
            Clipped::Invalid => {
                stats.invalid += 1;
                continue;
            }
        };
        let mine = payload.of(index, mesh.ids);
        let mask = mask.filter(|mask| mask.is_masked(index)).map(|m| (m, Weights::of(vertices)));
        let mut in_bounds = false;
        for piece in set_up.triangles() {
            in_bounds |= piece.bounds(width, height).is_some();
            piece.for_each_texel(width, height, |x, y| {
                if let Some((mask, weights)) = &mask {
                    let [b1, b2] = weights.at(x, y);
                    if !(mask.keep)(index, b1, b2) {
                        return;
                    }
                }
                let near = set_up.plane.at(x, y);
                let texel = y as usize * width as usize + x as usize;
                if is_nearer(near, mine, nearness[texel], payloads[texel]) {
                    nearness[texel] = near;
                    payloads[texel] = mine;
                }
            });
        }
        stats.drawn += usize::from(in_bounds);
    }
    stats
}

/// The homogeneous vertices of a triangle, `None` if an index is out of range.
pub(crate) fn vertices(
    projection: &Projection,
    mesh: &Mesh<'_>,
    triangle: [u32; 3],
) -> Option<[[f32; 4]; 3]> {
    let vertex = |i: u32| mesh.positions.get(i as usize).map(|&p| projection.homogeneous(p));
    let [a, b, c] = triangle;
    Some([vertex(a)?, vertex(b)?, vertex(c)?])
}

/// Greater nearness wins, equal nearness goes to the smaller payload: a total order, so that the
/// order of drawing never shows.
#[inline(always)]
pub(crate) fn is_nearer(near: f32, payload: u32, old_near: f32, old_payload: u32) -> bool {
    near > old_near || (near == old_near && payload < old_payload)
}
