//! Soft shadow maps for linear lights: Heidrich, Brabec and Seidel, *Soft Shadow Maps for Linear
//! Lights*, Eurographics Rendering Workshop 2000. A tube light from two depth maps or a few more.
//!
//! The method, in short:
//!
//! 1. Draw a depth map from each of N samples of the light, at equal steps from end to end.
//! 2. Find the depth discontinuities of each map ([`Discontinuity`]). Across each hangs a *skin*,
//!    from the blocker's edge along the sample's ray to the receiver behind it.
//! 3. Warp the skins into the maps of the neighbouring samples. Where they show there, nearest
//!    first and unless they lie behind the map's own surface, a receiver sees part of the segment
//!    between the two samples: none at the blocker's edge, all at the other end of the skin
//!    ([`Transition`]). That is the sample's visibility channel ([`VisibilityChannels`]).
//! 4. A receiver that both samples of a segment see, sees all of it; one that a single sample
//!    sees, sees what the channel says; one that none sees, nothing ([`SkinShadow`]).
//! 5. Area lights are a few linear ones ([`lines`]).
//!
//! Views of one light are rectified ([`SampleViews`]): a skin is then a span of a row. Maps that
//! come from elsewhere take the way over polygons ([`VisibilityChannels::draw_unrelated`]).
//!
//! [`IntervalVisibility`] goes beyond the paper: it takes the same maps and finds the union of what
//! all blockers hide. [`AdaptiveSamples`] answers the paper's open question of how many samples a
//! light needs.
//!
//! ```
//! use glam::Vec3;
//! use linear_light::{DrawnLight, RectifiedLight, SkinOptions};
//! use shadowmap_core::Bias;
//!
//! let ground = [Vec3::new(-3.0, 0.0, -3.0), Vec3::new(3.0, 0.0, 3.0), Vec3::new(3.0, 0.0, -3.0)];
//! let (a, b) = (Vec3::new(-1.0, 4.0, 0.0), Vec3::new(1.0, 4.0, 0.0));
//! let mut light = DrawnLight::new(RectifiedLight::fit(a, b, 3, [64, 64], ground.into_iter()));
//! // Your rasterizer goes here; this is an empty ground, 4 metres below the light.
//! light.draw(&SkinOptions::default(), |_view, nearness| nearness.fill(0.25));
//! let seen = light.with_shadows(Bias::default(), |shadows| {
//!     shadows[0].visibility(Vec3::ZERO, Vec3::Y)
//! });
//! assert_eq!(seen, 1.0);
//! ```
//!
//! # Differences to the paper
//!
//! * **Whether both samples see a point is decided where it is shaded**, not by a channel that says
//!   one half. The channel knows texels, receivers are finer: along the end of every penumbra the
//!   sum of two channels is off by one half here and there. [`VisibilityChannels::channel`] still
//!   gives the paper's channel.
//! * **Equation 1 per texel** ([`Transition::Rational`], the default) where the paper is content
//!   with an affine transition ([`Transition::Linear`]), exact only for receivers parallel to the
//!   light.
//! * **Silhouettes are placed between texels**: what the rows above and below and the other map
//!   know of the same edge halves the error of wide penumbrae.
//! * **Discontinuities are deviations from planes**: nearness is affine on a plane, so steep
//!   surfaces are none. The paper's 3 x 3 Laplacian of Gaussian is the other filter.
//! * A skin is drawn only from its front: from its back it is behind its blocker.
//! * A receiver's own horizon is not left to the maps: the light below it is cut off exactly.
//! * Two rows of texels are mixed, unless an edge lies along the light and is hard by nature.
//!
//! # What it cannot do
//!
//! A point that sees the light only between two samples, and neither of them, ends up in full
//! shadow (the paper's figure 6); a point that two samples see, with a blocker between their rays,
//! is taken for fully lit. Both end with more samples: on the test scene `crowded` two are worse
//! than two point lights, three are better; a grille of nine bars needs nine.
//!
//! # Features
//!
//! | feature | default | meaning |
//! |---|---|---|
//! | `std` | yes | SIMD levels are detected at run time |
//! | `libm` | no | mathematics for targets without `std`; one of the two is needed |
//! | `rayon` | no | rows run on rayon's thread pool |
#![no_std]
#![deny(unsafe_code)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod area;
mod channel;
mod counters;
mod crossings;
mod diffuse;
mod discontinuity;
mod drawn;
mod intervals;
mod kernels;
mod lanes;
mod lookup;
#[cfg(test)]
mod naive;
mod rectified;
mod shading;
mod silhouette;
mod skin_polygons;
mod skin_spans;
mod skins;
mod views;

pub use area::{WeightedLine, lines, polygon_lines};
pub use channel::VisibilityChannels;
pub use counters::Counters;
pub use diffuse::diffuse;
pub use discontinuity::{Discontinuity, EdgeFilter};
pub use drawn::DrawnLight;
pub use intervals::{
    AdaptiveOptions, AdaptiveSamples, Disagreement, FrustumMaps, INTERVAL_BIAS, IntervalCounters,
    IntervalVisibility, SampleMap, disagreement,
};
pub use rectified::{MAX_FRUSTA, MAX_TANGENT, RectifiedLight};
pub use shading::{SkinShadow, visibility};
pub use skins::{SkinOptions, Transition};
pub use views::SampleViews;

/// The crate whose views, maps and levels are taken here, in the version that takes them.
pub use shadowmap_core;

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
