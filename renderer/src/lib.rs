//! From a scene to a picture with soft shadows, without a GPU: the library behind the program
//! `penumbra`.
//!
//! Data flows in one direction, and each stage is a module:
//!
//! 1. [`scene`]: triangles, materials, lights and a camera; from a file or from [`builtin`].
//! 2. [`prepared`]: the tables that every frame looks things up in.
//! 3. [`camera`] and [`lighting`]: where the picture is taken from, which method draws each light,
//!    and where its depth maps are taken from ([`light_views`]).
//! 4. [`frame`]: the camera's pass, the depth maps, the visibility of every light from every
//!    pixel, and the picture. A [`frame::Frame`] keeps its memory from frame to frame.
//!
//! The number of threads and the SIMD level never change a bit of a result.
//!
//! ```
//! use renderer::camera::{CameraOptions, choose, view};
//! use renderer::frame::{Frame, Goal, Shot};
//! use renderer::lighting::{LightJob, LightOptions};
//! use renderer::prepared::Prepared;
//! use shadowmap_core::{Level, Threads};
//!
//! let scene = renderer::builtin::scene("torus").unwrap();
//! let prepared = Prepared::new(&scene);
//! let camera = choose(&scene, &CameraOptions::default())?;
//! let view = view(&camera, [64, 64], prepared.bounds());
//! let options = LightOptions { map_size: 128, ..LightOptions::default() };
//! let light = LightJob::new(&scene.lights[0], &options, &prepared, &view)?;
//!
//! let mut frame = Frame::new(Level::detect(), Threads::One);
//! let (lights, aa, tracer) = (&[light], 1, None);
//! let (prepared, camera, goal) = (&prepared, &view, Goal::Srgb);
//! frame.render(&Shot { prepared, camera, aa, lights, tracer, goal });
//! assert_eq!(frame.srgb().len(), 64 * 64 * 3);
//! # Ok::<(), renderer::Error>(())
//! ```
#![deny(unsafe_code)]

mod backdrops;
pub mod builtin;
pub mod camera;
#[cfg(feature = "program")]
pub mod cli;
#[cfg(feature = "program")]
pub mod compare;
pub mod cover;
pub mod default_light;
mod drawing;
mod emitters;
mod error;
mod faces;
mod facet;
pub mod frame;
mod hull;
mod light_block;
pub mod light_views;
pub mod lighting;
#[cfg(feature = "program")]
pub mod load;
#[cfg(feature = "program")]
pub mod mask;
#[cfg(feature = "program")]
pub mod memory;
pub mod method;
mod painter;
#[cfg(feature = "program")]
pub mod pass;
#[cfg(feature = "program")]
pub mod picture;
pub mod prepared;
pub mod receivers;
#[cfg(feature = "program")]
pub mod render;
pub mod scene;
#[cfg(feature = "program")]
pub mod settings;
mod shade;
mod shadow;
pub mod shapes;
mod show;
mod solids;
pub mod stats;
mod tone;
pub mod values;

pub use error::Error;
