//! Nearest texel search.
#![no_std]
#![deny(unsafe_code)]
// Lanes are numbered: what a loop does to several arrays at once, a vector does.
#![allow(clippy::needless_range_loop)]

mod batch;
mod build;
mod classify;
mod descend;
mod greatest;
mod jitter;
mod kernels;
mod map;
pub mod naive;
mod pyramid;
mod query;
mod reach;
mod search;
mod visits;
mod walk;

use kernels::{Job, run};
use shadowmap_core::Level;

pub use classify::Verdict;
pub use map::Map;
pub use pyramid::{IdGroup, NodeGroup, Pyramid, StorageError};
pub use query::{Hit, IdTest, Key, Query, Side};
pub use reach::{Cone, Reach, Receivers};
pub use visits::Visits;

/// The answer to one query without a pyramid: what [`naive::nearest`] gives, from the rows
/// of texels around the receiver outwards.
#[must_use]
pub fn nearest<'a>(level: Level, map: impl Into<Map<'a>>, query: &Query) -> Option<Hit> {
    let mut hit = None;
    run(level, Job::InBox { map: map.into(), query, hit: &mut hit });
    hit
}
