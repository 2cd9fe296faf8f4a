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
    /// Pixels whose search was replaced by interpolation.
    pub interpolated: u32,
    /// Searches whose reach went past the map's border: their penumbra may be cut.
    pub cut_by_border: u32,
    /// Tiles of 16 x 16 pixels.
    pub tiles: u32,
    /// Tiles that were decided as a whole, without a search.
    pub decided_tiles: u32,
}

/// Counters that bands on several threads add to. Sums do not depend on the order.
#[derive(Default)]
pub(crate) struct Tally([AtomicU32; 7]);

impl Tally {
    pub fn add(&self, counters: &Counters) {
        let Counters { receivers, outside, searches, interpolated, .. } = *counters;
        let Counters { cut_by_border, tiles, decided_tiles, .. } = *counters;
        let counts =
            [receivers, outside, searches, interpolated, cut_by_border, tiles, decided_tiles];
        for (sum, count) in self.0.iter().zip(counts) {
            sum.fetch_add(count, Ordering::Relaxed);
        }
    }

    pub fn total(self) -> Counters {
        let [receivers, outside, searches, interpolated, cut_by_border, tiles, decided_tiles] =
            self.0.map(AtomicU32::into_inner);
        Counters { receivers, outside, searches, interpolated, cut_by_border, tiles, decided_tiles }
    }
}
