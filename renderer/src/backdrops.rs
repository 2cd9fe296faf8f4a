//! Planes that everything else lies in front of.

use glam::{DVec3, Vec3};
use shadowmap_core::Light;

use crate::hull::points_around;
use crate::prepared::corners;
use crate::scene::Scene;

/// How many of the largest triangles are tried as backdrops: as many as there are bits, less one.
const CANDIDATES: usize = 63;

/// The bit of triangles that have no place; always set among those that [`Backdrops::lit_by`]
/// tells.
const NOWHERE: u64 = 1 << CANDIDATES;

/// How far a point may lie behind a backdrop, of the scene's extent: what rounding leaves.
const TOLERANCE: f64 = 1e-5;

/// The backdrops of a scene, and which triangles lie on them.
#[derive(Clone, Debug)]
pub struct Backdrops {
    planes: Vec<Backdrop>,
    of_triangles: Vec<u64>,
}

impl Backdrops {
    /// Those of a scene.
    #[must_use]
    pub fn new(scene: &Scene) -> Backdrops {
        let planes = Backdrop::find(scene);
        let of_triangle = |&triangle: &[u32; 3]| match placed(scene, triangle) {
            Some(corners) => bits(&planes, |plane| plane.holds(&corners)),
            None => NOWHERE,
        };
        let of_triangles = scene.mesh.triangles.iter().map(of_triangle).collect();
        Backdrops { planes, of_triangles }
    }

    /// One bit for each backdrop that the whole light is in front of. A triangle that has one of
    /// these bits can hide the light from nothing.
    #[must_use]
    pub fn lit_by(&self, light: &Light) -> u64 {
        bits(&self.planes, |plane| plane.is_lit_by(light)) | NOWHERE
    }

    /// One bit for each backdrop that a triangle lies on, for each triangle.
    #[must_use]
    pub fn of_triangles(&self) -> &[u64] {
        &self.of_triangles
    }
}

fn bits(planes: &[Backdrop], is_set: impl Fn(&Backdrop) -> bool) -> u64 {
    let planes = planes.iter().enumerate();
    planes.fold(0, |bits, (i, plane)| bits | u64::from(is_set(plane)) << i)
}

/// A plane with triangles on it and the whole scene on one side, such as the ground or a room's
/// wall: nothing lies behind it that it could hide from a light on that side.
#[derive(Clone, Copy, Debug)]
struct Backdrop {
    /// Towards the scene, of unit length.
    normal: DVec3,
    /// `normal . p` of its points.
    offset: f64,
    tolerance: f64,
}

impl Backdrop {
    /// The backdrops among the largest triangles of a scene.
    fn find(scene: &Scene) -> Vec<Backdrop> {
        let hull = points_around(triangles(scene).flatten().collect());
        let mut largest: Vec<(f64, [Vec3; 3])> =
            triangles(scene).map(|t| (doubled_area(&t).length(), t)).collect();
        largest.retain(|(area, _)| *area > 0.0);
        if largest.len() > CANDIDATES {
            largest.select_nth_unstable_by(CANDIDATES, |a, b| b.0.total_cmp(&a.0));
            largest.truncate(CANDIDATES);
        }
        let extent = scene.bounds().map_or(0.0, |bounds| bounds.extent().max_element());
        let tolerance = TOLERANCE * f64::from(extent);
        let mut found: Vec<Backdrop> = Vec::new();
        for (area, triangle) in largest {
            let normal = doubled_area(&triangle) / area;
            let offset = normal.dot(triangle[0].as_dvec3());
            if found.iter().any(|backdrop| backdrop.holds(&triangle)) {
                continue;
            }
            let front = Backdrop { normal, offset, tolerance };
            let back = Backdrop { normal: -normal, offset: -offset, tolerance };
            let holds_scene =
                |side: &Backdrop| hull.iter().all(|p| side.height(p.as_dvec3()) >= -tolerance);
            found.extend([front, back].into_iter().find(holds_scene));
        }
        found
    }

    fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }

    /// Whether a triangle lies on it.
    fn holds(&self, triangle: &[Vec3; 3]) -> bool {
        triangle.iter().all(|p| self.height(p.as_dvec3()).abs() <= self.tolerance)
    }

    /// Whether all of the light is on the scene's side.
    fn is_lit_by(&self, light: &Light) -> bool {
        let above = |p: Vec3| self.height(p.as_dvec3()) > self.tolerance;
        match *light {
            Light::Point { position } => above(position),
            Light::Sphere { center, radius } => {
                self.height(center.as_dvec3()) > self.tolerance + f64::from(radius.abs())
            }
            Light::Sun { direction, angle } => {
                let rise = -self.normal.dot(direction.as_dvec3().normalize_or_zero());
                rise > libm::sin(f64::from(angle).abs() * 0.5) + TOLERANCE
            }
            Light::Linear { a, b } => above(a) && above(b),
            Light::Triangle { a, b, c } => above(a) && above(b) && above(c),
            Light::Rectangle { corner, edge_u, edge_v } => {
                let far = corner + edge_u;
                [corner, far, corner + edge_v, far + edge_v].into_iter().all(above)
            }
            _ => false,
        }
    }
}

/// The normal of a triangle, as long as twice its area.
fn doubled_area(triangle: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    (b - a).cross(c - a)
}

/// The corners of a triangle, if all have a place.
fn placed(scene: &Scene, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
    corners(scene, triangle).filter(|corners| corners.iter().all(|p| p.is_finite()))
}

/// The triangles that have a place.
fn triangles(scene: &Scene) -> impl Iterator<Item = [Vec3; 3]> {
    scene.mesh.triangles.iter().filter_map(|&triangle| placed(scene, triangle))
}
