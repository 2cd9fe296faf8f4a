//! Lights with an area as a few linear lights.
//!
//! The paper draws a triangular light as three linear lights, one per edge (figure 8, right), which
//! leaves its inside dark. Here a polygon is cut into strips of equal height, parallel to its
//! longest edge, and the line through the middle of each strip stands for it, weighted with the
//! strip's area. The visibility of the polygon is the weighted mean of that of the lines: exact
//! along them, and a midpoint rule across.

use alloc::vec::Vec;

use glam::{DVec3, Vec3};
use shadowmap_core::Light;

/// One of the linear lights that stand for a light with an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedLine {
    /// One end.
    pub a: Vec3,
    /// The other end.
    pub b: Vec3,
    /// Its part of the light's visibility. The weights of all lines add up to 1.
    pub weight: f32,
}

/// `count` (at least 1) lines for a triangle or a rectangle; a linear light is its own only line.
/// `None` for lights of other shapes.
///
/// ```
/// use glam::Vec3;
/// use linear_light::lines;
/// use shadowmap_core::Light;
/// let light = Light::Rectangle { corner: Vec3::Y, edge_u: Vec3::X * 2.0, edge_v: Vec3::Z };
/// let lines = lines(&light, 2).unwrap();
/// assert_eq!(lines.len(), 2);
/// assert_eq!(lines[0].weight, 0.5);
/// assert_eq!(lines[0].a.distance(lines[0].b), 2.0);
/// ```
#[must_use]
pub fn lines(light: &Light, count: usize) -> Option<Vec<WeightedLine>> {
    match *light {
        Light::Linear { a, b } => Some(alloc::vec![WeightedLine { a, b, weight: 1.0 }]),
        Light::Triangle { a, b, c } => Some(polygon_lines(&[a, b, c], count)),
        Light::Rectangle { corner, edge_u, edge_v } => {
            let corners = [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v];
            Some(polygon_lines(&corners, count))
        }
        _ => None,
    }
}

/// `count` (at least 1) lines for a flat convex polygon. One without area gets lines all along its
/// longest edge.
///
/// # Panics
///
/// If there are less than two corners.
#[must_use]
pub fn polygon_lines(corners: &[Vec3], count: usize) -> Vec<WeightedLine> {
    assert!(corners.len() >= 2, "a light needs two corners");
    let count = count.max(1);
    let edges = || {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(p, q)| [p.as_dvec3(), q.as_dvec3()])
    };
    let mut longest = [corners[0].as_dvec3(), corners[1].as_dvec3()];
    for [p, q] in edges() {
        if (q - p).length_squared() > (longest[1] - longest[0]).length_squared() {
            longest = [p, q];
        }
    }
    let along = (longest[1] - longest[0]).normalize_or_zero();
    let from_edge = |p: DVec3| (p - longest[0]) - along * (p - longest[0]).dot(along);
    let mut farthest = DVec3::ZERO;
    for corner in corners {
        let away = from_edge(corner.as_dvec3());
        if away.length_squared() > farthest.length_squared() {
            farthest = away;
        }
    }
    let height = farthest.length();
    let up = farthest.normalize_or_zero();
    let mut lines = Vec::with_capacity(count);
    let mut total = 0.0;
    for strip in 0..count {
        let middle = height * (strip as f64 + 0.5) / count as f64;
        // Where the edges cross the middle of the strip.
        let mut ends: Option<[DVec3; 2]> = None;
        for [p, q] in edges() {
            let (below, above) = (from_edge(p).dot(up), from_edge(q).dot(up));
            if (below <= middle) == (above <= middle) {
                continue;
            }
            let point = p + (q - p) * ((middle - below) / (above - below));
            let [a, b] = ends.unwrap_or([point; 2]);
            let place = |p: DVec3| p.dot(along);
            ends = Some([
                if place(point) < place(a) { point } else { a },
                if place(point) > place(b) { point } else { b },
            ]);
        }
        let [a, b] = ends.unwrap_or(longest);
        let length = (b - a).length();
        total += length;
        lines.push((a, b, length));
    }
    let weighted = |(a, b, length): (DVec3, DVec3, f64)| WeightedLine {
        a: a.as_vec3(),
        b: b.as_vec3(),
        weight: (if total > 0.0 && total.is_finite() { length / total } else { 1.0 / count as f64 })
            as f32,
    };
    lines.into_iter().map(weighted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vec3, b: Vec3) -> bool {
        a.distance(b) < 1e-6
    }

    #[test]
    fn a_rectangle_is_cut_along_its_longer_edge() {
        let v = Vec3::new;
        let light =
            Light::Rectangle { corner: v(1.0, 2.0, 3.0), edge_u: Vec3::Z, edge_v: Vec3::X * 3.0 };
        let lines = lines(&light, 4).unwrap();
        let mut depths: Vec<f32> = lines.iter().map(|line| line.a.z).collect();
        depths.sort_by(f32::total_cmp);
        assert_eq!(depths, [3.125, 3.375, 3.625, 3.875]);
        for line in lines {
            let [left, right] = [line.a.x.min(line.b.x), line.a.x.max(line.b.x)];
            assert_eq!([left, right, line.a.y, line.b.y], [1.0, 4.0, 2.0, 2.0]);
            assert!(line.a.z == line.b.z && line.weight == 0.25);
        }
    }

    #[test]
    fn the_strips_of_a_triangle_weigh_what_they_cover() {
        let v = Vec3::new;
        let light =
            Light::Triangle { a: v(0.0, 0.0, 0.0), b: v(0.0, 2.0, 1.0), c: v(0.0, 0.0, 4.0) };
        let lines = lines(&light, 2).unwrap();
        // The longest edge is a c; half way up, the triangle is a quarter and three quarters.
        assert!((lines[0].weight - 0.75).abs() < 1e-6 && (lines[1].weight - 0.25).abs() < 1e-6);
        let [first, last] = [lines[0], lines[1]];
        assert!([first.a, first.b].iter().any(|p| close(*p, v(0.0, 0.5, 0.25))), "{first:?}");
        assert!([first.a, first.b].iter().any(|p| close(*p, v(0.0, 0.5, 3.25))), "{first:?}");
        assert!((last.a.distance(last.b) - 1.0).abs() < 1e-6 && last.a.y == 1.5);
    }

    #[test]
    fn corners_that_are_not_finite_have_weights_all_the_same() {
        for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let lines = polygon_lines(&[Vec3::ZERO, Vec3::new(1.0, wrong, 0.0), Vec3::Z], 4);
            assert!(lines.iter().all(|line| line.weight == 0.25), "{wrong}: {lines:?}");
        }
    }

    #[test]
    fn weights_add_up_whatever_the_corners_are() {
        for corners in [
            [Vec3::ZERO; 3].as_slice(),
            &[Vec3::ZERO, Vec3::X],
            &[Vec3::NAN, Vec3::X, Vec3::Y],
            &[Vec3::ZERO, Vec3::X, Vec3::new(1.5, 1.0, 0.0), Vec3::Y * 2.0, -Vec3::X],
        ] {
            let lines = polygon_lines(corners, 5);
            assert_eq!(lines.len(), 5);
            let sum: f32 = lines.iter().map(|line| line.weight).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{corners:?}");
        }
    }
}
