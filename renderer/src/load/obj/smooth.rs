//! Shading normals for files that have none.

use glam::Vec3;

use super::super::error::Fault;
use super::super::limits::Budget;
use super::{NONE, Obj};

/// The cosine of the angle (45 degrees) beyond which two faces meet in an edge.
const EDGE: f32 = 0.707;

/// A position where more faces meet than this is a tip: flat shading there keeps the time linear.
const MOST_FACES: usize = 64;

/// A normal per corner: the mean of the faces around its position in the same object, weighted
/// by area, leaving out those that meet the corner's own face in an edge. Zero, which means flat,
/// for corners that have a normal in the file and for faces with smoothing off.
pub(super) fn normals(obj: &Obj, budget: &mut Budget) -> Result<Vec<Vec3>, Fault> {
    let corners = obj.corners.len();
    budget.memory(corners as u64 * 12, "the normals")?;
    let mut normals = vec![Vec3::ZERO; corners];
    if obj.corners.iter().all(|c| c.normal != NONE) || obj.faces.iter().all(|f| !f.smooth) {
        return Ok(normals);
    }
    budget
        .memory((obj.positions.len() + corners + obj.faces.len() * 4) as u64 * 4, "the normals")?;

    // Newell's normal of every face, as long as twice its area.
    let mut face_normals = Vec::with_capacity(obj.faces.len());
    // The faces around each position, one position after the other.
    let mut ends = vec![0_u32; obj.positions.len() + 1];
    let mut start = 0;
    for face in &obj.faces {
        let around = &obj.corners[start..face.end];
        let first = obj.positions[around[0].position as usize];
        let position = |i: usize| obj.positions[around[i % around.len()].position as usize] - first;
        face_normals.push((1..around.len()).map(|i| position(i).cross(position(i + 1))).sum());
        around.iter().for_each(|c| ends[c.position as usize + 1] += 1);
        start = face.end;
    }
    for i in 1..ends.len() {
        ends[i] += ends[i - 1];
    }
    let mut next = ends.clone();
    let mut faces_at = vec![0_u32; corners];
    start = 0;
    for (f, face) in obj.faces.iter().enumerate() {
        for corner in &obj.corners[start..face.end] {
            let slot = &mut next[corner.position as usize];
            faces_at[*slot as usize] = f as u32;
            *slot += 1;
        }
        start = face.end;
    }

    start = 0;
    for (f, face) in obj.faces.iter().enumerate() {
        let own: Vec3 = face_normals[f];
        let own_direction = own.normalize_or_zero();
        for (normal, corner) in
            normals[start..face.end].iter_mut().zip(&obj.corners[start..face.end])
        {
            let p = corner.position as usize;
            let around = &faces_at[ends[p] as usize..ends[p + 1] as usize];
            if corner.normal != NONE || !face.smooth || around.len() > MOST_FACES {
                continue;
            }
            let sum: Vec3 = around
                .iter()
                .map(|&g| (&obj.faces[g as usize], face_normals[g as usize]))
                .filter(|(g, _)| g.smooth && g.object == face.object)
                .filter_map(|(_, n)| {
                    // Neighbours of open sheets may be wound the other way.
                    let cosine = n.normalize_or_zero().dot(own_direction);
                    (cosine.abs() >= EDGE).then(|| n * cosine.signum())
                })
                .sum();
            *normal = sum.normalize_or_zero();
        }
        start = face.end;
    }
    Ok(normals)
}
