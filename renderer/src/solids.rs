//! Closed surfaces: from outside of one, its front faces hide all of its back faces.

mod faces;

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use raster::Payload;
use shadowmap_core::{Level, Mesh, View};

use crate::prepared::corners;
use crate::scene::{Bounds, Scene};

use faces::Faces;
pub use faces::Shown;

/// The closed surfaces of a scene, and which triangles they consist of.
///
/// A set of connected triangles is closed if each edge is passed through as often in one direction
/// as in the other. Whatever the shape, a line of sight that starts outside then enters it before
/// it leaves it: a triangle that faces away is never the nearest.
#[derive(Clone, Debug)]
pub struct Solids {
    solids: Vec<Solid>,
    /// All triangles; empty if there are no solids.
    faces: Faces,
}

/// A closed surface.
#[derive(Clone, Debug)]
struct Solid {
    bounds: Bounds,
    /// Its vertices, each once.
    positions: Vec<Vec3>,
}

impl Solid {
    /// Whether a view sees all of it but for what lies beside its window.
    fn is_in_front(&self, view: &View) -> bool {
        let is_in_front = |p: Vec3| {
            let [_, _, n, q] = view.homogeneous_texel(p);
            q > 0.0 && n < view.max_nearness() * q
        };
        let Bounds { min, max } = self.bounds;
        let pick = |corner: usize, axis: usize| [min, max][corner >> axis & 1][axis];
        let corner = |c: usize| Vec3::new(pick(c, 0), pick(c, 1), pick(c, 2));
        (0..8).map(corner).all(is_in_front) || self.positions.iter().copied().all(is_in_front)
    }
}

impl Solids {
    /// Those of a scene; triangles that are `masked` may have holes and close nothing.
    #[must_use]
    pub fn new(scene: &Scene, masked: &[bool]) -> Solids {
        let mut pieces = Pieces::of(scene);
        let mut shells: HashMap<u32, Shell> = HashMap::new();
        for (index, &triangle) in scene.mesh.triangles.iter().enumerate() {
            let Some(corners) = corners(scene, triangle) else { continue };
            let shell = shells.entry(pieces.root(triangle[0])).or_insert(Shell::new(corners[0]));
            shell.add(triangle.map(|vertex| pieces.welded[vertex as usize]), corners);
            shell.has_holes |= masked.get(index) == Some(&true);
        }
        let mut solids = Solids { solids: Vec::new(), faces: Faces::default() };
        let mut of_roots = HashMap::new();
        for (root, shell) in shells {
            if let Some(outwards) = shell.outwards() {
                of_roots.insert(root, (solids.solids.len() as u32, outwards));
                solids.solids.push(Solid { bounds: shell.bounds, positions: Vec::new() });
            }
        }
        if of_roots.is_empty() {
            return solids;
        }
        for &triangle in &scene.mesh.triangles {
            let face = corners(scene, triangle).and_then(|[a, b, c]| {
                let &(solid, outwards) = of_roots.get(&pieces.root(triangle[0]))?;
                let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
                let normal = (b - a).cross(c - a).try_normalize()? * outwards;
                Some((normal.extend(-normal.dot(a)).as_vec4(), solid))
            });
            let (plane, solid) = face.unwrap_or_default();
            solids.faces.push(plane, solid);
        }
        for (vertex, &position) in (0..).zip(&scene.mesh.positions) {
            let is_first = pieces.welded[vertex as usize] == vertex;
            if let Some(&(solid, _)) = of_roots.get(&pieces.root(vertex)).filter(|_| is_first) {
                solids.solids[solid as usize].positions.push(position);
            }
        }
        solids
    }

    /// Those triangles of `mesh`, the scene's, that can be the nearest in one of `views`, listed in
    /// `shown` with their `payload` as object ID; `None` if all can. If they are to `keep_places`,
    /// the others stay in the list and get indices that no vertex has.
    pub fn nearest<'t>(
        &self,
        level: Level,
        mesh: &Mesh<'t>,
        views: &[View],
        payload: Payload,
        keep_places: bool,
        shown: &'t mut Shown,
    ) -> Option<Mesh<'t>> {
        let outside = |solid: &Solid| views.iter().all(|view| solid.is_in_front(view));
        let outside: Vec<bool> = self.solids.iter().map(outside).collect();
        if !outside.contains(&true) {
            return None;
        }
        let eyes: Vec<[f32; 4]> = views.iter().map(View::eye).collect();
        Some(self.faces.shown(level, &outside, &eyes, mesh, payload, keep_places, shown))
    }
}

