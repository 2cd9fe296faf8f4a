//! Groups of pixels along columns, side by side: what [`super::adaptive`] does to a group along a
//! row, done to all of them at once.

use super::adaptive::{COUNT, Samples, TILE};
use super::curve::{Curve, Curves};
use super::lanes::{Bits, bits, least};
use super::rule::{Beyond, Rule};

/// Groups from one row to another.
#[derive(Clone, Copy)]
pub(crate) struct Strip {
    first_row: u8,
    last_row: u8,
    /// A row before or after these that is known in all columns; if there is none, the first.
    outer_row: u8,
    /// Whether the row in the middle is known in all columns, too.
    is_halved: bool,
    /// Bit x: whether there is a group in column x.
    columns: u16,
}

impl Strip {
    pub const NONE: Strip =
        Strip { first_row: 0, last_row: 0, outer_row: 0, is_halved: false, columns: 0 };

    #[inline(always)]
    pub fn new(rows: [usize; 3], columns: u16) -> Strip {
        let [first_row, last_row, outer_row] = rows.map(|row| row as u8);
        Strip { first_row, last_row, outer_row, is_halved: false, columns }
    }
}

impl Samples {
    /// Interpolates the groups of a strip or asks for their middles; once these are known, looks at
    /// both halves.
    #[inline(always)]
    pub fn settle_strip(&mut self, strip: Strip, rule: &Rule<'_>) {
        let rows = [strip.first_row, strip.last_row, strip.outer_row].map(usize::from);
        let [first, last, _] = rows;
        if !strip.is_halved {
            return self.halve_strip(rows, strip.columns, rule);
        }
        let length = last - first;
        let half = length / 2;
        let middle = first + half;
        let [start, between, stop] = [first, middle, last].map(|y| row(&self.values, y));
        let discs = [first, middle, last].map(|y| row(&self.discs, y));
        let (mut curves, mut fits, mut within) = (Curves::FLAT, [0; TILE], [0; TILE]);
        for x in 0..TILE {
            let ends = [start[x], stop[x]];
            let line = Curve::line(ends, length);
            let bend = between[x] - line.at(half, length);
            curves.set(x, line.bent(half, length, bend));
            let disc = least(least(discs[0][x], discs[1][x]), discs[2][x]);
            let room = rule.room_in_half(first * TILE + x, last * TILE + x, disc);
            fits[x] = u8::from(rule.fits(&ends, bend, room, length));
            within[x] = u8::from(room.is_within_penumbra);
        }
        let agree = self.columns_agree(first, last, bits(&within));
        let fitting = strip.columns & bits(&fits) & agree;
        self.interpolate_strip([first, middle], [first, length], fitting, &curves);
        self.interpolate_strip([middle, last], [first, length], fitting, &curves);
        let others = strip.columns & !fitting;
        self.halve_strip([first, middle, last], others, rule);
        self.halve_strip([middle, last, first], others, rule);
    }

    /// Interpolates the groups in some columns whose ends are close, and asks for the middles of
    /// the others.
    #[inline(always)]
    fn halve_strip(&mut self, [first, last, outer]: [usize; 3], columns: u16, rule: &Rule<'_>) {
        let length = last - first;
        if length <= 1 || columns == 0 {
            return;
        }
        let [start, stop] = [first, last].map(|y| row(&self.values, y));
        let discs = [first, last].map(|y| row(&self.discs, y));
        let (outer_row, beyond) = (row(&self.values, outer), Beyond::of(first, last, outer));
        let (mut curves, mut flat) = (Curves::FLAT, [0; TILE]);
        let (mut close, mut within) = ([0; TILE], [0; TILE]);
        for x in 0..TILE {
            let ends = [start[x], stop[x]];
            curves.set(x, Curve::line(ends, length));
            let disc = least(discs[0][x], discs[1][x]);
            let room = rule.room(first * TILE + x, last * TILE + x, disc);
            close[x] = u8::from(rule.are_close(&ends, room));
            flat[x] = u8::from(rule.is_flat(&ends, outer_row[x], beyond));
            within[x] = u8::from(room.is_within_penumbra);
        }
        let within = bits(&within);
        // What another object is like out there tells nothing.
        let flat = bits(&flat) | !self.columns_agree(first.min(outer), last.max(outer), within);
        let agree = self.columns_agree(first, last, within);
        let close = columns & bits(&close) & flat & agree;
        self.interpolate_strip([first, last], [first, length], close, &curves);
        let others = columns & !close;
        self.asked[first + length / 2] |= others;
        if length > 2 && others != 0 {
            self.strips.push(Strip { is_halved: true, ..Strip::new([first, last, outer], others) });
        }
    }

    /// Interpolates what lies between two rows of a strip, in some columns. No group will end
    /// there: nobody will ask for these pixels' discs.
    #[inline(always)]
    fn interpolate_strip(
        &mut self,
        [from, to]: [usize; 2],
        [first, length]: [usize; 2],
        columns: u16,
        curves: &Curves,
    ) {
        if columns == 0 {
            return;
        }
        for y in from + 1..to {
            let values = &mut self.values.as_chunks_mut::<TILE>().0[y];
            for x in 0..TILE {
                let counts = columns >> x & 1 == 1;
                let value = curves.get(x).at(y - first, length);
                values[x] = if counts { value } else { values[x] };
            }
        }
    }

    /// The columns all of whose pixels from one row to another agree, some of them `within` a
    /// penumbra.
    #[inline(always)]
    fn columns_agree(&self, first: usize, last: usize, within: u16) -> u16 {
        let agree = |same: &Bits| same[first..last].iter().fold(u16::MAX, |all, row| all & row);
        agree(&self.same_object[1]) & (within | agree(&self.same_hard[1]))
    }
}

/// A row of a tile's pixels.
#[inline(always)]
fn row(pixels: &[f32; COUNT], y: usize) -> [f32; TILE] {
    pixels.as_chunks().0[y]
}
