//! A triangle as a receiver sees it: the cone of directions that it blocks.

use glam::DVec3;

/// The directions that a triangle covers, seen from the origin.
///
/// A direction lies in the cone when it is on the inner side of three planes, each through
/// the origin and one edge. Two triangles that share an edge have the same plane there with
/// the opposite sign, to the bit, so that no ray slips between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// Inward normals of the planes opposite to each corner.
    pub planes: [DVec3; 3],
    /// Six times the volume of the tetrahedron of triangle and origin, positive.
    pub volume: f64,
}

impl Cone {
    /// The cone of a triangle with corners relative to the eye. `None` if it is seen edge-on, has
    /// no area, or has a corner that is not finite.
    pub fn new([a, b, c]: [DVec3; 3]) -> Option<Cone> {
        let [n, m, k] = [b.cross(c), c.cross(a), a.cross(b)];
        let volume = a.dot(n);
        if volume > 0.0 {
            Some(Cone { planes: [n, m, k], volume })
        } else if volume < 0.0 {
            Some(Cone { planes: [-n, -m, -k], volume: -volume })
        } else {
            None
        }
    }

    /// The sum of the three normals: its dot product with a ray is `volume` where the ray's end
    /// lies on the triangle's plane, and more beyond.
    pub fn through(&self) -> DVec3 {
        (self.planes[0] + self.planes[1]) + self.planes[2]
    }

    /// Where the ray along `ray` meets the triangle: the parameter, at most 1 / `w`, and the
    /// weights of the three corners.
    pub fn hit(&self, ray: DVec3, w: f64) -> Option<[f64; 4]> {
        let [a, b, c] = self.planes.map(|n| n.dot(ray));
        let sum = (a + b) + c;
        let inside = a >= 0.0 && b >= 0.0 && c >= 0.0 && sum > 0.0 && sum >= self.volume * w;
        inside.then(|| [self.volume / sum, a / sum, b / sum, c / sum])
    }
}
