//! The ten operations that searches are made of, at every instruction set, and the door to them.

use core::ops::Range;

use shadowmap_core::Level;

use crate::batch::each_in_pyramid;
use crate::build::{Bounds, Family, build_upper};
use crate::classify::{Verdict, classify};
use crate::leaf::{Candidate, Leaf, Node, SiftTest, Tile};
use crate::leaves::{Ranges, Slopes, Tiles, build_leaves};
use crate::map::{ROWS, Row};
use crate::pyramid::{IdGroup, LANES, Layout, NodeGroup, Pyramid};
use crate::reach::{Boxes, GroupTest, Reach, Verdicts};
use crate::receivers::Seekers;
use crate::search::{Search, TileTest};
use crate::{Hit, IdTest, Map, Query};

#[cfg(target_feature = "sse2")]
mod avx2;
#[cfg(target_feature = "sse2")]
mod avx512;
#[cfg(any(
    target_feature = "sse2",
    all(target_arch = "aarch64", target_endian = "little"),
    all(target_arch = "wasm32", target_feature = "simd128"),
))]
mod bounds;
#[cfg(all(target_arch = "aarch64", target_endian = "little"))]
mod neon;
#[cfg(any(
    target_feature = "sse2",
    all(target_arch = "aarch64", target_endian = "little"),
    all(target_arch = "wasm32", target_feature = "simd128"),
))]
mod receivers;
pub(crate) mod scalar;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128;
#[cfg(target_feature = "sse2")]
mod sse41;
#[cfg(any(
    target_feature = "sse2",
    all(target_arch = "aarch64", target_endian = "little"),
    all(target_arch = "wasm32", target_feature = "simd128"),
))]
mod vectors;

