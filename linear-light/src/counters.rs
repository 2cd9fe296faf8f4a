//! What was done, counted.

use core::sync::atomic::{AtomicU32, Ordering};

/// How often what happened in one call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counters {
    /// Pixels where the camera sees something.
    pub receivers: u32,
    /// Receivers that a sample has outside its map or behind it. For that sample they count as lit.
    pub outside: u32,
}

/// Counters that bands on several threads add to. Sums do not depend on the order.
#[derive(Default)]
pub(crate) struct Tally {
    receivers: AtomicU32,
    outside: AtomicU32,
}

impl Tally {
    pub fn add(&self, counters: &Counters) {
        self.receivers.fetch_add(counters.receivers, Ordering::Relaxed);
        self.outside.fetch_add(counters.outside, Ordering::Relaxed);
    }
    pub fn total(self) -> Counters {
        Counters { receivers: self.receivers.into_inner(), outside: self.outside.into_inner() }
    }
}
