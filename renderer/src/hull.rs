//! Few points instead of many, to fit views around.

use glam::Vec3;

use crate::scene::Bounds;

/// Cells along each axis of the grid that sorts the points.
const CELLS: usize = 16;

/// Fewer points than this are taken as they are.
const FEW: usize = 512;

/// Points whose convex hull holds `points`, closely: the points themselves if they are few, else
/// the corners of the boxes around those in each cell of a grid.
#[must_use]
pub fn points_around(mut points: Vec<Vec3>) -> Vec<Vec3> {
    points.retain(|p| p.is_finite());
    if points.len() <= FEW {
        return points;
    }
    let start = Bounds { min: points[0], max: points[0] };
    let bounds = points.iter().fold(start, |b, &p| Bounds { min: b.min.min(p), max: b.max.max(p) });
    let scale = CELLS as f32 / bounds.extent().max(Vec3::splat(f32::MIN_POSITIVE));
    let mut cells = vec![None; CELLS.pow(3)];
    for p in points {
        let cell = ((p - bounds.min) * scale).to_array();
        // The conversion saturates; the last plane of the grid belongs to the last cell.
        let [x, y, z] = cell.map(|c| (c as usize).min(CELLS - 1));
        let cell: &mut Option<Bounds> = &mut cells[(z * CELLS + y) * CELLS + x];
        *cell = Some(match *cell {
            Some(Bounds { min, max }) => Bounds { min: min.min(p), max: max.max(p) },
            None => Bounds { min: p, max: p },
        });
    }
    let corners = |Bounds { min, max }: Bounds| {
        (0..8).map(move |corner| {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    };
    let mut points: Vec<Vec3> = cells.into_iter().flatten().flat_map(corners).collect();
    // The corners of a flat box coincide.
    points.dedup();
    points
}
