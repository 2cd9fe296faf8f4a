//! What all receivers of a call share.

use super::facing::contact;
use super::reach::Extent;
use crate::math::sqrt;
use shadowmap_core::{Bias, Projection, View, Warp};

/// Both views and the light's disc, as receivers need them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Geometry {
    /// Camera texel space to the light's homogeneous U, V, N, Q.
    pub warp: [[f32; 4]; 4],
    /// Camera texel space to homogeneous world space.
    pub world: [[f32; 4]; 4],
    /// The camera's and the light's centre of projection.
    pub camera_eye: [f32; 4],
    pub light_eye: [f32; 4],
    /// What a plane in the world is multiplied with to find its u, v and nearness components in
    /// the light's texel space.
    pub axes: [[f32; 4]; 3],
    /// Texel coordinates that the view axis passes through.
    pub center: [f32; 2],
    /// Tangents per texel; 0 for parallel light.
    pub tangent: [f32; 2],
    /// Whether the light has a place. If so, nearness is the inverse of depth.
    pub perspective: bool,
    /// What the map's nearness is multiplied with: 1, or the unit of a packed map.
    pub unit: f32,
    /// Radius of the light's disc: in metres, or a tangent for parallel light.
    pub radius: f32,
    /// Radius of the disc's image in texels per nearness of the map (on the view axis).
    pub spread: [f32; 2],
    /// How much nearer than a receiver blockers are at most that are close to it.
    pub contact: f32,
    pub bias: Bias,
}

impl Geometry {
    pub fn new(camera: &View, light: &View, radius: f32, unit: f32, bias: Bias) -> Geometry {
        let mut warp = *Warp::new(camera, light).rows();
        warp[2] = warp[2].map(|value| value * unit);
        let perspective = light.projection() == Projection::Perspective;
        let [_, _, forward] = light.axes();
        let [fx, fy] = light.focal().to_array();
        // A row U is focal * right + center * forward.
        let along = |row: [f32; 4]| (row[0] * forward.x + row[1] * forward.y) + row[2] * forward.z;
        let center = [along(light.rows()[0]), along(light.rows()[1])];
        let spread = [fx * radius / unit, fy * radius / unit];
        let column = |i: usize, scale: f32| light.inverse_rows().map(|row| row[i] * scale);
        Geometry {
            warp,
            world: *camera.inverse_rows(),
            camera_eye: camera.eye(),
            light_eye: light.eye(),
            axes: [column(0, 1.0), column(1, 1.0), column(2, 1.0 / unit)],
            center: if perspective { center } else { [0.0; 2] },
            tangent: if perspective { [1.0 / fx, 1.0 / fy] } else { [0.0; 2] },
            perspective,
            unit,
            radius,
            spread,
            contact: contact(spread),
            bias,
        }
    }

    /// How much the image of the disc is stretched along u and v at a receiver, for it faces the
    /// receiver and not the map: square roots of one plus squared tangents.
    pub fn stretch(&self, u: f32, v: f32) -> [f32; 2] {
        let tx = (u - self.center[0]) * self.tangent[0];
        let ty = (v - self.center[1]) * self.tangent[1];
        [sqrt(1.0 + tx * tx), sqrt(1.0 + ty * ty)]
    }

    /// The greatest stretch in any direction of any receiver.
    pub fn greatest_stretch(&self, extent: &Extent) -> f32 {
        let square = |[from, to]: [f32; 2], axis: usize| {
            let from = (from - self.center[axis]) * self.tangent[axis];
            let to = (to - self.center[axis]) * self.tangent[axis];
            (from * from).max(to * to)
        };
        sqrt(1.0 + (square(extent.u, 0) + square(extent.v, 1)))
    }
}
