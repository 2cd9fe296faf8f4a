//! Lists in memory of their own.

/// A list of at most `N`.
pub(crate) struct List<T, const N: usize> {
    items: [T; N],
    len: usize,
}

impl<T: Copy, const N: usize> List<T, N> {
    pub const fn new(item: T) -> Self {
        List { items: [item; N], len: 0 }
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    /// False if there is no room.
    #[inline(always)]
    pub fn push(&mut self, item: T) -> bool {
        let Some(place) = self.items.get_mut(self.len) else { return false };
        *place = item;
        self.len += 1;
        true
    }

    #[inline(always)]
    pub fn all(&self) -> &[T] {
        &self.items[..self.len]
    }

    #[inline(always)]
    pub fn part(&self, [from, end]: [usize; 2]) -> &[T] {
        &self.items[from..end]
    }
}
