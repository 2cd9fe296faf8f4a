//! Coverage and plane equations of as many triangles at a time as a vector has lanes.

use crate::bins::Grid;
use crate::coverage::{SNAP_SHIFT, SUBTEXELS};
use crate::plane::STEEPEST;
use crate::project::GUARD;
use crate::simd::{MAX_LANES, Simd};

/// Below this width and height, in 1/256 texel, a triangle is small: its bounds are a few vectors
/// wide, and its edge functions fit into 32 bits.
const fn small<S: Simd>() -> i32 {
    4 * S::LANES as i32 * SUBTEXELS
}

/// The most columns and rows of a triangle that becomes fragments while it is binned: the fewer
/// lanes share the work of one texel, the sooner it is left to the next stage.
pub(crate) const fn tiny<S: Simd>() -> usize {
    if S::LANES > 4 { 4 } else { 2 }
}

/// What all views beside each other share of a vector of triangles: rows and nearness.
#[derive(Clone, Copy)]
pub(crate) struct Shared<S: Simd> {
    /// U of the corners without its constant, and 1 / Q.
    across: [S::F; 3],
    scale: [S::F; 3],
    /// The bounds: first and last row, and how many 1/256 texels lie between the corners.
    y: [S::I; 2],
    height: S::I,
    /// Relative to the centre of the first row, and the extent of each edge.
    vs: [S::I; 2],
    dy: [S::I; 3],
    /// v and nearness of the first corner, and from there to the others.
    start: [S::D; 2],
    to: [[S::D; 2]; 2],
    /// The numerator of the plane's gradient along a row.
    slope: S::D,
    low: S::F,
    high: S::F,
}

impl<S: Simd> Shared<S> {
    /// From what is known of the three corners, see [`crate::vertices::Seen`].
    #[inline(always)]
    pub(crate) fn of(s: S, [a, b, c]: [[S::F; 4]; 3], grid: &Grid) -> Shared<S> {
        let vs = [snap(s, a[2]), snap(s, b[2]), snap(s, c[2])];
        let (y, [low, high]) = bounds(s, vs, grid.height);
        let [v, near] = [s.d_from_f(a[2]), s.d_from_f(a[3])];
        let [dy1, dn1] = [s.sub_d(s.d_from_f(b[2]), v), s.sub_d(s.d_from_f(b[3]), near)];
        let [dy2, dn2] = [s.sub_d(s.d_from_f(c[2]), v), s.sub_d(s.d_from_f(c[3]), near)];
        Shared {
            across: [a[0], b[0], c[0]],
            scale: [a[1], b[1], c[1]],
            y,
            height: s.sub_i(high, low),
            vs: relative(s, vs, y[0]),
            dy: [s.sub_i(vs[1], vs[0]), s.sub_i(vs[2], vs[1]), s.sub_i(vs[0], vs[2])],
            start: [v, near],
            to: [[dy1, dn1], [dy2, dn2]],
            slope: cross(s, dn1, dy2, dn2, dy1),
            low: s.min_f(s.min_f(a[3], b[3]), c[3]),
            high: s.max_f(s.max_f(a[3], b[3]), c[3]),
        }
    }

    /// Lanes with a corner whose index is out of range, or whose U is not a number.
    #[inline(always)]
    pub(crate) fn invalid(&self, s: S) -> u32 {
        let [a, b, c] = self.across;
        // Infinities of both signs add up to NaN, too, and are as invalid.
        let sum = s.add_f(s.add_f(a, b), c);
        !s.bits(s.equal_f(sum, sum))
    }

    /// u of the corners in the view whose U has this constant.
    #[inline(always)]
    pub(crate) fn us(&self, s: S, constant: f32) -> [S::F; 3] {
        let constant = s.splat_f(constant);
        let mut us = self.across;
        for (u, scale) in us.iter_mut().zip(self.scale) {
            *u = s.mul_f(s.add_f(*u, constant), scale);
        }
        us
    }
}

