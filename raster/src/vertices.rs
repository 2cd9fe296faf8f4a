//! First stage: every vertex to texel space, once for all views beside each other.

use alloc::vec::Vec;

use glam::Vec3;
use shadowmap_core::{BandSlice, Level, Threads, for_each_band};

use crate::clip::{INVALID, outcode};
use crate::project::Projection;
use crate::simd::{Simd, kernel};

/// A vertex as triangles need it: U without its constant, 1 / Q, v and nearness. Only the first
/// differs among views beside each other, by the constant of their U; so u is left to the second
/// stage, and all views read the same.
///
/// A vertex that needs clipping in the first and the last view has a NaN for 1 / Q and, in the low
/// bits of v, what is set in its outcodes in all views; so telling the two apart costs the common
/// case nothing.
pub(crate) type Seen = [f32; 4];

/// What stands for a vertex whose index is out of range.
pub(crate) const OUT_OF_RANGE: Seen = [f32::NAN, f32::NAN, with_code(INVALID), f32::NAN];

/// 1, where an outcode is put into the low bits: those of 0 would be denormal, which vectors are
/// slow to convert.
const ONE: u32 = 1.0_f32.to_bits();

/// The v of a vertex that needs clipping.
const fn with_code(code: u32) -> f32 {
    f32::from_bits(ONE | code)
}

/// The outcode that a vertex has in all views; 0 if it needs no clipping in one of them.
pub(crate) fn code_of([_, scale, v, _]: Seen) -> u32 {
    if scale.is_nan() { v.to_bits() & !ONE } else { 0 }
}

/// Vertices of a mesh as views beside each other see them. Reused between frames.
#[derive(Debug, Default)]
pub(crate) struct Vertices {
    pub(crate) seen: Vec<Seen>,
}

/// Vertices per unit of work.
const CHUNK: usize = 4096;

impl Vertices {
    /// `views` lie beside each other; there is at least one.
    pub(crate) fn transform(
        &mut self,
        level: Level,
        threads: Threads,
        views: &[Projection],
        positions: &[Vec3],
    ) {
        self.seen.resize(positions.len(), [0.0; 4]);
        let bands = BandSlice { data: &mut self.seen, len: CHUNK };
        for_each_band(threads, bands, &|index, seen| {
            let positions = &positions[index * CHUNK..][..seen.data.len()];
            let mut all_inside = true;
            project(level, views, positions, seen.data, &mut all_inside);
            if all_inside {
                return;
            }
            for (seen, position) in seen.data.iter_mut().zip(positions) {
                if seen[1].is_nan() {
                    let codes = views
                        .iter()
                        .map(|view| outcode(view.homogeneous(*position), view.max_nearness));
                    seen[2] = with_code(codes.fold(!ONE, |all, code| all & code));
                }
            }
        });
    }
}

kernel! {
    /// Projects `positions`; 1 / Q is NaN where a vertex needs clipping, which `all_inside` says
    /// that none does.
    fn project(
        views: &[Projection],
        positions: &[Vec3],
        seen: &mut [Seen],
        all_inside: &mut bool,
    ) = project_body
}

/// Written lane by lane: the compiler makes vectors of it.
#[inline(always)]
fn project_body<S: Simd>(
    _: S,
    views: &[Projection],
    positions: &[Vec3],
    seen: &mut [Seen],
    all_inside: &mut bool,
) {
    let mut all = true;
    let view = views[0];
    let last = views[views.len() - 1].rows[0][3];
    for (position, seen) in positions.iter().zip(seen) {
        let across = view.across(*position);
        let [first_u, v, n, q] = view.homogeneous(*position);
        let (_, inside_last) = view.project([across + last, v, n, q]);
        let ([_, v, n], inside_first) = view.project([first_u, v, n, q]);
        let scale = 1.0 / q;
        let inside = inside_first | inside_last;
        all &= inside;
        let scale = if inside { scale } else { f32::NAN };
        *seen = [across, scale, v, n];
    }
    *all_inside = all;
}
