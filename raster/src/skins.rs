//! Skins to visibility (Heidrich, Brabec and Seidel 2000, section 3.2).

use shadowmap_core::MapError;

use crate::clip::{Clipped, SetUp};
use crate::plane::Plane;
use crate::project::Projection;

/// A vertex of a skin, already in the texel space of the map that it is drawn into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinVertex {
    /// Texel coordinate along a row.
    pub u: f32,
    /// Texel coordinate down the map.
    pub v: f32,
    /// Nearness in the destination view.
    pub nearness: f32,
    /// The fraction of the light that is seen here, in \[0, 1\]: 0 at a blocker's edge, 1 on the
    /// receiver.
    pub visibility: f32,
}

/// Draws the triangles of skins into a visibility channel.
///
/// Nearness and visibility are interpolated *affinely* in the destination image: exact where light
/// and receiver are parallel, where perspective-correct interpolation is not. A texel takes the
/// visibility of the nearest skin; of equally near ones the smaller visibility, so that order does
/// not matter. Coverage follows the same rules as that of meshes.
///
/// **Nothing is cleared.** `nearness` is the depth buffer, greater is nearer: start from zeros to
/// keep all skins, or from a copy of the destination's depth map (with the caller's bias) to hide
/// skins that lie behind it. A skin of negative nearness counts as behind the far plane. A skin
/// with a value that is not finite is not drawn.
///
/// # Errors
///
/// If a slice has another length than the size says.
///
/// # Panics
///
/// If `width` or `height` exceed [`crate::MAX_SIZE`].
pub fn draw_skins(
    skins: &[[SkinVertex; 3]],
    width: u32,
    height: u32,
    nearness: &mut [f32],
    visibility: &mut [f32],
) -> Result<(), MapError> {
    MapError::check(width, height, "nearness", nearness.len())?;
    MapError::check(width, height, "visibility", visibility.len())?;
    assert!(width <= crate::MAX_SIZE && height <= crate::MAX_SIZE, "the map is too large");
    // Texel space is its own view: U = u, V = v, N = nearness, Q = 1, and nothing is too near.
    let projection = Projection { rows: [[0.0; 4]; 4], max_nearness: f32::MAX };
    for skin in skins {
        if !skin.iter().all(|s| s.visibility.is_finite()) {
            continue;
        }
        let vertices = skin.map(|s| [s.u, s.v, s.nearness, 1.0]);
        let (Clipped::Whole(set_up) | Clipped::Cut(set_up)) = SetUp::of(&projection, vertices)
        else {
            continue;
        };
        let plane = Plane::through(skin.map(|s| [s.u, s.v, s.visibility]));
        for piece in set_up.triangles() {
            piece.for_each_texel(width, height, |x, y| {
                let texel = y as usize * width as usize + x as usize;
                let (near, seen) = (set_up.plane.at(x, y), plane.at(x, y));
                let (old_near, old_seen) = (nearness[texel], visibility[texel]);
                if near > old_near || (near == old_near && seen < old_seen) {
                    nearness[texel] = near;
                    visibility[texel] = seen;
                }
            });
        }
    }
    Ok(())
}
