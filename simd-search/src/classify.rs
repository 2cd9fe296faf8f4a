//! The judgement of a whole region of receivers.

use shadowmap_core::Level;

use crate::IdTest;
use crate::kernels::{Job, Ops, run};
use crate::naive::reach as span;
use crate::pyramid::{FAN, MAX_LEVELS, Pyramid};
use crate::reach::{GroupTest, Reach};
use crate::traverse::{EXACT_EXTENT, failing, group_size, level_of};

/// The judgement of [`Pyramid::classify`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// No texel in reach blocks any of the receivers: each is fully lit.
    Clear,
    /// Every texel in reach blocks all of the receivers: each is in the umbra.
    Covered,
    /// Neither is certain.
    Mixed,
}

impl Pyramid<'_> {
    /// Judges all texels that receivers can reach, without looking at a single one.
    ///
    /// `Clear`: a search for blockers with the ID test `ids` finds nothing, from any of the
    /// receivers. `Covered`: a search for lit texels finds nothing, whatever its ID test. `Mixed`
    /// says nothing. Where both hold, because nothing is in reach or because all that is in reach
    /// fails the ID test, the verdict is `Clear`.
    #[must_use]
    pub fn classify(&self, level: Level, reach: &Reach, ids: IdTest) -> Verdict {
        let mut verdict = Verdict::Mixed;
        run(level, Job::Classify { pyramid: self, reach, ids, verdict: &mut verdict });
        verdict
    }
}

/// A group of nodes of which some are undecided.
#[derive(Clone, Copy, Default)]
struct Frame {
    x: u32,
    y: u32,
    undecided: u32,
}

/// What is known of the nodes visited so far.
#[derive(Default)]
struct Known {
    /// Some node surely holds a texel that blocks a receiver or may do so.
    blocks: bool,
    /// Some node surely holds a texel that does not block every receiver or may do so.
    is_lit: bool,
}

#[inline(always)]
pub(crate) fn classify(
    ops: &impl Ops,
    pyramid: &Pyramid<'_>,
    reach: &Reach,
    ids: IdTest,
) -> Verdict {
    let layout = &pyramid.layout;
    let [[left, right], [top, bottom]] = [reach.u, reach.v];
    let known = (right - left) + (bottom - top) + reach.radius;
    if known.is_nan() || layout.width > EXACT_EXTENT || layout.height > EXACT_EXTENT {
        return Verdict::Mixed;
    }
    let radius = reach.radius + 1.0; // Jitter moves texels by less.
    let around =
        |[from, to]: [f32; 2], size| span(from, radius, size).start..span(to, radius, size).end;
    let (columns, rows) = (around(reach.u, layout.width), around(reach.v, layout.height));
    if columns.is_empty() || rows.is_empty() {
        return Verdict::Clear;
    }
    let mut test = GroupTest::new(reach, layout, 1.0);
    let top = level_of(layout, columns.end - columns.start, rows.end - rows.start);
    let [width, height] = group_size(top);
    let mut known = Known::default();
    for y in rows.start / height..=(rows.end - 1) / height {
        for x in columns.start / width..=(columns.end - 1) / width {
            if !descend(ops, pyramid, &mut test, ids, &mut known, top, x, y) {
                return Verdict::Mixed;
            }
        }
    }
    if !known.blocks { Verdict::Clear } else { Verdict::Covered }
}

/// Adds one group of nodes to what is known; false if neither verdict is possible any more.
#[inline(always)]
fn descend(
    ops: &impl Ops,
    pyramid: &Pyramid<'_>,
    test: &mut GroupTest,
    ids: IdTest,
    known: &mut Known,
    top: usize,
    x: u32,
    y: u32,
) -> bool {
    let mut path = [Frame::default(); MAX_LEVELS];
    let mut level = top;
    path[level] = visit(ops, pyramid, test, ids, known, level, x, y);
    loop {
        if known.blocks && known.is_lit {
            return false;
        }
        let frame = &mut path[level];
        if frame.undecided == 0 {
            level += 1;
            if level > top {
                return true;
            }
            continue;
        }
        if level == 0 {
            return false;
        }
        let lane = frame.undecided.trailing_zeros();
        frame.undecided &= frame.undecided - 1;
        let (x, y) = (frame.x * FAN + lane % FAN, frame.y * FAN + lane / FAN);
        level -= 1;
        path[level] = visit(ops, pyramid, test, ids, known, level, x, y);
    }
}

#[inline(always)]
fn visit(
    ops: &impl Ops,
    pyramid: &Pyramid<'_>,
    test: &mut GroupTest,
    ids: IdTest,
    known: &mut Known,
    level: usize,
    x: u32,
    y: u32,
) -> Frame {
    let Some(index) = pyramid.layout.group(level, x, y) else { return Frame::default() };
    test.at(level, x, y);
    let verdicts = ops.group(test, &pyramid.nodes[index]);
    let mut may_block = verdicts.may_block;
    if may_block != 0 {
        may_block &= !failing(ops, pyramid, index, ids);
    }
    known.blocks |= may_block & !verdicts.may_be_lit != 0;
    known.is_lit |= verdicts.may_be_lit & !may_block != 0;
    Frame { x, y, undecided: may_block & verdicts.may_be_lit }
}
