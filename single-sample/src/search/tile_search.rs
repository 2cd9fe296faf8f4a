//! The search of a tile's receivers.

use simd_search::Pyramid;

use super::adaptive::{COUNT, Grid, Keys, Samples, TILE};
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::groups::{GROUPS, Groups};
use super::integral::{Sought, Sum, blocked_fraction};
use super::kernels::{Ops, Work};
use super::lanes::{Bits, rows_of_bits};
use super::list::List;
use super::outline::Places;
use super::outlines::{Outline, Outlines};
use super::planes::{Planes, extent};
use super::reach::{Extent, Reach};
use super::receiver::{Receiver, Seen};
use super::soa::Receivers;
use super::trace::{Trace, Traced};
use crate::Counters;

/// Finds the blocked fractions of all pixels of a tile.
pub(crate) struct SearchTile<'a, T> {
    pub geometry: &'a Geometry,
    pub field: &'a Field<'a, T>,
    pub pyramid: &'a Pyramid<'a>,
    /// The nearest depth of the whole map.
    pub greatest: f32,
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
        for group in 0..GROUPS {
            if let Some(outline @ Outline { part: None, .. }) = self.outlines.groups[group] {
                self.search_in_parts(ops, group, &outline);
            }
        }
    }
}

impl<T: Texel> SearchTile<'_, T> {
    /// Which pixels belong to a group with an outline that is kept.
    #[inline(always)]
    fn needed(&self) -> Bits {
        let groups = &self.outlines.groups;
        let is_kept = |group: usize| groups[group].is_some_and(|outline| outline.part.is_some());
        rows_of_bits(&self.groups.pixels_of(is_kept).map(u8::from))
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
        let Some(outline @ Outline { part: Some(part), .. }) = group else { return Sample::CLEAR };
        let receiver = self.receivers.get(pixel);
        if outline.is_cut && !self.reaches_blockers(&outline, &receiver) {
            return Sample::CLEAR;
        }
        let seen = Seen::of(self.geometry, &receiver);
        let sought = self.sought(&outline);
        let pieces = &mut self.outlines.pieces;
        let (sum, hidden) = pieces.hide(ops, self.field, &part, &receiver, &seen, &sought);
        Sample { blocked: self.blocked(&receiver, &sum, hidden), disc: sum.disc }
    }

    /// Searches all pixels of a group whose outline is too long to be kept. Part by part it is found
    /// again, hides something of each pixel's disc, and is forgotten: to find it once more whenever
    /// other pixels are asked for would take longer.
    #[inline(always)]
    fn search_in_parts(&mut self, ops: &impl Ops, group: usize, outline: &Outline) {
        let mut searched = List::<Partly, COUNT>::new(Partly::NONE);
        for pixel in 0..COUNT {
            if self.groups.has(group, pixel) {
                self.samples.add(pixel, 0.0);
                self.counters.searches += 1;
                if self.reaches_blockers(outline, &self.receivers.get(pixel)) {
                    searched.push(Partly { pixel: pixel as u8, ..Partly::NONE });
                }
            }
        }
        let extent = extent(self.groups, group, self.receivers);
        let size = [self.field.width, self.field.height];
        let reach = Reach::within(self.geometry, outline.greatest, size, &extent);
        let Some(reach) = reach else { return };
        let planes = Planes::of_group(self.groups, group, self.receivers, &extent, &reach);
        let sought = self.sought(outline);
        let SearchTile { geometry, field, pyramid, greatest, receivers, .. } = *self;
        let Outlines { pieces, leaves, above, .. } = &mut *self.outlines;
        let start = pieces.end();
        let mut left = List::<Places, HALVES>::new(reach.places);
        left.push(reach.places);
        while let Some(places) = left.pop() {
            let mut trace =
                Trace { geometry, field, pyramid, greatest, leaves, above, pieces, spare: 0 };
            match trace.outline(ops, &extent, &reach, &planes, places) {
                Traced::Nothing => {}
                Traced::NoRoom => {
                    for half in places.halves() {
                        left.push(half);
                    }
                }
                Traced::All => {
                    let part = pieces.part_since(start);
                    for partly in searched.all_mut() {
                        let receiver = receivers.get(usize::from(partly.pixel));
                        let seen = Seen::of(geometry, &receiver);
                        let (sum, hidden) =
                            pieces.hide(ops, field, &part, &receiver, &seen, &sought);
                        partly.sum.add(&sum);
                        partly.hidden = partly.hidden.or(hidden);
                    }
                }
            }
            pieces.truncate(start);
        }
        for &Partly { pixel, sum, hidden } in searched.all() {
            let pixel = usize::from(pixel);
            let blocked = self.blocked(&self.receivers.get(pixel), &sum, hidden);
            self.samples.add(pixel, blocked);
        }
    }

    /// The blocked fraction of a receiver's disc, from what all of its outline hides.
    #[inline(always)]
    fn blocked(&self, receiver: &Receiver, sum: &Sum, hidden: Option<bool>) -> f32 {
        let none = || self.outlines.pieces.hides_center(self.field, receiver);
        blocked_fraction(hidden.unwrap_or_else(none), sum.total)
    }

    #[inline(always)]
    fn sought(&self, outline: &Outline) -> Sought {
        Sought::between(outline.side * (self.grid.group as f32 / TILE as f32))
    }

    /// Whether a receiver reaches any place with blockers. Counts it if the map's border cuts its
    /// reach.
    #[inline(always)]
    fn reaches_blockers(&mut self, outline: &Outline, receiver: &Receiver) -> bool {
        let size = [self.field.width, self.field.height];
        let extent = Extent::of(receiver);
        let reach = Reach::within(self.geometry, outline.greatest, size, &extent);
        self.counters.cut_by_border += reach.map_or(0, |reach| u32::from(reach.is_cut));
        reach.is_some()
    }
}

/// Parts of a map that are half as large each as the one before, and the last once more: there is
/// room for what a few cells hold.
const HALVES: usize = 64;

/// A pixel of which a part is searched.
#[derive(Clone, Copy)]
struct Partly {
    pixel: u8,
    sum: Sum,
    hidden: Option<bool>,
}

impl Partly {
    const NONE: Partly = Partly { pixel: 0, sum: Sum::NONE, hidden: None };
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
