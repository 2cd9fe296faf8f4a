//! The search of a tile's receivers.

use super::adaptive::{COUNT, Grid, NO_KEY, Samples};
use super::field::{Field, Test, Texel};
use super::geometry::Geometry;
use super::integral::{blocked_fraction, sum};
use super::kernels::{Ops, Work};
use super::leaves::{LeafTest, Leaves};
use super::outline::{Outcome, Places, STRIP, outline};
use super::reach::{Extent, Reach};
use super::receiver::Receiver;
use super::segments::{CAPACITY, Segments};
use super::soa::Receivers;
use super::verdict::margin;
use crate::Counters;
use simd_search::Pyramid;

/// An outline that several receivers on one plane share.
struct Shared {
    plane: Receiver,
    is_complete: bool,
    segments: Segments,
}

/// Outlines of one tile.
pub(crate) struct Outlines {
    shared: [Shared; 2],
    len: usize,
    own: Segments,
    leaves: Leaves,
}

impl Shared {
    const fn new() -> Shared {
        Shared { plane: Receiver::NOTHING, is_complete: false, segments: Segments::new() }
    }
}

impl Outlines {
    pub const fn new() -> Outlines {
        Outlines {
            shared: [Shared::new(), Shared::new()],
            len: 0,
            own: Segments::new(),
            leaves: Leaves::new(),
        }
    }
}

/// Fewer receivers than this do not share an outline.
const FEW: u32 = 6;

/// Finds the blocked fractions of all pixels of a tile.
pub(crate) struct SearchTile<'a, T> {
    pub geometry: &'a Geometry,
    pub field: &'a Field<'a, T>,
    pub pyramid: &'a Pyramid<'a>,
    pub receivers: &'a Receivers,
    pub ids: &'a [u32; COUNT],
    pub grid: &'a Grid,
    /// The nearest depth in reach of the tile.
    pub greatest: f32,
    pub samples: &'a mut Samples,
    pub outlines: &'a mut Outlines,
    pub counters: &'a mut Counters,
}

impl<T: Texel> Work for SearchTile<'_, T> {
    #[inline(always)]
    fn run(mut self, ops: &impl Ops) {
        self.outlines.len = 0;
        self.set_keys();
        self.samples.begin(self.grid);
        let before = self.counters.searches;
        let mut rows = false;
        loop {
            for i in 0..self.samples.wanted().len() {
                let pixel = usize::from(self.samples.wanted()[i]);
                self.samples.values[pixel] = self.search(ops, pixel);
            }
            self.counters.searches += self.samples.wanted().len() as u32;
            if !self.samples.refine(self.grid) {
                if rows {
                    break;
                }
                rows = true;
                self.samples.begin_rows(self.grid);
            }
        }
        let receivers = self.samples.keys.iter().filter(|&&key| key != NO_KEY).count() as u32;
        self.counters.interpolated += receivers - (self.counters.searches - before);
    }
}

