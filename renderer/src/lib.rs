//! Pictures.

pub mod builtin;
pub mod load;
pub mod scene;
pub mod shapes;
mod show;
