//! Finding the outline of the blockers around some receivers.

use simd_search::Pyramid;

use super::above::Above;
use super::cell::{CELL, is_uniform};
use super::facing::close_to;
use super::field::{Field, Texel};
use super::geometry::Geometry;
use super::integral::cell_of;
use super::kernels::Ops;
use super::leaves::{LeafTest, Leaves};
use super::outline::{Places, STRIP, Strip};
use super::pieces::Pieces;
use super::planes::Planes;
use super::reach::{Extent, Reach};

/// What outlines are found with.
pub(crate) struct Trace<'a, T> {
    pub geometry: &'a Geometry,
    pub field: &'a Field<'a, T>,
    pub pyramid: &'a Pyramid<'a>,
    /// The nearest depth of the whole map.
    pub greatest: f32,
    pub leaves: &'a mut Leaves,
    pub above: &'a mut Above,
    pub pieces: &'a mut Pieces,
    /// How many cells there should be room for besides.
    pub spare: usize,
}

/// What became of an outline.
pub(crate) enum Traced {
    /// Surely nothing blocks.
    Nothing,
    /// All of it is found.
    All,
    /// There was no room.
    NoRoom,
}

impl<T: Texel> Trace<'_, T> {
    /// Adds the outline in some places to the pieces: that which receivers with this extent and
    /// these planes share, of whose reach these places are all or a part.
    #[inline(always)]
    pub fn outline(
        &mut self,
        ops: &impl Ops,
        extent: &Extent,
        reach: &Reach,
        planes: &Planes,
        places: Places,
    ) -> Traced {
        let Trace { geometry, field, pyramid, greatest, spare, .. } = *self;
        let Trace { pieces, leaves, above, .. } = self;
        let size = [field.width, field.height];
        let most = extent.nearness[1];
        let nearer = most + close_to(field.contact, most);
        let is_of_use = nearer < reach.greatest;
        let plane = is_of_use.then(|| above.plane(planes, size, greatest)).flatten();
        let [left, top] = cell_of(extent.u[0], extent.v[0]);
        let [right, bottom] = cell_of(extent.u[1], extent.v[1]);
        let receivers = Places { columns: [left, right + 1], rows: [top, bottom + 1] };
        // The first test passes what blocks some receivers, and the second what blocks all of them.
        let tests = planes.tests(most);
        let leaf_test = LeafTest::new(geometry, extent, planes, size);
        let start = pieces.end();
        let mut has_leaves = false;
        for part in places.parts() {
            if !leaves.find(pyramid, &leaf_test, part) {
                continue;
            }
            has_leaves = true;
            let mut fits = true;
            leaves.take_contested(&part, |at| {
                fits = fits && pieces.dispute(pyramid, at, start, spare);
            });
            let mut boxes = leaves.boxes(part, if plane.is_some() { CELL as i32 } else { STRIP });
            while let (true, Some(places)) = (fits, boxes.next()) {
                if let Some(plane) = &plane {
                    let at = [places.columns[0], places.rows[0]];
                    let room = &mut pieces.room;
                    if let Some(bits) = above.blocking(ops, field, plane, at, nearer, room) {
                        fits = is_uniform(&bits)
                            || pieces.push(field, at, &bits, receivers.hold(at), spare);
                        continue;
                    }
                }
                let strip =
                    Strip::new(ops, field, &tests, extent, leaves, places, &mut pieces.room);
                for i in 0..strip.cells() {
                    let Some((at, [some, all])) = strip.divided(i) else { continue };
                    fits = fits
                        && if some == all {
                            pieces.push(field, at, &some, receivers.hold(at), spare)
                        } else {
                            pieces.dispute(pyramid, at, start, spare)
                        };
                }
            }
            if !fits {
                return Traced::NoRoom;
            }
        }
        if has_leaves { Traced::All } else { Traced::Nothing }
    }
}
