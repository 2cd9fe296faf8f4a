//! Bounds of ever larger parts of a map.

use core::fmt;
use core::ops::Range;

use crate::Map;
use crate::kernels::{Job, run};
use crate::map::{COLUMNS, ROWS};
use shadowmap_core::Level;

/// Columns of texels in a node of the lowest level.
pub(crate) const LEAF_WIDTH: u32 = COLUMNS as u32;
/// Rows of texels in a node of the lowest level.
pub(crate) const LEAF_HEIGHT: u32 = ROWS as u32;
/// Children of a node along each axis.
pub(crate) const FAN: u32 = 4;
/// Nodes in a group: the children of one node.
pub(crate) const LANES: usize = (FAN * FAN) as usize;
/// Levels of the largest map there can be.
pub(crate) const MAX_LEVELS: usize = 16;

/// Storage of a [`Pyramid`]: planar bounds of 16 sibling nodes.
///
/// Node i of a group bounds every texel's nearness n in its part of the map:
/// `low[i] <= n - (slope_x[i] * x + slope_y[i] * y) <= high[i]` with (x, y) measured from the
/// node's centre. A node without texels has `low` above `high`. Allocated by the caller, as
/// `vec![NodeGroup::default(); length]`, and read by whoever has their own questions
/// ([`Pyramid::leaves`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct NodeGroup {
    /// Change of nearness per texel to the right.
    pub slope_x: [f32; LANES],
    /// Change of nearness per texel downwards.
    pub slope_y: [f32; LANES],
    /// The lower bound at the node's centre.
    pub low: [f32; LANES],
    /// The upper bound at the node's centre.
    pub high: [f32; LANES],
}

/// Storage of a [`Pyramid`] for searches with an ID test: which of 16 sibling nodes hold a single
/// object ID. Public only to be allocated: `vec![IdGroup::default(); length]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct IdGroup {
    pub(crate) id: [u32; LANES],
    /// Bit i: all texels of node i have the ID `id[i]`.
    pub(crate) single: u32,
}

/// Where a level's groups lie in the storage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LevelShape {
    /// Index of the level's first group.
    pub first: usize,
    /// Groups per row and rows of groups.
    pub columns: u32,
    pub rows: u32,
}

/// How a map of some size is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    pub width: u32,
    pub height: u32,
    /// From the lowest to the one that is a single group.
    pub levels: [LevelShape; MAX_LEVELS],
    pub count: usize,
    pub groups: usize,
}

impl Layout {
    pub fn new(width: u32, height: u32) -> Layout {
        let mut levels = [LevelShape::default(); MAX_LEVELS];
        let (mut count, mut groups) = (0, 0);
        let mut columns = Layout::columns(width);
        let mut rows = height.div_ceil(LEAF_HEIGHT * FAN);
        if columns > 0 && rows > 0 {
            loop {
                levels[count] = LevelShape { first: groups, columns, rows };
                groups += columns as usize * rows as usize;
                count += 1;
                if columns == 1 && rows == 1 {
                    break;
                }
                (columns, rows) = (columns.div_ceil(FAN), rows.div_ceil(FAN));
            }
        }
        Layout { width, height, levels, count, groups }
    }

    /// Groups of leaves side by side in a map of that width.
    #[inline(always)]
    pub fn columns(width: u32) -> u32 {
        width.div_ceil(LEAF_WIDTH * FAN)
    }

    /// Groups of leaves, which come first in the storage.
    pub fn leaves(&self) -> usize {
        self.levels[0].columns as usize * self.levels[0].rows as usize
    }

    /// The part of storage that holds leaves.
    pub fn leaves_of<'s>(
        &self,
        nodes: &'s mut [NodeGroup],
        ids: &'s mut [IdGroup],
    ) -> (&'s mut [NodeGroup], &'s mut [IdGroup]) {
        let leaf_ids = self.leaves().min(ids.len());
        (&mut nodes[..self.leaves()], &mut ids[..leaf_ids])
    }

    /// Checks the length of storage.
    pub fn check(&self, nodes: &[NodeGroup], ids: &[IdGroup]) -> Result<(), StorageError> {
        let check = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(StorageError { what, found, expected }) }
        };
        check("nodes", nodes.len(), self.groups)?;
        if ids.is_empty() { Ok(()) } else { check("ids", ids.len(), self.groups) }
    }

    /// Where group (x, y) of a level is stored; `None` outside the map.
    #[inline(always)]
    pub fn group(&self, level: usize, x: u32, y: u32) -> Option<usize> {
        let shape = &self.levels[level];
        (x < shape.columns && y < shape.rows)
            .then(|| shape.first + y as usize * shape.columns as usize + x as usize)
    }

    /// Texels per node of a level, along each axis.
    #[inline(always)]
    pub fn node_size(level: usize) -> [u64; 2] {
        [u64::from(LEAF_WIDTH) << (2 * level), u64::from(LEAF_HEIGHT) << (2 * level)]
    }
}

