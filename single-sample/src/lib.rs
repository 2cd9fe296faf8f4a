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
//! [`paper`] is that method with the authors' own parameters, plain and scalar.
//!
//! [`search`] is the same idea with one physical parameter, the size of the light, and without the
//! method's known errors. Its differences to the paper:
//!
//! * The penumbra's width follows from the light's radius and each blocker's depth, and the
//!   reach of a search from the nearest depth around it, instead of `r_scale`, `r_bias` and
//!   `r_shrink` (the future work of section 6).
//! * Not only the nearest point of the shadow's edge counts but all of it within reach: corners,
//!   curves, thin blockers and overlapping penumbrae need no cases of their own, and there is no
//!   ring and no step where the nearest blocker changes.
//! * Texels are compared with the receiver's tangent plane instead of object IDs, and close to the
//!   receiver it with theirs. Objects shadow themselves softly, without acne, and shadows are right
//!   up to the feet of what stands on the ground.
//! * What the receiver's own horizon hides is exact.
//!
//! Error against ray tracing with 4096 rays (penumbra RMSE; camera 512², map 1024²; scenes of the
//! workspace):
//!
//! | scene, radius | [`search`] | [`paper`], map 256² |
//! |---|---|---|
//! | one rectangle, 0.5 m | 0.006 | 0.14 |
//! | torus, 0.5 m | 0.008 | 0.17 |
//! | torus, 0.1 m | 0.019 | 0.27 |
//! | 21 objects, 0.5 m | 0.016 | 0.27 |
//!
//! Everything is plain slices: whoever has depth maps from elsewhere describes them with a
//! [`View`](shadowmap_core::View) each and needs no rasterizer of ours. Nothing is allocated.
//!
//! ```
//! use glam::Vec3;
//! use shadowmap_core::{DepthMap, Level, Threads, View};
//! use simd_search::{NodeGroup, Pyramid};
//! use single_sample::{Camera, LightMap, Surfaces, Texels, paper, search};
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
//!
//! // The faster and better search wants a pyramid over the light's map.
//! let level = Level::detect();
//! let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(8, 8)];
//! let pyramid = Pyramid::build(level, map, &mut nodes, &mut [])?;
//! let parameters = search::Parameters { radius: 0.1, ..Default::default() };
//! search::visibility(level, Threads::One, &camera, &light, &pyramid, &parameters, &mut mask);
//! assert_eq!(mask, [255; 64]);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! # Features
//!
//! | feature | default | meaning |
//! |---|---|---|
//! | `std` | yes | SIMD levels are detected at run time |
//! | `libm` | no | mathematics for targets without `std`; one of the two is needed |
//! | `rayon` | no | rows of tiles run on rayon's thread pool |
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

/// The crates whose views, maps, levels and pyramids are taken here, in the versions that take
/// them.
pub use {shadowmap_core, simd_search};

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
