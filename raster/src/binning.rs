//! Second stage: which texels could each triangle cover? 64 triangles at a time.
//!
//! Most triangles of a mesh seen from a light cover no texel centre, or a few. So the first question
//! is answered for all lanes alike, without a branch; only those that cover something get a plane
//! equation, and the smallest ones leave this stage as finished [`Fragment`]s.

use shadowmap_core::Mesh;

use crate::bins::{Bins, Fragment, Grid, Large, Masked, Small};
use crate::clip::{Clipped, INVALID, SetUp};
use crate::coverage::{SUBTEXELS, Triangle, centers_between, snap};
use crate::kernel::kernel;
use crate::mask::Weights;
use crate::plain::vertices;
use crate::plane::{Plane, STEEPEST};
use crate::project::Projection;
use crate::vertices::{OUT_OF_RANGE, Vertices};
use crate::{AlphaMask, Payload};

/// Triangles in flight: enough that no load waits for the store before it, few enough for the
/// first-level cache.
const LANES: usize = 64;

/// Below this width and height, in 1/256 texel, a triangle is small: its edge functions are exact
/// in single precision.
const SMALL: i32 = 16 * SUBTEXELS;

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
fn bin_body(source: &Source<'_>, first: usize, end: usize, bins: &mut Bins) {
    let mut corners = Corners { u: [[0.0; LANES]; 3], v: [[0.0; LANES]; 3] };
    let mut lanes = Lanes::new();
    let mut survivors = Survivors::new();
    for first in (first..end).step_by(LANES) {
        let triangles = &source.mesh.triangles[first..end.min(first + LANES)];
        corners.gather(source, triangles);
        lanes.cover(&corners, &source.grid);
        if let Some(mask) = source.mask {
            for (lane, class) in lanes.class[..triangles.len()].iter_mut().enumerate() {
                if mask.is_masked(first + lane) {
                    *class = SPECIAL;
                }
            }
        }
        survivors.select(&lanes, source, triangles, &corners);
        bins.stats.drawn += lanes.class.iter().filter(|&&class| class & IN_BOUNDS != 0).count();
        for i in 0..survivors.count {
            emit(source, first, &lanes, &survivors, i, bins);
        }
    }
}

/// Classes of triangles: the four lowest bits are the texels (0, 0), (1, 0), (0, 1), (1, 1) of its
/// bounds that a tiny triangle covers.
const TINY: u32 = 15;
const IS_SMALL: u32 = 16;
const IS_LARGE: u32 = 32;
const SPECIAL: u32 = 64;
const SURVIVES: u32 = 127;
const IN_BOUNDS: u32 = 128;

struct Corners {
    u: [[f32; LANES]; 3],
    v: [[f32; LANES]; 3],
}

impl Corners {
    #[inline(always)]
    fn gather(&mut self, source: &Source<'_>, triangles: &[[u32; 3]]) {
        let seen = &source.vertices.seen[..];
        for (lane, triangle) in triangles.iter().enumerate() {
            for k in 0..3 {
                let [u, v] = seen.get(triangle[k] as usize).copied().unwrap_or(OUT_OF_RANGE);
                self.u[k][lane] = u;
                self.v[k][lane] = v;
            }
        }
        // Points have no area and are not drawn.
        for k in 0..3 {
            self.u[k][triangles.len()..].fill(0.0);
            self.v[k][triangles.len()..].fill(0.0);
        }
    }
}

struct Lanes {
    class: [u32; LANES],
    x: [i32; LANES],
    y: [i32; LANES],
    last_x: [i32; LANES],
    last_y: [i32; LANES],
    edges: [[f32; LANES]; 3],
    step_x: [[f32; LANES]; 3],
    step_y: [[f32; LANES]; 3],
}

impl Lanes {
    fn new() -> Lanes {
        Lanes {
            class: [0; LANES],
            x: [0; LANES],
            y: [0; LANES],
            last_x: [0; LANES],
            last_y: [0; LANES],
            edges: [[0.0; LANES]; 3],
            step_x: [[0.0; LANES]; 3],
            step_y: [[0.0; LANES]; 3],
        }
    }

