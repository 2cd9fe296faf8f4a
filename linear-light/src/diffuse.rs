//! The light that a diffuse surface receives from an unshadowed linear light, in closed form.

use glam::{DVec2, Vec3};

/// The mean over a linear light from `a` to `b` of `max(0, cos) / distance²`, as a surface at
/// `position` with unit `normal` receives it: what a point light of the same intensity gives with
/// `max(0, cos) / distance²` alone. In 1 / metres².
///
/// The light shines alike in all directions (Poulin and Amanatides, *Shading and shadowing with
/// linear light sources*, Eurographics 1990); what is below the surface's horizon adds nothing.
/// Multiply by the visibility for a shadowed one. 0 where the result would not be finite.
///
/// ```
/// use glam::Vec3;
/// // A very short light is a point: 1 / (2 metres)².
/// let light = (Vec3::new(-0.001, 2.0, 0.0), Vec3::new(0.001, 2.0, 0.0));
/// let received = linear_light::diffuse(Vec3::ZERO, Vec3::Y, light.0, light.1);
/// assert!((received - 0.25).abs() < 1e-5);
/// ```
#[must_use]
pub fn diffuse(position: Vec3, normal: Vec3, a: Vec3, b: Vec3) -> f32 {
    let [p, n, a, b] = [position, normal, a, b].map(Vec3::as_dvec3);
    let (to_a, along) = (a - p, b - a);
    let length = along.length();
    let received = if length > 0.0 {
        // Along the light from the point nearest to the receiver: n . l = alpha + beta s.
        let axis = along / length;
        let start = to_a.dot(axis);
        let across = to_a - axis * start;
        let (distance, alpha, beta) = (across.length(), n.dot(across), n.dot(axis));
        let horizon = -alpha / beta;
        let (mut low, mut high) = (start, start + length);
        if beta > 0.0 {
            low = low.max(horizon);
        } else if beta < 0.0 {
            high = high.min(horizon);
        } else if alpha <= 0.0 {
            high = low;
        }
        // The integral of (alpha + beta s) / (distance² + s²)^(3/2).
        let integral = |s: f64| {
            let far = DVec2::new(distance, s).length();
            let facing =
                if distance > 0.0 { alpha / distance * (s / (distance * far)) } else { 0.0 };
            facing - beta / far
        };
        if low < high { (integral(high) - integral(low)) / length } else { 0.0 }
    } else {
        let far = to_a.length();
        n.dot(to_a).max(0.0) / (far * far * far)
    };
    let received = received.max(0.0) as f32;
    if received.is_finite() { received } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn above_a_ground_on_paper() {
        // From (-1, 1) to (1, 1) above the origin: 1/2 of the integral of (1 + s²)^(-3/2).
        let found = diffuse(Vec3::ZERO, Vec3::Y, Vec3::new(-1., 1., 0.), Vec3::new(1., 1., 0.));
        assert!((found - core::f32::consts::FRAC_1_SQRT_2).abs() < 1e-6);
        let below = diffuse(Vec3::ZERO, Vec3::NEG_Y, Vec3::new(-1., 1., 0.), Vec3::new(1., 1., 0.));
        assert_eq!(below, 0.0);
    }

    proptest! {
        #[test]
        fn is_the_mean_of_many_points(v in proptest::array::uniform9(-3.0_f32..3.0)) {
            let (n, a, b) = (Vec3::from_slice(&v), Vec3::from_slice(&v[3..]), Vec3::from_slice(&v[6..]));
            prop_assume!(n.length() > 0.1 && a.distance(b) > 0.1);
            let n = n.normalize();
            let point = |i: u16| a + (b - a) * ((f32::from(i) + 0.5) / 4096.0);
            prop_assume!((0..4096).all(|i| point(i).length() > 0.2));
            let at = |i: u16| f64::from(n.dot(point(i)).max(0.0) / point(i).length().powi(3));
            let mean = (0..4096).map(at).sum::<f64>() / 4096.0;
            let found = f64::from(diffuse(Vec3::ZERO, n, a, b));
            prop_assert!((found - mean).abs() < 1e-3 * (mean + 0.1), "{found} {mean}");
        }

        #[test]
        fn any_floats(v in proptest::array::uniform12(any::<f32>())) {
            let at = |i: usize| Vec3::from_slice(&v[3 * i..]);
            prop_assert!(diffuse(at(0), at(1), at(2), at(3)) >= 0.0);
        }
    }
}
