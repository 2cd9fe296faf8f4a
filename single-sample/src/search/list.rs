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

    /// Forgets all but the first `len`.
    pub fn truncate(&mut self, len: usize) {
        self.len = len;
    }

    pub fn has_room(&self, count: usize) -> bool {
        self.len + count <= N
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
    pub fn pop(&mut self) -> Option<T> {
        self.len = self.len.checked_sub(1)?;
        Some(self.items[self.len])
    }

    #[inline(always)]
    pub fn all(&self) -> &[T] {
        &self.items[..self.len]
    }

    #[inline(always)]
    pub fn all_mut(&mut self) -> &mut [T] {
        &mut self.items[..self.len]
    }

    #[inline(always)]
    pub fn part(&self, [from, end]: [usize; 2]) -> &[T] {
        &self.items[from..end]
    }
}
