//! The light's texels, as the search reads them.

use shadowmap_core::View;

use super::geometry::Geometry;
use crate::LightMap;

/// Columns of texels that are tested at a time.
pub(crate) const BLOCK_COLUMNS: usize = 16;
/// Rows of texels that are tested at a time: those of a leaf of the pyramid, and the next.
pub(crate) const BLOCK_ROWS: usize = 9;

/// Nearness of texels side by side.
pub(crate) type Row = [f32; BLOCK_COLUMNS];

/// The number of each texel in a row.
pub(crate) const LANE: Row =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Texels that are tested at a time.
pub(crate) struct Block<'a> {
    /// The centre of the first.
    pub first: [f32; 2],
    pub rows: [&'a Row; BLOCK_ROWS],
}

/// One texel of a map in either layout. Its nearness is in the unit that
/// [`super::geometry::Geometry::unit`] says.
pub(crate) trait Texel: Copy + Sync {
    /// Nearness of the map per nearness of the view.
    fn unit(view: &View) -> f32;
    fn nearness(self) -> f32;
    /// The nearness of a row of texels, which may be written to `room`.
    fn row<'a, const COLUMNS: usize>(
        texels: &'a [Self; COLUMNS],
        room: &'a mut [f32; COLUMNS],
    ) -> &'a [f32; COLUMNS];
}

impl Texel for f32 {
    fn unit(_: &View) -> f32 {
        1.0
    }
    #[inline(always)]
    fn nearness(self) -> f32 {
        self
    }
    #[inline(always)]
    fn row<'a, const COLUMNS: usize>(
        texels: &'a [f32; COLUMNS],
        _: &'a mut [f32; COLUMNS],
    ) -> &'a [f32; COLUMNS] {
        texels
    }
}

/// A texel of a [`shadowmap_core::PackedMap`].
impl Texel for u32 {
    fn unit(view: &View) -> f32 {
        16_777_215.0 / view.max_nearness()
    }
    #[inline(always)]
    fn nearness(self) -> f32 {
        // Through a signed number, for which every instruction set has a conversion.
        (self >> 8) as i32 as f32
    }
    #[inline(always)]
    fn row<'a, const COLUMNS: usize>(
        texels: &'a [u32; COLUMNS],
        room: &'a mut [f32; COLUMNS],
    ) -> &'a [f32; COLUMNS] {
        for (nearness, texel) in room.iter_mut().zip(texels) {
            *nearness = texel.nearness();
        }
        room
    }
}

/// A map of texels. Outside of it nothing blocks.
#[derive(Clone, Copy)]
pub(crate) struct Field<'a, T> {
    pub texels: &'a [T],
    pub width: i32,
    pub height: i32,
    /// See [`Geometry::contact`].
    pub contact: f32,
}

impl<'a, T: Texel> Field<'a, T> {
    /// The texels of a map of `light`.
    pub fn new(light: &LightMap<'_>, texels: &'a [T], geometry: &Geometry) -> Self {
        let [width, height] = [light.view().width(), light.view().height()].map(|size| size as i32);
        Field { texels, width, height, contact: geometry.contact }
    }

    /// Nearness of texel (x, y); NaN outside the map.
    #[inline(always)]
    pub fn nearness(&self, x: i32, y: i32) -> f32 {
        if (0..self.width).contains(&x) && (0..self.height).contains(&y) {
            self.texels[y as usize * self.width as usize + x as usize].nearness()
        } else {
            f32::NAN
        }
    }

    /// The block whose first texel is (x, y); NaN outside the map. Texels that cannot be borrowed
    /// are written to `room`.
    #[inline(always)]
    pub fn block<'b>(&'b self, at: [i32; 2], room: &'b mut [Row; BLOCK_ROWS]) -> Block<'b> {
        Block { first: at.map(|at| at as f32 + 0.5), rows: self.rows(at, room) }
    }

    /// Rows of texels, of which (x, y) is the first, in the same way.
    #[inline(always)]
    pub fn rows<'b, const COLUMNS: usize, const ROWS: usize>(
        &'b self,
        [x, y]: [i32; 2],
        room: &'b mut [[f32; COLUMNS]; ROWS],
    ) -> [&'b [f32; COLUMNS]; ROWS] {
        if x < 0 || y < 0 || x > self.width - COLUMNS as i32 || y > self.height - ROWS as i32 {
            for (row, y) in room.iter_mut().zip(y..) {
                for (nearness, x) in row.iter_mut().zip(x..) {
                    *nearness = self.nearness(x, y);
                }
            }
            return room.each_ref();
        }
        let mut start = y as usize * self.width as usize + x as usize;
        let mut rows = [&Zero::<COLUMNS>::ROW; ROWS];
        for (row, room) in rows.iter_mut().zip(room) {
            let texels = self.texels[start..].first_chunk().expect("the rows lie in the map");
            *row = T::row(texels, room);
            start += self.width as usize;
        }
        rows
    }
}

/// What a row refers to before its texels are known.
struct Zero<const COLUMNS: usize>;

impl<const COLUMNS: usize> Zero<COLUMNS> {
    const ROW: [f32; COLUMNS] = [0.0; COLUMNS];
}
