//! Casters with holes: the alpha test.

use core::fmt;

/// An alpha test for some of a mesh's triangles.
///
/// `keep(triangle, b1, b2)` is asked for every texel centre of a flagged triangle, with the
/// perspective-correct weights of the triangle's second and third vertex (each in \[0, 1\]; the
/// first one's is `1 - b1 - b2`). Where it says no, the texel is as if the triangle had a hole
/// there. It may be called from several threads, in any order, also for texels where something else
/// is nearer; so it must be a pure function.
#[derive(Clone, Copy)]
pub struct AlphaMask<'a> {
    /// Which triangles are tested. Triangles past the end are opaque.
    pub masked: &'a [bool],
    /// Whether the caster is there.
    pub keep: &'a (dyn Fn(usize, f32, f32) -> bool + Sync),
}

impl fmt::Debug for AlphaMask<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AlphaMask").field("masked", &self.masked).finish_non_exhaustive()
    }
}

impl AlphaMask<'_> {
    pub(crate) fn is_masked(&self, triangle: usize) -> bool {
        self.masked.get(triangle).copied().unwrap_or(false)
    }
}

/// The perspective-correct weights of a triangle's vertices as a function of the texel: rows of
/// the inverse of its homogeneous vertex matrix (Olano and Greer 1997), so that vertices behind
/// the viewer do no harm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    rows: [[f64; 3]; 3],
}

impl Weights {
    /// From the rows (U, V, N, Q) of three vertices.
    pub(crate) fn of(vertices: [[f32; 4]; 3]) -> Weights {
        let [a, b, c] = vertices.map(|[u, v, _, q]| [f64::from(u), f64::from(v), f64::from(q)]);
        let cross = |p: [f64; 3], q: [f64; 3]| {
            [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
        };
        Weights { rows: [cross(b, c), cross(c, a), cross(a, b)] }
    }

    /// The weights of the second and third vertex at the centre of texel (x, y). Of a triangle seen
    /// edge-on both are 0.
    pub(crate) fn at(&self, x: i32, y: i32) -> [f32; 2] {
        let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let [w0, w1, w2] = self.rows.map(|r| (r[0] * px + r[1] * py) + r[2]);
        let sum = (w0 + w1) + w2;
        if sum == 0.0 { [0.0; 2] } else { [w1, w2].map(|w| ((w / sum) as f32).clamp(0.0, 1.0)) }
    }
}
