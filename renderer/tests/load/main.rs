//! Scene files, sound and broken.

mod features;
mod generate;
mod malformed;
mod mutations;
mod table;
