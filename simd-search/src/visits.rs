//! How much of a map and of its pyramid a search looks at.

use core::cell::Cell;

use crate::build::{Bounds, Family};
use crate::kernels::{Job, Ops, scalar};
use crate::leaf::{Candidate, Leaf, Node, SiftTest, Tile};
use crate::leaves::{Ranges, Slopes, Tiles};
use crate::map::{COLUMNS, ROWS, Row};
use crate::pyramid::{LANES, NodeGroup};
use crate::reach::{Boxes, GroupTest, Verdicts};
use crate::receivers::Seekers;
use crate::search::TileTest;
use crate::{Map, Pyramid, Query};

/// What a search looked at: the same at every level, since all take the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visits {
    /// Texels compared, 16 at a time.
    pub texels: u64,
    /// Nodes of the pyramid compared, 16 at a time.
    pub nodes: u64,
}

impl Visits {
    /// What [`crate::nearest`] looks at. With jitter, and in a map of fewer than 16 columns or 8
    /// rows, texels are compared one by one, and such are not counted.
    #[must_use]
    pub fn of_box<'a>(map: impl Into<Map<'a>>, query: &Query) -> Visits {
        counted(Job::InBox { map: map.into(), query, hit: &mut None })
    }

    /// What [`Pyramid::nearest_each`] looks at, whose answers are in `hits` then. Texels as in
    /// [`Visits::of_box`].
    ///
    /// # Panics
    ///
    /// If the pyramid is of a map of another size, or there are not as many `hits` as queries.
    #[must_use]
    pub fn of_pyramid<'a>(
        map: impl Into<Map<'a>>,
        pyramid: &Pyramid<'_>,
        queries: &[Query],
        hits: &mut [Option<crate::Hit>],
    ) -> Visits {
        let map = map.into();
        pyramid.check(&map);
        assert_eq!(queries.len(), hits.len(), "one hit per query");
        counted(Job::InPyramid { map, pyramid, queries, hits })
    }
}

fn counted(job: Job<'_>) -> Visits {
    let ops = Counted { ops: scalar::kernels(), texels: Cell::new(0), nodes: Cell::new(0) };
    job.run(&ops);
    Visits { texels: ops.texels.get(), nodes: ops.nodes.get() }
}

/// Kernels that count what they are asked.
struct Counted<K> {
    ops: K,
    texels: Cell<u64>,
    nodes: Cell<u64>,
}

impl<K: Ops> Ops for Counted<K> {
    fn tile(&self, test: &TileTest, rows: [&Row; ROWS]) -> u128 {
        self.texels.set(self.texels.get() + (COLUMNS * ROWS) as u64);
        self.ops.tile(test, rows)
    }
    fn sift(&self, test: &SiftTest, rows: [&Row; ROWS]) -> [u128; 2] {
        self.texels.set(self.texels.get() + (COLUMNS * ROWS) as u64);
        self.ops.sift(test, rows)
    }
    fn equal(&self, numbers: &[u32; LANES], number: u32) -> u32 {
        self.ops.equal(numbers, number)
    }
    fn group(&self, test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
        self.nodes.set(self.nodes.get() + LANES as u64);
        self.ops.group(test, boxes, nodes)
    }
    fn leaves(&self, tiles: &Tiles<'_>, slopes: &Slopes) -> Ranges {
        self.ops.leaves(tiles, slopes)
    }
    fn parent(&self, children: &NodeGroup, family: &Family) -> [Bounds; 2] {
        self.ops.parent(children, family)
    }
    fn concerned(&self, node: &Node, seekers: &Seekers, among: u64, lit: bool) -> u64 {
        self.nodes.set(self.nodes.get() + u64::from(among.count_ones()));
        self.ops.concerned(node, seekers, among, lit)
    }
    fn matters(
        &self,
        leaf: &Leaf,
        rows: [&Row; ROWS],
        seekers: &Seekers,
        lanes: u64,
        lit: bool,
    ) -> u64 {
        self.ops.matters(leaf, rows, seekers, lanes, lit)
    }
    fn ask_tile(&self, tile: &Tile<'_>, seekers: &mut Seekers, lanes: u64, lit: bool) {
        self.texels
            .set(self.texels.get() + (COLUMNS * ROWS) as u64 * u64::from(lanes.count_ones()));
        self.ops.ask_tile(tile, seekers, lanes, lit);
    }
    fn ask(&self, texels: &[Candidate], seekers: &mut Seekers, lanes: u64, lit: bool) {
        self.texels.set(self.texels.get() + (texels.len() * seekers.count) as u64);
        self.ops.ask(texels, seekers, lanes, lit);
    }
}
