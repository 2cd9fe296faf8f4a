//! The judgement of a whole region of receivers.

use shadowmap_core::Level;

use crate::IdTest;
use crate::kernels::{Job, Ops, run};
use crate::pyramid::Pyramid;
use crate::reach::{GroupTest, Reach};
use crate::walk::{EXACT_EXTENT, failing, walk};

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
    // Whether some node surely holds a texel that blocks a receiver or may do so, and one that
    // does not block every receiver or may do so.
    let (mut blocks, mut is_lit) = (false, false);
    let test = GroupTest::new(reach, layout, 1.0);
    let decided = walk(ops, pyramid, reach, &test, |group, verdicts| {
        let mut may_block = verdicts.may_block;
        if may_block != 0 {
            may_block &= !failing(ops, pyramid, group.index, ids);
        }
        blocks |= may_block & !verdicts.may_be_lit != 0;
        is_lit |= verdicts.may_be_lit & !may_block != 0;
        let undecided = may_block & verdicts.may_be_lit;
        (!(blocks && is_lit) && (group.level > 0 || undecided == 0)).then_some(undecided)
    });
    match (decided, blocks) {
        (false, _) => Verdict::Mixed,
        (true, false) => Verdict::Clear,
        (true, true) => Verdict::Covered,
    }
}