    #[inline(always)]
    fn cover(&mut self, corners: &Corners, grid: &Grid) {
        let (width, height) = (grid.width as i32, grid.height as i32);
        let no_small = if width < 16 { IS_LARGE } else { 0 };
        for l in 0..LANES {
            let u = [corners.u[0][l], corners.u[1][l], corners.u[2][l]];
            let v = [corners.v[0][l], corners.v[1][l], corners.v[2][l]];
            let sum = u[0] + u[1] + u[2];
            let x = [snap(u[0]), snap(u[1]), snap(u[2])];
            let y = [snap(v[0]), snap(v[1]), snap(v[2])];
            let (low_x, high_x) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
            let (low_y, high_y) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));
            let (x0, x1) = centers_between(low_x, high_x, width);
            let (y0, y1) = centers_between(low_y, high_y, height);
            // Relative to the first texel's centre.
            let (cx, cy) = (x0 * SUBTEXELS + SUBTEXELS / 2, y0 * SUBTEXELS + SUBTEXELS / 2);
            let rx = [
                x[0].wrapping_sub(cx) as f32,
                x[1].wrapping_sub(cx) as f32,
                x[2].wrapping_sub(cx) as f32,
            ];
            let ry = [
                y[0].wrapping_sub(cy) as f32,
                y[1].wrapping_sub(cy) as f32,
                y[2].wrapping_sub(cy) as f32,
            ];
            let area = (rx[1] - rx[0]) * (ry[2] - ry[0]) - (ry[1] - ry[0]) * (rx[2] - rx[0]);
            let sign = if area < 0.0 { -1.0_f32 } else { 1.0 };
            let mut edges = [0.0_f32; 3];
            let mut step_x = [0.0_f32; 3];
            let mut step_y = [0.0_f32; 3];
            for k in 0..3 {
                let (from, to) = (k, (k + 1) % 3);
                let dx = (rx[to] - rx[from]) * sign;
                let dy = (ry[to] - ry[from]) * sign;
                let owned = (dy < 0.0) | ((dy == 0.0) & (dx > 0.0));
                edges[k] = (dy * rx[from] - dx * ry[from]) - if owned { 0.0 } else { 1.0 };
                step_x[k] = -(dy * SUBTEXELS as f32);
                step_y[k] = dx * SUBTEXELS as f32;
                self.edges[k][l] = edges[k];
                self.step_x[k][l] = step_x[k];
                self.step_y[k][l] = step_y[k];
            }
            let [e0, e1, e2] = edges;
            let [a0, a1, a2] = step_x;
            let [b0, b1, b2] = step_y;
            let c00 = (e0 >= 0.0) & (e1 >= 0.0) & (e2 >= 0.0);
            let c10 = (e0 + a0 >= 0.0) & (e1 + a1 >= 0.0) & (e2 + a2 >= 0.0) & (x0 < x1);
            let (f0, f1, f2) = (e0 + b0, e1 + b1, e2 + b2);
            let c01 = (f0 >= 0.0) & (f1 >= 0.0) & (f2 >= 0.0) & (y0 < y1);
            let c11 =
                (f0 + a0 >= 0.0) & (f1 + a1 >= 0.0) & (f2 + a2 >= 0.0) & (x0 < x1) & (y0 < y1);
            let tiny =
                u32::from(c00) | u32::from(c10) << 1 | u32::from(c01) << 2 | u32::from(c11) << 3;
            let in_bounds = (x0 <= x1) & (y0 <= y1);
            let is_small =
                (high_x.wrapping_sub(low_x) < SMALL) & (high_y.wrapping_sub(low_y) < SMALL);
            let is_tiny = (x1 - x0 < 2) & (y1 - y0 < 2);
            let class = if is_tiny { tiny | IN_BOUNDS } else { IS_SMALL | IN_BOUNDS };
            let class = if area == 0.0 { 0 } else { class };
            let class = if is_small { class } else { IS_LARGE };
            let class = if no_small != 0 { no_small } else { class };
            let class = if in_bounds { class } else { 0 };
            self.class[l] = if sum.is_nan() { SPECIAL } else { class };
            self.x[l] = x0;
            self.y[l] = y0;
            self.last_x[l] = x1;
            self.last_y[l] = y1;
        }
    }
}

/// The triangles that cover something, and their planes.
struct Survivors {
    count: usize,
    lane: [u8; LANES],
    groups: [Group; LANES / GROUP],
}

