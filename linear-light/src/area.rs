//! Lights with an area as a few linear lights.
//!
//! The paper draws a triangular light as three linear lights, one per edge (figure 8, right), which
//! leaves its inside dark. Here a polygon is cut into strips of equal height, and the line through
//! the middle of each strip stands for it, weighted with the strip's area. The visibility of the
//! polygon is the weighted mean of that of the lines: exact along them, and a midpoint rule across.
//!
//! The strips lie aslant to the polygon's edges. What is built is often built along the same
//! directions as its lights, and a blocker's edge, or a wall's horizon, that is parallel to the
//! lines would pass all of each at once: its penumbra would be a stair of as many steps as there
//! are lines.

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
/// assert_eq!(lines[0].a.y, 1.0);
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
    let direction = aslant(corners, longest, count);
    let place = |p: DVec3| (p - longest[0]).dot(direction);
    let across = farthest(corners, longest[0], direction).normalize_or_zero();
    let height = |p: DVec3| (p - longest[0]).dot(across);
    let (mut lowest, mut highest) = (0.0_f64, 0.0_f64);
    for corner in corners {
        let height = height(corner.as_dvec3());
        (lowest, highest) = (lowest.min(height), highest.max(height));
    }
    let mut lines = Vec::with_capacity(count);
    let mut total = 0.0;
    for strip in 0..count {
        let middle = lowest + (highest - lowest) * (strip as f64 + 0.5) / count as f64;
        // Where the edges cross the middle of the strip.
        let mut ends: Option<[DVec3; 2]> = None;
        for [p, q] in edges() {
            let (below, above) = (height(p), height(q));
            if (below <= middle) == (above <= middle) {
                continue;
            }
            let point = p + (q - p) * ((middle - below) / (above - below));
            let [a, b] = ends.unwrap_or([point; 2]);
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

/// The direction of `count` lines: that of the longest edge, turned so far that over that edge's
/// length a line climbs three of eight strips, or what whole ones that leaves of fewer: then each
/// height above the edge of a rectangle is met by as many lines. To the side where the other edges
/// are not.
fn aslant(corners: &[Vec3], longest: [DVec3; 2], count: usize) -> DVec3 {
    let base = longest[1] - longest[0];
    let along = base.normalize_or_zero();
    let highest = farthest(corners, longest[0], along);
    let climbed = count * 3 / 8;
    let rise = highest * (climbed as f64 / (count - climbed) as f64);
    let [up, down] = [base + rise, base - rise].map(DVec3::normalize_or_zero);
    let nearest_edge = |direction: DVec3| {
        let next = corners.iter().cycle().skip(1);
        let edges = corners.iter().zip(next);
        let edges = edges.map(|(p, q)| (q.as_dvec3() - p.as_dvec3()).normalize_or_zero());
        // Not those along the longest, which are as near on both sides.
        let others = edges.filter(|edge| edge.cross(along).length_squared() > 1e-6);
        others.fold(0.0, |most: f64, edge| most.max(edge.dot(direction).abs()))
    };
    if nearest_edge(down) < nearest_edge(up) { down } else { up }
}

/// From a line to the corner that is farthest from it.
fn farthest(corners: &[Vec3], origin: DVec3, direction: DVec3) -> DVec3 {
    let mut farthest = DVec3::ZERO;
    for corner in corners {
        let from = corner.as_dvec3() - origin;
        let away = from - direction * from.dot(direction);
        if away.length_squared() > farthest.length_squared() {
            farthest = away;
        }
    }
    farthest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The part of a light on the near side of a plane, by its lines.
    fn part_before(lines: &[WeightedLine], normal: Vec3, distance: f32) -> f32 {
        let part = |line: &WeightedLine| {
            let [a, b] = [line.a, line.b].map(|end| end.dot(normal) - distance);
            let [near, far] = [a.min(b), a.max(b)];
            if near >= 0.0 { 0.0 } else { (near / (near - far.max(0.0))).min(1.0) }
        };
        lines.iter().map(|line| line.weight * part(line)).sum()
    }

    #[test]
    fn an_edge_along_a_side_of_a_rectangle_hides_what_it_covers() {
        let [corner, u, v] = [Vec3::new(1.0, 2.0, 3.0), Vec3::Z, Vec3::X * 3.0];
        let light = Light::Rectangle { corner, edge_u: u, edge_v: v };
        for count in 3..=17 {
            let lines = lines(&light, count).unwrap();
            assert_eq!(lines.len(), count);
            for part in [0.0, 0.01, 0.2, 0.5, 0.77, 1.0] {
                for edge in [u, v] {
                    let distance = (corner + edge * part).dot(edge);
                    let hidden = part_before(&lines, edge, distance);
                    assert!((hidden - part).abs() < 1e-5, "{count} {edge}: {hidden}, not {part}");
                }
            }
        }
    }

    #[test]
    fn a_single_line_is_the_middle_along_the_longer_edge() {
        let [corner, u, v] = [Vec3::new(1.0, 2.0, 3.0), Vec3::Z, Vec3::X * 3.0];
        let light = Light::Rectangle { corner, edge_u: u, edge_v: v };
        let [line] = lines(&light, 1).unwrap()[..] else { panic!("one line") };
        let [left, right] = [line.a.x.min(line.b.x), line.a.x.max(line.b.x)];
        assert_eq!([left, right, line.a.y, line.b.y], [1.0, 4.0, 2.0, 2.0]);
        assert_eq!([line.a.z, line.b.z, line.weight], [3.5, 3.5, 1.0]);
    }

    #[test]
    fn the_lines_of_a_triangle_cover_it_and_turn_away_from_its_other_edges() {
        let v = Vec3::new;
        let [a, b, c] = [v(0.0, 0.0, 0.0), v(0.0, 2.0, 0.0), v(0.0, 0.0, 4.0)];
        let lines = lines(&Light::Triangle { a, b, c }, 8).unwrap();
        let (mut middle, slack) = (Vec3::ZERO, 1e-5);
        for line in &lines {
            for p in [line.a, line.b] {
                assert!(
                    p.x == 0.0 && p.y > -slack && p.z > -slack && p.y * 2.0 + p.z < 4.0 + slack
                );
            }
            let slope = (line.b.y - line.a.y) / (line.b.z - line.a.z);
            assert!((-2.0..-0.7).contains(&slope), "{slope} is no better than an edge's");
            middle += (line.a + line.b) * 0.5 * line.weight;
        }
        assert!(middle.distance((a + b + c) / 3.0) < 0.01, "{middle}");
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
