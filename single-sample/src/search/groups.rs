//! Receivers of a tile that share a plane, or at least an object.

use super::adaptive::{COUNT, TILE};
use super::soa::Receivers;
use super::surfaces::{Distinct, SURFACES};

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

/// Which group each pixel belongs to.
pub(crate) struct Groups {
    of: [u8; COUNT],
    pub members: [u32; GROUPS],
}

/// The group of each surface by its number, and bit by bit which groups there are.
#[inline(always)]
fn of_surfaces(surfaces: &Distinct) -> ([u8; SURFACES + 1], u32) {
    let mut groups = [OTHERS as u8; SURFACES + 1];
    let (mut planes, mut objects) = (0, [0_u32; OTHERS - PLANES]);
    let mut objects_len = 0;
    for (i, (id, pixels)) in surfaces.iter().enumerate() {
        if pixels >= FEW && planes < PLANES {
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
    let first = |count: usize| (1 << count) - 1;
    let used = first(planes) | (first(objects_len) << PLANES) | (1 << OTHERS);
    (groups, used)
}

impl Groups {
    pub const fn new() -> Groups {
        Groups { of: [NO_GROUP; COUNT], members: [0; GROUPS] }
    }

    /// Which pixels see something of the light, and belong to a group for which that is so.
    #[inline(always)]
    pub fn pixels_of(&self, counts: impl Fn(usize) -> bool) -> [bool; COUNT] {
        let mut found = [false; COUNT];
        for (found, of) in found.iter_mut().zip(&self.of) {
            *found = *of != NO_GROUP;
        }
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
    pub fn set(&mut self, surfaces: &Distinct, receivers: &Receivers) {
        let (groups, used) = of_surfaces(surfaces);
        // Whole rows at a time: what is after a run is set with the next one.
        let mut of = [NO_GROUP; COUNT + TILE];
        let runs = surfaces.runs();
        for (i, run) in runs.iter().enumerate() {
            let end = runs.get(i + 1).map_or(COUNT, |next| usize::from(next.first));
            for start in (usize::from(run.first)..end).step_by(TILE) {
                of[start..][..TILE].fill(groups[usize::from(run.surface)]);
            }
        }
        for i in 0..COUNT {
            self.of[i] = if receivers.sky[i] > 0.0 { of[i] } else { NO_GROUP };
        }
        self.members = [0; GROUPS];
        for group in (0..GROUPS).filter(|group| used >> group & 1 == 1) {
            let count: u16 = self.of.iter().map(|&of| u16::from(of == group as u8)).sum();
            self.members[group] = u32::from(count);
        }
    }
}