impl<T: Texel> SearchTile<'_, T> {
    /// What pixels must have in common to be interpolated: the object and the hard shadow test.
    #[inline(always)]
    fn set_keys(&mut self) {
        let r = self.receivers;
        let (width, height) = (self.field.width, self.field.height);
        let mut texels = [f32::NAN; COUNT];
        for (i, texel) in texels.iter_mut().enumerate() {
            // Casts saturate, so that the border stands for what is outside.
            let (x, y) = (r.u[i] as i32, r.v[i] as i32);
            *texel = self.field.nearness(x.clamp(0, width - 1), y.clamp(0, height - 1));
        }
        for i in 0..COUNT {
            let above = r.hn[i] * texels[i] > (r.above[i] - r.hv[i] * r.v[i]) - r.hu[i] * r.u[i];
            let hard = u32::from(above & (texels[i] > r.nearness[i]));
            let key = (self.ids[i] << 1 | hard).wrapping_add(1);
            self.samples.keys[i] = if r.sky[i] > 0.0 { key } else { NO_KEY };
        }
    }

    /// The blocked fraction of one pixel.
    #[inline(always)]
    fn search(&mut self, ops: &impl Ops, pixel: usize) -> f32 {
        let receiver = self.receivers.get(pixel);
        let Receiver { u, v, nearness, .. } = receiver;
        let extent = Extent { u: [u; 2], v: [v; 2], nearness: [nearness; 2] };
        let Some(reach) = self.reach(&extent) else { return 0.0 };
        self.counters.cut_by_border += u32::from(reach.is_cut);
        let total = match self.shared(ops, &receiver) {
            Some(index) => sum(&receiver, &self.outlines.shared[index].segments),
            None => self.own(ops, &receiver, reach.places),
        };
        blocked_fraction(self.field.hides_center(&receiver), total)
    }

    #[inline(always)]
    fn reach(&self, extent: &Extent) -> Option<Reach> {
        let size = [self.field.width, self.field.height];
        Reach::within(self.geometry, self.greatest, size, extent)
    }

    /// The sum over an outline of the receiver's own, found piece by piece.
    #[inline(always)]
    fn own(&mut self, ops: &impl Ops, receiver: &Receiver, places: Places) -> i32 {
        let Receiver { u, v, nearness, .. } = *receiver;
        let extent = Extent { u: [u; 2], v: [v; 2], nearness: [nearness; 2] };
        let leaf_test = LeafTest::new(self.geometry, &extent, receiver, margin(receiver));
        let test = Test::of(receiver);
        let Outlines { own: segments, leaves, .. } = &mut *self.outlines;
        let mut total = 0_i32;
        segments.len = 0;
        for part in places.parts() {
            if !leaves.find(self.pyramid, &leaf_test, part) {
                continue;
            }
            for places in leaves.boxes(part, STRIP) {
                // A leaf's rows of a strip surely fit into half of the room.
                if segments.len > CAPACITY / 2 {
                    segments.pad();
                    total = total.wrapping_add(sum(receiver, segments));
                    segments.len = 0;
                }
                outline(ops, self.field, &test, None, places, segments);
            }
        }
        segments.pad();
        total.wrapping_add(sum(receiver, segments))
    }

    /// The index of the outline for all receivers on this receiver's plane, if there is one.
    #[inline(always)]
    fn shared(&mut self, ops: &impl Ops, receiver: &Receiver) -> Option<usize> {
        let known = self.outlines.shared[..self.outlines.len]
            .iter()
            .position(|shared| receiver.is_on_plane_of(&shared.plane));
        if let Some(index) = known {
            return self.outlines.shared[index].is_complete.then_some(index);
        }
        let index = self.outlines.len;
        let shared = self.outlines.shared.get_mut(index)?;
        // Whoever is on the plane: where they are, and between which planes theirs lie.
        let r = self.receivers;
        let mut extent = Extent::EMPTY;
        let mut above = [f32::INFINITY, f32::NEG_INFINITY];
        let mut count = 0;
        for i in 0..COUNT {
            let other = r.get(i);
            if other.sky > 0.0 && other.is_on_plane_of(receiver) {
                extent.add(other.u, other.v, other.nearness);
                above = [above[0].min(other.above), above[1].max(other.above)];
                count += 1;
            }
        }
        if count < FEW {
            return None;
        }
        let size = [self.field.width, self.field.height];
        let reach = Reach::within(self.geometry, self.greatest, size, &extent)?;
        // Planes may differ in their direction, too, by what `is_on_plane_of` tolerates.
        let room = receiver.plane_room(size);
        let Receiver { hu, hv, hn, .. } = *receiver;
        let [least, most] = extent.nearness;
        let some = Test { hu, hv, hn, above: above[0] - room, nearness: least };
        let all = Test { above: above[1] + room, nearness: most, ..some };
        shared.plane = *receiver;
        shared.segments.len = 0;
        let leaf_test = LeafTest::new(self.geometry, &extent, receiver, margin(receiver) - room);
        let leaves = &mut self.outlines.leaves;
        let mut outcome = Outcome::Complete;
        for part in reach.places.parts() {
            if !leaves.find(self.pyramid, &leaf_test, part) {
                continue;
            }
            for places in leaves.boxes(part, STRIP) {
                if outcome == Outcome::Complete {
                    outcome =
                        outline(ops, self.field, &some, Some(&all), places, &mut shared.segments);
                }
            }
        }
        shared.is_complete = outcome == Outcome::Complete;
        shared.segments.pad();
        self.outlines.len += 1;
        shared.is_complete.then_some(index)
    }
}
