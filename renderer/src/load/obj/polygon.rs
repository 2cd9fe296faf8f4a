//! Polygons to triangles, by cutting off ears.
//!
//! A corner is an ear when the triangle of it and its neighbours lies inside the polygon: it is
//! convex, and no reflex corner of the rest is in the triangle. Cutting ears off one by one takes
//! a polygon of n corners to n - 2 triangles (Meisters 1975, "Polygons have ears"). Rings made
//! of one outline with a slit, where corners coincide, come out right too.

use glam::{DVec2, DVec3};

use super::super::error::Fault;

/// Tests of points against triangles that all polygons of a file may take together: about a
/// second. Cutting a polygon of n corners takes up to n^2.
const MOST_WORK: u64 = 1 << 28;

/// Cuts polygons into triangles.
#[derive(Default)]
pub(super) struct Triangulator {
    points: Vec<DVec2>,
    previous: Vec<usize>,
    next: Vec<usize>,
    is_ear: Vec<bool>,
    work: u64,
}

impl Triangulator {
    /// Appends the triangles of a polygon of at least 3 corners, `corners.len() - 2` of them, as
    /// indices of corners. Keeps the winding. A polygon that is not plane is cut as it looks
    /// along its normal; one that crosses itself is cut somehow.
    ///
    /// # Errors
    ///
    /// When the polygons of the file have too many corners.
    pub(super) fn cut(
        &mut self,
        corners: &[DVec3],
        triangles: &mut Vec<[usize; 3]>,
    ) -> Result<(), Fault> {
        let n = corners.len();
        self.project(corners);
        let fan = (1..n - 1).map(|i| [0, i, i + 1]);
        // Without area, or with coordinates that are not finite, any cut will do.
        if !fan.clone().any(|[a, b, c]| self.area(a, b, c) < 0.0) {
            triangles.extend(fan);
            return Ok(());
        }
        self.previous.clear();
        self.previous.extend((0..n).map(|i| (i + n - 1) % n));
        self.next.clear();
        self.next.extend((0..n).map(|i| (i + 1) % n));
        self.is_ear.clear();
        self.is_ear.resize(n, false);
        let mut at = 0;
        self.find_ears(at)?;
        for _ in 2..n {
            let ear = self.next_ear(at)?;
            let (a, c) = (self.previous[ear], self.next[ear]);
            triangles.push([a, ear, c]);
            self.next[a] = c;
            self.previous[c] = a;
            self.is_ear[a] = self.test_ear(a)?;
            self.is_ear[c] = self.test_ear(c)?;
            // Going on past the next corner avoids a fan of slivers.
            at = self.next[c];
        }
        Ok(())
    }

    /// Drops the coordinate along which the polygon is largest seen, so that it turns left.
    fn project(&mut self, corners: &[DVec3]) {
        let following = corners.iter().cycle().skip(1);
        // Newell's normal.
        let normal: DVec3 = corners.iter().zip(following).map(|(a, b)| a.cross(*b)).sum();
        let [x, y, z] = normal.abs().to_array();
        self.points.clear();
        self.points.extend(corners.iter().map(|p| {
            if x >= y && x >= z {
                DVec2::new(p.y * normal.x.signum(), p.z)
            } else if y >= z {
                DVec2::new(p.z * normal.y.signum(), p.x)
            } else {
                DVec2::new(p.x * normal.z.signum(), p.y)
            }
        }));
    }

    /// Twice the area of a triangle, positive when it turns left.
    fn area(&self, a: usize, b: usize, c: usize) -> f64 {
        let [a, b, c] = [a, b, c].map(|i| self.points[i]);
        (b - a).perp_dot(c - a)
    }

    /// Tests every corner of what is left of the polygon.
    fn find_ears(&mut self, start: usize) -> Result<(), Fault> {
        let mut at = start;
        loop {
            self.is_ear[at] = self.test_ear(at)?;
            at = self.next[at];
            if at == start {
                return Ok(());
            }
        }
    }

    /// The first ear from `start` on. Where rounding, coinciding corners or crossing edges have
    /// left none: the first corner of no area, else the first convex one, else any.
    fn next_ear(&mut self, start: usize) -> Result<usize, Fault> {
        if let Some(ear) = self.first(start, |s, i| s.is_ear[i])? {
            return Ok(ear);
        }
        self.find_ears(start)?;
        let turn = |s: &Self, i: usize| s.area(s.previous[i], i, s.next[i]);
        if let Some(ear) = self.first(start, |s, i| s.is_ear[i])? {
            return Ok(ear);
        }
        if let Some(flat) = self.first(start, |s, i| turn(s, i) == 0.0)? {
            return Ok(flat);
        }
        Ok(self.first(start, |s, i| turn(s, i) > 0.0)?.unwrap_or(start))
    }

    fn first(
        &mut self,
        start: usize,
        wanted: impl Fn(&Self, usize) -> bool,
    ) -> Result<Option<usize>, Fault> {
        let mut at = start;
        loop {
            if wanted(self, at) {
                return Ok(Some(at));
            }
            self.spend()?;
            at = self.next[at];
            if at == start {
                return Ok(None);
            }
        }
    }

    fn test_ear(&mut self, b: usize) -> Result<bool, Fault> {
        let (a, c) = (self.previous[b], self.next[b]);
        if self.area(a, b, c) <= 0.0 {
            return Ok(false);
        }
        let mut at = self.next[c];
        while at != a {
            self.spend()?;
            let p = self.points[at];
            let apart = [a, b, c].iter().all(|&i| self.points[i] != p);
            let inside = || {
                let sides = [(a, b), (b, c), (c, a)];
                sides.iter().all(|&(from, to)| self.area(from, to, at) >= 0.0)
            };
            let is_reflex = || self.area(self.previous[at], at, self.next[at]) <= 0.0;
            if apart && inside() && is_reflex() {
                return Ok(false);
            }
            at = self.next[at];
        }
        Ok(true)
    }

