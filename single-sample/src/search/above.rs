//! Which texels of cells are above a plane that several tiles show.
//!
//! The discs of one tile's receivers reach over far more of the map than the tile covers, so that
//! neighbours look at much the same cells. Which texels of a cell are above a plane is the same for
//! all of them, up to rounding. If these are also nearer than all of a tile's receivers, and not
//! close to any, they are what blocks each of them.

use super::cell::{CELL, CellBits};
use super::field::{BLOCK_COLUMNS, BLOCK_ROWS, Field, LANE, Texel};
use super::kernels::Ops;
use super::outline::{Room, cell_bits};
use super::planes::{Planes, ROUNDING};
use super::texel_test::Test;

/// Columns and rows of cells that have places of their own. Those farther apart take turns. Few in
/// tests, for small maps to have some.
const PLACES: [usize; 2] = if cfg!(test) { [4, 2] } else { [64, 32] };
/// How many planes are told apart.
const PLANES: usize = 8;
/// The place of new ones among them.
const NEW: usize = 4;
/// What no more tiles than this show is not worth being kept.
const FEW: u32 = if cfg!(test) { 0 } else { 4 };

/// A plane's room for the rounding of the receivers' own, relative to the greatest of what is added
/// up to compare a texel with it: less would take tiles far from each other for different planes,
/// and more the ground for something above itself.
const ROOM: f32 = 12.0 * ROUNDING;

/// What is known of the cells around the tiles so far: 80 KiB.
pub(crate) struct Above {
    planes: [Plane; PLANES],
    /// How many planes there were.
    count: u32,
    cells: [Known; PLACES[0] * PLACES[1]],
}

/// Which texels of one cell are above a plane.
#[derive(Clone, Copy)]
struct Known {
    /// The cell's first texel.
    at: [i32; 2],
    /// The plane's number.
    plane: u32,
    /// The least nearness above the plane; negative infinity if it is not clear what is above it.
    least: f32,
    bits: CellBits,
}

impl Known {
    /// Nothing, for no plane has this number.
    const NONE: Known = Known { at: [0; 2], plane: 0, least: 0.0, bits: CellBits::NONE };

    /// Finds what is above a plane in a cell.
    #[inline(always)]
    fn find<T: Texel>(
        ops: &impl Ops,
        field: &Field<'_, T>,
        plane: &Plane,
        at: [i32; 2],
        room: &mut Room,
    ) -> Known {
        let some = cell_bits(ops, field, &plane.test(-plane.room), None, None, at, room);
        let known = |least: f32| Known { at, plane: plane.number, least, bits: some };
        if some == CellBits::NONE {
            return known(f32::INFINITY);
        }
        let all = cell_bits(ops, field, &plane.test(plane.room), None, None, at, room);
        known(if some == all { least(field, at, &all) } else { f32::NEG_INFINITY })
    }
}

impl Above {
    pub const fn new() -> Above {
        Above {
            planes: [Plane::NONE; PLANES],
            count: 0,
            cells: [Known::NONE; PLACES[0] * PLACES[1]],
        }
    }

    /// The plane that all receivers of a tile with these planes share, in a map of that size
    /// without texels nearer than `greatest`; `None` if there is no such plane, or few tiles have
    /// shown it.
    #[inline(always)]
    pub fn plane(&mut self, planes: &Planes, size: [i32; 2], greatest: f32) -> Option<Plane> {
        let far = [size[0] as f32, size[1] as f32, greatest];
        let known = self.planes.iter().position(|plane| plane.stands_for(planes, far));
        let mut plane = match known {
            Some(i) => self.planes[i],
            None => Plane::of(planes, far, self.count + 1),
        };
        if known.is_none() {
            if !plane.stands_for(planes, far) {
                return None;
            }
            self.count += 1;
        }
        plane.tiles += 1;
        // The latest comes first, but for new ones, of which most are not seen again.
        let (first, last) = known.map_or((NEW, PLANES - 1), |i| (0, i));
        self.planes.copy_within(first..last, first + 1);
        self.planes[first] = plane;
        (plane.tiles > FEW).then_some(plane)
    }

    /// Which texels of the cell whose first one is `at` block all receivers on a plane; `None` if
    /// not the same ones may block each of them. They do if all that is above the plane is `nearer`
    /// than so: than the receivers, and than what is close to them.
    #[inline(always)]
    pub fn blocking<T: Texel>(
        &mut self,
        ops: &impl Ops,
        field: &Field<'_, T>,
        plane: &Plane,
        at: [i32; 2],
        nearer: f32,
        room: &mut Room,
    ) -> Option<CellBits> {
        let known = &mut self.cells[plane.place(at)];
        if known.plane != plane.number || known.at != at {
            *known = Known::find(ops, field, plane, at, room);
        }
        (known.least > nearer).then_some(known.bits)
    }
}

