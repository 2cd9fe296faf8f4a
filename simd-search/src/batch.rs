//! Many searches at once: what can matter to neighbouring receivers is found once for all.

use shadowmap_core::Level;

use crate::candidates::ask_all;
use crate::descend::{Path, descend};
use crate::kernels::{Job, Ops, run};
use crate::parts::{Parts, is_wide};
use crate::pyramid::Pyramid;
use crate::reach::{Cone, GroupTest, Reach, Receivers};
use crate::receivers::{BATCH, Seekers};
use crate::search::Search;
use crate::walk::{EXACT_EXTENT, failing, walk};
use crate::{Hit, IdTest, Key, Map, Query, Side};

/// Fewer are searched one by one.
const FEW: usize = 4;

impl Pyramid<'_> {
    /// The answer to one query: what [`crate::naive::nearest`] gives.
    ///
    /// # Panics
    ///
    /// If the pyramid is of a map of another size.
    #[must_use]
    pub fn nearest<'m>(&self, level: Level, map: impl Into<Map<'m>>, query: &Query) -> Option<Hit> {
        let mut hit = [None];
        self.nearest_each(level, map, core::slice::from_ref(query), &mut hit);
        hit[0]
    }

    /// The answers to many queries.
    ///
    /// Up to 64 receivers in sequence share one way down the pyramid if they lie within a hundred
    /// texels of each other (two hundred on one plane), look at most 1024 texels far, have the same
    /// ID test, no jitter and [`Key::Distance`]. If they look farther than 24 texels or lie farther
    /// apart, those on one plane, eight or more, go together, and then the rest. Otherwise up to 16
    /// of them that lie within 24 texels of the first try again, and so do the others; of those
    /// that still differ each searches for itself, with the hit of the one before (of the same
    /// side) as its hint unless it brings its own. Best are blocks of 8 x 8 pixels in Morton order,
    /// in which 16 in sequence are neighbours as well. Takes 10 KiB of stack.
    ///
    /// # Panics
    ///
    /// If the pyramid is of a map of another size, or there are not as many `hits` as queries.
    pub fn nearest_each<'m>(
        &self,
        level: Level,
        map: impl Into<Map<'m>>,
        queries: &[Query],
        hits: &mut [Option<Hit>],
    ) {
        let map = map.into();
        self.check(&map);
        assert_eq!(queries.len(), hits.len(), "one hit per query");
        run(level, Job::InPyramid { map, pyramid: self, queries, hits });
    }
}

/// What searches need besides the stack of their own.
struct Scratch {
    path: Path,
    seekers: Seekers,
}

/// The answers to `queries`.
#[inline(always)]
pub(crate) fn each_in_pyramid(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    queries: &[Query],
    hits: &mut [Option<Hit>],
) {
    let mut scratch = Scratch { path: Path::new(), seekers: Seekers::new() };
    for (queries, hits) in queries.chunks(BATCH).zip(hits.chunks_mut(BATCH)) {
        let mut lit = 0;
        for i in 0..queries.len() {
            lit |= u64::from(queries[i].side == Side::Lit) << (i % BATCH);
        }
        let all = u64::MAX >> (BATCH - queries.len().clamp(1, BATCH));
        for some in [all & !lit, lit] {
            answer(ops, map, pyramid, queries, some, hits, &mut scratch);
        }
    }
}

/// The answers to some queries, which look for the same side, bit i for query i: together, or in
/// parts, or each for itself.
#[inline(always)]
fn answer(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    queries: &[Query],
    some: u64,
    hits: &mut [Option<Hit>],
    scratch: &mut Scratch,
) {
    let mut parts = Parts::of(some);
    while let Some(part) = parts.next(queries) {
        let batch = Batch::of(queries, part.some, &mut scratch.seekers);
        if let Some(reach) = batch.reach(&map, &scratch.seekers) {
            if part.is_all && is_wide(&reach) && parts.divide_by_plane(queries, part.some) {
                continue;
            }
            if batch.answer(ops, map, pyramid, &reach, scratch, hits) {
                continue;
            }
        }
        if part.is_last {
            one_by_one(ops, map, pyramid, queries, part.some, hits, &mut scratch.path);
        } else {
            parts.divide(part.some);
        }
    }
}

/// The answers to some queries, which look for the same side, each for itself.
#[inline(always)]
fn one_by_one(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    queries: &[Query],
    some: u64,
    hits: &mut [Option<Hit>],
    path: &mut Path,
) {
    let (mut last, mut rest) = (None, some);
    while rest != 0 {
        let i = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        hits[i] = one_in_pyramid(ops, map, pyramid, &queries[i], last, path);
        last = hits[i].map(|hit| [hit.x, hit.y]).or(last);
    }
}

/// The answer to one query.
#[inline(always)]
fn one_in_pyramid(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    query: &Query,
    hint: Option<[u32; 2]>,
    path: &mut Path,
) -> Option<Hit> {
    let mut search = Search::new(map, query, query.hint.or(hint));
    if !(query.radius >= 0.0 && query.point.u.is_finite() && query.point.v.is_finite()) {
        // Nothing is within reach.
    } else if map.width() > EXACT_EXTENT || map.height() > EXACT_EXTENT {
        search.ask_box(ops);
    } else {
        let test = search.group_test(pyramid);
        descend(ops, pyramid, &mut search, test, path);
    }
    search.best
}

