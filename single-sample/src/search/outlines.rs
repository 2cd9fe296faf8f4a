//! The outlines of the blockers around one tile, one for each group of its receivers.

use simd_search::Pyramid;

use super::above::{Above, Plane};
use super::cell::{CELL, CellBits, is_uniform};
use super::disputed::Disputed;
use super::facing::close_to;
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::groups::{GROUPS, Groups};
use super::integral::cell_of;
use super::kernels::{Ops, Work};
use super::leaves::{LeafTest, Leaves};
use super::list::List;
use super::outline::{Places, Room, STRIP, Strip};
use super::planes::{Planes, extent};
use super::reach::{Extent, Reach};
use super::recent::Recent;
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
    /// The longer side of the receivers' extent, in texels.
    pub side: f32,
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
        side: 0.0,
        is_shared: false,
        groups: [0; 2],
        cells: [0; 2],
        disputed: [0; 2],
    };
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
    above: Above,
    pub recent: Recent,
    pub room: Room,
}

impl Outlines {
    pub const fn new() -> Outlines {
        Outlines {
            groups: [None; GROUPS],
            segments: Segments::new(),
            cells: List::new(Cell { at: [0; 2], segments: [0; 2] }),
            disputed: Disputed::new(),
            leaves: Leaves::new(),
            above: Above::new(),
            recent: Recent::new(),
            room: Room::new(),
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
        self.outlines.cells.clear();
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
        let Reach { greatest, is_cut, .. } = reach;
        let own = Outline { greatest, is_cut, side: extent.side(), ..Outline::NONE };
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
        let (field, pyramid) = (self.field, self.pyramid);
        let size = [field.width, field.height];
        let most = extent.nearness[1];
        let nearer = most + close_to(field.contact, most);
        let Outlines { segments, cells, disputed, leaves, above, recent, room, .. } =
            &mut *self.outlines;
        let is_of_use = nearer < reach.greatest;
        let plane = is_of_use.then(|| above.plane(planes, size, self.greatest)).flatten();
        let [left, top] = cell_of(extent.u[0], extent.v[0]);
        let [right, bottom] = cell_of(extent.u[1], extent.v[1]);
        let receivers = Places { columns: [left, right + 1], rows: [top, bottom + 1] };
        // The first test passes what blocks some receivers, and the second what blocks all of them.
        let tests = planes.tests(most);
        let leaf_test = LeafTest::new(self.geometry, extent, planes, size);
        let start = [segments.len() / LANES, cells.len(), disputed.pad()];
        let mut draft =
            Draft { field, pyramid, receivers, segments, cells, disputed, recent, room };
        let mut has_leaves = false;
        for part in reach.places.parts() {
            if !leaves.find(pyramid, &leaf_test, part) {
                continue;
            }
            has_leaves = true;
            let mut fits = true;
            let first_leaf = draft.disputed.len();
            leaves.take_contested(&part, |at| {
                fits = fits && draft.disputed.push(pyramid, at, first_leaf);
            });
            let mut boxes = leaves.boxes(part, if plane.is_some() { CELL as i32 } else { STRIP });
            while let (true, Some(places)) = (fits, boxes.next()) {
                if let Some(plane) = &plane
                    && draft.add_known(ops, above, plane, nearer, places)
                {
                    continue;
                }
                let strip = Strip::new(ops, field, &tests, extent, leaves, places, draft.room);
                fits = fits && draft.add(&strip, first_leaf);
            }
            if !fits {
                draft.segments.pad();
                return Some(own);
            }
        }
        let groups = [start[0], draft.segments.pad()];
        for group in groups[0]..groups[1] {
            draft.segments.bound(group);
        }
        has_leaves.then_some(Outline {
            is_shared: true,
            groups,
            cells: [start[1], draft.cells.len()],
            disputed: [start[2], draft.disputed.pad()],
            ..own
        })
    }
}

/// The outline of one group as far as it is found.
struct Draft<'a, T> {
    field: &'a Field<'a, T>,
    pyramid: &'a Pyramid<'a>,
    /// The cells that the receivers lie in, and maybe more.
    receivers: Places,
    segments: &'a mut Segments,
    cells: &'a mut List<Cell, 256>,
    disputed: &'a mut Disputed,
    recent: &'a mut Recent,
    room: &'a mut Room,
}

impl<T: Texel> Draft<'_, T> {
    /// Adds the cells of a strip; false if there is no room. `first_leaf` is the first disputed one
    /// that cells may belong to.
    #[inline(always)]
    fn add(&mut self, strip: &Strip<2>, first_leaf: usize) -> bool {
        for i in 0..strip.cells() {
            let Some((at, [some, all])) = strip.divided(i) else { continue };
            let fits = if some != all {
                self.disputed.push(self.pyramid, at, first_leaf)
            } else {
                self.segments.has_room(OWN_CELLS) && self.outline(at, &some)
            };
            if !fits {
                return false;
            }
        }
        true
    }

    /// Adds a cell with what is known to be above a plane; false if it must be looked at, or there
    /// is no room.
    #[inline(always)]
    fn add_known(
        &mut self,
        ops: &impl Ops,
        above: &mut Above,
        plane: &Plane,
        nearer: f32,
        Places { columns: [x, _], rows: [y, _] }: Places,
    ) -> bool {
        let at = [x, y];
        let Some(bits) = above.blocking(ops, self.field, plane, at, nearer, self.room) else {
            return false;
        };
        is_uniform(&bits) || (self.segments.has_room(OWN_CELLS) && self.outline(at, &bits))
    }

    /// Adds the outline in a cell; false if there is no room for noting the cell.
    #[inline(always)]
    fn outline(&mut self, at: [i32; 2], bits: &CellBits) -> bool {
        let first = self.segments.len();
        self.recent.outline(self.field, at, bits, self.segments, |_| true);
        let cell = Cell { at, segments: [first, self.segments.len()] };
        !self.receivers.hold(at) || self.cells.push(cell)
    }
}
