//! The two layouts of depth + ID maps that can be searched.

use shadowmap_core::{DepthMap, PackedMap};

/// Columns and rows of the tiles that kernels test at once.
pub(crate) const COLUMNS: usize = 16;
/// See [`COLUMNS`].
pub(crate) const ROWS: usize = 8;

/// One row of a tile.
pub(crate) type Row = [f32; COLUMNS];

/// A depth + ID map in either layout.
///
/// Made from a [`DepthMap`] or a [`PackedMap`] (or a reference to one) by `into()`; every function
/// that searches takes either directly.
#[derive(Clone, Copy, Debug)]
pub enum Map<'a> {
    /// Nearness and object IDs in two arrays.
    Planar(DepthMap<'a>),
    /// 24 bits of nearness and 8 bits of object ID in one word (Brabec and Seidel 2002, section
    /// 4.1). Nearness is the upper 24 bits as a number from 0 to 16,777,215, which `f32` holds
    /// exactly: receivers and offsets are in that unit. Object IDs are compared modulo 256.
    Packed(PackedMap<'a>),
}

impl<'a> From<DepthMap<'a>> for Map<'a> {
    fn from(map: DepthMap<'a>) -> Self {
        Map::Planar(map)
    }
}
impl<'a> From<&DepthMap<'a>> for Map<'a> {
    fn from(map: &DepthMap<'a>) -> Self {
        Map::Planar(*map)
    }
}
impl<'a> From<PackedMap<'a>> for Map<'a> {
    fn from(map: PackedMap<'a>) -> Self {
        Map::Packed(map)
    }
}
impl<'a> From<&PackedMap<'a>> for Map<'a> {
    fn from(map: &PackedMap<'a>) -> Self {
        Map::Packed(*map)
    }
}

