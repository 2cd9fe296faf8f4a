//! Scene files, sound and broken.

mod features;
mod malformed;
mod mutations;
mod table;