/// A hierarchy of bounds over a map, in storage that the caller owns.
///
/// The crate documentation explains it; [`Pyramid::nearest`] and [`Pyramid::nearest_each`] search
/// with it, [`Pyramid::classify`] judges a whole region of receivers at once.
///
/// ```
/// use shadowmap_core::{DepthMap, Level, LightPoint};
/// use simd_search::{NodeGroup, Pyramid, Query};
/// let mut nearness = vec![0.25; 64 * 64];
/// nearness[40 * 64 + 40] = 0.5;
/// let map = DepthMap::new(64, 64, &nearness, &[]).unwrap();
/// let mut storage = vec![NodeGroup::default(); Pyramid::storage_len(64, 64)];
/// let pyramid = Pyramid::build(Level::detect(), map, &mut storage, &mut []).unwrap();
/// let query = Query::new(LightPoint::flat(30.0, 30.0, 0.25), 0.001, 20.0);
/// let hit = pyramid.nearest(Level::detect(), map, &query).unwrap();
/// assert_eq!((hit.x, hit.y), (40, 40));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Pyramid<'a> {
    pub(crate) layout: Layout,
    pub(crate) nodes: &'a [NodeGroup],
    pub(crate) ids: &'a [IdGroup],
    /// The bits of an object ID that the map holds.
    pub(crate) id_mask: u32,
}

impl<'a> Pyramid<'a> {
    /// How many [`NodeGroup`]s (and, for searches with an ID test, [`IdGroup`]s) a map of that
    /// size needs: about one for 2000 texels.
    #[must_use]
    pub fn storage_len(width: u32, height: u32) -> usize {
        Layout::new(width, height).groups
    }

    /// The pyramid of `map`. Without `ids` (an empty slice) searches with an ID test find the same,
    /// but are not narrowed by it.
    ///
    /// # Errors
    ///
    /// If `nodes` is not [`Pyramid::storage_len`] long, or `ids` neither that nor empty.
    pub fn build<'m>(
        level: Level,
        map: impl Into<Map<'m>>,
        nodes: &'a mut [NodeGroup],
        ids: &'a mut [IdGroup],
    ) -> Result<Pyramid<'a>, StorageError> {
        let map = map.into();
        let (width, height) = (map.width(), map.height());
        Pyramid::update(level, map, nodes, ids, 0..width, 0..height)
    }

    /// The pyramid of `map`, from the storage of one whose map was the same but for the given
    /// columns and rows of texels.
    ///
    /// # Errors
    ///
    /// As [`Pyramid::build`].
    pub fn update<'m>(
        level: Level,
        map: impl Into<Map<'m>>,
        nodes: &'a mut [NodeGroup],
        ids: &'a mut [IdGroup],
        columns: Range<u32>,
        rows: Range<u32>,
    ) -> Result<Pyramid<'a>, StorageError> {
        let map = map.into();
        let layout = Layout::new(map.width(), map.height());
        layout.check(nodes, ids)?;
        let columns = columns.start..columns.end.min(map.width());
        let rows = rows.start..rows.end.min(map.height());
        if !columns.is_empty() && !rows.is_empty() {
            let (nodes, ids) = layout.leaves_of(nodes, ids);
            run(
                level,
                Job::Leaves { map, nodes, ids, columns: columns.clone(), rows: rows.clone() },
            );
        }
        Ok(Pyramid::upon_leaves(level, map, layout, nodes, ids, columns, rows))
    }

    /// The pyramid of `map`, from leaves that were built band by band ([`crate::LeafBands`]).
    ///
    /// # Errors
    ///
    /// As [`Pyramid::build`].
    pub fn finish<'m>(
        level: Level,
        map: impl Into<Map<'m>>,
        nodes: &'a mut [NodeGroup],
        ids: &'a mut [IdGroup],
    ) -> Result<Pyramid<'a>, StorageError> {
        let map = map.into();
        let (width, height) = (map.width(), map.height());
        let layout = Layout::new(width, height);
        layout.check(nodes, ids)?;
        Ok(Pyramid::upon_leaves(level, map, layout, nodes, ids, 0..width, 0..height))
    }

    /// The pyramid, with the nodes above the leaves made anew that depend on the given texels.
    fn upon_leaves(
        level: Level,
        map: Map<'_>,
        layout: Layout,
        nodes: &'a mut [NodeGroup],
        ids: &'a mut [IdGroup],
        columns: Range<u32>,
        rows: Range<u32>,
    ) -> Pyramid<'a> {
        if !columns.is_empty() && !rows.is_empty() {
            let (nodes, ids) = (&mut *nodes, &mut *ids);
            run(level, Job::Upper { layout: &layout, nodes, ids, columns, rows });
        }
        Pyramid { layout, nodes, ids, id_mask: map.id_mask() }
    }

    /// Width and height of the map that it is of.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.layout.width, self.layout.height]
    }

    /// Texels of a leaf, along a row and down.
    pub const LEAF: [u32; 2] = [LEAF_WIDTH, LEAF_HEIGHT];
    /// Leaves of a group along each axis.
    pub const GROUP: u32 = FAN;

    /// The bounds of group (x, y) of the lowest level: of 4 x 4 leaves, row by row. `None` outside
    /// the map.
    #[inline]
    #[must_use]
    pub fn leaves(&self, x: u32, y: u32) -> Option<&'a NodeGroup> {
        self.nodes.get(self.layout.group(0, x, y)?)
    }

    /// Panics unless the pyramid is one of a map of this size.
    #[inline(always)]
    pub(crate) fn check(&self, map: &Map<'_>) {
        assert!(
            [map.width(), map.height()] == self.size(),
            "the pyramid is of a map of another size"
        );
    }
}

/// Storage of a [`Pyramid`] does not have the length that the map needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StorageError {
    what: &'static str,
    found: usize,
    expected: usize,
}

impl fmt::Display for StorageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let StorageError { what, found, expected } = self;
        write!(f, "{what} has {found} groups, the map's pyramid needs {expected}")
    }
}

impl core::error::Error for StorageError {}
