//! The triangles of closed surfaces, and those of them that a viewer sees from outside.

use glam::Vec4;
use raster::Payload;
#[cfg(target_arch = "x86_64")]
use shadowmap_core::LevelKind;
use shadowmap_core::{Level, Mesh};

use crate::drawing::HIDDEN;
use crate::light_block::levels;

/// How far behind a face, of the distances at hand, a viewer must be: what rounding leaves.
const TOLERANCE: f32 = 1e-5;

/// Faces that are looked at together.
const LANES: usize = 16;

/// The triangles of a scene as parts of its solids.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    planes: Vec<Planes>,
    /// The solid of each.
    solids: Vec<u32>,
}

/// The planes of as many faces that follow each other.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Planes([[f32; LANES]; 4]);

/// Triangles that are drawn, with what stands for each in a map. Reused between frames.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    triangles: Vec<[u32; 3]>,
    payloads: Vec<u32>,
}

impl Faces {
    /// Adds the next triangle. Its plane, over (x, y, z, 1), is positive outside of its solid; zero
    /// for a triangle that is part of none.
    pub fn push(&mut self, plane: Vec4, solid: u32) {
        let lane = self.solids.len() % LANES;
        if lane == 0 {
            self.planes.push(Planes([[0.0; LANES]; 4]));
        }
        if let Some(Planes(planes)) = self.planes.last_mut() {
            for (coefficients, value) in planes.iter_mut().zip(plane.to_array()) {
                coefficients[lane] = value;
            }
        }
        self.solids.push(solid);
    }

    /// The triangles of `mesh`, the scene's, but for those of the solids that the `eyes`,
    /// homogeneous points, are `outside` of and that all of these see from behind. If they are to
    /// `keep_places`, those get indices that no vertex has; else they are not listed. Object IDs of
    /// the list are the `payload` that its triangles have in `mesh`.
    pub fn shown<'t>(
        &self,
        level: Level,
        outside: &[bool],
        eyes: &[[f32; 4]],
        mesh: &Mesh<'t>,
        payload: Payload,
        keep_places: bool,
        shown: &'t mut Shown,
    ) -> Mesh<'t> {
        shown.triangles.resize(mesh.triangles.len(), HIDDEN);
        shown.payloads.resize(mesh.triangles.len(), 0);
        let count = list(level, self, outside, eyes, mesh, payload, keep_places, shown);
        let (triangles, ids) = (&shown.triangles[..count], &shown.payloads[..count]);
        Mesh { positions: mesh.positions, triangles, ids }
    }
}

levels!(
    /// Fills the list of [`Faces::shown`], from its start on. Returns its length.
    list,
    list_body,
    (
        faces: &Faces,
        outside: &[bool],
        eyes: &[[f32; 4]],
        mesh: &Mesh<'_>,
        payload: Payload,
        keep_places: bool,
        shown: &mut Shown
    ) -> usize
);

#[inline(always)]
fn list_body(
    faces: &Faces,
    outside: &[bool],
    eyes: &[[f32; 4]],
    mesh: &Mesh<'_>,
    payload: Payload,
    keep_places: bool,
    shown: &mut Shown,
) -> usize {
    let outside_all = !outside.contains(&false);
    let farthest = eyes.as_flattened().iter().fold(0.0, |most: f32, x| most.max(x.abs()));
    let (triangles, payloads) = (&mut shown.triangles[..], &mut shown.payloads[..]);
    let mut count = 0;
    let blocks = mesh.triangles.chunks(LANES).zip(&faces.planes);
    for (first, (block, planes)) in (0..).step_by(LANES).zip(blocks) {
        let mut hidden = planes.are_behind(eyes, farthest);
        if !outside_all {
            for (hidden, &solid) in hidden.iter_mut().zip(&faces.solids[first..]) {
                *hidden &= outside[solid as usize];
            }
        }
        for (lane, (triangle, hidden)) in block.iter().zip(hidden).enumerate() {
            // Written in any case and overwritten by the next one, which is faster than to decide.
            triangles[count] = *triangle;
            payloads[count] = match payload {
                Payload::ObjectId => mesh.ids.get(first + lane).copied().unwrap_or(0),
                Payload::TriangleIndex => (first + lane) as u32 + 1,
            };
            if keep_places && hidden {
                triangles[count] = HIDDEN;
            }
            count += usize::from(keep_places | !hidden);
        }
    }
    count
}

impl Planes {
    /// Which of them all of `eyes`, with no coordinate beyond `farthest`, are behind.
    #[inline(always)]
    fn are_behind(&self, eyes: &[[f32; 4]], farthest: f32) -> [bool; LANES] {
        let Planes([px, py, pz, pw]) = self;
        let mut behind = [true; LANES];
        for &[x, y, z, w] in eyes {
            for i in 0..LANES {
                let height = ((px[i] * x + py[i] * y) + pz[i] * z) + pw[i] * w;
                behind[i] &= height < -(TOLERANCE * (farthest + pw[i].abs()));
            }
        }
        behind
    }
}
