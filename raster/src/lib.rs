//! Triangles to depth + payload maps: exact, the same bits at every SIMD level, with any number
//! of threads and in any order of the triangles.
//!
//! A map holds, for every texel, the *nearness* (see [`View`]) of the nearest triangle at the
//! texel's centre and a 32-bit payload: the object ID for light maps, the triangle index for a
//! camera pass ([`Payload`]). It knows no shadows.
//!
//! # Method
//!
//! 1. Every vertex is transformed once by the view's rows to homogeneous texel space.
//! 2. A triangle that crosses the near plane, or leaves a guard band of ±16384 texels, is clipped
//!    in homogeneous space.
//! 3. Coverage is exact: vertices are snapped to 1/256 texel (24.8 fixed point), edge functions are
//!    integers, and the top-left rule gives each texel on a shared edge to one triangle. Back faces
//!    are kept, since shadow casters are two-sided.
//! 4. Nearness is one plane equation in texel coordinates, taken from the *unsnapped* vertices in
//!    double precision and clamped to what the vertices span.
//! 5. Greater nearness wins; equal nearness goes to the smaller payload. So the order of triangles
//!    never matters, and rows can be shared out among threads.
//!
//! [`draw_plain`] does this in the most obvious way and is the specification of [`Rasterizer`].
//!
//! ```
//! use glam::Vec3;
//! use raster::{DepthBuffer, Payload, Rasterizer};
//! use shadowmap_core::{Level, Mesh, Threads, View};
//!
//! let positions = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(3.0, -1.0, 0.0), Vec3::new(-1.0, 3.0, 0.0)];
//! let mesh = Mesh { positions: &positions, triangles: &[[0, 1, 2]], ids: &[7] };
//! let view = View::perspective(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, Vec3::Y, 0.8, 64, 64, 0.1);
//! let mut map = DepthBuffer::new(64, 64);
//! let mut rasterizer = Rasterizer::new(Level::detect(), Threads::One);
//! rasterizer.draw(&view, &mesh, Payload::ObjectId, map.target());
//! assert_eq!(map.payload[0], 7);
//! assert_eq!(map.nearness[0], 0.5); // 2 metres away
//! ```
//!
//! # Features
//!
//! | feature | default | meaning |
//! |---|---|---|
//! | `std` | yes | SIMD levels are detected at run time |
//! | `libm` | no | mathematics for targets without `std`; one of the two is needed |
//! | `rayon` | no | bands of rows run on rayon's thread pool |
//!
//! [`View`]: shadowmap_core::View
#![no_std]
#![deny(unsafe_code)]

extern crate alloc;

mod ahead;
mod band;
mod binning;
mod bins;
mod clip;
mod coverage;
mod lanes;
mod line;
mod map;
mod mask;
mod plain;
mod plane;
mod project;
mod rasterizer;
mod simd;
mod skins;
mod small;
mod span;
mod strips;
mod texels;
mod tiny;
mod vertices;

pub use map::{DepthBuffer, DrawStats, Payload, Target};
pub use mask::AlphaMask;
pub use plain::draw_plain;
pub use rasterizer::Rasterizer;
pub use skins::{SkinVertex, draw_skins};
pub use texels::Texels;

/// The crate whose views, maps and levels are taken here, in the version that takes them.
pub use shadowmap_core;

/// The largest width and height of a map, in texels.
pub const MAX_SIZE: u32 = 16384;

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