/// The least nearness of those texels of a cell that are set; infinity if none are.
#[inline(always)]
fn least<T: Texel>(field: &Field<'_, T>, at: [i32; 2], bits: &CellBits) -> f32 {
    let mut room = [LANE; BLOCK_ROWS];
    let rows = field.block(at, &mut room).rows;
    let mut least = [f32::INFINITY; BLOCK_COLUMNS];
    for y in 0..BLOCK_ROWS {
        let bits = u32::from(bits.row(y));
        for x in 0..BLOCK_COLUMNS {
            let counts = (bits & 1 << x != 0) & (rows[y][x] < least[x]);
            least[x] = if counts { rows[y][x] } else { least[x] };
        }
    }
    let mut half = BLOCK_COLUMNS / 2;
    while half > 0 {
        for x in 0..half {
            least[x] = least[x].min(least[x + half]);
        }
        half /= 2;
    }
    least[0]
}

/// A plane that receivers share: above it are texels (s, t) of nearness n for which
/// `hu s + hv t + hn n > above`.
#[derive(Clone, Copy)]
pub(crate) struct Plane {
    number: u32,
    /// How many tiles have shown it.
    tiles: u32,
    hu: f32,
    hv: f32,
    hn: f32,
    above: f32,
    /// What is farther from it than this is above the planes of all receivers, or of none.
    room: f32,
}

impl Plane {
    /// That of no receivers.
    const NONE: Plane =
        Plane { number: 0, tiles: 0, hu: 0.0, hv: 0.0, hn: 0.0, above: 0.0, room: 0.0 };

    /// One amid those of some receivers, for texels whose coordinates and nearness go so far.
    #[inline(always)]
    fn of(planes: &Planes, far: [f32; 3], number: u32) -> Plane {
        let middle = |[low, high]: [f32; 2]| (low + high) * 0.5;
        let [hu, hv, hn] = [middle(planes.hu), middle(planes.hv), middle(planes.hn)];
        let [u, v] = planes.at;
        let above = middle(planes.above) + (hn * planes.nearness + (hu * u + hv * v));
        let across = hu.abs() * far[0] + hv.abs() * far[1];
        let room = (above.abs() + (hn.abs() * far[2] + across)) * ROOM;
        Plane { number, tiles: 0, hu, hv, hn, above, room }
    }

    /// Whether it is that of all receivers with these planes but for half of its room. Of their
    /// texels none that blocks is less near than the receivers.
    #[inline(always)]
    fn stands_for(&self, planes: &Planes, far: [f32; 3]) -> bool {
        let apart = |[low, high]: [f32; 2], value: f32| (value - low).max(high - value);
        let ([u, v], n) = (planes.at, planes.nearness);
        let along = [self.hu * u, self.hv * v, self.hn * n];
        let above = self.above - (along[2] + (along[0] + along[1]));
        let across = apart(planes.hu, self.hu) * far[0] + apart(planes.hv, self.hv) * far[1];
        let apart =
            apart(planes.above, above) + (apart(planes.hn, self.hn) * (far[2] - n) + across);
        let rounding = self.above.abs() + (along[2].abs() + (along[0].abs() + along[1].abs()));
        // False for NaN.
        apart + rounding * (0.25 * ROUNDING) < self.room * 0.5
    }

    /// The place of a cell in the [`Above`]: neighbours have different ones, and so has the same
    /// cell for other planes.
    #[inline(always)]
    fn place(&self, at: [i32; 2]) -> usize {
        let [x, y] = at.map(|at| at.div_euclid(CELL as i32) as u32);
        let column = x.wrapping_add(self.number.wrapping_mul(21)) as usize % PLACES[0];
        let row = y.wrapping_add(self.number.wrapping_mul(11)) as usize % PLACES[1];
        row * PLACES[0] + column
    }

    /// The test for what is above the plane and so much more.
    #[inline(always)]
    fn test(&self, room: f32) -> Test {
        let Plane { hu, hv, hn, above, .. } = *self;
        let nearness = f32::NEG_INFINITY;
        Test { at: [0.0; 2], hu: [hu; 2], hv: [hv; 2], hn, above: above + room, nearness }
    }
}
