//! Second stage: which texels could each triangle cover? As many triangles at a time as a vector
//! has lanes.
//!
//! Most triangles of a mesh seen from a light cover no texel centre, or a few. So the first question
//! is answered for all lanes alike, without a branch; only where some lane covers something are
//! plane equations set up, and the smallest triangles leave this stage as finished fragments.

use shadowmap_core::Mesh;

use crate::bins::{Bins, Grid, Large, Masked, Small};
use crate::clip::{Clipped, INVALID, SetUp};
use crate::coverage::Triangle;
use crate::lanes::{self, Lanes, Planes, inside};
use crate::line::clamp;
use crate::mask::Weights;
use crate::plain::vertices;
use crate::plane::Plane;
use crate::project::Projection;
use crate::simd::{MAX_LANES, Simd, kernel, set_bits};
use crate::vertices::{OUT_OF_RANGE, Seen, Vertices};
use crate::{AlphaMask, Payload};

/// What is drawn, and from where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub(crate) mesh: Mesh<'a>,
    pub(crate) mask: Option<&'a AlphaMask<'a>>,
    pub(crate) payload: Payload,
    pub(crate) projection: Projection,
    pub(crate) vertices: &'a Vertices,
    pub(crate) grid: Grid,
}

kernel! {
    /// Sorts the triangles from index `first` to before `end` into `bins`.
    fn bin(source: &Source<'_>, first: usize, end: usize, bins: &mut Bins) = bin_body
}

#[inline(always)]
fn bin_body<S: Simd>(s: S, source: &Source<'_>, first: usize, end: usize, bins: &mut Bins) {
    let mut first = first;
    while first + S::LANES <= end {
        let triangles = &source.mesh.triangles[first..first + S::LANES];
        bin_group(s, source, first, triangles, S::LANES, bins);
        first += S::LANES;
    }
    if first < end {
        // Triangles past the end are points, which have no area.
        let mut triangles = [[0; 3]; MAX_LANES];
        triangles[..end - first].copy_from_slice(&source.mesh.triangles[first..end]);
        bin_group(s, source, first, &triangles[..S::LANES], end - first, bins);
    }
}

/// Sorts one vector of triangles, of which the first `count` are wanted.
#[inline(always)]
fn bin_group<S: Simd>(
    s: S,
    source: &Source<'_>,
    first: usize,
    triangles: &[[u32; 3]],
    count: usize,
    bins: &mut Bins,
) {
    let seen = s.gather_pairs(&source.vertices.seen, triangles, OUT_OF_RANGE);
    let wanted = (1 << count) - 1;
    let lanes = Lanes::cover(s, &seen, wanted, &source.grid);
    let Lanes { mut special, mut drawn, mut large, .. } = lanes;
    if let Some(mask) = source.mask {
        let masked = set_bits(drawn | large).filter(|lane| mask.is_masked(first + lane));
        special |= masked.fold(0, |bits, lane| bits | 1 << lane);
        drawn &= !special;
        large &= !special;
    }
    if drawn != 0 {
        let near = s.gather(&source.vertices.nearness, triangles);
        let planes = Planes::through(s, &seen, near);
        // A gradient that means nothing is left to the scalar code.
        large |= drawn & !planes.sound;
        drawn &= planes.sound;
        if lanes.tiny & drawn != 0 {
            push_tiny(s, source, first, &lanes, lanes.tiny & drawn, &planes, bins);
        }
        if lanes.small & drawn != 0 {
            push_small(s, source, first, &lanes, lanes.small & drawn, &planes, bins);
        }
    }
    bins.stats.drawn += drawn.count_ones() as usize;
    for lane in set_bits(large) {
        push_large(source, first + lane, triangles[lane], bins);
    }
    for lane in set_bits(special) {
        push_special(source, first + lane, bins);
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

/// Turns tiny triangles into fragments: texel by texel of their bounds, all lanes alike.
#[inline(always)]
fn push_tiny<S: Simd>(
    s: S,
    source: &Source<'_>,
    first: usize,
    lanes: &Lanes<S>,
    tiny: u32,
    planes: &Planes<S>,
    bins: &mut Bins,
) {
    let grid = &source.grid;
    let payload = payloads(s, source, first);
    let (columns, rows) = (s.sub_i(lanes.x[1], lanes.x[0]), s.sub_i(lanes.y[1], lanes.y[0]));
    let (one, half) = (s.splat_d(1.0), s.splat_d(0.5));
    let px = s.add_d(s.d_from_f(s.f_from_i(lanes.x[0])), half);
    let mut py = s.add_d(s.d_from_f(s.f_from_i(lanes.y[0])), half);
    let (mut y, mut row_edges) = (lanes.y[0], lanes.edges);
    for down in 0..lanes::tiny::<S>() {
        let mut rest = tiny & s.bits(s.greater_i(rows, s.splat_i(down as i32 - 1)));
        if rest == 0 {
            return;
        }
        let row = s.add_d(s.mul_d(planes.b, py), planes.c);
        let mut ys = [0; MAX_LANES];
        s.store_u(&mut ys, y);
        while rest != 0 {
            // The lanes in the band of the first one that is left.
            let band = ys[rest.trailing_zeros() as usize % MAX_LANES] >> grid.shift;
            let start = (band << grid.shift) as i32;
            let end = start + grid.rows() as i32;
            let here =
                s.and_m(s.greater_i(y, s.splat_i(start - 1)), s.greater_i(s.splat_i(end), y));
            let here = rest & s.bits(here);
            rest &= !here;
            let fragments = &mut bins.bands[band as usize].fragments;
            let texel = s.mul_i(s.sub_i(y, s.splat_i(start)), s.splat_i(grid.width as i32));
            let (mut texel, mut px) = (s.add_i(texel, lanes.x[0]), px);
            let mut edges = row_edges;
            for right in 0..lanes::tiny::<S>() {
                let wide = here & s.bits(s.greater_i(columns, s.splat_i(right as i32 - 1)));
                if wide == 0 {
                    break;
                }
                let covered = wide & inside(s, edges);
                if covered != 0 {
                    let near = s.f_from_d(s.add_d(s.mul_d(planes.a, px), row));
                    let near = clamp(s, near, planes.low, planes.high);
                    fragments.push(s, covered, texel, near, payload);
                }
                texel = s.add_i(texel, s.splat_i(1));
                px = s.add_d(px, one);
                for (edge, [_, dy]) in edges.iter_mut().zip(lanes.delta) {
                    *edge = s.sub_i(*edge, s.shift_left::<8>(dy));
                }
            }
        }
        y = s.add_i(y, s.splat_i(1));
        py = s.add_d(py, one);
        for (edge, [dx, _]) in row_edges.iter_mut().zip(lanes.delta) {
            *edge = s.add_i(*edge, s.shift_left::<8>(dx));
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
    let (mut edges, mut dx, mut dy) =
        ([[0; MAX_LANES]; 3], [[0; MAX_LANES]; 3], [[0; MAX_LANES]; 3]);
    for k in 0..3 {
        s.store_u(&mut edges[k], s.shift_right::<8>(lanes.edges[k]));
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
        let small = Small {
            x: x[0][lane] as u16,
            y: y[0][lane] as u16,
            last_x: x[1][lane] as u16,
            last_y: y[1][lane] as u16,
            edges: [0, 1, 2].map(|k| edges[k][lane] as i32),
            step_x: [0, 1, 2].map(|k| -(dy[k][lane] as i32)),
            step_y: [0, 1, 2].map(|k| dx[k][lane] as i32),
            plane: Plane { a: a[lane], b: b[lane], c: c[lane], low: low[lane], high: high[lane] },
            payload: payload[lane],
        };
        for band in y[0][lane] >> grid.shift..=y[1][lane] >> grid.shift {
            bins.bands[band as usize].small.push(small);
        }
    }
}

#[inline(never)]
fn push_large(source: &Source<'_>, index: usize, triangle: [u32; 3], bins: &mut Bins) {
    let Vertices { seen, nearness } = source.vertices;
    let points = triangle.map(|i| {
        let [u, v]: Seen = seen[i as usize];
        [u, v, nearness[i as usize]]
    });
    if let Some(triangle) = Triangle::new(points.map(|[u, v, _]| [u, v])) {
        let payload = source.payload.of(index, source.mesh.ids);
        let large = Large { triangle, plane: Plane::through(points), payload };
        bins.stats.drawn += usize::from(bins.push_large(large, &source.grid));
    }
}

/// A triangle that needs clipping or has an alpha test.
#[inline(never)]
fn push_special(source: &Source<'_>, index: usize, bins: &mut Bins) {
    let triangle = source.mesh.triangles[index];
    // The outcodes that stand in v where u is NaN tell most of what is to know.
    let codes = triangle.map(|i| match source.vertices.seen.get(i as usize) {
        Some([u, v]) if u.is_nan() => v.to_bits(),
        Some(_) => 0,
        None => INVALID,
    });
    if (codes[0] | codes[1] | codes[2]) & INVALID != 0 {
        bins.stats.invalid += 1;
        return;
    }
    if codes[0] & codes[1] & codes[2] != 0 {
        bins.stats.clipped += 1;
        return;
    }
    let Some(vertices) = vertices(&source.projection, &source.mesh, triangle) else { return };
    let set_up = match SetUp::of(&source.projection, vertices) {
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
