//! Many searches at once: what the pyramid says of neighbouring receivers is asked once for all.

use shadowmap_core::{Level, LightPoint};

use crate::descend::{Path, descend};
use crate::kernels::{Job, Ops, run};
use crate::pyramid::{LANES, Pyramid};
use crate::reach::{Cone, GroupTest, Reach, Receivers};
use crate::search::{Search, sqrt};
use crate::tiles::Tiles;
use crate::walk::EXACT_EXTENT;
use crate::{Hit, IdTest, Key, Map, Query, Side};

/// Receivers that share one list of tiles.
const BATCH: usize = 64;
/// Fewer are searched one by one.
const FEW: usize = 4;
/// More tiles than this are listed only when no hit tells how far away the answers can be.
const FEW_TILES: usize = LANES;

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

    /// The answers to many queries, best to a block of neighbouring receivers in rows.
    ///
    /// Each search takes the hit of the one before (of the same side) as its hint, unless it
    /// brings its own. Up to 64 receivers in sequence share one look at the pyramid, which is of
    /// use if they lie close together and have the same ID test.
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

/// The answers to `queries`.
#[inline(always)]
pub(crate) fn each_in_pyramid(
    ops: &impl Ops,
    map: Map<'_>,
    pyramid: &Pyramid<'_>,
    queries: &[Query],
    hits: &mut [Option<Hit>],
) {
    let mut path = Path::new();
    let mut tiles = Tiles::new();
    for (queries, hits) in queries.chunks(BATCH).zip(hits.chunks_mut(BATCH)) {
        for side in [Side::Blocker, Side::Lit] {
            let Some(mut batch) = Batch::of(queries, side) else { continue };
            let mut last = None;
            let is_listed = batch.is_listable(&map)
                && (tiles.list(ops, &map, pyramid, &batch, FEW_TILES) || {
                    // What is found for one receiver bounds how far the others must look.
                    let first = one_in_pyramid(ops, map, pyramid, batch.first, None, &mut path);
                    if let Some(hit) = first {
                        last = Some([hit.x, hit.y]);
                        batch.narrow(pyramid, &hit);
                    }
                    tiles.list(ops, &map, pyramid, &batch, Tiles::ROOM)
                });
            for (query, hit) in queries.iter().zip(&mut *hits) {
                if query.side != side {
                    continue;
                }
                if is_listed && tiles.count == 0 {
                    *hit = None;
                    continue;
                }
                let hint = query.hint.or(last);
                *hit = if is_listed {
                    let mut search = Search::new(map, query, hint);
                    tiles.search(ops, pyramid, &mut search);
                    search.best
                } else {
                    one_in_pyramid(ops, map, pyramid, query, hint, &mut path)
                };
                last = hit.map(|hit| [hit.x, hit.y]).or(last);
            }
        }
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
        descend(ops, pyramid, &mut search, path);
    }
    search.best
}

/// Those of up to [`BATCH`] queries that look for one side.
pub(crate) struct Batch<'q> {
    pub first: &'q Query,
    /// What [`Receivers`] holds.
    columns: [[f32; BATCH]; 6],
    count: usize,
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
    fn of(queries: &'q [Query], side: Side) -> Option<Batch<'q>> {
        let first = queries.iter().find(|query| query.side == side)?;
        let mut batch = Batch {
            first,
            columns: [[0.0; BATCH]; 6],
            count: 0,
            radius: 0.0,
            same_ids: true,
            plain: true,
            by_distance: true,
            cone: Some(Cone { nearness: f32::INFINITY, at_most: 0.0 }),
        };
        for query in queries.iter().filter(|query| query.side == side) {
            let LightPoint { u, v, nearness, slope } = query.point;
            let row = [u, v, nearness, slope.x, slope.y, query.offset];
            for (column, value) in batch.columns.iter_mut().zip(row) {
                column[batch.count % BATCH] = value;
            }
            batch.count += 1;
            batch.radius = if query.radius > batch.radius { query.radius } else { batch.radius };
            batch.same_ids &= query.ids == first.ids;
            batch.plain &= query.jitter_amplitude() == 0.0;
            match query.key {
                Key::Distance => batch.cone = None,
                Key::Ratio { at_most } => {
                    batch.by_distance = false;
                    if let Some(cone) = &mut batch.cone {
                        cone.nearness = cone.nearness.min(nearness);
                        cone.at_most = cone.at_most.max(at_most);
                    }
                }
            }
        }
        Some(batch)
    }

    /// Whether a list of tiles is worth it.
    #[inline(always)]
    fn is_listable(&self, map: &Map<'_>) -> bool {
        self.count >= FEW && self.plain && Search::is_tiled(map)
    }

    /// The ID test that whatever counts for one of the receivers passes.
    #[inline(always)]
    pub fn ids(&self) -> IdTest {
        if self.same_ids { self.first.ids } else { IdTest::Any }
    }

    /// `None` if a receiver's coordinates are not finite.
    #[inline(always)]
    pub fn reach(&self) -> Option<Reach> {
        let [u, v, nearness, slope_x, slope_y, offset] =
            self.columns.each_ref().map(|column| &column[..self.count]);
        let receivers = Receivers { u, v, nearness, slope_x, slope_y, offset };
        let reach = Reach::around(&receivers, self.radius)?;
        Some(Reach { cone: self.cone, ..reach })
    }

    /// Takes the texel found for one of them as a bound on the distance for all, if it surely
    /// counts for all.
    #[inline(always)]
    fn narrow(&mut self, pyramid: &Pyramid<'_>, found: &Hit) {
        let Some(reach) = self.reach().filter(|_| self.same_ids && self.by_distance) else {
            return;
        };
        let (x, y) = (found.x as f32 + 0.5, found.y as f32 + 0.5);
        let above = found.nearness - reach.plane.plane_at(x, y);
        let test = GroupTest::new(&reach, &pyramid.layout, 0.0);
        let counts = match self.first.side {
            Side::Blocker => above > test.most,
            Side::Lit => above <= test.least,
        };
        if counts {
            let far = |x: f32, [from, to]: [f32; 2]| (x - from).max(to - x);
            let (dx, dy) = (far(x, reach.u), far(y, reach.v));
            let distance = sqrt(dx * dx + dy * dy) * (1.0 + 1.0 / 262144.0);
            self.radius = self.radius.min(distance);
        }
    }
}