/// A vector of triangles in one view, snapped, and what they cover.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    /// The bounds: first and last column, first and last row.
    pub(crate) x: [S::I; 2],
    pub(crate) y: [S::I; 2],
    /// The edge functions at the centre of the first texel, less 1 where they do not own it.
    pub(crate) edges: [S::I; 3],
    /// The extent of each edge.
    pub(crate) delta: [[S::I; 2]; 3],
    /// Less than [`small`], with an area and something in the bounds.
    pub(crate) drawn: u32,
    /// Of these, those with bounds of at most [`tiny`] columns and rows.
    pub(crate) tiny: u32,
    /// Those with larger bounds.
    pub(crate) small: u32,
    /// Not small, with something in the bounds.
    pub(crate) large: u32,
    /// With a vertex that needs clipping.
    pub(crate) special: u32,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn cover(
        s: S,
        shared: &Shared<S>,
        us: [S::F; 3],
        wanted: u32,
        grid: &Grid,
    ) -> Lanes<S> {
        let us = [snap(s, us[0]), snap(s, us[1]), snap(s, us[2])];
        let (x, [low, high]) = bounds(s, us, grid.width);
        let width = s.sub_i(high, low);
        // Beyond the guard band, or a NaN, which snaps to what lies further out.
        let guard = GUARD as i32 * SUBTEXELS;
        let special =
            s.or_m(s.greater_i(high, s.splat_i(guard - 1)), s.greater_i(s.splat_i(1 - guard), low));
        let special = s.bits(special);
        let (y, vs) = (shared.y, shared.vs);
        let empty = s.or_m(s.greater_i(x[0], x[1]), s.greater_i(y[0], y[1]));
        let in_bounds = wanted & !s.bits(empty) & !special;
        // What overflows from here on is not small.
        let (zero, one) = (s.splat_i(0), s.splat_i(1));
        let [dy0, dy1, dy2] = shared.dy;
        let mut delta = [
            [s.sub_i(us[1], us[0]), dy0],
            [s.sub_i(us[2], us[1]), dy1],
            [s.sub_i(us[0], us[2]), dy2],
        ];
        // Wound so that the edge functions are positive inside; (dx, dy) of edge 2 points back to
        // vertex 0, whence the order of the products.
        let area = s.sub_i(s.mul_i(delta[2][0], delta[0][1]), s.mul_i(delta[0][0], delta[2][1]));
        let reversed = s.greater_i(zero, area);
        let us = relative(s, us, x[0]);
        let mut edges = [s.select_i(reversed, s.sub_i(zero, area), area); 3];
        for k in 0..3 {
            for extent in &mut delta[k] {
                *extent = s.select_i(reversed, s.sub_i(zero, *extent), *extent);
            }
            // At any point the three add up to the area.
            edges[k] = if k < 2 {
                let [dx, dy] = delta[k];
                s.sub_i(s.mul_i(dy, us[k]), s.mul_i(dx, vs[k]))
            } else {
                s.sub_i(s.sub_i(edges[2], edges[0]), edges[1])
            };
        }
        for (edge, [dx, dy]) in edges.iter_mut().zip(delta) {
            // An edge owns its centres if it leads up, or is level and leads to the right.
            let foreign = s.not_negative(s.sub_i(s.shift_left::<16>(dy), dx));
            *edge = s.select_i(foreign, s.sub_i(*edge, one), *edge);
        }
        let tiny = s.splat_i(tiny::<S>() as i32);
        let is_tiny =
            s.and_m(s.greater_i(tiny, s.sub_i(x[1], x[0])), s.greater_i(tiny, s.sub_i(y[1], y[0])));
        let is_tiny = s.bits(is_tiny);
        let limit = s.splat_i(small::<S>());
        let is_small =
            s.bits(s.and_m(s.greater_i(limit, width), s.greater_i(limit, shared.height)));
        let is_small = if (grid.width as usize) < MAX_LANES { 0 } else { is_small };
        let flat = !s.bits(s.or_m(reversed, s.greater_i(area, zero)));
        let drawn = in_bounds & is_small & !flat;
        Lanes {
            x,
            y,
            edges,
            delta,
            tiny: drawn & is_tiny,
            small: drawn & !is_tiny,
            large: in_bounds & !is_small,
            special: special & wanted,
            drawn,
        }
    }
}

/// The lanes in which no edge function is negative.
#[inline(always)]
pub(crate) fn inside<S: Simd>(s: S, [a, b, c]: [S::I; 3]) -> u32 {
    s.bits(s.not_negative(s.or_i(s.or_i(a, b), c)))
}

/// Snapped coordinates relative to the centre of a texel.
#[inline(always)]
fn relative<S: Simd>(s: S, [a, b, _]: [S::I; 3], texel: S::I) -> [S::I; 2] {
    let center = s.add_i(s.shift_left::<8>(texel), s.splat_i(SUBTEXELS / 2));
    [s.sub_i(a, center), s.sub_i(b, center)]
}

