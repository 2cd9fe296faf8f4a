//! The outlines of the blockers around one tile, one for each group of its receivers.

use simd_search::Pyramid;

use super::above::Above;
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::groups::{GROUPS, Groups};
use super::kernels::{Ops, Work};
use super::leaves::Leaves;
use super::pieces::{Part, Pieces};
use super::planes::{Planes, extent};
use super::reach::Reach;
use super::soa::Receivers;
use super::trace::{Trace, Traced};

/// The outline of the blockers of one group.
#[derive(Clone, Copy)]
pub(crate) struct Outline {
    /// The nearest depth in reach.
    pub greatest: f32,
    /// Whether the map's border cuts the reach of some receiver.
    pub is_cut: bool,
    /// The longer side of the receivers' extent, in texels.
    pub side: f32,
    /// `None` if it is too long to be kept: then it is found anew, part by part.
    pub part: Option<Part>,
}

/// The outlines of a tile's groups.
pub(crate) struct Outlines {
    /// Of each group; `None` if surely nothing blocks it.
    pub groups: [Option<Outline>; GROUPS],
    pub pieces: Pieces,
    pub leaves: Leaves,
    pub above: Above,
}

impl Outlines {
    pub const fn new() -> Outlines {
        Outlines {
            groups: [None; GROUPS],
            pieces: Pieces::new(),
            leaves: Leaves::new(),
            above: Above::new(),
        }
    }
}

/// Cells that there is room for behind all outlines that are kept, for parts of others.
const SPARE: usize = if cfg!(test) { 1 } else { 8 };

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
        self.outlines.pieces.clear();
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
        let planes = Planes::of_group(self.groups, group, self.receivers, &extent, &reach);
        let Outlines { pieces, leaves, above, .. } = &mut *self.outlines;
        let start = pieces.end();
        let FindOutlines { geometry, field, pyramid, greatest, .. } = *self;
        let mut trace =
            Trace { geometry, field, pyramid, greatest, leaves, above, pieces, spare: SPARE };
        let part = match trace.outline(ops, &extent, &reach, &planes, reach.places) {
            Traced::Nothing => return None,
            Traced::All => Some(self.outlines.pieces.part_since(start)),
            Traced::NoRoom => {
                self.outlines.pieces.truncate(start);
                None
            }
        };
        let Reach { greatest, is_cut, .. } = reach;
        Some(Outline { greatest, is_cut, side: extent.side(), part })
    }
}
