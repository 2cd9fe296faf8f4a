//! Closed forms of the disc that a light appears as.

use crate::math::sqrt;

/// The fraction of a disc of radius 1 on the near side of a straight line, `s` in front of its
/// centre: `0.5 + (asin s + s sqrt(1 - s²)) / pi`, the "sinusoid" that Brabec and Seidel 2002
/// hoped for in section 6. 0 for s <= -1, 1 for s >= 1 and for NaN.
///
/// Computed as `1 - (1 - s)^1.5 P(s)` on \[0, 1\], within 5e-7.
#[inline(always)]
pub(crate) fn disc_fraction(s: f32) -> f32 {
    let s = if s < 1.0 { s } else { 1.0 };
    let s = if s > -1.0 { s } else { -1.0 };
    let a = s.abs();
    let p = 0.005_335_016_4 + a * -0.001_268_898_9;
    let p = -0.017_241_514 + a * p;
    let p = 0.113_365_86 + a * p;
    let p = 0.5 + a * p;
    let rest = 1.0 - a;
    let beyond = (rest * sqrt(rest)) * p;
    if s < 0.0 { beyond } else { 1.0 - beyond }
}

/// The angle of the vector (x, y) from the x axis, for y >= 0: in \[0, pi\], within 3e-6. NaN for
/// (0, 0).
#[inline(always)]
pub(crate) fn angle(y: f32, x: f32) -> f32 {
    let flat = x.abs();
    let steep = y > flat;
    let (small, large) = if steep { (flat, y) } else { (y, flat) };
    let q = small / large;
    let t = q * q;
    let p = 0.052_647_325 + t * -0.011_719_127;
    let p = -0.116_426_453 + t * p;
    let p = 0.193_540_36 + t * p;
    let p = -0.332_622_82 + t * p;
    let p = 0.999_977_22 + t * p;
    let p = p * q;
    let p = if steep { core::f32::consts::FRAC_PI_2 - p } else { p };
    if x < 0.0 { core::f32::consts::PI - p } else { p }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disc_fraction_is_the_circular_segment() {
        for i in -1100..=1100 {
            let s = f64::from(i) / 1000.0;
            let c = s.clamp(-1.0, 1.0);
            let exact = 0.5 + (c.asin() + c * (1.0 - c * c).sqrt()) / core::f64::consts::PI;
            assert!((f64::from(disc_fraction(s as f32)) - exact).abs() < 5e-7, "at {s}");
        }
        assert_eq!(disc_fraction(0.0), 0.5);
        assert_eq!((disc_fraction(-1.0), disc_fraction(1.0)), (0.0, 1.0));
        assert_eq!((disc_fraction(f32::NEG_INFINITY), disc_fraction(f32::NAN)), (0.0, 1.0));
    }

    #[test]
    fn angle_is_the_arc_tangent() {
        for i in 0..=1000 {
            let exact = f64::from(i) * core::f64::consts::PI / 1000.0;
            let (y, x) = (exact.sin().max(0.0), exact.cos());
            for scale in [1e-10, 1.0, 1e10] {
                let found = angle((y * scale) as f32, (x * scale) as f32);
                assert!((f64::from(found) - exact).abs() < 3e-6, "at {exact}: {found}");
            }
        }
    }
}
