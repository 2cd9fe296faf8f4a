//! Soft shadows from a single sample of the light: Brabec and Seidel, *Single Sample Soft Shadows
//! using Depth Maps*, Graphics Interface 2002.
//!
//! The method, in short:
//!
//! 1. Draw a depth + object-ID map from the light's centre, and one from the camera.
//! 2. Warp every camera pixel into the light's map. If the texel there is nearer to the light,
//!    the pixel is in the hard shadow ("inner"), else it is lit ("outer").
//! 3. Search the neighbourhood of that texel for the nearest blocker (outer), or for the nearest
//!    texel where the light sees the receiver (inner).
//! 4. The distance to it, relative to the width of the penumbra, is the visibility: 0.5 on the
//!    hard edge, rising to 1 outside and falling to 0 inside.
//! 5. The width of the penumbra follows from the depths of blocker and receiver.
//!
//! [`paper`] is that method with the authors' own parameters.
//!
//! Everything is plain slices: whoever has depth maps from elsewhere describes them with a
//! [`View`](shadowmap_core::View) each and needs no rasterizer of ours. Nothing is allocated.
//!
//! ```
//! use glam::Vec3;
//! use shadowmap_core::{DepthMap, Threads, View};
//! use single_sample::{Camera, LightMap, Surfaces, Texels, paper};
//!
//! // A camera and a light, both 4 m above a ground that both see everywhere.
//! let view = View::perspective(Vec3::Y * 4.0, Vec3::ZERO, Vec3::Z, 1.0, 8, 8, 0.1);
//! let (nearness, ids) = ([0.25; 64], [1; 64]);
//! let map = DepthMap::new(8, 8, &nearness, &ids)?;
//! let camera = Camera::new(&view, map, Surfaces::FromDepth)?;
//! let light = LightMap::new(&view, Texels::Plain(map))?;
//!
//! let mut mask = [0_u8; 64];
//! paper::visibility(&camera, &light, &paper::Parameters::default(), Threads::One, &mut mask);
//! assert_eq!(mask, [255; 64]);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
#![no_std]
#![deny(unsafe_code)]

#[cfg(any(feature = "std", test))]
extern crate std;

mod camera;
mod counters;
mod disc;
mod mask;
mod math;
pub mod paper;
mod receiver;
pub mod search;

pub use camera::{LightMap, Texels};
pub use counters::Counters;
pub use mask::{Found, Visibility};
pub use shadowmap_core::{Camera, SizeError, Surface, Surfaces};