    fn spend(&mut self) -> Result<(), Fault> {
        self.work += 1;
        if self.work > MOST_WORK {
            let text = "the faces have too many corners to cut them into triangles";
            return Err(Fault::TooLarge(text.into()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cuts, checks that the triangles tile the polygon, and returns their number.
    fn cut(corners: &[DVec3]) -> usize {
        let mut triangulator = Triangulator::default();
        let mut triangles = Vec::new();
        triangulator.cut(corners, &mut triangles).unwrap();
        let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a);
        let whole: DVec3 =
            (1..corners.len() - 1).map(|i| area(corners[0], corners[i], corners[i + 1])).sum();
        let normal = whole.normalize();
        for t in &triangles {
            let [a, b, c] = t.map(|i| corners[i]);
            let signed = area(a, b, c).dot(normal);
            assert!(signed >= -1e-9 * whole.length(), "{t:?} is turned: {signed}");
        }
        let sum: f64 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| corners[i]);
                area(a, b, c).length()
            })
            .sum();
        assert!((sum - whole.length()).abs() < 1e-9 * whole.length(), "{sum} {}", whole.length());
        triangles.len()
    }

    fn plane(points: &[[f64; 2]]) -> Vec<DVec3> {
        let (u, v) = (DVec3::new(0.6, 0.48, 0.64), DVec3::new(-0.8, 0.36, 0.48));
        points.iter().map(|p| u * p[0] + v * p[1] + DVec3::new(1.0, 2.0, 3.0)).collect()
    }

    #[test]
    fn convex_concave_and_collinear() {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]];
        let arrow = [[0., 0.], [2., 1.], [0., 2.], [0.5, 1.]];
        let l = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let collinear = [[0., 0.], [1., 0.], [2., 0.], [2., 2.], [1., 0.5], [0., 2.], [0., 1.]];
        let comb = [[0., 0.], [4., 0.], [4., 3.], [3., 1.], [2., 3.], [1., 1.], [0., 3.]];
        for polygon in [&square[..], &arrow, &l, &collinear, &comb] {
            for start in 0..polygon.len() {
                let mut turned = plane(polygon);
                turned.rotate_left(start);
                assert_eq!(cut(&turned), polygon.len() - 2);
                turned.reverse();
                assert_eq!(cut(&turned), polygon.len() - 2);
            }
        }
    }

    /// A ring as one outline: around the outside, through the slit, back around the inside.
    #[test]
    fn rings_with_a_slit() {
        for n in 3..40 {
            for inner in [0.2, 0.6, 0.95] {
                let at = |i: usize, radius: f64| {
                    let angle = i as f64 / n as f64 * std::f64::consts::TAU;
                    let wobble = 1.0 + 0.04 * (7.0 * angle).sin() * f64::from(n > 8);
                    [radius * wobble * angle.cos(), radius * wobble * angle.sin()]
                };
                let inner = if n < 8 { inner * 0.4 } else { inner };
                let mut ring: Vec<_> = (0..=n).map(|i| at(i % n, 1.0)).collect();
                ring.extend((0..=n).rev().map(|i| at(i % n, inner)));
                for start in [0, 1, n, n + 1, 2 * n] {
                    let mut turned = plane(&ring);
                    turned.rotate_left(start);
                    assert_eq!(cut(&turned), 2 * n);
                }
            }
        }
    }

    #[test]
    fn stars_and_spirals() {
        let star = |i: usize| {
            let angle = i as f64 * std::f64::consts::TAU / 50.0;
            let radius = if i.is_multiple_of(2) { 1.0 } else { 0.3 };
            [radius * angle.cos(), radius * angle.sin()]
        };
        assert_eq!(cut(&plane(&(0..50).map(star).collect::<Vec<_>>())), 48);
        let arm = |i: usize, width: f64| {
            let angle = i as f64 * 0.3;
            [(angle * 0.2 + width) * angle.cos(), (angle * 0.2 + width) * angle.sin()]
        };
        let mut spiral: Vec<_> = (1..150).map(|i| arm(i, 0.5)).collect();
        spiral.extend((1..150).rev().map(|i| arm(i, 0.0)));
        assert_eq!(cut(&plane(&spiral)), 296);
    }

    #[test]
    fn anything_ends_with_two_triangles_less_than_corners() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let special = [0.0, 1.0, f64::NAN, f64::INFINITY, 1e300, -1e300];
        for round in 0..3000 {
            let n = 3 + round % 30;
            let corner = |random: &mut dyn FnMut() -> f64| match round % 3 {
                0 => random(),
                1 => (random() * 3.0).floor(),
                _ => special[(random() * 6.0) as usize],
            };
            let corners: Vec<_> = (0..n)
                .map(|_| DVec3::new(corner(&mut random), corner(&mut random), corner(&mut random)))
                .collect();
            let mut triangles = Vec::new();
            Triangulator::default().cut(&corners, &mut triangles).unwrap();
            assert_eq!(triangles.len(), n - 2);
            assert!(triangles.iter().flatten().all(|&i| i < n));
        }
    }

    #[test]
    fn endless_work_is_refused() {
        // A saw tooth of which every test looks at every corner.
        let saw = |i: usize| DVec3::new(i as f64, (i % 2) as f64, 0.0);
        let mut corners: Vec<_> = (0..60_000).map(saw).collect();
        corners.push(DVec3::new(30_000.0, -1e9, 0.0));
        let result = Triangulator::default().cut(&corners, &mut Vec::new());
        assert!(matches!(result, Err(Fault::TooLarge(_))));
    }
}
