//! What was done, counted.

use core::sync::atomic::{AtomicU32, Ordering};

/// How often what happened in one call.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counters {
    /// Pixels where the camera sees something.
    pub receivers: u32,
    /// Receivers outside the light's map or behind the light. They count as lit.
    pub outside: u32,
    /// Searches of the light's map.
    pub searches: u32,
    /// Searches whose reach went past the map's border: their penumbra may be cut.
    pub cut_by_border: u32,
}

/// Counters that bands on several threads add to. Sums do not depend on the order.
#[derive(Default)]
pub(crate) struct Tally {
    receivers: AtomicU32,
    outside: AtomicU32,
    searches: AtomicU32,
    cut_by_border: AtomicU32,
}

impl Tally {
    pub fn add(&self, counters: &Counters) {
        let Counters { receivers, outside, searches, cut_by_border } = *counters;
        self.receivers.fetch_add(receivers, Ordering::Relaxed);
        self.outside.fetch_add(outside, Ordering::Relaxed);
        self.searches.fetch_add(searches, Ordering::Relaxed);
        self.cut_by_border.fetch_add(cut_by_border, Ordering::Relaxed);
    }
    pub fn total(self) -> Counters {
        Counters {
            receivers: self.receivers.into_inner(),
            outside: self.outside.into_inner(),
            searches: self.searches.into_inner(),
            cut_by_border: self.cut_by_border.into_inner(),
        }
    }
}
