//! Lights, by shape.

use glam::Vec3;

/// The shape of a light. Its colour and brightness are the caller's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Light {
    /// A point: shadows have no penumbra.
    Point {
        /// Where it stands.
        position: Vec3,
    },
    /// A sphere, which a receiver sees as the disc through its centre that faces it.
    Sphere {
        /// Where it stands.
        center: Vec3,
        /// Radius of the sphere in metres.
        radius: f32,
    },
    /// A light at infinity, such as the sun.
    Sun {
        /// The way its light travels; need not be of unit length.
        direction: Vec3,
        /// Angular diameter in radians (the sun's is 0.0093, half a degree).
        angle: f32,
    },
    /// A line segment: a fluorescent tube.
    Linear {
        /// One end.
        a: Vec3,
        /// The other end.
        b: Vec3,
    },
    /// A triangle that shines to both sides.
    Triangle {
        /// First corner.
        a: Vec3,
        /// Second corner.
        b: Vec3,
        /// Third corner.
        c: Vec3,
    },
    /// A parallelogram that shines to both sides: `corner + s * edge_u + t * edge_v` for s, t in
    /// \[0, 1\].
    Rectangle {
        /// One corner.
        corner: Vec3,
        /// The edge from the corner to one neighbour.
        edge_u: Vec3,
        /// The edge from the corner to the other neighbour.
        edge_v: Vec3,
    },
}

impl Light {
    /// The middle of the light, `None` for a sun, which has no place.
    #[must_use]
    pub fn center(&self) -> Option<Vec3> {
        match *self {
            Light::Point { position } => Some(position),
            Light::Sphere { center, .. } => Some(center),
            Light::Sun { .. } => None,
            Light::Linear { a, b } => Some((a + b) * 0.5),
            Light::Triangle { a, b, c } => Some((a + b + c) * (1.0 / 3.0)),
            Light::Rectangle { corner, edge_u, edge_v } => Some(corner + (edge_u + edge_v) * 0.5),
        }
    }
}
