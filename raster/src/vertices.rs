//! First stage: every vertex to texel space, once.

use alloc::vec::Vec;

use glam::Vec3;
use shadowmap_core::{BandSlice, Level, Threads, for_each_band};

use crate::clip::{INVALID, outcode};
use crate::project::Projection;
use crate::simd::{Simd, kernel};

/// A vertex as triangles need it, u and v together since they are always read together.
///
/// A vertex that needs clipping has a NaN for u and its outcode in the bits of v, so that
/// telling the two apart costs the common case nothing.
pub(crate) type Seen = [f32; 2];

/// What stands for a vertex whose index is out of range.
pub(crate) const OUT_OF_RANGE: Seen = [f32::NAN, f32::from_bits(INVALID)];

/// Vertices of a mesh as one view sees them. Reused between frames.
#[derive(Debug, Default)]
pub(crate) struct Vertices {
    pub(crate) seen: Vec<Seen>,
    pub(crate) nearness: Vec<f32>,
}

/// Vertices per unit of work.
const CHUNK: usize = 4096;

impl Vertices {
    pub(crate) fn transform(
        &mut self,
        level: Level,
        threads: Threads,
        projection: &Projection,
        positions: &[Vec3],
    ) {
        self.seen.resize(positions.len(), [0.0; 2]);
        self.nearness.resize(positions.len(), 0.0);
        let bands = (
            BandSlice { data: &mut self.seen, len: CHUNK },
            BandSlice { data: &mut self.nearness, len: CHUNK },
        );
        for_each_band(threads, bands, &|index, (seen, nearness)| {
            let positions = &positions[index * CHUNK..][..seen.data.len()];
            project(level, projection, positions, seen.data, nearness.data);
            for (seen, position) in seen.data.iter_mut().zip(positions) {
                if seen[0].is_nan() {
                    let code = outcode(projection.homogeneous(*position), projection.max_nearness);
                    seen[1] = f32::from_bits(code);
                }
            }
        });
    }
}

kernel! {
    /// Projects `positions`; u is NaN where a vertex needs clipping.
    fn project(
        projection: &Projection,
        positions: &[Vec3],
        seen: &mut [Seen],
        nearness: &mut [f32],
    ) = project_body
}

/// Written lane by lane: the compiler makes vectors of it.
#[inline(always)]
fn project_body<S: Simd>(
    _: S,
    projection: &Projection,
    positions: &[Vec3],
    seen: &mut [Seen],
    nearness: &mut [f32],
) {
    let projection = *projection;
    for ((position, seen), nearness) in positions.iter().zip(seen).zip(nearness) {
        let ([u, v, n], inside) = projection.project(projection.homogeneous(*position));
        *seen = [if inside { u } else { f32::NAN }, v];
        *nearness = n;
    }
}
