//! How far in front of a receiver a texel must be to block it.

use crate::LightPoint;

/// The tolerance of a shadow test, relative to the receiver's own plane.
///
/// A receiver brings its tangent plane ([`LightPoint`]), so the test compares each texel with the
/// plane *at that texel's centre*. What remains to tolerate is rounding (`constant`) and the
/// part of the receiver's plane that a texel's footprint spans (`slope`). Neither needs tuning on
/// ordinary scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// Relative to the receiver's nearness.
    pub constant: f32,
    /// In texels, times the slope of the receiver's plane.
    pub slope: f32,
}

impl Default for Bias {
    fn default() -> Self {
        Bias { constant: 1.0 / 8192.0, slope: 0.5 }
    }
}

impl Bias {
    /// By how much nearness must exceed the receiver's plane to block `point`.
    #[must_use]
    pub fn offset(&self, point: &LightPoint) -> f32 {
        self.constant * point.nearness + self.slope * (point.slope.x.abs() + point.slope.y.abs())
    }
}