impl Map<'_> {
    /// Texels per row.
    #[inline(always)]
    #[must_use]
    pub fn width(&self) -> u32 {
        match self {
            Map::Planar(map) => map.width(),
            Map::Packed(map) => map.width(),
        }
    }

    /// Rows.
    #[inline(always)]
    #[must_use]
    pub fn height(&self) -> u32 {
        match self {
            Map::Planar(map) => map.height(),
            Map::Packed(map) => map.height(),
        }
    }

    /// Nearness of texel (x, y).
    ///
    /// # Panics
    ///
    /// If the texel lies outside the map.
    #[inline(always)]
    #[must_use]
    pub fn nearness(&self, x: u32, y: u32) -> f32 {
        let index = self.index(x, y);
        match self {
            Map::Planar(map) => map.nearness()[index],
            Map::Packed(map) => unpack(map.texels()[index]),
        }
    }

    /// Object ID of texel (x, y): modulo 256 in a packed map, 0 in a map without IDs.
    ///
    /// # Panics
    ///
    /// If the texel lies outside the map.
    #[inline(always)]
    #[must_use]
    pub fn id(&self, x: u32, y: u32) -> u32 {
        let index = self.index(x, y);
        match self {
            Map::Planar(map) if map.ids().is_empty() => 0,
            Map::Planar(map) => map.ids()[index],
            Map::Packed(map) => map.texels()[index] & 0xff,
        }
    }

    #[inline(always)]
    fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width() && y < self.height(), "the texel lies outside the map");
        y as usize * self.width() as usize + x as usize
    }

    /// The bits of an object ID that the map holds.
    #[inline(always)]
    pub(crate) fn id_mask(&self) -> u32 {
        match self {
            Map::Planar(_) => u32::MAX,
            Map::Packed(_) => 0xff,
        }
    }

    /// Calls `work` with the nearness of the tile whose first texel is (x, y). The tile must lie
    /// within the map.
    #[inline(always)]
    pub(crate) fn with_tile<T>(&self, x: u32, y: u32, work: impl Fn([&Row; ROWS]) -> T) -> T {
        match self {
            Map::Planar(map) => work(planar_tile(map, x, y)),
            Map::Packed(map) => {
                let mut unpacked = [[0.0; COLUMNS]; ROWS];
                work(unpack_tile(map, x, y, &mut unpacked))
            }
        }
    }

    /// The nearness of the tile whose first texel is (x, y): that of the map itself, or what is put
    /// into `unpacked`. The tile must lie within the map.
    #[inline(always)]
    pub(crate) fn tile<'b>(
        &'b self,
        x: u32,
        y: u32,
        unpacked: &'b mut [Row; ROWS],
    ) -> [&'b Row; ROWS] {
        match self {
            Map::Planar(map) => planar_tile(map, x, y),
            Map::Packed(map) => unpack_tile(map, x, y, unpacked),
        }
    }

    /// The rows of up to `N` tiles side by side, as [`Map::tile`]: of `count` of them, and then
    /// anything.
    #[inline(always)]
    pub(crate) fn tiles<'b, const N: usize>(
        &'b self,
        x: u32,
        y: u32,
        count: usize,
        copied: &'b mut [[Row; N]; ROWS],
    ) -> [&'b [Row; N]; ROWS] {
        let width = self.width() as usize;
        let start = y as usize * width + x as usize;
        match self {
            Map::Planar(map) if count == N => {
                let mut tiles = [whole(map.nearness(), start); ROWS];
                for i in 1..ROWS {
                    tiles[i] = whole(map.nearness(), start + i * width);
                }
                return tiles;
            }
            Map::Planar(map) => {
                for (i, copied) in copied.iter_mut().enumerate() {
                    let row = &map.nearness()[start + i * width..][..count * COLUMNS];
                    copied.as_flattened_mut()[..row.len()].copy_from_slice(row);
                }
            }
            Map::Packed(map) => {
                for (i, copied) in copied.iter_mut().enumerate() {
                    let row = &map.texels()[start + i * width..][..count * COLUMNS];
                    for (copied, row) in copied.iter_mut().zip(row.as_chunks().0) {
                        unpack_row(row, copied);
                    }
                }
            }
        }
        copied.each_ref()
    }

    /// Object IDs of the texels from (x, y) on, as many as a tile has columns. They must lie
    /// within the row.
    #[inline(always)]
    pub(crate) fn row_of_ids(&self, x: u32, y: u32) -> [u32; COLUMNS] {
        let start = y as usize * self.width() as usize + x as usize;
        match self {
            Map::Planar(map) if map.ids().is_empty() => [0; COLUMNS],
            Map::Planar(map) => *row(map.ids(), start),
            Map::Packed(map) => row(map.texels(), start).map(|texel| texel & 0xff),
        }
    }
}

#[inline(always)]
fn planar_tile<'a>(map: &DepthMap<'a>, x: u32, y: u32) -> [&'a Row; ROWS] {
    let width = map.width() as usize;
    let texels = &map.nearness()[y as usize * width + x as usize..];
    // Loops, for closures need not be inlined.
    let mut rows = [row(texels, 0); ROWS];
    for i in 1..ROWS {
        rows[i] = row(texels, i * width);
    }
    rows
}

#[inline(always)]
fn unpack_tile<'b>(
    map: &PackedMap<'_>,
    x: u32,
    y: u32,
    unpacked: &'b mut [Row; ROWS],
) -> [&'b Row; ROWS] {
    let width = map.width() as usize;
    let texels = &map.texels()[y as usize * width + x as usize..];
    for i in 0..ROWS {
        unpack_row(row(texels, i * width), &mut unpacked[i]);
    }
    unpacked.each_ref()
}

#[inline(always)]
fn unpack_row(texels: &[u32; COLUMNS], unpacked: &mut Row) {
    for column in 0..COLUMNS {
        unpacked[column] = unpack(texels[column]);
    }
}

#[inline(always)]
fn whole<const N: usize>(texels: &[f32], start: usize) -> &[Row; N] {
    texels[start..].as_chunks().0.first_chunk().expect("tiles lie within the map")
}

#[inline(always)]
fn row<T, const N: usize>(texels: &[T], start: usize) -> &[T; N] {
    texels[start..].first_chunk().expect("tiles lie within the map")
}

/// Through a signed number, for which every instruction set has a conversion.
#[inline(always)]
fn unpack(texel: u32) -> f32 {
    (texel >> 8) as i32 as f32
}
