//! The leaves of a pyramid, built band by band while the map is drawn.

use shadowmap_core::{BandSlice, Bands, Level};

use crate::Map;
use crate::kernels::{Job, run};
use crate::pyramid::{FAN, IdGroup, LEAF_HEIGHT, Layout, NodeGroup, StorageError};

/// The leaves of a [`Pyramid`](crate::Pyramid), cut into bands of rows.
///
/// Reading a map again that was just drawn costs about as much as all the arithmetic that its
/// pyramid takes. Who builds each band's leaves as soon as the band is drawn finds its texels in
/// the cache, and threads that draw bands build them as well ([`Bands`]).
/// [`Pyramid::finish`](crate::Pyramid::finish) adds the rest.
///
/// ```
/// use shadowmap_core::{DepthMap, Level, Threads, for_each_band};
/// use simd_search::{LeafBands, NodeGroup, Pyramid};
/// let (level, nearness) = (Level::detect(), vec![0.25; 80 * 100]);
/// let mut nodes = vec![NodeGroup::default(); Pyramid::storage_len(80, 100)];
/// let bands = LeafBands::new(80, 100, LeafBands::ROWS, &mut nodes, &mut []).unwrap();
/// for_each_band(Threads::One, bands, &|index, band| {
///     let rows = (index * 32 * 80)..((index + 1) * 32 * 80).min(nearness.len());
///     let height = rows.len() as u32 / 80;
///     band.build(level, DepthMap::new(80, height, &nearness[rows], &[]).unwrap());
/// });
/// let map = DepthMap::new(80, 100, &nearness, &[]).unwrap();
/// let pyramid = Pyramid::finish(level, map, &mut nodes, &mut []).unwrap();
/// # let _ = pyramid;
/// ```
#[derive(Debug)]
pub struct LeafBands<'a> {
    nodes: BandSlice<'a, NodeGroup>,
    ids: BandSlice<'a, IdGroup>,
}

impl<'a> LeafBands<'a> {
    /// Bands have a multiple of this many rows, as many as a [`NodeGroup`] of leaves.
    pub const ROWS: u32 = LEAF_HEIGHT * FAN;

    /// Storage of the pyramid of a map, cut into bands of `rows` rows. Without `ids` as in
    /// [`Pyramid::build`](crate::Pyramid::build).
    ///
    /// # Errors
    ///
    /// As [`Pyramid::build`](crate::Pyramid::build).
    ///
    /// # Panics
    ///
    /// If `rows` is not a multiple of [`LeafBands::ROWS`].
    pub fn new(
        width: u32,
        height: u32,
        rows: u32,
        nodes: &'a mut [NodeGroup],
        ids: &'a mut [IdGroup],
    ) -> Result<LeafBands<'a>, StorageError> {
        assert!(rows > 0 && rows.is_multiple_of(LeafBands::ROWS), "bands of a multiple of 32 rows");
        let layout = Layout::new(width, height);
        layout.check(nodes, ids)?;
        let len = (rows / LeafBands::ROWS) as usize * Layout::columns(width).max(1) as usize;
        let (nodes, ids) = layout.leaves_of(nodes, ids);
        Ok(LeafBands { nodes: BandSlice { data: nodes, len }, ids: BandSlice { data: ids, len } })
    }

    /// Builds the leaves, of one band or of all, from a map that has the texels of their rows and
    /// no others.
    ///
    /// # Panics
    ///
    /// If the map has another size.
    pub fn build<'m>(self, level: Level, map: impl Into<Map<'m>>) {
        let map = map.into();
        let (columns, rows) = (0..map.width(), 0..map.height());
        let (nodes, ids) = (self.nodes.data, self.ids.data);
        assert_eq!(
            Layout::new(columns.end, rows.end).leaves(),
            nodes.len(),
            "the rows of the band"
        );
        run(level, Job::Leaves { map, nodes, ids, columns, rows });
    }
}

impl Bands for LeafBands<'_> {
    fn count(&self) -> usize {
        self.nodes.count()
    }
    fn split_at(self, bands: usize) -> (Self, Self) {
        let (nodes, ids) = (self.nodes.split_at(bands), self.ids.split_at(bands));
        (LeafBands { nodes: nodes.0, ids: ids.0 }, LeafBands { nodes: nodes.1, ids: ids.1 })
    }
}
