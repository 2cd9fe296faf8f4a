//! Fetches the next band while this one is drawn.

use crate::band::Rows;
use crate::simd::Simd;

/// Bytes of a line of the cache.
const LINE: usize = 64;

/// The most lines of either plane that are fetched beside one triangle: more at once would make it
/// wait.
const MOST: usize = 16;

/// The lines of the band after the one at hand, fetched a few at a time while small triangles are
/// drawn. These keep the core busy and leave memory idle; clearing the next band is the reverse.
#[derive(Debug)]
pub(crate) struct Ahead {
    /// The next lines of both planes. Addresses only: nothing is read through them.
    nearness: *const u8,
    payload: *const u8,
    /// How many are left, and how many go with one triangle.
    left: usize,
    at_once: usize,
}

impl Ahead {
    /// What follows `rows`, shared out among so many triangles.
    #[inline(always)]
    pub(crate) fn of(rows: &Rows<'_>, triangles: usize) -> Ahead {
        let is_last = rows.band + 1 >= rows.grid.bands();
        let lines = if is_last { 0 } else { size_of_val(rows.nearness) / LINE };
        Ahead {
            nearness: rows.nearness.as_ptr_range().end.cast(),
            payload: rows.payload.as_ptr_range().end.cast(),
            left: lines,
            at_once: lines.div_ceil(triangles.max(1)).min(MOST),
        }
    }

    /// Fetches what goes with one triangle.
    #[inline(always)]
    pub(crate) fn fetch<S: Simd>(&mut self, s: S) {
        let count = self.left.min(self.at_once);
        for _ in 0..count {
            s.prefetch_later(self.nearness);
            s.prefetch_later(self.payload);
            self.nearness = self.nearness.wrapping_add(LINE);
            self.payload = self.payload.wrapping_add(LINE);
        }
        self.left -= count;
    }
}
