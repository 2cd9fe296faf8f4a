//! The surfaces that a tile shows, told apart.

use core::ops::Range;

use glam::Vec3;

use super::adaptive::COUNT;
use super::lanes::bits_of_eight;

/// How many surfaces are told apart. What there is no room for shares the number after theirs.
pub(crate) const SURFACES: usize = 32;

/// Places of the hash table that finds them.
const SLOTS: usize = 4 * SURFACES;

/// What pixels of one plane have in common: the object's ID, then the bits of the normal. One
/// object hardly ever shows parallel planes.
type Surface = u128;

/// The surfaces of a tile, and where they are.
pub(crate) struct Distinct {
    list: [Surface; SURFACES],
    /// Pixels of each; the last counts what the list has no room for.
    pixels: [u16; SURFACES + 1],
    len: usize,
    /// One more than the index of the surface with this hash, or one with an earlier; 0 for none.
    slots: [u8; SLOTS],
    runs: [Run; COUNT],
    runs_len: usize,
}

/// Pixels side by side with the same surface, up to the next run.
#[derive(Clone, Copy)]
pub(crate) struct Run {
    pub first: u8,
    /// The surface's number.
    pub surface: u8,
}

impl Distinct {
    pub const fn new() -> Distinct {
        Distinct {
            list: [0; SURFACES],
            pixels: [0; SURFACES + 1],
            len: 0,
            slots: [0; SLOTS],
            runs: [Run { first: 0, surface: 0 }; COUNT],
            runs_len: 0,
        }
    }

    #[inline(always)]
    pub fn clear(&mut self) {
        self.pixels = [0; SURFACES + 1];
        self.len = 0;
        self.slots = [0; SLOTS];
        self.runs_len = 0;
    }

    /// Adds a run of pixels that follows those so far, with the surface of that number.
    #[inline(always)]
    pub fn add(&mut self, run: &Range<usize>, surface: u8) {
        self.pixels[usize::from(surface)] += (run.end - run.start) as u16;
        self.runs[self.runs_len] = Run { first: run.start as u8, surface };
        self.runs_len += 1;
    }

    /// The runs, which together are all pixels.
    #[inline(always)]
    pub fn runs(&self) -> &[Run] {
        &self.runs[..self.runs_len]
    }

    /// The object and the count of pixels of each surface, by its number.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = (u32, usize)> {
        let pixels = self.pixels.iter().map(|&count| usize::from(count));
        self.list[..self.len].iter().map(|&surface| surface as u32).zip(pixels)
    }

    /// The number of a surface, which is noted if it is new and there is room.
    #[inline(always)]
    pub fn number(&mut self, id: u32, normal: Vec3) -> u8 {
        // Zeros of both signs are the same.
        let [a, b, c] = normal.to_array().map(|value| (value + 0.0).to_bits());
        let surface = [c, b, a, id].iter().fold(0, |all, &part| all << 32 | Surface::from(part));
        let mixed = (id ^ a.rotate_left(9) ^ b.rotate_left(18) ^ c.rotate_left(27))
            .wrapping_mul(0x9e37_79b1);
        let mut slot = (mixed >> 20) as usize % SLOTS;
        loop {
            match self.slots[slot] {
                0 if self.len == SURFACES => return SURFACES as u8,
                0 => {
                    self.list[self.len] = surface;
                    self.len += 1;
                    self.slots[slot] = self.len as u8;
                    return self.len as u8 - 1;
                }
                known if self.list[usize::from(known) - 1] == surface => return known - 1,
                _ => slot = (slot + 1) % SLOTS,
            }
        }
    }
}

/// The numbers that entries of a table were found to have.
pub(crate) struct Memo {
    entries: [u32; SLOTS],
    numbers: [u8; SLOTS],
}

impl Memo {
    /// Not a number of a surface.
    const NONE: u8 = u8::MAX;

    #[inline(always)]
    pub fn new() -> Memo {
        Memo { entries: [0; SLOTS], numbers: [Memo::NONE; SLOTS] }
    }

    /// The number of an entry, which `find` finds if it is not known.
    #[inline(always)]
    pub fn number(&mut self, entry: u32, find: impl FnOnce() -> u8) -> u8 {
        // Neighbours in the table mostly have different places.
        let place = entry as usize % SLOTS;
        if self.entries[place] != entry || self.numbers[place] == Memo::NONE {
            self.entries[place] = entry;
            self.numbers[place] = find();
        }
        self.numbers[place]
    }
}

/// Calls `each` with every run of a tile's pixels, the first pixel of which, unless it is the
/// tile's, `is_new`.
#[inline(always)]
pub(crate) fn each_run(is_new: impl Fn(usize) -> bool, mut each: impl FnMut(Range<usize>)) {
    const WORD: usize = u64::BITS as usize;
    let mut bytes = [0_u8; COUNT];
    for i in 1..COUNT {
        bytes[i] = u8::from(is_new(i));
    }
    // Bit by bit where runs start; the last one says where they end.
    let mut starts = [0; COUNT / WORD + 1];
    starts[COUNT / WORD] = 1;
    for (i, eight) in bytes.as_chunks::<8>().0.iter().enumerate() {
        starts[i * 8 / WORD] |= u64::from(bits_of_eight(*eight)) << (i * 8 % WORD);
    }
    let (mut first, mut word, mut bits) = (0, 0, starts[0]);
    while first < COUNT {
        while bits == 0 {
            word += 1;
            bits = starts[word];
        }
        let end = word * WORD + bits.trailing_zeros() as usize;
        bits &= bits - 1;
        each(first..end);
        first = end;
    }
}
