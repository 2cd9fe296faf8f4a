//! The plane equation of one quantity over a triangle.

/// A quantity that is affine in texel coordinates, `a x + b y + c`, clamped to what the vertices
/// span: a sliver's gradient may be all rounding, its value at a texel is bounded all the same.
///
/// Double precision keeps the far end of a large triangle, whose near end may be a thousand times
/// nearer, exact to single precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
    pub(crate) low: f32,
    pub(crate) high: f32,
}

/// Gradients steeper than this are rounding, not geometry; bounded, they cannot overflow.
pub(crate) const STEEPEST: f32 = 1e30;

impl Plane {
    /// The plane through three points (x, y, value).
    pub(crate) fn through(points: [[f32; 3]; 3]) -> Plane {
        let [[x0, y0, n0], [x1, y1, n1], [x2, y2, n2]] = points.map(|p| p.map(f64::from));
        let (dx1, dy1, dn1) = (x1 - x0, y1 - y0, n1 - n0);
        let (dx2, dy2, dn2) = (x2 - x0, y2 - y0, n2 - n0);
        let scale = 1.0 / (dx1 * dy2 - dx2 * dy1);
        let a = (dn1 * dy2 - dn2 * dy1) * scale;
        let b = (dx1 * dn2 - dx2 * dn1) * scale;
        let c = n0 - (a * x0 + b * y0);
        let [n0, n1, n2] = points.map(|p| p[2]);
        Plane { a, b, c, low: n0.min(n1).min(n2), high: n0.max(n1).max(n2) }.or_flat()
    }

    /// The plane itself, or a flat one at its high value if it is too steep to mean anything.
    pub(crate) fn or_flat(self) -> Plane {
        // Written so that a NaN counts as steep.
        let sound = [self.a, self.b, self.c].iter().all(|&x| (x as f32).abs() < STEEPEST);
        if sound { self } else { Plane { a: 0.0, b: 0.0, c: f64::from(self.high), ..self } }
    }

    /// The value at the centre of texel (x, y).
    #[inline(always)]
    pub(crate) fn at(&self, x: i32, y: i32) -> f32 {
        let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let value = (self.a * px + (self.b * py + self.c)) as f32;
        value.max(self.low).min(self.high)
    }
}
