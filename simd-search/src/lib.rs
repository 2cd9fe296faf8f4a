//! The search of Brabec and Seidel, *Single Sample Soft Shadows using Depth Maps*, Graphics
//! Interface 2002, sections 3.2 to 4.3: the texel nearest to a receiver that blocks it, or that
//! does not.
//!
//! # The question
//!
//! A receiver lies at (u, v) in a light's depth map, between the centres of texels. Its surface is
//! a plane there ([`LightPoint`](shadowmap_core::LightPoint)). A texel *blocks* if it is nearer to
//! the light than that plane, compared at the texel's own centre:
//!
//! ```text
//!   . . . . . . . . . . . . .      P  the receiver
//!   . . . . . . . . # # # # .      #  texels that block it
//!   . . . . . . . # # # # # .      .  texels that do not
//!   . . . ( . . ) # # # # # .
//!   . . (   P---->1 # # # # .      1  the nearest that blocks: the answer
//!   . . . ( . . ) # # # # # .
//!   . . . . . . . # # # # # .      its distance is what the penumbra is made of
//!   . . . . . . . . . . . . .
//! ```
//!
//! A receiver that sees the light's centre asks for the nearest blocker ([`Side::Blocker`], the
//! outer penumbra); one that does not, for the nearest texel that does not block ([`Side::Lit`],
//! the inner penumbra). Object IDs can be excluded or required ([`IdTest`]), and what is minimised
//! may be the distance or its ratio to the width of the penumbra ([`Key`]). Of equals the first in
//! row-major order is the answer. [`Query::candidate`] is the definition, [`naive::nearest`] asks
//! it of every texel in reach, and every other path gives the same texel with the same bits.
//!
//! # How not to ask every texel
//!
//! Most receivers are far from any shadow, and for them the naive search is slowest: it sees the
//! whole window to find nothing. So the map is covered with boxes, 16 x 8 texels at the bottom, 4 x
//! 4 boxes in each larger one. Of each box we know a plane that no texel rises above, and one that
//! none falls below. Nearness is affine in the image for every flat surface, hence a floor
//! under a tilted light has a bound as flat as the floor itself:
//!
//! ```text
//!   nearness                           bounds by least and greatest alone would
//!     ^        ____ upper plane        say that part of the floor may be above P
//!     |   ____/_.-'
//!     |  /_.-'-'____ the floor
//!     | -'____/ lower plane
//!     +-----------------------> x
//! ```
//!
//! Two planes differ most at the corners of a box. So one comparison per box says "nothing in here
//! blocks" or "all of this blocks", and a box that is farther away than the best answer so far
//! is passed over as well. Sixteen sibling boxes are compared at once, one per lane.
//!
//! # Neighbours together
//!
//! Neighbours find nearly the same texel. One search after the other can use that: the neighbour's
//! hit is asked first, and bounds the search ([`Query::hint`]). [`Pyramid::nearest_each`] does
//! more. It goes down the pyramid once for 64 receivers, from the nearest box to the farthest, with
//! a plane below all of theirs and one above, and sorts the texels it meets:
//!
//! ```text
//!   . . . . . . . . a a b b      #  receivers
//!   . . # # # . . a a b b b      .  below all of their planes: block nobody
//!   . . # # # . . a b b b b      a  above all of their planes, and between them and every b
//!   . . # # # . . . a b b b      b  above all of their planes, but an `a` is nearer to each of
//!   . . . . . . . . . a b b         them, in the same row or column
//! ```
//!
//! Only the texels `a`, and those between the two planes, can be the answer for anyone, and none
//! farther away than the farthest corner of the receivers' box from the best `a`, nor in a box that
//! is farther than it from every receiver. The few that are left (some 30 where a flat floor is
//! shadowed) are asked by 16 receivers at once, one per lane. Where an object stands on the floor,
//! or an edge runs through the block, the receivers of each plane go down by themselves. On curved
//! surfaces many texels lie between the two planes: there each receiver compares its own plane with
//! a box's bounds before anyone goes into it, then with the texels, again 16 receivers at once, and
//! only those that some texel matters to ask: texel by texel or, where many are left, all of the
//! box at once by one receiver after the other. A few that go into a box ask all of it without
//! sorting.
//!
//! [`Pyramid::classify`] tells only whether there are any boxes that can matter.
//!
//! None of this changes an answer. Distances are computed for a box as for its texels, with
//! operations that are monotone in spite of rounding; bounds on nearness have room for all the
//! rounding there is.
//!
//! # Differences to the paper
//!
//! * The paper compares with the receiver's depth, a layer parallel to the map. Here the layer is
//!   the receiver's plane; [`LightPoint::flat`](shadowmap_core::LightPoint::flat) is the paper's.
//! * The paper's box has no pyramid and finds the nearest texel of the box; here a texel beyond the
//!   radius does not count.
//!
//! # Features
//!
//! | feature | default | meaning |
//! |---|---|---|
//! | `std` | yes | SIMD levels are detected at run time |
//! | `libm` | no | mathematics for targets without `std`; one of the two is needed |
//!
//! A query allocates nothing, and the crate never does: a pyramid's storage is the caller's.
#![no_std]
#![deny(unsafe_code)]
// Lanes are numbered: what a loop does to several arrays at once, a vector does.
#![allow(clippy::needless_range_loop)]

mod bands;
mod batch;
mod build;
mod candidates;
mod classify;
mod descend;
mod greatest;
mod jitter;
mod kernels;
mod leaf;
mod leaves;
mod map;
pub mod naive;
mod parts;
mod precedence;
mod pyramid;
mod query;
mod reach;
mod receivers;
mod search;
mod visits;
mod walk;

use kernels::{Job, run};
use shadowmap_core::Level;

pub use bands::LeafBands;
pub use classify::Verdict;
pub use map::Map;
pub use pyramid::{IdGroup, NodeGroup, Pyramid, StorageError};
pub use query::{Hit, IdTest, Key, Query, Side};
pub use reach::{Cone, Reach, Receivers};
pub use visits::Visits;

/// The crate whose views, maps and levels are taken here, in the version that takes them.
pub use shadowmap_core;

/// The answer to one query without a pyramid: what [`naive::nearest`] gives, from the rows
/// of texels around the receiver outwards.
#[must_use]
pub fn nearest<'a>(level: Level, map: impl Into<Map<'a>>, query: &Query) -> Option<Hit> {
    let mut hit = None;
    run(level, Job::InBox { map: map.into(), query, hit: &mut hit });
    hit
}

/// The README's example is compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
