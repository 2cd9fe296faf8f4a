//! The vocabulary of the soft-shadow crates.
//!
//! Every crate of the workspace speaks in these terms, and nothing here draws or searches:
//!
//! * [`View`]: where a depth map is taken from, for lights and cameras alike, perspective,
//!   orthographic and off-axis.
//! * [`DepthMap`] and [`PackedMap`]: borrowed depth + object-ID maps. They hold **nearness**, the
//!   one quantity that is affine in the image for every projection (see [`View`]).
//! * [`Light`]: point, sphere, sun, linear, triangle, rectangle.
//! * [`LightPoint`]: a receiver as a light's map sees it, position and tangent plane, and the
//!   [`Bias`] that needs no tuning.
//! * [`Camera`] and [`Warp`]: the receivers as a camera sees them, and their way into a light's
//!   map.
//! * [`Level`]: which SIMD instructions this machine has.
//! * [`Threads`] and [`for_each_band`]: work split into bands of rows that never share one, with
//!   memory per thread [`for_each_band_with`]; [`both`]: two stages side by side.
//!
//! # Conventions
//!
//! Right-handed world, y up, metres, radians. Texel (0, 0) is at the top left of a map, its centre
//! at (0.5, 0.5); maps are row-major. Object ID 0 is "nothing". Visibility is the fraction of the
//! light that a point sees, in \[0, 1\].
//!
//! # Same bits everywhere
//!
//! What decides a pixel uses IEEE add, subtract, multiply, divide and square root only, in one
//! written order, without fused multiply-add; trigonometry comes from the `libm` crate on every
//! target. So results are identical on every machine.
//!
//! # Features
//!
//! | feature | default | meaning |
//! |---|---|---|
//! | `std` | yes | SIMD levels are detected at run time |
//! | `libm` | no | mathematics for targets without `std`; one of the two is needed |
//! | `rayon` | no | bands run on rayon's thread pool |
#![no_std]
#![deny(unsafe_code)]

#[cfg(feature = "std")]
extern crate std;

mod bands;
mod bias;
mod camera;
mod depth;
mod fit;
mod from_depth;
mod level;
mod light;
mod map;
mod mesh;
mod receiver;
mod view;
mod warp;

pub use bands::{BandSlice, Bands, Threads, both, for_each_band, for_each_band_with};
pub use bias::Bias;
pub use camera::{Camera, SizeError, Surface, Surfaces};
pub use depth::{DepthConvention, ForeignDepth};
pub use fit::{Extents, ImagePoint, Spread, fit_extents};
pub use level::{Level, LevelKind};
pub use light::Light;
pub use map::{DepthMap, MapError, PackedMap};
pub use mesh::Mesh;
pub use receiver::{HardShadow, LightPoint, hard_shadow};
pub use view::{Projection, View, Window};
pub use warp::{Plane, Warp};

/// The version of glam whose vectors and matrices all crates of the workspace take.
pub use glam;

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
