//! The search of a tile's receivers.

use core::ops::Range;

use simd_search::Pyramid;

use super::adaptive::{COUNT, Grid, Keys, Samples, TILE};
use super::cell::{CELL, CellBits, is_uniform};
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::groups::Groups;
use super::integral::{Sought, Sum, blocked_fraction, cell_of, hides_center, sum, sum_in_reach};
use super::kernels::{Ops, Work};
use super::lanes::{Bits, rows_of_bits};
use super::leaves::LeafTest;
use super::outline::{Places, STRIP, Strip, cell_bits};
use super::outlines::{Outline, Outlines};
use super::planes::Planes;
use super::reach::{Extent, Reach};
use super::receiver::{Receiver, Seen};
use super::recent::Recent;
use super::segments::{LANES, Segments};
use super::soa::Receivers;
use super::texel_test::Test;
use crate::Counters;

/// From a cell's first texel to its middle.
const MIDDLE: f32 = CELL as f32 * 0.5 + 0.5;

/// Finds the blocked fractions of all pixels of a tile.
pub(crate) struct SearchTile<'a, T> {
    pub geometry: &'a Geometry,
    pub field: &'a Field<'a, T>,
    pub pyramid: &'a Pyramid<'a>,
    pub receivers: &'a Receivers,
    pub groups: &'a Groups,
    pub ids: &'a [u32; COUNT],
    pub grid: &'a Grid,
    pub samples: &'a mut Samples,
    pub outlines: &'a mut Outlines,
    pub counters: &'a mut Counters,
}

/// What the search of a pixel finds.
struct Sample {
    /// The blocked fraction of the disc.
    blocked: f32,
    /// See [`Samples::discs`].
    disc: f32,
}

impl Sample {
    /// Nothing in reach.
    const CLEAR: Sample = Sample { blocked: 0.0, disc: f32::INFINITY };
}

impl<T: Texel> Work for SearchTile<'_, T> {
    #[inline(always)]
    fn run(mut self, ops: &impl Ops) {
        let needed = self.needed();
        let keys = Keys { objects: self.ids, hard: self.hard(), needed };
        self.samples.begin(self.grid, &keys);
        let before = self.counters.searches;
        loop {
            for i in 0..self.samples.wanted().len() {
                let pixel = usize::from(self.samples.wanted()[i]);
                let Sample { blocked, disc } = self.search(ops, pixel);
                self.samples.values[pixel] = blocked;
                self.samples.discs[pixel] = disc;
            }
            self.counters.searches += self.samples.wanted().len() as u32;
            if !self.samples.refine(self.grid, self.receivers) {
                break;
            }
        }
        let receivers: u32 = needed.iter().map(|row| row.count_ones()).sum();
        self.counters.interpolated += receivers - (self.counters.searches - before);
    }
}

