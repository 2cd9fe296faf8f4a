//! Receivers of a tile that share a plane, or at least an object.

use super::adaptive::COUNT;
use super::soa::{Pixels, Receivers};

/// How many groups there may be. The last one is for whatever fits no other.
pub(crate) const GROUPS: usize = 9;

/// Index of the group of whatever fits no other.
const OTHERS: usize = GROUPS - 1;

/// How many groups of one plane there may be.
const PLANES: usize = 6;

/// The group of pixels that see nothing of the light.
const NO_GROUP: u8 = u8::MAX;

/// Planes of fewer receivers than this are not worth a group of their own.
const FEW: usize = 32;

/// How many surfaces are told apart.
const SURFACES: usize = 32;

/// Places of the hash table that finds them.
const SLOTS: usize = 4 * SURFACES;

/// Which group each pixel belongs to.
pub(crate) struct Groups {
    of: [u8; COUNT],
    pub members: [u32; GROUPS],
}

/// What pixels of one plane have in common: the object's ID, then the bits of the normal. One object
/// hardly ever shows parallel planes.
type Surface = u128;

/// Pixels side by side with the same surface.
#[derive(Clone, Copy)]
struct Run {
    first: u8,
    surface: u8,
}

/// The surfaces of a tile.
struct Surfaces {
    list: [Surface; SURFACES],
    /// Pixels of each; the last counts what the list has no room for.
    pixels: [usize; SURFACES + 1],
    len: usize,
    /// One more than the index of the surface with this hash, or one with an earlier; 0 for none.
    slots: [u8; SLOTS],
    runs: [Run; COUNT],
    runs_len: usize,
}

impl Surfaces {
    #[inline(always)]
    fn of(pixels: &Pixels) -> Surfaces {
        let [a, b, c, _] = &pixels.planes;
        let ids = &pixels.ids;
        // Neighbours mostly share a surface.
        let mut is_new = [1_u8; COUNT];
        for i in 1..COUNT {
            let differs = (a[i] != a[i - 1])
                | (b[i] != b[i - 1])
                | (c[i] != c[i - 1])
                | (ids[i] != ids[i - 1]);
            is_new[i] = u8::from(differs);
        }
        let mut surfaces = Surfaces {
            list: [0; SURFACES],
            pixels: [0; SURFACES + 1],
            len: 0,
            slots: [0; SLOTS],
            runs: [Run { first: 0, surface: 0 }; COUNT],
            runs_len: 0,
        };
        for (i, eight) in is_new.as_chunks::<8>().0.iter().enumerate() {
            let mut eight = u64::from_le_bytes(*eight);
            while eight != 0 {
                let first = i * 8 + eight.trailing_zeros() as usize / 8;
                eight &= eight - 1;
                let [a, b, c] = [a, b, c].map(|lane| u128::from(lane[first].to_bits()));
                surfaces.add(first, u128::from(ids[first]) | a << 32 | b << 64 | c << 96);
            }
        }
        surfaces.finish(COUNT);
        surfaces
    }

    /// Begins a run.
    #[inline(always)]
    fn add(&mut self, first: usize, surface: Surface) {
        self.finish(first);
        let surface = self.find(surface);
        self.runs[self.runs_len] = Run { first: first as u8, surface: surface as u8 };
        self.runs_len += 1;
    }

    /// The index of a surface, which is noted if it is new and there is room.
    #[inline(always)]
    fn find(&mut self, surface: Surface) -> usize {
        let [a, b, c, d] = [0, 32, 64, 96].map(|shift| (surface >> shift) as u32);
        let mixed = (a ^ b.rotate_left(9) ^ c.rotate_left(18) ^ d.rotate_left(27))
            .wrapping_mul(0x9e37_79b1);
        let mut slot = (mixed >> 20) as usize % SLOTS;
        loop {
            match self.slots[slot] {
                0 if self.len == SURFACES => return SURFACES,
                0 => {
                    self.list[self.len] = surface;
                    self.len += 1;
                    self.slots[slot] = self.len as u8;
                    return self.len - 1;
                }
                known if self.list[usize::from(known) - 1] == surface => {
                    return usize::from(known) - 1;
                }
                _ => slot = (slot + 1) % SLOTS,
            }
        }
    }

    /// Ends the present run.
    #[inline(always)]
    fn finish(&mut self, end: usize) {
        if let Some(last) = self.runs[..self.runs_len].last() {
            self.pixels[usize::from(last.surface)] += end - usize::from(last.first);
        }
    }

    /// The group of each surface.
    #[inline(always)]
    fn groups(&self) -> [u8; SURFACES + 1] {
        let mut groups = [OTHERS as u8; SURFACES + 1];
        let (mut planes, mut objects) = (0, [0_u32; OTHERS - PLANES]);
        let mut objects_len = 0;
        for (i, surface) in self.list[..self.len].iter().enumerate() {
            let id = *surface as u32;
            if self.pixels[i] >= FEW && planes < PLANES {
                groups[i] = planes as u8;
                planes += 1;
                continue;
            }
            let known = objects[..objects_len].iter().position(|other| *other == id);
            let object = known.unwrap_or(objects_len);
            if object == objects.len() {
                continue;
            }
            if known.is_none() {
                objects[object] = id;
                objects_len += 1;
            }
            groups[i] = (PLANES + object) as u8;
        }
        groups
    }
}

impl Groups {
    pub const fn new() -> Groups {
        Groups { of: [NO_GROUP; COUNT], members: [0; GROUPS] }
    }

    /// Which pixels see something of the light, and belong to a group for which that is so.
    #[inline(always)]
    pub fn pixels_of(&self, counts: impl Fn(usize) -> bool) -> [bool; COUNT] {
        let mut found = self.of.map(|of| of != NO_GROUP);
        for group in 0..GROUPS {
            if self.members[group] > 0 && !counts(group) {
                for (found, of) in found.iter_mut().zip(&self.of) {
                    *found &= *of != group as u8;
                }
            }
        }
        found
    }

    /// The group of a pixel, if it sees something of the light.
    #[inline(always)]
    pub fn of(&self, pixel: usize) -> Option<usize> {
        let group = self.of[pixel];
        (group != NO_GROUP).then_some(usize::from(group))
    }

    /// Whether a pixel belongs to a group.
    #[inline(always)]
    pub fn has(&self, group: usize, pixel: usize) -> bool {
        self.of[pixel] == group as u8
    }

    /// One group of the first `count` pixels.
    #[inline(always)]
    pub fn set_one(&mut self, count: usize) {
        self.of = [NO_GROUP; COUNT];
        self.of[..count].fill(0);
        self.members = [0; GROUPS];
        self.members[0] = count as u32;
    }

    /// Forms the groups.
    #[inline(always)]
    pub fn set(&mut self, pixels: &Pixels, receivers: &Receivers) {
        let surfaces = Surfaces::of(pixels);
        let groups = surfaces.groups();
        let runs = &surfaces.runs[..surfaces.runs_len];
        for (i, run) in runs.iter().enumerate() {
            let end = runs.get(i + 1).map_or(COUNT, |next| usize::from(next.first));
            self.of[usize::from(run.first)..end].fill(groups[usize::from(run.surface)]);
        }
        for i in 0..COUNT {
            self.of[i] = if receivers.sky[i] > 0.0 { self.of[i] } else { NO_GROUP };
        }
        for (group, members) in self.members.iter_mut().enumerate() {
            let count: u16 = self.of.iter().map(|&of| u16::from(of == group as u8)).sum();
            *members = u32::from(count);
        }
    }
}