/// What the algorithms, written once, ask of an instruction set.
///
/// Each instruction set makes one [`Kernels`] of ten closures inside a function with its target
/// features: closures have the features of the function they are made in, and everything between
/// is `#[inline(always)]`.
pub(crate) trait Ops {
    /// The texels of a tile that pass the test: 16 bits for each row, the first in the lowest.
    fn tile(&self, test: &TileTest, rows: [&Row; ROWS]) -> u128;
    /// The texels of a tile that may count for some receiver of a batch, and those that count for
    /// each that they are in reach of: bits as those of [`Ops::tile`].
    fn sift(&self, test: &SiftTest, rows: [&Row; ROWS]) -> [u128; 2];
    /// The numbers that equal one of them, bit i for number i.
    fn equal(&self, numbers: &[u32; LANES], number: u32) -> u32;
    /// What 16 nodes can hold.
    fn group(&self, test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts;
    /// The ranges of the texels of leaves side by side, minus planes with the given slopes through
    /// their centres.
    fn leaves(&self, tiles: &Tiles<'_>, slopes: &Slopes) -> Ranges;
    /// Bounds of a node with each of [`Family::slopes`].
    fn parent(&self, children: &NodeGroup, family: &Family) -> [Bounds; 2];
    /// Those of the receivers in `among` that a node may hold the answer for by its bounds, bit i
    /// for receiver i.
    fn concerned(&self, node: &Node, seekers: &Seekers, among: u64, lit: bool) -> u64;
    /// Those of the receivers in `lanes` that texels of a leaf may be the answer for.
    fn matters(
        &self,
        leaf: &Leaf,
        rows: [&Row; ROWS],
        seekers: &Seekers,
        lanes: u64,
        lit: bool,
    ) -> u64;
    /// Lets the receivers in `lanes` ask a tile.
    fn ask_tile(&self, tile: &Tile<'_>, seekers: &mut Seekers, lanes: u64, lit: bool);
    /// Lets receivers ask each of the texels, all that have a bit in `lanes` and others.
    fn ask(&self, texels: &[Candidate], seekers: &mut Seekers, lanes: u64, lit: bool);
}

/// [`Ops`] of ten closures.
pub(crate) struct Kernels<T, S, E, G, L, P, C, M, K, A> {
    pub tile: T,
    pub sift: S,
    pub equal: E,
    pub group: G,
    pub leaves: L,
    pub parent: P,
    pub concerned: C,
    pub matters: M,
    pub ask_tile: K,
    pub ask: A,
}

impl<T, S, E, G, L, P, C, M, K, A> Ops for Kernels<T, S, E, G, L, P, C, M, K, A>
where
    T: Fn(&TileTest, [&Row; ROWS]) -> u128,
    S: Fn(&SiftTest, [&Row; ROWS]) -> [u128; 2],
    E: Fn(&[u32; LANES], u32) -> u32,
    G: Fn(&GroupTest, &Boxes, &NodeGroup) -> Verdicts,
    L: Fn(&Tiles<'_>, &Slopes) -> Ranges,
    P: Fn(&NodeGroup, &Family) -> [Bounds; 2],
    C: Fn(&Node, &Seekers, u64, bool) -> u64,
    M: Fn(&Leaf, [&Row; ROWS], &Seekers, u64, bool) -> u64,
    K: Fn(&Tile<'_>, &mut Seekers, u64, bool),
    A: Fn(&[Candidate], &mut Seekers, u64, bool),
{
    #[inline(always)]
    fn tile(&self, test: &TileTest, rows: [&Row; ROWS]) -> u128 {
        (self.tile)(test, rows)
    }
    #[inline(always)]
    fn sift(&self, test: &SiftTest, rows: [&Row; ROWS]) -> [u128; 2] {
        (self.sift)(test, rows)
    }
    #[inline(always)]
    fn equal(&self, numbers: &[u32; LANES], number: u32) -> u32 {
        (self.equal)(numbers, number)
    }
    #[inline(always)]
    fn group(&self, test: &GroupTest, boxes: &Boxes, nodes: &NodeGroup) -> Verdicts {
        (self.group)(test, boxes, nodes)
    }
    #[inline(always)]
    fn leaves(&self, tiles: &Tiles<'_>, slopes: &Slopes) -> Ranges {
        (self.leaves)(tiles, slopes)
    }
    #[inline(always)]
    fn parent(&self, children: &NodeGroup, family: &Family) -> [Bounds; 2] {
        (self.parent)(children, family)
    }
    #[inline(always)]
    fn concerned(&self, node: &Node, seekers: &Seekers, among: u64, lit: bool) -> u64 {
        (self.concerned)(node, seekers, among, lit)
    }
    #[inline(always)]
    fn matters(
        &self,
        leaf: &Leaf,
        rows: [&Row; ROWS],
        seekers: &Seekers,
        lanes: u64,
        lit: bool,
    ) -> u64 {
        (self.matters)(leaf, rows, seekers, lanes, lit)
    }
    #[inline(always)]
    fn ask_tile(&self, tile: &Tile<'_>, seekers: &mut Seekers, lanes: u64, lit: bool) {
        (self.ask_tile)(tile, seekers, lanes, lit);
    }
    #[inline(always)]
    fn ask(&self, texels: &[Candidate], seekers: &mut Seekers, lanes: u64, lit: bool) {
        (self.ask)(texels, seekers, lanes, lit);
    }
}

/// Everything that is done with kernels. An instruction set's module is one function that does a
/// job, so that it is entered once for a whole batch.
pub(crate) enum Job<'a> {
    /// The box around the receiver, without a pyramid.
    InBox {
        map: Map<'a>,
        query: &'a Query,
        hit: &'a mut Option<Hit>,
    },
    InPyramid {
        map: Map<'a>,
        pyramid: &'a Pyramid<'a>,
        queries: &'a [Query],
        hits: &'a mut [Option<Hit>],
    },
    Classify {
        pyramid: &'a Pyramid<'a>,
        reach: &'a Reach,
        ids: IdTest,
        verdict: &'a mut Verdict,
    },
    /// The leaves that depend on the texels of `columns` and `rows`...
    Leaves {
        map: Map<'a>,
        nodes: &'a mut [NodeGroup],
        ids: &'a mut [IdGroup],
        columns: Range<u32>,
        rows: Range<u32>,
    },
    /// ...and the nodes above them.
    Upper {
        layout: &'a Layout,
        nodes: &'a mut [NodeGroup],
        ids: &'a mut [IdGroup],
        columns: Range<u32>,
        rows: Range<u32>,
    },
}

impl Job<'_> {
    #[inline(always)]
    pub(crate) fn run(self, ops: &impl Ops) {
        match self {
            Job::InBox { map, query, hit } => {
                let mut search = Search::new(map, query, query.hint);
                search.ask_box(ops);
                *hit = search.best;
            }
            Job::InPyramid { map, pyramid, queries, hits } => {
                each_in_pyramid(ops, map, pyramid, queries, hits);
            }
            Job::Classify { pyramid, reach, ids, verdict } => {
                *verdict = classify(ops, pyramid, reach, ids);
            }
            Job::Leaves { map, nodes, ids, columns, rows } => {
                build_leaves(ops, map, nodes, ids, columns, rows);
            }
            Job::Upper { layout, nodes, ids, columns, rows } => {
                build_upper(ops, layout, nodes, ids, columns, rows);
            }
        }
    }
}

/// Does a job with the kernels of `level`, and with those of [`Level::SCALAR`] where the level is
/// of another architecture than this program.
#[allow(unsafe_code)]
pub(crate) fn run(level: Level, job: Job<'_>) {
    match level.kind() {
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Sse41 => unsafe { sse41::run(job) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Avx2 => unsafe { avx2::run(job) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(target_feature = "sse2")]
        shadowmap_core::LevelKind::Avx512 => unsafe { avx512::run(job) },
        // SAFETY: a `Level` exists only where its instructions do.
        #[cfg(all(target_arch = "aarch64", target_endian = "little"))]
        shadowmap_core::LevelKind::Neon => unsafe { neon::run(job) },
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        shadowmap_core::LevelKind::Simd128 => simd128::run(job),
        _ => scalar::run(job),
    }
}
