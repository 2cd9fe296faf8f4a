//! Second stage: which texels could each triangle cover? As many triangles at a time as a vector
//! has lanes, and in all views beside each other while they are at hand.
//!
//! Most triangles of a mesh seen from a light cover no texel centre, or a few. So coverage and
//! plane equations are found for all lanes alike, without a branch, and the smallest triangles
//! leave this stage as finished fragments. Branches, which no one can predict here, come last.

use shadowmap_core::Mesh;

use crate::bins::{Bins, Grid, Large, Masked, Small};
use crate::clip::{Clipped, INVALID, SetUp};
use crate::coverage::Triangle;
use crate::lanes::{Lanes, Planes, Shared, harmless_scale};
use crate::mask::Weights;
use crate::plain::vertices;
use crate::plane::Plane;
use crate::project::Projection;
use crate::simd::{MAX_LANES, Simd, kernel, set_bits};
use crate::tiny::Tiny;
use crate::vertices::{OUT_OF_RANGE, Vertices, code_of};
use crate::{AlphaMask, Payload};

/// What is drawn, and from where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(crate) mesh: Mesh<'a>,
    pub(crate) mask: Option<&'a AlphaMask<'a>>,
    pub(crate) payload: Payload,
    /// Beside each other.
    pub(crate) views: &'a [Projection],
    pub(crate) vertices: &'a Vertices,
    pub(crate) grid: Grid,
}

