//! Pictures.
#![deny(unsafe_code)]

pub mod builtin;
pub mod camera;
#[cfg(feature = "program")]
pub mod cli;
#[cfg(feature = "program")]
pub mod compare;
pub mod default_light;
mod drawing;
pub mod emitters;
mod error;
pub mod faces;
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
pub mod method;
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
pub mod shade;
mod shadow;
pub mod shapes;
mod show;
pub mod stats;
mod tone;
pub mod values;

pub use error::Error;
