//! Receivers of a tile that share a plane.

use super::adaptive::COUNT;
use super::soa::{Pixels, Receivers};

/// How many groups there may be. The last one is for whatever fits no other.
pub(crate) const GROUPS: usize = 9;

/// Index of the group of receivers that share nothing.
pub(crate) const LONERS: usize = GROUPS - 1;

/// The group of pixels that see nothing of the light.
const NO_GROUP: u8 = u8::MAX;

/// Fewer receivers than this are better off on their own.
const FEW: u32 = 8;

/// Which group each pixel belongs to.
pub(crate) struct Groups {
    of: [u8; COUNT],
    pub members: [u32; GROUPS],
}

impl Groups {
    pub const fn new() -> Groups {
        Groups { of: [NO_GROUP; COUNT], members: [0; GROUPS] }
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
    pub fn set_one(&mut self, count: usize) {
        self.of = [NO_GROUP; COUNT];
        self.of[..count].fill(0);
        self.members = [0; GROUPS];
        self.members[0] = count as u32;
    }

    /// Forms the groups: by object and normal, since one object hardly ever shows parallel planes.
    pub fn set(&mut self, pixels: &Pixels, receivers: &Receivers) {
        let [a, b, c, _] = &pixels.planes;
        let ids = &pixels.ids;
        // Neighbours mostly share a surface.
        let mut is_new = [true; COUNT];
        for i in 1..COUNT {
            is_new[i] = (a[i] != a[i - 1])
                | (b[i] != b[i - 1])
                | (c[i] != c[i - 1])
                | (ids[i] != ids[i - 1]);
        }
        let mut own = [NO_GROUP; COUNT];
        for i in 0..COUNT {
            // Not seen from above: no plane to compare texels with.
            let loner = if is_seen(receivers.hn[i]) { 0 } else { LONERS as u8 };
            own[i] = if receivers.sky[i] > 0.0 { loner } else { NO_GROUP };
        }
        let mut surfaces = [(0, [f32::NAN; 3]); LONERS];
        self.members = [0; GROUPS];
        let (mut count, mut group) = (0, LONERS);
        for i in 0..COUNT {
            if is_new[i] {
                let surface = (ids[i], [a[i], b[i], c[i]]);
                let known = surfaces[..count].iter().position(|other| *other == surface);
                group = known.unwrap_or(count);
                if known.is_none() && count < LONERS {
                    surfaces[count] = surface;
                    count += 1;
                }
            }
            let of = if own[i] == 0 { group as u8 } else { own[i] };
            self.of[i] = of;
            if of != NO_GROUP {
                self.members[usize::from(of)] += 1;
            }
        }
        let mut is_small = [false; GROUPS];
        for group in 0..LONERS {
            if (1..FEW).contains(&self.members[group]) {
                is_small[group] = true;
                self.members[LONERS] += core::mem::take(&mut self.members[group]);
            }
        }
        if is_small.contains(&true) {
            for of in &mut self.of {
                if is_small.get(usize::from(*of)) == Some(&true) {
                    *of = LONERS as u8;
                }
            }
        }
    }
}

/// Whether a plane is seen well enough from above to compare texels with it.
pub(crate) fn is_seen(hn: f32) -> bool {
    hn > 1e-3
}