/// What some queries that look for the same side have in common.
struct Batch<'q> {
    queries: &'q [Query],
    /// Bit i: query i is one of them.
    some: u64,
    first: &'q Query,
    radius: f32,
    /// All have the same ID test, no jitter, and distances for keys.
    same_ids: bool,
    plain: bool,
    by_distance: bool,
}

impl<'q> Batch<'q> {
    #[inline(always)]
    fn of(queries: &'q [Query], some: u64, seekers: &mut Seekers) -> Batch<'q> {
        let first = &queries[some.trailing_zeros() as usize];
        let (mut radius, mut same_ids, mut plain, mut by_distance) = (0.0, true, true, true);
        seekers.clear();
        let mut rest = some;
        while rest != 0 {
            let query = &queries[rest.trailing_zeros() as usize];
            rest &= rest - 1;
            seekers.push(query);
            radius = if query.radius > radius { query.radius } else { radius };
            same_ids &= query.ids == first.ids;
            plain &= query.jitter <= 0.0 || query.jitter.is_nan();
            by_distance &= matches!(query.key, Key::Distance);
        }
        Batch { queries, some, first, radius, same_ids, plain, by_distance }
    }

    /// Finds all answers at once. False if that is not possible or not worth it.
    #[inline(always)]
    fn answer(
        &self,
        ops: &impl Ops,
        map: Map<'_>,
        pyramid: &Pyramid<'_>,
        reach: &Reach,
        scratch: &mut Scratch,
        hits: &mut [Option<Hit>],
    ) -> bool {
        let Scratch { path, seekers } = scratch;
        let Query { side, ids, .. } = *self.first;
        let is_answered = if self.same_ids && self.by_distance {
            ask_all(ops, map, pyramid, reach, side, ids, seekers, path)
        } else {
            self.is_nothing(ops, pyramid, reach)
        };
        if is_answered {
            self.give(map, seekers, hits);
        }
        is_answered
    }

    /// Hands out the answers.
    #[inline(always)]
    fn give(&self, map: Map<'_>, seekers: &Seekers, hits: &mut [Option<Hit>]) {
        if seekers.count == hits.len() && seekers.order == [f32::INFINITY; BATCH] {
            return hits.fill(None);
        }
        let (mut rest, mut i) = (self.some, 0);
        while rest != 0 {
            hits[rest.trailing_zeros() as usize] = match seekers.found(i) {
                Some(([x, y], distance_squared)) => {
                    let nearness = map.nearness(x, y);
                    Some(Hit { x, y, distance_squared, nearness, key: distance_squared })
                }
                None => None,
            };
            rest &= rest - 1;
            i += 1;
        }
    }

    /// That of all, `None` if they are few, cannot be answered at once, or have coordinates that
    /// are not finite.
    #[inline(always)]
    fn reach(&self, map: &Map<'_>, seekers: &Seekers) -> Option<Reach> {
        if seekers.count < FEW || !self.plain || !Search::is_tiled(map) {
            return None;
        }
        let Seekers { u, v, nearness, slope_x, slope_y, offset, .. } = seekers;
        let count = seekers.count.min(BATCH);
        let receivers = Receivers {
            u: &u[..count],
            v: &v[..count],
            nearness: &nearness[..count],
            slope_x: &slope_x[..count],
            slope_y: &slope_y[..count],
            offset: &offset[..count],
        };
        let reach = Reach::around(&receivers, self.radius)?;
        let cone = if self.by_distance { None } else { self.cone() };
        Some(Reach { cone, ..reach })
    }

    /// Whether no node of the pyramid can matter to any of them.
    #[inline(always)]
    fn is_nothing(&self, ops: &impl Ops, pyramid: &Pyramid<'_>, reach: &Reach) -> bool {
        let ids = if self.same_ids { self.first.ids } else { IdTest::Any };
        let test = GroupTest::new(reach, &pyramid.layout, 0.0);
        walk(ops, pyramid, reach, &test, |group, verdicts| {
            let mut nodes = verdicts.of(self.first.side);
            if nodes != 0 {
                nodes &= !failing(ops, pyramid, group.index, ids);
            }
            (group.level > 0 || nodes == 0).then_some(nodes)
        })
    }

    /// The cone around those of all, if all have ratios for keys.
    fn cone(&self) -> Option<Cone> {
        let mut cone = Cone { nearness: f32::INFINITY, at_most: 0.0 };
        let mut rest = self.some;
        while rest != 0 {
            let query = &self.queries[rest.trailing_zeros() as usize];
            rest &= rest - 1;
            let Key::Ratio { at_most } = query.key else { return None };
            cone.nearness = cone.nearness.min(query.point.nearness);
            cone.at_most = cone.at_most.max(at_most);
        }
        Some(cone)
    }
}
