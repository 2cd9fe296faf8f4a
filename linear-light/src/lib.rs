//! Soft shadow maps for linear lights: Heidrich, Brabec and Seidel, *Soft Shadow Maps for Linear
//! Lights*, Eurographics Rendering Workshop 2000.
#![no_std]
#![deny(unsafe_code)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod area;
mod channel;
mod counters;
mod crossings;
mod discontinuity;
mod intervals;
mod lookup;
#[cfg(test)]
mod naive;
mod shading;
mod silhouette;
mod skin_polygons;
mod skin_spans;
mod skins;
mod views;

pub use area::{WeightedLine, lines, polygon_lines};
pub use channel::VisibilityChannels;
pub use counters::Counters;
pub use discontinuity::{Discontinuity, EdgeFilter};
pub use intervals::{FrustumMaps, INTERVAL_BIAS, IntervalCounters, IntervalVisibility, SampleMap};
pub use shading::{SkinShadow, visibility};
pub use skins::{SkinOptions, Transition};
pub use views::{MAX_TANGENT, RectifiedLight, SampleViews};
