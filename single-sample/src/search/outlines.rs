//! The outlines of the blockers around one tile, one for each group of its receivers.

use simd_search::Pyramid;

use super::cell::outline;
use super::disputed::Disputed;
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::groups::{GROUPS, Groups};
use super::integral::cell_of;
use super::kernels::{Ops, Work};
use super::leaves::{LeafTest, Leaves};
use super::outline::{Places, STRIP, Strip};
use super::planes::{Planes, extent};
use super::reach::{Extent, Reach};
use super::segments::{LANES, Segments};
use super::soa::Receivers;

/// A cell by its first texel, and its range of the shared segments.
#[derive(Clone, Copy)]
pub(crate) struct Cell {
    pub at: [i32; 2],
    pub segments: [usize; 2],
}

/// The outline of the blockers of one group, as ranges of what [`Outlines`] holds.
#[derive(Clone, Copy)]
pub(crate) struct Outline {
    /// The nearest depth in reach.
    pub greatest: f32,
    /// Whether the map's border cuts the reach of some receiver.
    pub is_cut: bool,
    /// Whether the outline is in `segments` and `disputed`. If not, receivers find their own.
    pub is_shared: bool,
    /// Groups of lanes.
    pub groups: [usize; 2],
    pub cells: [usize; 2],
    /// Groups of lanes.
    pub disputed: [usize; 2],
}

impl Outline {
    const NONE: Outline = Outline {
        greatest: 0.0,
        is_cut: false,
        is_shared: false,
        groups: [0; 2],
        cells: [0; 2],
        disputed: [0; 2],
    };
}

/// A list of at most `N`.
pub(crate) struct List<T, const N: usize> {
    items: [T; N],
    len: usize,
}

impl<T: Copy, const N: usize> List<T, N> {
    const fn new(item: T) -> Self {
        List { items: [item; N], len: 0 }
    }

    /// False if there is no room.
    #[inline(always)]
    fn push(&mut self, item: T) -> bool {
        let Some(place) = self.items.get_mut(self.len) else { return false };
        *place = item;
        self.len += 1;
        true
    }

    #[inline(always)]
    pub fn part(&self, [from, end]: [usize; 2]) -> &[T] {
        &self.items[from..end]
    }
}

/// The outlines of a tile's groups.
pub(crate) struct Outlines {
    /// Of each group; `None` if surely nothing blocks it.
    pub groups: [Option<Outline>; GROUPS],
    /// The outlines in cells that look the same to all receivers of a group. Behind them, for a
    /// while, those of one receiver's own.
    pub segments: Segments,
    /// Of these the cells that receivers lie in.
    pub cells: List<Cell, 256>,
    /// The cells that look different to some receivers of a group.
    pub disputed: Disputed,
    pub leaves: Leaves,
}

impl Outlines {
    pub const fn new() -> Outlines {
        Outlines {
            groups: [None; GROUPS],
            segments: Segments::new(),
            cells: List::new(Cell { at: [0; 2], segments: [0; 2] }),
            disputed: Disputed::new(),
            leaves: Leaves::new(),
        }
    }
}

/// Cells that there is room for behind all shared segments.
const OWN_CELLS: usize = 4;

/// Finds the outlines of a tile's groups.
pub(crate) struct FindOutlines<'a, T> {
    pub geometry: &'a Geometry,
    pub field: &'a Field<'a, T>,
    pub pyramid: &'a Pyramid<'a>,
    /// The nearest depth of the whole map.
    pub greatest: f32,
    pub receivers: &'a Receivers,
    pub groups: &'a Groups,
    pub outlines: &'a mut Outlines,
}

impl<T: Texel> Work for FindOutlines<'_, T> {
    #[inline(always)]
    fn run(mut self, ops: &impl Ops) {
        self.outlines.segments.truncate(0);
        self.outlines.cells.len = 0;
        self.outlines.disputed.clear();
        for group in 0..GROUPS {
            let is_empty = self.groups.members[group] == 0;
            self.outlines.groups[group] = if is_empty { None } else { self.group(ops, group) };
        }
    }
}

impl<T: Texel> FindOutlines<'_, T> {
    #[inline(always)]
    fn group(&mut self, ops: &impl Ops, group: usize) -> Option<Outline> {
        let size = [self.field.width, self.field.height];
        let extent = extent(self.groups, group, self.receivers);
        let reach = Reach::new(self.geometry, self.pyramid, self.greatest, size, &extent)?;
        let own = Outline { greatest: reach.greatest, is_cut: reach.is_cut, ..Outline::NONE };
        let planes = Planes::of_group(self.groups, group, self.receivers, &extent, &reach);
        self.shared(ops, &extent, &reach, &planes, own)
    }

    /// The outline that all receivers share; if there is no room for it, `own`.
    #[inline(always)]
    fn shared(
        &mut self,
        ops: &impl Ops,
        extent: &Extent,
        reach: &Reach,
        planes: &Planes,
        own: Outline,
    ) -> Option<Outline> {
        let Outlines { segments, cells, disputed, leaves, .. } = &mut *self.outlines;
        // The first test passes what blocks some receivers, and the second what blocks all of them.
        let tests = planes.tests(extent.nearness[1]);
        let leaf_test =
            LeafTest::new(self.geometry, extent, planes, [self.field.width, self.field.height]);
        let start = [segments.len() / LANES, cells.len, disputed.pad()];
        let [left, top] = cell_of(extent.u[0], extent.v[0]);
        let [right, bottom] = cell_of(extent.u[1], extent.v[1]);
        let receivers = Places { columns: [left, right + 1], rows: [top, bottom + 1] };
        let mut has_leaves = false;
        for part in reach.places.parts() {
            if !leaves.find(self.pyramid, &leaf_test, part) {
                continue;
            }
            has_leaves = true;
            let mut fits = true;
            let first_leaf = disputed.len();
            leaves.take_contested(&part, |at| {
                fits = fits && disputed.push(self.pyramid, at, first_leaf);
            });
            if !fits {
                segments.pad();
                return Some(own);
            }
            for places in leaves.boxes(part, STRIP) {
                let strip = Strip::new(ops, self.field, &tests, extent, leaves, places);
                for i in 0..strip.cells() {
                    let Some((at, [some, all])) = strip.divided(i) else { continue };
                    let first = segments.len();
                    let fits = if some != all {
                        disputed.push(self.pyramid, at, first_leaf)
                    } else if !segments.has_room(OWN_CELLS) {
                        false
                    } else {
                        outline(self.field, at, &some, segments);
                        let cell = Cell { at, segments: [first, segments.len()] };
                        !receivers.hold(at) || cells.push(cell)
                    };
                    if !fits {
                        segments.pad();
                        return Some(own);
                    }
                }
            }
        }
        let groups = [start[0], segments.pad()];
        for group in groups[0]..groups[1] {
            segments.bound(group);
        }
        has_leaves.then_some(Outline {
            is_shared: true,
            groups,
            cells: [start[1], cells.len],
            disputed: [start[2], disputed.pad()],
            ..own
        })
    }
}
