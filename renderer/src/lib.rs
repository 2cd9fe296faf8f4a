//! Pictures.
#![deny(unsafe_code)]

pub mod builtin;
pub mod camera;
pub mod cli;
pub mod compare;
pub mod emitters;
mod error;
pub mod faces;
mod facet;
pub mod frame;
mod hull;
mod light_block;
pub mod light_views;
pub mod lighting;
pub mod load;
pub mod method;
pub mod pass;
pub mod picture;
pub mod prepared;
pub mod receivers;
pub mod render;
pub mod scene;
pub mod settings;
pub mod shade;
mod shadow;
pub mod shapes;
mod show;
pub mod stats;
mod tone;
pub mod values;

pub use error::Error;