/// [`crate::coverage::snap`].
#[inline(always)]
fn snap<S: Simd>(s: S, a: S::F) -> S::I {
    let shifted = s.add_f(s.mul_f(a, s.splat_f(SUBTEXELS as f32)), s.splat_f(SNAP_SHIFT));
    s.sub_i(s.i_from_bits(shifted), s.splat_i(SNAP_SHIFT.to_bits() as i32))
}

/// First and last texel along one axis, as [`crate::coverage::centers_between`], and the least and
/// the greatest coordinate.
#[inline(always)]
fn bounds<S: Simd>(s: S, [a, b, c]: [S::I; 3], size: u32) -> ([S::I; 2], [S::I; 2]) {
    const HALF: i32 = SUBTEXELS / 2;
    let (low, high) = (s.min_i(s.min_i(a, b), c), s.max_i(s.max_i(a, b), c));
    let first = s.shift_right::<8>(s.add_i(low, s.splat_i(HALF - 1)));
    let last = s.shift_right::<8>(s.sub_i(high, s.splat_i(HALF)));
    let bounds = [s.max_i(first, s.splat_i(0)), s.min_i(last, s.splat_i(size as i32 - 1))];
    (bounds, [low, high])
}

/// Plane equations side by side.
#[derive(Clone, Copy)]
pub(crate) struct Planes<S: Simd> {
    pub(crate) a: S::D,
    pub(crate) b: S::D,
    pub(crate) c: S::D,
    pub(crate) low: S::F,
    pub(crate) high: S::F,
    /// Which of them mean something.
    pub(crate) sound: u32,
}

impl<S: Simd> Planes<S> {
    /// [`Plane::through`], in the same order of operations. Of the `wanted` lanes it is said which
    /// are sound; `harmless` is [`harmless_scale`] of the view.
    #[inline(always)]
    pub(crate) fn through(
        s: S,
        shared: &Shared<S>,
        us: [S::F; 3],
        wanted: u32,
        harmless: f32,
    ) -> Planes<S> {
        let (x0, [y0, n0]) = (s.d_from_f(us[0]), shared.start);
        let dx1 = s.sub_d(s.d_from_f(us[1]), x0);
        let dx2 = s.sub_d(s.d_from_f(us[2]), x0);
        let [[dy1, dn1], [dy2, dn2]] = shared.to;
        let scale = s.div_d(s.splat_d(1.0), cross(s, dx1, dy2, dx2, dy1));
        let a = s.mul_d(shared.slope, scale);
        let b = s.mul_d(cross(s, dx1, dn2, dx2, dn1), scale);
        let c = s.sub_d(n0, s.add_d(s.mul_d(a, x0), s.mul_d(b, y0)));
        let mut sound = are_below(s, scale, harmless);
        if wanted & !sound != 0 {
            sound = [a, b, c].iter().fold(!0, |all, &x| all & are_below(s, x, STEEPEST));
        }
        Planes { a, b, c, low: shared.low, high: shared.high, sound }
    }
}

/// A limit to the reciprocals of determinants, below which every plane of a view is sound: saves to
/// look at three numbers where one will do.
///
/// Extents are at most 2^15 texels and differences of nearness, up to rounding, `max_nearness`. So
/// gradients stay below 2^17 `max_nearness` times the reciprocal, and what they add up to over 2^15
/// texels below a quarter of [`STEEPEST`].
pub(crate) fn harmless_scale(max_nearness: f32) -> f32 {
    const TEXELS: f32 = (1_u64 << 34) as f32;
    if max_nearness < 0.1 * STEEPEST { STEEPEST / TEXELS / max_nearness } else { 0.0 }
}

/// `a b - c d`.
#[inline(always)]
fn cross<S: Simd>(s: S, a: S::D, b: S::D, c: S::D, d: S::D) -> S::D {
    s.sub_d(s.mul_d(a, b), s.mul_d(c, d))
}

/// The lanes of a size below `limit`.
#[inline(always)]
fn are_below<S: Simd>(s: S, a: S::D, limit: f32) -> u32 {
    let a = s.f_from_d(a);
    s.bits(s.and_m(s.less_f(a, s.splat_f(limit)), s.less_f(s.splat_f(-limit), a)))
}
