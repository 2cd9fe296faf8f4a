//! From a camera's pixel to a receiver in the light's texel space.

use shadowmap_core::{Camera, LightPoint, View, Warp};

/// One pixel's receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    /// Where it lies in the light's map; `None` behind the light.
    pub point: Option<LightPoint>,
    /// Object ID.
    pub id: u32,
    /// Whether the camera and the centre of the light are on different sides of the surface.
    pub turned_away: bool,
}

impl Receiver {
    /// The receiver of pixel (x, y) as the light's view sees it. `None` where the camera sees
    /// nothing.
    pub fn of(camera: &Camera<'_>, x: u32, y: u32, warp: &Warp, light: &View) -> Option<Receiver> {
        let nearness =
            camera.map().nearness()[y as usize * camera.map().width() as usize + x as usize];
        if nearness.is_nan() || nearness <= 0.0 {
            return None;
        }
        let (id, plane) = camera.plane(x, y, nearness);
        let point = warp.at(x as f32 + 0.5, y as f32 + 0.5, nearness).map(|seen| LightPoint {
            u: seen.x,
            v: seen.y,
            nearness: seen.z,
            slope: plane.slope_in(light),
        });
        let sides = plane.side_of(camera.view().eye()) * plane.side_of(light.eye());
        Some(Receiver { point, id, turned_away: sides < 0.0 })
    }
}
