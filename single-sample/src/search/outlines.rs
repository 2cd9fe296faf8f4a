//! The outlines of the blockers around one tile, one for each group of its receivers.

use simd_search::Pyramid;

use super::adaptive::COUNT;
use super::cell::outline;
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::groups::{GROUPS, Groups, LONERS};
use super::integral::cell_of;
use super::kernels::{Ops, Work};
use super::leaves::{LeafTest, Leaves};
use super::outline::{Places, STRIP, Strip};
use super::planes::{Plane, bounds, extent};
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
    /// The outlines in cells that look the same to all receivers of a group.
    pub segments: Segments,
    /// Of these the cells that receivers lie in.
    pub cells: List<Cell, 256>,
    /// The cells where some texel blocks some receivers of a group and not others.
    pub disputed: List<[i32; 2], 256>,
    /// Memory for a receiver's own outline.
    pub own: Segments,
    pub leaves: Leaves,
}

impl Outlines {
    pub const fn new() -> Outlines {
        Outlines {
            groups: [None; GROUPS],
            segments: Segments::new(),
            cells: List::new(Cell { at: [0; 2], segments: [0; 2] }),
            disputed: List::new([0; 2]),
            own: Segments::new(),
            leaves: Leaves::new(),
        }
    }
}

/// The most disputed cells that are cheaper than an outline of each receiver's own.
const MOST_DISPUTED: usize = 48;

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
        self.outlines.segments.clear();
        self.outlines.cells.len = 0;
        self.outlines.disputed.len = 0;
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
        if group == LONERS {
            return Some(own);
        }
        let first = (0..COUNT).find(|&pixel| self.groups.has(group, pixel))?;
        let corners = reach.places.corners();
        let bounds = bounds(self.groups, group, self.receivers, first, &corners);
        self.shared(ops, &extent, &reach, &bounds, own)
    }

    /// The outline that all receivers share; if there is no room for it, `own`.
    #[inline(always)]
    fn shared(
        &mut self,
        ops: &impl Ops,
        extent: &Extent,
        reach: &Reach,
        bounds: &[Plane; 2],
        own: Outline,
    ) -> Option<Outline> {
        let Outlines { segments, cells, disputed, leaves, .. } = &mut *self.outlines;
        // What is above the first blocks some receivers, what is above the second all of them.
        let tests = [bounds[0].test(extent.nearness[0]), bounds[1].test(extent.nearness[1])];
        let leaf_test =
            LeafTest::new(self.geometry, extent, bounds, [self.field.width, self.field.height]);
        let start = [segments.len(), cells.len, disputed.len];
        let [left, top] = cell_of(extent.u[0], extent.v[0]);
        let [right, bottom] = cell_of(extent.u[1], extent.v[1]);
        let receivers = Places { columns: [left, right + 1], rows: [top, bottom + 1] };
        let mut has_leaves = false;
        for part in reach.places.parts() {
            if !leaves.find(self.pyramid, &leaf_test, part) {
                continue;
            }
            has_leaves = true;
            for places in leaves.boxes(part, STRIP) {
                let strip = Strip::new(ops, self.field, &tests, places);
                for i in 0..strip.cells() {
                    let Some((at, [some, all])) = strip.divided(i) else { continue };
                    let first = segments.len();
                    let fits = if some != all {
                        disputed.len - start[2] < MOST_DISPUTED && disputed.push(at)
                    } else if segments.is_full() {
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
        let groups = [start[0] / LANES, segments.pad()];
        for group in groups[0]..groups[1] {
            segments.bound(group);
        }
        has_leaves.then_some(Outline {
            is_shared: true,
            groups,
            cells: [start[1], cells.len],
            disputed: [start[2], disputed.len],
            ..own
        })
    }
}