/// The vertices of a scene by place, and which of them triangles connect.
struct Pieces {
    /// The first vertex with the same position, for each vertex.
    welded: Vec<u32>,
    /// A vertex closer to the root of its piece, which is its own parent.
    parent: Vec<u32>,
}

impl Pieces {
    fn of(scene: &Scene) -> Pieces {
        let positions = &scene.mesh.positions;
        let mut first = HashMap::with_capacity(positions.len());
        // Adding 0 turns -0 into it.
        let place = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
        let welded: Vec<u32> =
            (0..).zip(positions).map(|(i, p)| *first.entry(place(p)).or_insert(i)).collect();
        let mut pieces = Pieces { parent: (0..positions.len() as u32).collect(), welded };
        for &triangle in &scene.mesh.triangles {
            if corners(scene, triangle).is_some() {
                let [a, b, c] = triangle.map(|vertex| pieces.root(vertex));
                let least = a.min(b).min(c);
                for root in [a, b, c] {
                    pieces.parent[root as usize] = least;
                }
            }
        }
        pieces
    }

    fn root(&mut self, vertex: u32) -> u32 {
        let mut at = self.welded[vertex as usize];
        while self.parent[at as usize] != at {
            let parent = self.parent[at as usize];
            // Halves the way for those who come later.
            self.parent[at as usize] = self.parent[parent as usize];
            at = parent;
        }
        at
    }
}

/// What tells whether connected triangles are closed, and which side of them is outside.
struct Shell {
    origin: DVec3,
    bounds: Bounds,
    /// The sum of a random number per edge, negative in one of its directions: 0 for a closed one,
    /// and by chance for one in 2^64 others.
    open: u64,
    has_holes: bool,
    /// Six times the volume, positive if counter-clockwise triangles face outwards.
    volume: f64,
}

impl Shell {
    fn new(corner: Vec3) -> Shell {
        Shell {
            origin: corner.as_dvec3(),
            bounds: Bounds { min: corner, max: corner },
            open: 0,
            has_holes: false,
            volume: 0.0,
        }
    }

    fn add(&mut self, [a, b, c]: [u32; 3], corners: [Vec3; 3]) {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let edge = random(u64::from(from.min(to)) << 32 | u64::from(from.max(to)));
            match from.cmp(&to) {
                std::cmp::Ordering::Less => self.open = self.open.wrapping_add(edge),
                std::cmp::Ordering::Equal => {}
                std::cmp::Ordering::Greater => self.open = self.open.wrapping_sub(edge),
            }
        }
        for corner in corners {
            self.bounds.min = self.bounds.min.min(corner);
            self.bounds.max = self.bounds.max.max(corner);
            self.has_holes |= !corner.is_finite();
        }
        let [a, b, c] = corners.map(|corner| corner.as_dvec3() - self.origin);
        self.volume += a.dot(b.cross(c));
    }

    /// 1 if the surface is closed and counter-clockwise triangles face outwards, -1 if they face
    /// inwards; `None` if it is open, or as flat as one that has two sides and nothing between.
    fn outwards(&self) -> Option<f64> {
        let extent = f64::from(self.bounds.extent().max_element());
        let is_flat = self.volume.abs() <= 1e-9 * extent.powi(3);
        (self.open == 0 && !self.has_holes && !is_flat).then(|| self.volume.signum())
    }
}

