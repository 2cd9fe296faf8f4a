//! The volume that all rays of a receiver to a light run through.

use glam::DVec3;

use crate::mask::Bounds;
use crate::sampling::LightRays;

/// More than double precision loses in a shaft's planes, relative to all that goes into them.
const SLACK: f64 = 1e-13;

/// A pyramid from a receiver around all of its rays to a light. It is cut off where the rays end
/// only by the box around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shaft {
    eye: DVec3,
    /// Inward normals of four planes through the eye; zero where a side is not bounded.
    planes: [DVec3; 4],
    slack: [f64; 4],
    /// The box around the shaft, relative to the eye.
    low: DVec3,
    high: DVec3,
}

impl Shaft {
    /// Around the rays from `eye` to a light of such bounds, in a scene with coordinates up to
    /// `extent`.
    pub fn new(eye: DVec3, rays: &LightRays, bounds: &Bounds, extent: f64) -> Shaft {
        let middle = rays.to(bounds.center);
        let corners = bounds.corners().map(|point| rays.to(point));
        let [a, b, c, d] = corners;
        let sides = if a == c {
            // A single ray: two planes hold it, from both sides.
            let n = middle.any_orthogonal_vector();
            let m = middle.cross(n);
            [(n, middle), (-n, middle), (m, middle), (-m, middle)]
                .map(|(n, m)| (n, n.length() * m.length()))
        } else if a == d || a == b {
            // A fan of rays in one plane: held from both sides, and closed at both ends.
            let across = a.cross(c);
            let size = a.length() * c.length();
            let [first, last] = [across.cross(a), c.cross(across)];
            [(across, size), (-across, size), (first, size * a.length()), (last, size * c.length())]
        } else {
            [(a, b), (b, c), (c, d), (d, a)].map(|(p, q)| {
                let n = p.cross(q);
                (if n.dot(middle) < 0.0 { -n } else { n }, p.length() * q.length())
            })
        };
        let scale = extent.max(eye.abs().max_element());
        let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
        for corner in corners {
            // A ray without an end goes as far as there is anything.
            let end = if rays.w > 0.0 { corner } else { corner.signum() * 3.0 * scale };
            let end = DVec3::select(corner.cmpeq(DVec3::ZERO), DVec3::ZERO, end);
            low = low.min(end);
            high = high.max(end);
        }
        let margin = DVec3::splat(SLACK * scale);
        Shaft {
            eye,
            planes: sides.map(|(n, _)| n),
            slack: sides.map(|(_, size)| SLACK * scale * size),
            low: low - margin,
            high: high + margin,
        }
    }

    /// Where the rays start.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// False if the box from `low` to `high`, relative to the eye, is surely outside.
    pub fn meets(&self, low: DVec3, high: DVec3) -> bool {
        if low.cmpgt(self.high).any() || high.cmplt(self.low).any() {
            return false;
        }
        let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let meets = |(n, slack): (&DVec3, f64)| n.dot(center) + n.abs().dot(half) >= -slack;
        self.planes.iter().zip(self.slack).all(meets)
    }
}
