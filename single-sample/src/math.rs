//! The one function that `core` lacks; correctly rounded, hence the same bits, in both versions.

/// The square root.
#[cfg(feature = "std")]
pub(crate) fn sqrt(x: f32) -> f32 {
    x.sqrt()
}

/// The square root.
#[cfg(not(feature = "std"))]
pub(crate) fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}
