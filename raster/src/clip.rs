//! Clipping in homogeneous texel space, and the set-up of one triangle.

use crate::coverage::Triangle;
use crate::plane::Plane;
use crate::project::{GUARD, Projection};

/// Three vertices and six planes make at most nine corners.
const MAX_CORNERS: usize = 9;
const PLANES: usize = 6;

/// A triangle ready to draw: what is left of it as a fan, and one plane equation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SetUp {
    corners: [[f32; 2]; MAX_CORNERS],
    count: usize,
    pub(crate) plane: Plane,
}

/// What [`SetUp::of`] made of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Clipped {
    /// It needed no clipping.
    Whole(SetUp),
    /// It was cut.
    Cut(SetUp),
    /// Nothing of it is left.
    Gone,
    /// It has a vertex that is not finite.
    Invalid,
}

impl SetUp {
    /// Sets up the triangle with these homogeneous vertices.
    pub(crate) fn of(projection: &Projection, vertices: [[f32; 4]; 3]) -> Clipped {
        let projected = vertices.map(|h| projection.project(h));
        if projected.iter().all(|&(_, inside)| inside) {
            let points = projected.map(|(seen, _)| seen);
            let mut corners = [[0.0; 2]; MAX_CORNERS];
            for (corner, [u, v, _]) in corners.iter_mut().zip(points) {
                *corner = [u, v];
            }
            return Clipped::Whole(SetUp { corners, count: 3, plane: Plane::through(points) });
        }
        let codes = vertices.map(|h| outcode(h, projection.max_nearness));
        if codes.iter().any(|code| code & INVALID != 0) {
            return Clipped::Invalid;
        }
        if codes[0] & codes[1] & codes[2] != 0 {
            return Clipped::Gone;
        }
        // A vertex keeps the place that its unclipped triangles give it, or there would be cracks.
        let corners = [0, 1, 2].map(|i| Corner {
            homogeneous: vertices[i].map(f64::from),
            seen: projected[i].1.then_some(projected[i].0),
        });
        match clip(corners, f64::from(projection.max_nearness)) {
            Some(polygon) => {
                let whole = corners.map(|corner| corner.homogeneous);
                Clipped::Cut(polygon.set_up(whole, projection.max_nearness))
            }
            None => Clipped::Gone,
        }
    }

    /// The triangles of the fan that have an area.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = Triangle> + '_ {
        (2..self.count)
            .filter_map(|i| Triangle::new([self.corners[0], self.corners[i - 1], self.corners[i]]))
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    homogeneous: [f64; 4],
    /// u, v and nearness, known for vertices that need no clipping.
    seen: Option<[f32; 3]>,
}

impl Corner {
    fn seen(&self, max_nearness: f32) -> [f32; 3] {
        let [u, v, n, q] = self.homogeneous;
        self.seen.unwrap_or_else(|| {
            // Rounding may leave a corner on the wrong side of the plane that made it.
            let bounded = |x: f64| (x as f32).clamp(-GUARD, GUARD);
            let nearness = ((n / q) as f32).min(max_nearness).clamp(0.0, f32::MAX);
            [bounded(u / q), bounded(v / q), nearness]
        })
    }
}

struct Polygon {
    corners: [Corner; MAX_CORNERS],
    count: usize,
}

/// The signed distance, up to a positive factor, to the near plane, the plane of nearness 0 and
/// the four sides of the guard band; inside is not negative.
fn distance(plane: usize, [u, v, n, q]: [f64; 4], max_nearness: f64) -> f64 {
    let guard = f64::from(GUARD);
    match plane {
        0 => max_nearness * q - n,
        1 => n,
        2 => guard * q + u,
        3 => guard * q - u,
        4 => guard * q + v,
        _ => guard * q - v,
    }
}

/// The outcode of a vertex that is not finite.
pub(crate) const INVALID: u32 = 1 << PLANES;

/// One bit for each plane that a vertex lies outside of, or [`INVALID`].
pub(crate) fn outcode(vertex: [f32; 4], max_nearness: f32) -> u32 {
    if !vertex.iter().all(|x| x.is_finite()) {
        return INVALID;
    }
    let (vertex, max_nearness) = (vertex.map(f64::from), f64::from(max_nearness));
    (0..PLANES).fold(0, |code, plane| {
        // A NaN, from a view without a near plane, is outside.
        let inside = distance(plane, vertex, max_nearness) >= 0.0;
        code | (u32::from(!inside) << plane)
    })
}

/// Sutherland and Hodgman 1974. An edge is always cut from its inner end, so that both triangles at
/// a shared edge get the same new vertex.
fn clip(corners: [Corner; 3], max_nearness: f64) -> Option<Polygon> {
    let mut polygon = Polygon { corners: [Corner::default(); MAX_CORNERS], count: 3 };
    polygon.corners[..3].copy_from_slice(&corners);
    for plane in 0..PLANES {
        let old = polygon.corners;
        let count = core::mem::take(&mut polygon.count);
        for i in 0..count {
            let (from, to) = (old[i], old[(i + 1) % count]);
            let from_distance = distance(plane, from.homogeneous, max_nearness);
            let to_distance = distance(plane, to.homogeneous, max_nearness);
            if from_distance >= 0.0 {
                polygon.push(from);
            }
            if (from_distance >= 0.0) != (to_distance >= 0.0) {
                polygon.push(if from_distance >= 0.0 {
                    cut(from, from_distance, to, to_distance)
                } else {
                    cut(to, to_distance, from, from_distance)
                });
            }
        }
    }
    let sound = polygon.count >= 3
        && polygon.corners().iter().all(|c| c.homogeneous.iter().all(|x| x.is_finite()));
    sound.then_some(polygon)
}

fn cut(inner: Corner, inner_distance: f64, outer: Corner, outer_distance: f64) -> Corner {
    let t = inner_distance / (inner_distance - outer_distance);
    let homogeneous = core::array::from_fn(|i| {
        inner.homogeneous[i] + (outer.homogeneous[i] - inner.homogeneous[i]) * t
    });
    Corner { homogeneous, seen: None }
}

impl Polygon {
    /// A convex polygon gains at most one corner per plane; rounding may make it a hair less than
    /// convex, and what would exceed the array is dropped.
    fn push(&mut self, corner: Corner) {
        if self.count < MAX_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[Corner] {
        &self.corners[..self.count]
    }

    /// The fan, with the plane of the whole triangle: `N = a U + b V + c Q` at its vertices.
    fn set_up(&self, [p0, p1, p2]: [[f64; 4]; 3], max_nearness: f32) -> SetUp {
        let mut corners = [[0.0; 2]; MAX_CORNERS];
        let (mut low, mut high) = (f32::INFINITY, 0.0_f32);
        for (corner, polygon) in corners.iter_mut().zip(self.corners()) {
            let [u, v, n] = polygon.seen(max_nearness);
            *corner = [u, v];
            (low, high) = (low.min(n), high.max(n));
        }
        let determinant = |i: usize, j: usize, k: usize| {
            (p0[i] * (p1[j] * p2[k] - p2[j] * p1[k]) - p1[i] * (p0[j] * p2[k] - p2[j] * p0[k]))
                + p2[i] * (p0[j] * p1[k] - p1[j] * p0[k])
        };
        let [u, v, n, q] = [0, 1, 2, 3];
        let scale = 1.0 / determinant(u, v, q);
        let plane = Plane {
            a: determinant(n, v, q) * scale,
            b: determinant(u, n, q) * scale,
            c: determinant(u, v, n) * scale,
            low,
            high,
        };
        SetUp { corners, count: self.count, plane: plane.or_flat() }
    }
}