impl<T: Texel> SearchTile<'_, T> {
    /// Which pixels belong to a group that something may block.
    #[inline(always)]
    fn needed(&self) -> Bits {
        let groups = &self.outlines.groups;
        rows_of_bits(&self.groups.pixels_of(|group| groups[group].is_some()).map(u8::from))
    }

    /// Which pixels are in shadow by the hard shadow test.
    #[inline(always)]
    fn hard(&self) -> Bits {
        let r = self.receivers;
        let Field { width, height, texels, .. } = *self.field;
        let last = [(width - 1) as f32, (height - 1) as f32];
        let mut places = [0_u32; COUNT];
        for i in 0..COUNT {
            let (x, y) = (whole_part(r.u[i], last[0]), whole_part(r.v[i], last[1]));
            places[i] = y.wrapping_mul(width as u32).wrapping_add(x);
        }
        let mut nearness = [f32::NAN; COUNT];
        for i in 0..COUNT {
            if let Some(texel) = texels.get(places[i] as usize) {
                nearness[i] = texel.nearness();
            }
        }
        let mut hard = [0; COUNT];
        for i in 0..COUNT {
            let above = r.hn[i] * nearness[i] > (r.above[i] - r.hv[i] * r.v[i]) - r.hu[i] * r.u[i];
            hard[i] = u8::from(above & (nearness[i] > r.nearness[i]));
        }
        rows_of_bits(&hard)
    }

    /// Searches one pixel.
    #[inline(always)]
    fn search(&mut self, ops: &impl Ops, pixel: usize) -> Sample {
        let group = self.groups.of(pixel).and_then(|group| self.outlines.groups[group]);
        let Some(outline) = group else { return Sample::CLEAR };
        let receiver = self.receivers.get(pixel);
        let seen = Seen::of(self.geometry, &receiver);
        let sought = Sought::between(outline.side * (self.grid.group as f32 / TILE as f32));
        if outline.is_cut || !outline.is_shared {
            let extent = Extent::of(&receiver);
            let size = [self.field.width, self.field.height];
            let reach = Reach::within(self.geometry, outline.greatest, size, &extent);
            let Some(Reach { places, is_cut, .. }) = reach else { return Sample::CLEAR };
            self.counters.cut_by_border += u32::from(is_cut);
            if !outline.is_shared {
                let (Sum { total, disc }, hidden) =
                    self.own(ops, &receiver, &seen, &sought, places);
                return Sample { blocked: blocked_fraction(hidden, total), disc };
            }
        }
        let [first, end] = outline.groups;
        let mut sum = sum_in_reach(&seen, &sought, &self.outlines.segments, first..end);
        let mut hidden = None;
        if outline.disputed[0] < outline.disputed[1] {
            let (own, hides) = self.disputed(ops, &outline, &receiver, &seen, &sought);
            sum.add(&own);
            hidden = hides;
        }
        let hidden = hidden.unwrap_or_else(|| {
            let Outlines { segments, cells, .. } = &*self.outlines;
            let cell = cell_of(receiver.u, receiver.v);
            let cell = cells.part(outline.cells).iter().find(|other| other.at == cell);
            let [first, end] = cell.map_or([0; 2], |cell| cell.segments);
            hides_center(self.field, &receiver, segments, first..end)
        });
        Sample { blocked: blocked_fraction(hidden, sum.total), disc: sum.disc }
    }

    /// The sum over the receiver's own outline in disputed cells, and whether it hides the disc's
    /// middle if that lies in one of them.
    #[inline(always)]
    fn disputed(
        &mut self,
        ops: &impl Ops,
        group: &Outline,
        receiver: &Receiver,
        seen: &Seen,
        sought: &Sought,
    ) -> (Sum, Option<bool>) {
        let Outlines { disputed, segments, recent, room, .. } = &mut *self.outlines;
        let (test, extent) = (Test::of(receiver), Extent::of(receiver));
        let cell = cell_of(receiver.u, receiver.v);
        let mut own = Own::behind(seen, sought, segments, recent);
        let mut hidden = None;
        for lanes in group.disputed[0]..group.disputed[1] {
            let [mut leaves, close] = disputed.blocking(lanes, receiver, seen, self.field.contact);
            while leaves != 0 {
                let lane = leaves.trailing_zeros();
                let leaf = lanes * LANES + lane as usize;
                let close = (close >> lane & 1 == 1).then_some(&extent);
                leaves &= leaves - 1;
                for at in disputed.cells(leaf) {
                    let middle = at.map(|at| at as f32 + MIDDLE);
                    let reach = (at != cell).then(|| Test::in_reach(seen, middle));
                    let reach = reach.as_ref();
                    let bits = cell_bits(ops, self.field, &test, reach, close, at, room);
                    if is_uniform(&bits) {
                        continue;
                    }
                    let added = own.add(self.field, at, &bits, at == cell);
                    if at == cell {
                        hidden = Some(hides_center(self.field, receiver, own.segments, added));
                    }
                }
            }
        }
        (own.sum(), hidden)
    }

    /// The sum over all of the receiver's own outline, and whether it hides the disc's middle.
    #[inline(always)]
    fn own(
        &mut self,
        ops: &impl Ops,
        receiver: &Receiver,
        seen: &Seen,
        sought: &Sought,
        places: Places,
    ) -> (Sum, bool) {
        let extent = Extent::of(receiver);
        let leaf_test = LeafTest::new(
            self.geometry,
            &extent,
            &Planes::of(receiver),
            [self.field.width, self.field.height],
        );
        let tests = [Test::of(receiver)];
        let cell = cell_of(receiver.u, receiver.v);
        let Outlines { segments, leaves, recent, room, .. } = &mut *self.outlines;
        let mut own = Own::behind(seen, sought, segments, recent);
        let mut hidden = None;
        for part in places.parts() {
            if !leaves.find(self.pyramid, &leaf_test, part) {
                continue;
            }
            for places in leaves.boxes(part, STRIP) {
                let strip = Strip::new(ops, self.field, &tests, &extent, leaves, places, room);
                for i in 0..strip.cells() {
                    let Some((at, [bits])) = strip.divided(i) else { continue };
                    let added = own.add(self.field, at, &bits, at == cell);
                    if at == cell {
                        hidden = Some(hides_center(self.field, receiver, own.segments, added));
                    }
                }
            }
        }
        let none = || hides_center(self.field, receiver, own.segments, 0..0);
        let hidden = hidden.unwrap_or_else(none);
        (own.sum(), hidden)
    }
}

