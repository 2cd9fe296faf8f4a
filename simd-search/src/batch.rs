//! Many searches at once: what can matter to neighbouring receivers is found once for all.

use shadowmap_core::Level;

use crate::candidates::ask_all;
use crate::descend::{Path, descend};
use crate::kernels::{Job, Ops, run};
use crate::pyramid::Pyramid;
use crate::reach::{Cone, GroupTest, Reach, Receivers};
use crate::receivers::{BATCH, Seekers};
use crate::search::Search;
use crate::walk::{EXACT_EXTENT, failing, walk};
use crate::{Hit, IdTest, Key, Map, Query, Side};

/// Receivers that are asked together where 64 do not agree, and how far they are from the first of
/// them at most, in texels along each axis.
const PART: usize = 16;
const NEAR: f32 = 24.0;
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
    /// ID test, no jitter and [`Key::Distance`]. Otherwise up to 16 of them that lie within 24 texels
    /// of the first try again, and so do the others; of those that still differ each searches for
    /// itself, with the hit of the one before (of the same side) as its hint unless it brings its
    /// own. Best are blocks of 8 x 8 pixels in Morton order, in which 16 in sequence are neighbours
    /// as well. Takes 10 KiB of stack.
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
        for side in [Side::Blocker, Side::Lit] {
            answer(ops, map, pyramid, side, queries, hits, &mut scratch);
        }
    }
}

/// The answers to those of up to 64 queries that look for `side`: together, or those of up to 16
/// neighbours, or each for itself.
#[inline(always)]
fn answer(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    side: Side,
    queries: &[Query],
    hits: &mut [Option<Hit>],
    scratch: &mut Scratch,
) {
    let Some(batch) = Batch::of(queries, side, &mut scratch.seekers) else { return };
    if batch.answer(ops, map, pyramid, scratch, queries, hits) {
        return;
    }
    let mut left = 0;
    for i in 0..queries.len() {
        left |= u64::from(queries[i].side == side) << (i % BATCH);
    }
    while left != 0 {
        let (places, count) = neighbours(queries, left);
        let (mut part, mut found) = ([queries[0]; PART], [None; PART]);
        for i in 0..count {
            part[i] = queries[places[i]];
            left &= !(1 << places[i]);
        }
        let (part, found) = (&part[..count], &mut found[..count]);
        answer_part(ops, map, pyramid, side, part, found, scratch);
        for i in 0..count {
            hits[places[i]] = found[i];
        }
    }
}

/// Where the first of the queries in `left` is and up to 15 more that are close to it, and how many
/// that are.
#[inline(always)]
fn neighbours(queries: &[Query], left: u64) -> ([usize; PART], usize) {
    let (mut places, mut count, mut rest) = ([0; PART], 0, left);
    while rest != 0 && count < PART {
        let i = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        let (first, point) = (&queries[places[0]].point, &queries[i].point);
        let is_near = (point.u - first.u).abs() <= NEAR && (point.v - first.v).abs() <= NEAR;
        if count == 0 || is_near {
            places[count] = i;
            count += 1;
        }
    }
    (places, count)
}

/// The answers to up to 16 queries that look for `side`: together, or each for itself.
#[inline(always)]
fn answer_part(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    side: Side,
    queries: &[Query],
    hits: &mut [Option<Hit>],
    scratch: &mut Scratch,
) {
    let Some(part) = Batch::of(queries, side, &mut scratch.seekers) else { return };
    if part.answer(ops, map, pyramid, scratch, queries, hits) {
        return;
    }
    let mut last = None;
    for (query, hit) in queries.iter().zip(hits) {
        *hit = one_in_pyramid(ops, map, pyramid, query, last, &mut scratch.path);
        last = hit.map(|hit| [hit.x, hit.y]).or(last);
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

/// What up to [`BATCH`] queries that look for one side have in common.
struct Batch<'q> {
    first: &'q Query,
    radius: f32,
    /// All have the same ID test, no jitter, and distances for keys.
    same_ids: bool,
    plain: bool,
    by_distance: bool,
    /// Around all of theirs, if all have ratios for keys.
    cone: Option<Cone>,
}

impl<'q> Batch<'q> {
    /// `None` if none of them looks for `side`.
    #[inline(always)]
    fn of(queries: &'q [Query], side: Side, seekers: &mut Seekers) -> Option<Batch<'q>> {
        let first = queries.iter().find(|query| query.side == side)?;
        let (mut radius, mut same_ids, mut plain, mut by_distance) = (0.0, true, true, true);
        seekers.clear();
        // A loop without closures and adapters, which need not be inlined.
        for query in queries {
            if query.side == side {
                seekers.push(query);
                radius = if query.radius > radius { query.radius } else { radius };
                same_ids &= query.ids == first.ids;
                plain &= query.jitter <= 0.0 || query.jitter.is_nan();
                by_distance &= matches!(query.key, Key::Distance);
            }
        }
        let cone = if by_distance { None } else { cone(queries, side) };
        Some(Batch { first, radius, same_ids, plain, by_distance, cone })
    }

    /// Finds all answers at once. False if that is not possible or not worth it.
    #[inline(always)]
    fn answer(
        &self,
        ops: &impl Ops,
        map: Map<'_>,
        pyramid: &Pyramid<'_>,
        scratch: &mut Scratch,
        queries: &[Query],
        hits: &mut [Option<Hit>],
    ) -> bool {
        let Scratch { path, seekers } = scratch;
        if seekers.count < FEW || !self.plain || !Search::is_tiled(&map) {
            return false;
        }
        let Some(reach) = self.reach(seekers) else { return false };
        let Query { side, ids, .. } = *self.first;
        let is_answered = if self.same_ids && self.by_distance {
            ask_all(ops, map, pyramid, &reach, side, ids, seekers, path)
        } else {
            self.is_nothing(ops, pyramid, &reach)
        };
        if is_answered {
            self.give(map, seekers, queries, hits);
        }
        is_answered
    }

    /// Hands out the answers.
    #[inline(always)]
    fn give(&self, map: Map<'_>, seekers: &Seekers, queries: &[Query], hits: &mut [Option<Hit>]) {
        if seekers.count == queries.len() && seekers.order == [f32::INFINITY; BATCH] {
            return hits.fill(None);
        }
        let mut i = 0;
        for (query, hit) in queries.iter().zip(hits) {
            if query.side == self.first.side {
                *hit = match seekers.found(i) {
                    Some(([x, y], distance_squared)) => {
                        let nearness = map.nearness(x, y);
                        Some(Hit { x, y, distance_squared, nearness, key: distance_squared })
                    }
                    None => None,
                };
                i += 1;
            }
        }
    }

    /// `None` if a receiver's coordinates are not finite.
    #[inline(always)]
    fn reach(&self, seekers: &Seekers) -> Option<Reach> {
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
        Some(Reach { cone: self.cone, ..reach })
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
}

/// The cone around those of all, if all have ratios for keys.
fn cone(queries: &[Query], side: Side) -> Option<Cone> {
    let mut cone = Cone { nearness: f32::INFINITY, at_most: 0.0 };
    for query in queries.iter().filter(|query| query.side == side) {
        let Key::Ratio { at_most } = query.key else { return None };
        cone.nearness = cone.nearness.min(query.point.nearness);
        cone.at_most = cone.at_most.max(at_most);
    }
    Some(cone)
}
