//! What outlines are made of, and what they hide of a receiver's light.

use core::ops::Range;

use simd_search::Pyramid;

use super::cell::{CELL, CellBits, is_uniform};
use super::disputed::Disputed;
use super::field::{Field, Texel};
use super::integral::{Sought, Sum, cell_of, hides_center, sum, sum_in_reach};
use super::kernels::Ops;
use super::list::List;
use super::outline::{Room, cell_bits};
use super::reach::Extent;
use super::receiver::{Receiver, Seen};
use super::recent::Recent;
use super::segments::{LANES, Segments};
use super::texel_test::Test;

/// From a cell's first texel to its middle.
const MIDDLE: f32 = CELL as f32 * 0.5 + 0.5;

/// A cell by its first texel, and its range of the shared segments.
#[derive(Clone, Copy)]
struct Cell {
    at: [i32; 2],
    segments: [usize; 2],
}

/// The outline of the blockers of one group, or a part of it, as ranges of what [`Pieces`] hold.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    /// Groups of lanes.
    segments: [usize; 2],
    cells: [usize; 2],
    /// Groups of lanes.
    disputed: [usize; 2],
}

/// Where a part begins, or ends.
#[derive(Clone, Copy)]
pub(crate) struct Mark {
    segments: usize,
    cells: usize,
    disputed: usize,
}

/// The outlines of a tile's groups.
pub(crate) struct Pieces {
    /// The outlines in cells that look the same to all receivers of a group. Behind them, for a
    /// while, those of one receiver's own.
    segments: Segments,
    /// Of these the cells that receivers lie in.
    cells: List<Cell, 256>,
    /// The cells that look different to some receivers of a group.
    disputed: Disputed,
    recent: Recent,
    pub room: Room,
}

/// Cells that there is room for behind all shared segments.
const OWN_CELLS: usize = if cfg!(test) { 1 } else { 3 };

impl Pieces {
    pub const fn new() -> Pieces {
        Pieces {
            segments: Segments::new(),
            cells: List::new(Cell { at: [0; 2], segments: [0; 2] }),
            disputed: Disputed::new(),
            recent: Recent::new(),
            room: Room::new(),
        }
    }

    /// Forgets all outlines.
    pub fn clear(&mut self) {
        self.truncate(Mark { segments: 0, cells: 0, disputed: 0 });
    }

    /// Where the next outline begins, if the last one was ended by [`Pieces::part_since`].
    pub fn end(&self) -> Mark {
        let (segments, disputed) = (self.segments.len(), self.disputed.len());
        Mark { segments, cells: self.cells.len(), disputed }
    }

    /// Forgets what was added since then.
    pub fn truncate(&mut self, mark: Mark) {
        self.segments.truncate(mark.segments);
        self.cells.truncate(mark.cells);
        self.disputed.truncate(mark.disputed);
    }

    /// Adds the outline in a cell that looks the same to all receivers, and notes the cell if
    /// receivers lie in it. False if there is no room for it and `spare` other cells.
    #[inline(always)]
    pub fn push<T: Texel>(
        &mut self,
        field: &Field<'_, T>,
        at: [i32; 2],
        bits: &CellBits,
        holds_receivers: bool,
        spare: usize,
    ) -> bool {
        let fits = self.segments.has_room(1 + OWN_CELLS + spare)
            && (!holds_receivers || self.cells.has_room(1 + spare));
        if fits {
            let first = self.segments.len();
            self.recent.outline(field, at, bits, &mut self.segments, |_| true);
            if holds_receivers {
                self.cells.push(Cell { at, segments: [first, self.segments.len()] });
            }
        }
        fits
    }

    /// Adds a cell that looks different to some receivers. False if there is no room for it and
    /// `spare` groups of others.
    #[inline(always)]
    pub fn dispute(
        &mut self,
        pyramid: &Pyramid<'_>,
        at: [i32; 2],
        since: Mark,
        spare: usize,
    ) -> bool {
        let fits = self.disputed.has_room(1 + spare * LANES);
        if fits {
            self.disputed.push(pyramid, at, since.disputed);
        }
        fits
    }

    /// What was added since then.
    #[inline(always)]
    pub fn part_since(&mut self, mark: Mark) -> Part {
        let segments = [mark.segments / LANES, self.segments.pad()];
        for group in segments[0]..segments[1] {
            self.segments.bound(group);
        }
        let disputed = [mark.disputed / LANES, self.disputed.pad()];
        Part { segments, cells: [mark.cells, self.cells.len()], disputed }
    }

    /// Whether the middle of a receiver's disc is hidden if its cell has no outline.
    pub fn hides_center<T: Texel>(&self, field: &Field<'_, T>, receiver: &Receiver) -> bool {
        hides_center(field, receiver, &self.segments, 0..0)
    }

    /// What a part hides of a receiver's disc, and whether it hides the disc's middle if that lies
    /// in one of its cells.
    #[inline(always)]
    pub fn hide<T: Texel>(
        &mut self,
        ops: &impl Ops,
        field: &Field<'_, T>,
        part: &Part,
        receiver: &Receiver,
        seen: &Seen,
        sought: &Sought,
    ) -> (Sum, Option<bool>) {
        let mut sum =
            sum_in_reach(seen, sought, &self.segments, part.segments[0]..part.segments[1]);
        let mut hidden = None;
        if part.disputed[0] < part.disputed[1] {
            let (own, hides) = self.own(ops, field, part, receiver, seen, sought);
            sum.add(&own);
            hidden = hides;
        }
        let hidden = hidden.or_else(|| {
            let at = cell_of(receiver.u, receiver.v);
            let cell = self.cells.part(part.cells).iter().find(|cell| cell.at == at)?;
            let [first, end] = cell.segments;
            Some(hides_center(field, receiver, &self.segments, first..end))
        });
        (sum, hidden)
    }

    /// The sum over the receiver's own outline in disputed cells, and whether it hides the disc's
    /// middle if that lies in one of them.
    #[inline(always)]
    fn own<T: Texel>(
        &mut self,
        ops: &impl Ops,
        field: &Field<'_, T>,
        part: &Part,
        receiver: &Receiver,
        seen: &Seen,
        sought: &Sought,
    ) -> (Sum, Option<bool>) {
        let Pieces { disputed, segments, recent, room, .. } = self;
        let (test, extent) = (Test::of(receiver), Extent::of(receiver));
        let cell = cell_of(receiver.u, receiver.v);
        let mut own = Own::behind(seen, sought, segments, recent);
        let mut hidden = None;
        for lanes in part.disputed[0]..part.disputed[1] {
            let [mut leaves, close] = disputed.blocking(lanes, receiver, seen, field.contact);
            while leaves != 0 {
                let lane = leaves.trailing_zeros();
                let leaf = lanes * LANES + lane as usize;
                let close = (close >> lane & 1 == 1).then_some(&extent);
                leaves &= leaves - 1;
                for at in disputed.cells(leaf) {
                    let middle = at.map(|at| at as f32 + MIDDLE);
                    let reach = (at != cell).then(|| Test::in_reach(seen, middle));
                    let reach = reach.as_ref();
                    let bits = cell_bits(ops, field, &test, reach, close, at, room);
                    if is_uniform(&bits) {
                        continue;
                    }
                    let added = own.add(field, at, &bits, at == cell);
                    if at == cell {
                        hidden = Some(hides_center(field, receiver, own.segments, added));
                    }
                }
            }
        }
        (own.sum(), hidden)
    }
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