/// The whole part of a number from 0 to `most`, which is less than 2^23; of any beyond, that of the
/// nearer end.
#[inline(always)]
fn whole_part(number: f32, most: f32) -> u32 {
    // Numbers from here on are whole. A cast, which saturates, would be one by one.
    const WHOLE: f32 = 8_388_608.0;
    let number = if number > 0.0 { number } else { 0.0 };
    let number = if number < most { number } else { most };
    let rounded = (number + WHOLE) - WHOLE;
    let cut = if rounded > number { rounded - 1.0 } else { rounded };
    (cut + WHOLE).to_bits() & 0x7f_ffff
}

/// A receiver's own outline, behind the shared one.
struct Own<'a> {
    seen: &'a Seen,
    sought: &'a Sought,
    segments: &'a mut Segments,
    recent: &'a mut Recent,
    /// Where it begins: at a whole group of lanes.
    start: usize,
    /// The sum over what there was no room to keep.
    sum: Sum,
}

impl<'a> Own<'a> {
    #[inline(always)]
    fn behind(
        seen: &'a Seen,
        sought: &'a Sought,
        segments: &'a mut Segments,
        recent: &'a mut Recent,
    ) -> Own<'a> {
        let start = segments.len();
        Own { seen, sought, segments, recent, start, sum: Sum::NONE }
    }

    /// Adds the outline in a cell if it is in reach or around, or `always`, and says which segments
    /// that are.
    #[inline(always)]
    fn add<T: Texel>(
        &mut self,
        field: &Field<'_, T>,
        at: [i32; 2],
        bits: &CellBits,
        always: bool,
    ) -> Range<usize> {
        if !self.segments.has_room(1) {
            self.add_up();
        }
        let first = self.segments.len();
        let (seen, around) = (self.seen, self.sought.around);
        self.recent.outline(field, at, bits, self.segments, |bounds| {
            always | bounds.are_around(seen, around)
        });
        first..self.segments.len()
    }

    /// Adds up all segments, none of which are kept.
    #[inline(always)]
    fn add_up(&mut self) {
        let groups = self.start / LANES..self.segments.pad();
        self.sum.add(&sum(self.seen, self.sought, self.segments, groups));
        self.segments.truncate(self.start);
    }

    /// The sum over all of them.
    #[inline(always)]
    fn sum(mut self) -> Sum {
        self.add_up();
        self.sum
    }
}
