//! Pictures.

pub mod scene;
