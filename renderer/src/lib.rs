//! Pictures.

pub mod builtin;
pub mod scene;
pub mod shapes;
mod show;
