//! The memory of one plane of a map.

use alloc::{vec, vec::Vec};
use core::ops::{Deref, DerefMut};
use core::slice;

/// Elements of four bytes in a page of memory.
const PAGE: usize = 1024;

/// One value of four bytes per texel, row-major: a slice that chooses where in memory it starts.
///
/// A row of a map of 1024 texels is as long as a page, so that what lies above each other falls
/// into one and the same set of the nearest cache, which holds about twelve lines. Nearness and
/// payload of a triangle of ten rows do not fit into that if both start alike in their pages. So
/// they start at different places, each with a line of the cache.
#[derive(Debug)]
pub struct Texels<T> {
    storage: Vec<T>,
    /// Where in a page the first element lies, in elements.
    place: usize,
    /// Its index in the storage.
    first: usize,
    len: usize,
}

impl<T: Copy + Default> Texels<T> {
    /// `len` times the default, from `place` elements after the start of a page on.
    pub(crate) fn new(len: usize, place: usize) -> Texels<T> {
        const { assert!(size_of::<T>() == 4) };
        let room = if len == 0 { 0 } else { PAGE };
        let storage = vec![T::default(); len + room];
        let start = storage.as_ptr() as usize / size_of::<T>();
        let first = place.wrapping_sub(start) % PAGE;
        Texels { first: first.min(room), storage, place, len }
    }
}

impl<T> Deref for Texels<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.storage[self.first..][..self.len]
    }
}

impl<T> DerefMut for Texels<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.storage[self.first..][..self.len]
    }
}

impl<T: Copy + Default> Clone for Texels<T> {
    fn clone(&self) -> Texels<T> {
        let mut copy = Texels::new(self.len, self.place);
        copy.copy_from_slice(self);
        copy
    }
}

impl<T: PartialEq> PartialEq for Texels<T> {
    fn eq(&self, other: &Texels<T>) -> bool {
        self[..] == other[..]
    }
}

impl<'a, T> IntoIterator for &'a Texels<T> {
    type Item = &'a T;
    type IntoIter = slice::Iter<'a, T>;

    fn into_iter(self) -> slice::Iter<'a, T> {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_where_it_is_told_to() {
        for (len, place) in [(1, 0), (1, 256), (5000, 0), (5000, 256), (1 << 20, 1023)] {
            let texels = Texels::<u32>::new(len, place);
            let copy = texels.clone();
            for texels in [&texels, &copy] {
                assert_eq!(texels.len(), len);
                assert_eq!(texels.as_ptr() as usize / 4 % PAGE, place);
                assert!(texels.iter().all(|&texel| texel == 0));
            }
        }
        assert!(Texels::<f32>::new(0, 256).is_empty());
    }

    #[test]
    fn copies_hold_the_same_and_are_their_own() {
        let mut texels = Texels::<u32>::new(100, 7);
        texels.iter_mut().zip(0..).for_each(|(texel, i)| *texel = i);
        let mut copy = texels.clone();
        assert_eq!(copy, texels);
        assert!(copy.iter().copied().eq(0..100));
        copy[99] = 0;
        assert_ne!(copy, texels);
    }
}