kernel! {
    /// Sorts the triangles from index `first` to before `end` into the `bins` of each view.
    fn bin(source: &Source<'_>, first: usize, end: usize, bins: &mut [Bins]) = bin_body
}

/// Vectors of triangles that go through a step together, so that what a step waits for is long
/// there when the next one needs it.
const BLOCK: usize = 8;

#[inline(always)]
fn bin_body<S: Simd>(s: S, source: &Source<'_>, first: usize, end: usize, bins: &mut [Bins]) {
    let harmless = harmless_scale(source.views[0].max_nearness);
    let nothing = Shared::of(s, [[s.splat_f(0.0); 4]; 3], &source.grid);
    let mut shared = [nothing; BLOCK];
    let mut covered = [Covered::of(s, source, &source.views[0], first, 0, &nothing); BLOCK];
    let mut tiny = [Tiny::NONE; BLOCK];
    let mut planes = [Planes::through(s, &nothing, covered[0].us, 0, harmless); BLOCK];
    for first in (first..end).step_by(BLOCK * S::LANES) {
        let vectors = (end - first).div_ceil(S::LANES).min(BLOCK);
        for (index, shared) in shared[..vectors].iter_mut().enumerate() {
            *shared = gather(s, source, first + index * S::LANES);
        }
        for (view, bins) in source.views.iter().zip(bins.iter_mut()) {
            let covered = &mut covered[..vectors];
            for (index, (covered, shared)) in covered.iter_mut().zip(&shared).enumerate() {
                let first = first + index * S::LANES;
                let wanted = wanted((end - first).min(S::LANES));
                *covered = Covered::of(s, source, view, first, wanted, shared);
            }
            for (tiny, covered) in tiny.iter_mut().zip(&*covered) {
                tiny.find(s, &covered.lanes, covered.lanes.tiny & covered.drawn, &source.grid);
            }
            for (index, covered) in covered.iter_mut().enumerate() {
                let tiny = &mut tiny[index];
                if tiny.is_any() || covered.lanes.small & covered.drawn != 0 {
                    let (shared, us) = (&shared[index], covered.us);
                    planes[index] = Planes::through(s, shared, us, covered.drawn, harmless);
                    if covered.drawn & !planes[index].sound != 0 {
                        covered.leave_out(planes[index].sound, tiny);
                    }
                }
            }
            for (index, covered) in covered.iter().enumerate() {
                let (first, tiny) = (first + index * S::LANES, &tiny[index]);
                covered.push(s, source, view, first, tiny, &planes[index], bins);
            }
        }
    }
}

/// The lanes of a vector of so many triangles.
#[inline(always)]
fn wanted(triangles: usize) -> u32 {
    u32::MAX >> (32 - triangles)
}

/// What all views share of the vector that starts with triangle `first`. Triangles past the end
/// are points, which have no area.
#[inline(always)]
fn gather<S: Simd>(s: S, source: &Source<'_>, first: usize) -> Shared<S> {
    fetch_ahead(s, source, first);
    let mut padded = [[0; 3]; MAX_LANES];
    let mut triangles = &source.mesh.triangles[first..];
    if triangles.len() < S::LANES {
        padded[..triangles.len()].copy_from_slice(triangles);
        triangles = &padded;
    }
    let corners = s.gather(&source.vertices.seen, triangles, OUT_OF_RANGE);
    Shared::of(s, corners, &source.grid)
}

/// Fetches what vectors of triangles well after triangle `first` are going to read: most of what
/// binning waits for is memory.
#[inline(always)]
fn fetch_ahead<S: Simd>(s: S, source: &Source<'_>, first: usize) {
    let Mesh { triangles, ids, .. } = source.mesh;
    let indices = triangles.as_ptr().wrapping_add(first + 24 * S::LANES).cast::<u8>();
    for line in (0..S::LANES * size_of::<[u32; 3]>()).step_by(64) {
        s.prefetch_read(indices.wrapping_add(line));
    }
    s.prefetch_read(ids.as_ptr().wrapping_add(first + 48 * S::LANES).cast());
    // A few corners stand for those around them.
    let vertices = source.vertices.seen.as_ptr();
    for ahead in (0..S::LANES).step_by(8) {
        if let Some(&[a, b, c]) = triangles.get(first + 12 * S::LANES + ahead) {
            s.prefetch_read(vertices.wrapping_add(a as usize).cast());
            s.prefetch_read(vertices.wrapping_add(b as usize).cast());
            s.prefetch_read(vertices.wrapping_add(c as usize).cast());
        }
    }
}

/// A vector of triangles in one view, and where they could be drawn.
#[derive(Clone, Copy)]
struct Covered<S: Simd> {
    us: [S::F; 3],
    lanes: Lanes<S>,
    drawn: u32,
    large: u32,
    special: u32,
    invalid: u32,
}

impl<S: Simd> Covered<S> {
    /// The `wanted` lanes of the vector that starts with triangle `first`.
    #[inline(always)]
    fn of(
        s: S,
        source: &Source<'_>,
        view: &Projection,
        first: usize,
        wanted: u32,
        shared: &Shared<S>,
    ) -> Covered<S> {
        let us = shared.us(s, view.rows[0][3]);
        let lanes = Lanes::cover(s, shared, us, wanted, &source.grid);
        let Lanes { mut special, mut drawn, mut large, .. } = lanes;
        // Whoever hides triangles that cannot be seen leaves many that are invalid.
        let invalid = if special == 0 { 0 } else { special & shared.invalid(s) };
        special &= !invalid;
        if let Some(mask) = source.mask {
            let masked = set_bits(drawn | large).filter(|lane| mask.is_masked(first + lane));
            special |= masked.fold(0, |bits, lane| bits | 1 << lane);
            drawn &= !special;
            large &= !special;
        }
        Covered { us, lanes, drawn, large, special, invalid }
    }

    /// Leaves the lanes that are not `sound`, whose gradient means nothing, to the scalar code.
    #[cold]
    fn leave_out(&mut self, sound: u32, tiny: &mut Tiny) {
        self.large |= self.drawn & !sound;
        self.drawn &= sound;
        tiny.keep(sound);
    }

    #[inline(always)]
    fn push(
        &self,
        s: S,
        source: &Source<'_>,
        view: &Projection,
        first: usize,
        tiny: &Tiny,
        planes: &Planes<S>,
        bins: &mut Bins,
    ) {
        let Covered { lanes, drawn, large, special, invalid, .. } = self;
        if tiny.is_any() {
            let payload = payloads(s, source, first);
            tiny.push(s, lanes, planes, payload, &source.grid, bins);
        }
        if lanes.small & drawn != 0 {
            push_small(s, source, first, lanes, lanes.small & drawn, planes, bins);
        }
        bins.stats.drawn += drawn.count_ones() as usize;
        if *invalid != 0 {
            bins.stats.invalid += invalid.count_ones() as usize;
        }
        for lane in set_bits(*large) {
            push_large(source, view, first + lane, source.mesh.triangles[first + lane], bins);
        }
        for lane in set_bits(*special) {
            push_special(source, view, first + lane, bins);
        }
    }
}

/// The payloads of the triangles from `first` on.
#[inline(always)]
fn payloads<S: Simd>(s: S, source: &Source<'_>, first: usize) -> S::I {
    match source.payload {
        Payload::TriangleIndex => {
            s.add_i(s.splat_i((first as u32).wrapping_add(1) as i32), s.lanes())
        }
        Payload::ObjectId => {
            let ids = source.mesh.ids.get(first..).unwrap_or_default();
            if ids.len() >= S::LANES {
                return s.load_u(ids);
            }
            let mut padded = [0; MAX_LANES];
            padded[..ids.len()].copy_from_slice(ids);
            s.load_u(&padded)
        }
    }
}

/// Sorts small triangles into the bands that they touch.
#[inline(always)]
fn push_small<S: Simd>(
    s: S,
    source: &Source<'_>,
    first: usize,
    lanes: &Lanes<S>,
    small: u32,
    planes: &Planes<S>,
    bins: &mut Bins,
) {
    let grid = &source.grid;
    let (mut x, mut y) = ([[0; MAX_LANES]; 2], [[0; MAX_LANES]; 2]);
    for k in 0..2 {
        s.store_u(&mut x[k], lanes.x[k]);
        s.store_u(&mut y[k], lanes.y[k]);
    }
    let mut edges = [[0; MAX_LANES]; 3];
    for (out, edge) in edges.iter_mut().zip(lanes.edges) {
        s.store_u(out, s.shift_right::<8>(edge));
    }
    let (mut dx, mut dy) = ([[0; MAX_LANES]; 2], [[0; MAX_LANES]; 2]);
    for k in 0..2 {
        s.store_u(&mut dx[k], lanes.delta[k][0]);
        s.store_u(&mut dy[k], lanes.delta[k][1]);
    }
    let (mut a, mut b, mut c) = ([0.0; MAX_LANES], [0.0; MAX_LANES], [0.0; MAX_LANES]);
    s.store_d(&mut a, planes.a);
    s.store_d(&mut b, planes.b);
    s.store_d(&mut c, planes.c);
    let (mut low, mut high, mut payload) = ([0.0; MAX_LANES], [0.0; MAX_LANES], [0; MAX_LANES]);
    s.store_f(&mut low, planes.low);
    s.store_f(&mut high, planes.high);
    s.store_u(&mut payload, payloads(s, source, first));
    for lane in set_bits(small) {
        for band in y[0][lane] >> grid.shift..=y[1][lane] >> grid.shift {
            // Made anew for each, number by number where it stays: to read it back as a whole, for
            // a copy, would have to wait.
            bins.bands[band as usize].small.push(Small {
                x: x[0][lane] as u16,
                y: y[0][lane] as u16,
                last_x: x[1][lane] as u16,
                last_y: y[1][lane] as u16,
                edges: [0, 1, 2].map(|k| edges[k][lane] as i32),
                steps: [[0, 1].map(|k| -(dy[k][lane] as i16)), [0, 1].map(|k| dx[k][lane] as i16)],
                plane: Plane {
                    a: a[lane],
                    b: b[lane],
                    c: c[lane],
                    low: low[lane],
                    high: high[lane],
                },
                payload: payload[lane],
            });
        }
    }
}

#[inline(never)]
fn push_large(
    source: &Source<'_>,
    view: &Projection,
    index: usize,
    triangle: [u32; 3],
    bins: &mut Bins,
) {
    let points = triangle.map(|i| {
        let [across, scale, v, near] = source.vertices.seen[i as usize];
        [(across + view.rows[0][3]) * scale, v, near]
    });
    if let Some(triangle) = Triangle::new(points.map(|[u, v, _]| [u, v])) {
        let payload = source.payload.of(index, source.mesh.ids);
        let large = Large { triangle, plane: Plane::through(points), payload };
        bins.stats.drawn += usize::from(bins.push_large(large, &source.grid));
    }
}

/// A triangle that needs clipping or has an alpha test.
#[inline(never)]
fn push_special(source: &Source<'_>, view: &Projection, index: usize, bins: &mut Bins) {
    let triangle = source.mesh.triangles[index];
    let codes = triangle
        .map(|i| source.vertices.seen.get(i as usize).map_or(INVALID, |&seen| code_of(seen)));
    if (codes[0] | codes[1] | codes[2]) & INVALID != 0 {
        bins.stats.invalid += 1;
        return;
    }
    if codes[0] & codes[1] & codes[2] != 0 {
        bins.stats.clipped += 1;
        return;
    }
    let Some(vertices) = vertices(view, &source.mesh, triangle) else { return };
    let set_up = match SetUp::of(view, vertices) {
        Clipped::Whole(set_up) => set_up,
        Clipped::Cut(set_up) => {
            bins.stats.clipped += 1;
            set_up
        }
        Clipped::Gone => {
            bins.stats.clipped += 1;
            return;
        }
        Clipped::Invalid => {
            bins.stats.invalid += 1;
            return;
        }
    };
    let payload = source.payload.of(index, source.mesh.ids);
    let masked = source.mask.is_some_and(|mask| mask.is_masked(index));
    let mut drawn = false;
    for triangle in set_up.triangles() {
        let large = Large { triangle, plane: set_up.plane, payload };
        drawn |= if masked {
            let weights = Weights::of(vertices);
            bins.push_masked(Masked { large, index, weights }, &source.grid)
        } else {
            bins.push_large(large, &source.grid)
        };
    }
    bins.stats.drawn += usize::from(drawn);
}