/// Triangles set up at a time.
const GROUP: usize = 16;

/// Triangles side by side.
#[derive(Clone, Copy)]
struct Group {
    u: [[f32; GROUP]; 3],
    v: [[f32; GROUP]; 3],
    nearness: [[f32; GROUP]; 3],
    x: [i32; GROUP],
    y: [i32; GROUP],
    a: [f64; GROUP],
    b: [f64; GROUP],
    c: [f64; GROUP],
    low: [f32; GROUP],
    high: [f32; GROUP],
    /// Nearness at the four texels of a tiny triangle.
    texels: [[f32; GROUP]; 4],
}

impl Survivors {
    fn new() -> Survivors {
        let group = Group {
            u: [[0.0; GROUP]; 3],
            v: [[0.0; GROUP]; 3],
            nearness: [[0.0; GROUP]; 3],
            x: [0; GROUP],
            y: [0; GROUP],
            a: [0.0; GROUP],
            b: [0.0; GROUP],
            c: [0.0; GROUP],
            low: [0.0; GROUP],
            high: [0.0; GROUP],
            texels: [[0.0; GROUP]; 4],
        };
        Survivors { count: 0, lane: [0; LANES], groups: [group; LANES / GROUP] }
    }

    #[inline(always)]
    fn select(
        &mut self,
        lanes: &Lanes,
        source: &Source<'_>,
        triangles: &[[u32; 3]],
        corners: &Corners,
    ) {
        let nearness = &source.vertices.nearness[..];
        self.count = 0;
        for lane in 0..LANES {
            self.lane[self.count % LANES] = lane as u8;
            self.count += usize::from(lanes.class[lane] & SURVIVES != 0);
        }
        for i in 0..self.count {
            let lane = self.lane[i] as usize % LANES;
            let group = &mut self.groups[i / GROUP];
            let i = i % GROUP;
            for k in 0..3 {
                group.u[k][i] = corners.u[k][lane];
                group.v[k][i] = corners.v[k][lane];
                let vertex = triangles[lane][k] as usize;
                group.nearness[k][i] = nearness.get(vertex).copied().unwrap_or(0.0);
            }
            group.x[i] = lanes.x[lane];
            group.y[i] = lanes.y[lane];
        }
        for group in &mut self.groups[..self.count.div_ceil(GROUP)] {
            group.planes();
        }
    }
}

impl Group {
    /// [`Plane::through`] and [`Plane::at`] in the same order of operations.
    #[inline(always)]
    fn planes(&mut self) {
        for i in 0..GROUP {
            let x0 = f64::from(self.u[0][i]);
            let x1 = f64::from(self.u[1][i]);
            let x2 = f64::from(self.u[2][i]);
            let y0 = f64::from(self.v[0][i]);
            let y1 = f64::from(self.v[1][i]);
            let y2 = f64::from(self.v[2][i]);
            let n0 = f64::from(self.nearness[0][i]);
            let n1 = f64::from(self.nearness[1][i]);
            let n2 = f64::from(self.nearness[2][i]);
            let (dx1, dy1, dn1) = (x1 - x0, y1 - y0, n1 - n0);
            let (dx2, dy2, dn2) = (x2 - x0, y2 - y0, n2 - n0);
            let scale = 1.0 / (dx1 * dy2 - dx2 * dy1);
            let a = (dn1 * dy2 - dn2 * dy1) * scale;
            let b = (dx1 * dn2 - dx2 * dn1) * scale;
            self.a[i] = a;
            self.b[i] = b;
            self.c[i] = n0 - (a * x0 + b * y0);
        }
        for i in 0..GROUP {
            let n = [self.nearness[0][i], self.nearness[1][i], self.nearness[2][i]];
            self.low[i] = least(n[0], least(n[1], n[2]));
            self.high[i] = most(n[0], most(n[1], n[2]));
        }
        for i in 0..GROUP {
            let (a, b, c) = (self.a[i], self.b[i], self.c[i]);
            let sound = (a.abs() < STEEPEST) & (b.abs() < STEEPEST) & (c.abs() < STEEPEST);
            let a = if sound { a } else { 0.0 };
            let b = if sound { b } else { 0.0 };
            let c = if sound { c } else { f64::from(self.high[i]) };
            self.a[i] = a;
            self.b[i] = b;
            self.c[i] = c;
            let (px, py) = (f64::from(self.x[i]) + 0.5, f64::from(self.y[i]) + 0.5);
            let (ax0, ax1) = (a * px, a * (px + 1.0));
            let (by0, by1) = (b * py + c, b * (py + 1.0) + c);
            self.texels[0][i] = (ax0 + by0) as f32;
            self.texels[1][i] = (ax1 + by0) as f32;
            self.texels[2][i] = (ax0 + by1) as f32;
            self.texels[3][i] = (ax1 + by1) as f32;
        }
        for k in 0..4 {
            for i in 0..GROUP {
                self.texels[k][i] = least(most(self.texels[k][i], self.low[i]), self.high[i]);
            }
        }
    }
}

