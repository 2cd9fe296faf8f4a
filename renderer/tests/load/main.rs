//! Scene files, sound and broken.

mod table;