/// The bits of a number, mixed (SplitMix64's finalizer).
fn random(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::drawing::{Drawing, HIDDEN, Viewer};
    use crate::prepared::Prepared;
    use raster::{DepthBuffer, Rasterizer};
    use shadowmap_core::{Level, Threads};

    /// The unit cube around the origin, each side with its own corners.
    fn cube() -> Scene {
        let mut scene = Scene::default();
        for side in 0..6 {
            let (axis, sign) = (side / 2, [-1.0, 1.0][side % 2]);
            let corner = |u: f32, v: f32| {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (0.5 * sign, u * sign, v);
                Vec3::from(p)
            };
            let corners =
                [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
            scene.add_object("side", 0, &corners, &[[0, 1, 2], [0, 2, 3]]);
        }
        scene
    }

    fn seen_from(eye: Vec3, near: f32) -> View {
        View::perspective(eye, Vec3::ZERO, Vec3::new(0.1, 1.0, 0.2), 1.5, 64, 64, near)
    }

    /// How many triangles can be the nearest from there.
    fn count(scene: &Scene, masked: &[bool], views: &[View]) -> usize {
        let (solids, mut shown) = (Solids::new(scene, masked), Shown::default());
        let mesh = scene.mesh.as_mesh();
        let [in_place, listed] = [true, false].map(|keep_places| {
            let (level, payload) = (Level::detect(), Payload::ObjectId);
            let found = solids.nearest(level, &mesh, views, payload, keep_places, &mut shown);
            let found = found.unwrap_or(mesh);
            assert_eq!(found.triangles.len(), found.ids.len());
            found.triangles.iter().filter(|&&triangle| triangle != HIDDEN).count()
        });
        assert_eq!(in_place, listed);
        listed
    }

    #[test]
    fn a_closed_surface_seen_from_outside_shows_its_front() {
        let (corner, front) = (Vec3::new(2.0, 2.0, 3.0), Vec3::new(0.0, 0.0, 3.0));
        let whole = cube();
        assert_eq!(count(&whole, &[], &[seen_from(corner, 0.1)]), 6);
        assert_eq!(count(&whole, &[], &[seen_from(front, 0.1)]), 2);
        // From either of two places.
        assert_eq!(count(&whole, &[], &[seen_from(front, 0.1), seen_from(corner, 0.1)]), 6);
        // Inside out.
        let mut turned = cube();
        turned.mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        assert_eq!(count(&turned, &[], &[seen_from(corner, 0.1)]), 6);
    }

    #[test]
    fn what_is_open_or_looked_into_is_drawn_whole() {
        let view = seen_from(Vec3::new(2.0, 2.0, 3.0), 0.1);
        let mut open = cube();
        open.mesh.triangles[0] = HIDDEN;
        assert_eq!(count(&open, &[], &[view]), 11);
        let mut one_turned = cube();
        one_turned.mesh.triangles[3].swap(0, 1);
        assert_eq!(count(&one_turned, &[], &[view]), 12);
        let holes: Vec<bool> = (0..12).map(|triangle| triangle == 7).collect();
        assert_eq!(count(&cube(), &holes, &[view]), 12);
        // From inside, and where the near plane cuts it open.
        assert_eq!(count(&cube(), &[], &[seen_from(Vec3::splat(0.1), 0.01)]), 12);
        assert_eq!(count(&cube(), &[], &[seen_from(Vec3::Z * 3.0, 2.6)]), 12);
        // A plate with two sides and nothing between them.
        let mut plate = Scene::default();
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        plate.add_object("plate", 0, &corners, &[[0, 1, 2], [0, 2, 1]]);
        assert_eq!(count(&plate, &[], &[view]), 2);
    }

    #[test]
    fn maps_are_what_all_triangles_give() {
        for name in ["torus", "crowded", "show"] {
            let scene = builtin::scene(name).unwrap();
            let prepared = Prepared::new(&scene);
            let eye = Vec3::new(1.5, 8.0, 1.5);
            let views = [View::perspective(eye, Vec3::ZERO, Vec3::X, 0.9, 256, 256, 0.5)];
            let both =
                [(Viewer::Light, Payload::ObjectId), (Viewer::Camera, Payload::TriangleIndex)];
            for (viewer, payload) in both {
                let mut maps = [DepthBuffer::new(0, 0)];
                let mut drawing = Drawing::new(Level::detect(), Threads::One);
                let drawn = drawing.draw(&prepared, viewer, &views, payload, &mut maps);
                let mut whole = DepthBuffer::new(256, 256);
                let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
                let mesh = scene.mesh.as_mesh();
                let all = rasterizer.draw(&views[0], &mesh, payload, whole.target());
                assert!(drawn * 10 < all.drawn as u64 * 7, "{name}: {drawn} of {}", all.drawn);
                // Where a silhouette passes through a texel's centre, rounding decides.
                let near = |(a, b): (&f32, &f32)| (a / b - 1.0).abs() < 1e-3 || a == b;
                let pairs = maps[0].nearness.iter().zip(&whole.nearness);
                let different = pairs.filter(|&pair| !near(pair)).count();
                assert!(different <= 2, "{name}: {different} texels differ");
                let pairs = maps[0].payload.iter().zip(&whole.payload);
                let different = pairs.filter(|(a, b)| a != b).count();
                assert!(different <= 4, "{name}: {different} payloads differ");
            }
        }
    }
}