/// Minimum of numbers that are not NaN: one instruction, unlike `f32::min`.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Maximum of numbers that are not NaN.
#[inline(always)]
fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn emit(
    source: &Source<'_>,
    first: usize,
    lanes: &Lanes,
    survivors: &Survivors,
    i: usize,
    bins: &mut Bins,
) {
    let grid = &source.grid;
    let lane = survivors.lane[i] as usize % LANES;
    let group = &survivors.groups[i / GROUP];
    let i = i % GROUP;
    let class = lanes.class[lane];
    let index = first + lane;
    let (x, y) = (group.x[i], group.y[i]);
    if class & TINY != 0 {
        let payload = source.payload.of(index, source.mesh.ids);
        let mut covered = class & TINY;
        while covered != 0 {
            let k = covered.trailing_zeros() as usize;
            covered &= covered - 1;
            let (x, y) = (x as u32 + (k as u32 & 1), y as u32 + (k as u32 >> 1));
            let texel = (y & ((1 << grid.shift) - 1)) * grid.width + x;
            let nearness = group.texels[k][i];
            bins.bands[(y >> grid.shift) as usize].fragments.push(Fragment {
                texel,
                nearness,
                payload,
            });
        }
        return;
    }
    let plane = Plane {
        a: group.a[i],
        b: group.b[i],
        c: group.c[i],
        low: group.low[i],
        high: group.high[i],
    };
    let payload = source.payload.of(index, source.mesh.ids);
    match class & SURVIVES {
        IS_SMALL => {
            let last_y = lanes.last_y[lane];
            let small = Small {
                x: x as u16,
                y: y as u16,
                last_x: lanes.last_x[lane] as u16,
                last_y: last_y as u16,
                edges: [0, 1, 2].map(|k| lanes.edges[k][lane] as i32 >> 8),
                step_x: [0, 1, 2].map(|k| lanes.step_x[k][lane] as i32 >> 8),
                step_y: [0, 1, 2].map(|k| lanes.step_y[k][lane] as i32 >> 8),
                plane,
                payload,
            };
            for band in y >> grid.shift..=last_y >> grid.shift {
                bins.bands[band as usize].small.push(small);
            }
        }
        IS_LARGE => {
            let corners = [0, 1, 2].map(|k| [group.u[k][i], group.v[k][i]]);
            if let Some(triangle) = Triangle::new(corners) {
                let large = Large { triangle, plane, payload };
                bins.stats.drawn += usize::from(bins.push_large(large, grid));
            }
        }
        _ => special(source, index, group, i, payload, bins),
    }
}

/// A triangle that needs clipping or has an alpha test.
#[inline(never)]
fn special(
    source: &Source<'_>,
    index: usize,
    group: &Group,
    i: usize,
    payload: u32,
    bins: &mut Bins,
) {
    // The outcodes that stand in v where u is NaN tell most of what is to know.
    let codes = [0, 1, 2].map(|k| if group.u[k][i].is_nan() { group.v[k][i].to_bits() } else { 0 });
    if (codes[0] | codes[1] | codes[2]) & INVALID != 0 {
        bins.stats.invalid += 1;
        return;
    }
    if codes[0] & codes[1] & codes[2] != 0 {
        bins.stats.clipped += 1;
        return;
    }
    let Some(vertices) = vertices(&source.projection, &source.mesh, source.mesh.triangles[index])
    else {
        bins.stats.invalid += 1;
        return;
    };
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
