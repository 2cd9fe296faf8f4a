//! Work split into bands of rows that threads never share.

#[cfg(feature = "rayon")]
use std::sync::{Mutex, PoisonError};

/// How bands are run. The default is the pool where the feature `rayon` is on, which another crate
/// may have done: whoever means one thread says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Threads {
    /// One after another on the calling thread.
    #[cfg_attr(not(feature = "rayon"), default)]
    One,
    /// On the rayon pool that the call is made from (by default the global one).
    #[cfg(feature = "rayon")]
    #[default]
    Pool,
}

impl Threads {
    /// How many threads there are.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Threads::One => 1,
            #[cfg(feature = "rayon")]
            Threads::Pool => rayon::current_num_threads(),
        }
    }
}

/// Something that can be cut between two bands. Tuples are cut alike in all their parts.
pub trait Bands: Send + Sized {
    /// How many bands there are.
    fn count(&self) -> usize;
    /// The first `bands` bands, and the rest.
    fn split_at(self, bands: usize) -> (Self, Self);
}

/// A slice cut into bands of `len` elements, the last one possibly shorter.
#[derive(Debug)]
pub struct BandSlice<'a, T> {
    /// The elements of all bands.
    pub data: &'a mut [T],
    /// Elements per band, at least 1.
    pub len: usize,
}

impl<T: Send> Bands for BandSlice<'_, T> {
    fn count(&self) -> usize {
        self.data.len().div_ceil(self.len)
    }
    fn split_at(self, bands: usize) -> (Self, Self) {
        let at = (bands * self.len).min(self.data.len());
        let (head, tail) = self.data.split_at_mut(at);
        (BandSlice { data: head, len: self.len }, BandSlice { data: tail, len: self.len })
    }
}

macro_rules! tuple_bands {
    ($($name:ident $index:tt),+) => {
        impl<$($name: Bands),+> Bands for ($($name,)+) {
            fn count(&self) -> usize {
                self.0.count()
            }
            fn split_at(self, bands: usize) -> (Self, Self) {
                let cut = ($(self.$index.split_at(bands),)+);
                (($(cut.$index.0,)+), ($(cut.$index.1,)+))
            }
        }
    };
}
tuple_bands!(A 0, B 1);
tuple_bands!(A 0, B 1, C 2);
tuple_bands!(A 0, B 1, C 2, D 3);

/// Calls `work(index, band)` for every band of `bands`; each call owns its band alone.
///
/// The order of the calls is not fixed, so that results must not depend on it. Nothing is
/// allocated.
///
/// ```
/// use shadowmap_core::{BandSlice, Threads, for_each_band};
/// let mut rows = [0; 12];
/// for_each_band(Threads::One, BandSlice { data: &mut rows, len: 4 }, &|index, band| {
///     band.data.fill(index);
/// });
/// assert_eq!(rows, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]);
/// ```
pub fn for_each_band<B: Bands>(threads: Threads, bands: B, work: &(impl Fn(usize, B) + Sync)) {
    let count = bands.count();
    match threads {
        Threads::One => in_order(0, count, bands, work),
        #[cfg(feature = "rayon")]
        Threads::Pool => on_pool(0, count, bands, work),
    }
}

/// Calls `work(memory, index, band)` for every band of `bands`, with memory that each thread makes
/// once by `start` and keeps from band to band.
///
/// Threads take bands in order, each the next one when it is done with the last: bands may differ
/// much in the work that they are. Results must depend neither on the order of the calls nor on
/// what earlier calls left in the memory.
///
/// ```
/// use shadowmap_core::{BandSlice, Threads, for_each_band_with};
/// let mut rows = [0; 12];
/// let bands = BandSlice { data: &mut rows, len: 4 };
/// for_each_band_with(Threads::One, bands, || 0, &|calls, index, band| {
///     *calls += 1;
///     band.data.fill(10 * index + *calls);
/// });
/// assert_eq!(rows, [1, 1, 1, 1, 12, 12, 12, 12, 23, 23, 23, 23]);
/// ```
pub fn for_each_band_with<B: Bands, M>(
    threads: Threads,
    bands: B,
    start: impl Fn() -> M + Sync,
    work: &(impl Fn(&mut M, usize, B) + Sync),
) {
    let count = bands.count();
    match threads {
        Threads::One => {
            let mut memory = start();
            in_order(0, count, bands, |index, band| work(&mut memory, index, band));
        }
        #[cfg(feature = "rayon")]
        Threads::Pool => {
            let queue = Mutex::new((0, Some(bands)));
            on_each(threads.count().min(count), &|| {
                let mut memory = start();
                while let Some((index, band)) = next(&queue) {
                    work(&mut memory, index, band);
                }
            });
        }
    }
}

/// Does two things that do not depend on each other, side by side where there are threads for it.
pub fn both<A: Send, B: Send>(
    threads: Threads,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    match threads {
        Threads::One => (first(), second()),
        #[cfg(feature = "rayon")]
        Threads::Pool => rayon::join(first, second),
    }
}

fn in_order<B: Bands>(first: usize, count: usize, mut bands: B, mut work: impl FnMut(usize, B)) {
    for index in first..first + count {
        let (band, rest) = bands.split_at(1);
        work(index, band);
        bands = rest;
    }
}

#[cfg(feature = "rayon")]
fn on_pool<B: Bands>(first: usize, count: usize, bands: B, work: &(impl Fn(usize, B) + Sync)) {
    if count <= 1 {
        return in_order(first, count, bands, work);
    }
    let half = count / 2;
    let (head, tail) = bands.split_at(half);
    rayon::join(
        || on_pool(first, half, head, work),
        || on_pool(first + half, count - half, tail, work),
    );
}

/// Does the same on several threads.
#[cfg(feature = "rayon")]
fn on_each(threads: usize, work: &(impl Fn() + Sync)) {
    if threads <= 1 {
        return work();
    }
    let half = threads / 2;
    rayon::join(|| on_each(half, work), || on_each(threads - half, work));
}

/// Takes the first band of those left, and the index of that.
#[cfg(feature = "rayon")]
fn next<B: Bands>(queue: &Mutex<(usize, Option<B>)>) -> Option<(usize, B)> {
    // Whoever panics here has taken no band.
    let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
    let (index, bands) = &mut *queue;
    let (band, rest) = bands.take().filter(|bands| bands.count() > 0)?.split_at(1);
    *bands = Some(rest);
    *index += 1;
    Some((*index - 1, band))
}

#[cfg(all(test, feature = "rayon"))]
mod tests {
    use super::*;

    #[test]
    fn threads_that_take_bands_leave_none_out() {
        let mut rows = [0; 35];
        let bands = BandSlice { data: &mut rows, len: 4 };
        for_each_band_with(Threads::Pool, bands, || 100, &|memory, index, band| {
            band.data.iter_mut().for_each(|value| *value += *memory + index);
        });
        assert!(rows.iter().enumerate().all(|(i, &value)| value == 100 + i / 4));
    }
}
