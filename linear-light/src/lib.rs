//! Soft shadow maps for linear lights.
#![no_std]
#![deny(unsafe_code)]

extern crate alloc;

mod views;

pub use views::{MAX_TANGENT, RectifiedLight, SampleViews};
