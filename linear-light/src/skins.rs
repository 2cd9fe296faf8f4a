//! What skins are drawn with.

use shadowmap_core::{Level, Threads};

use crate::Discontinuity;

/// How visibility changes across a skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Transition {
    /// From 0 at the blocker's edge to 1 at the receiver, affine in the destination's image, as
    /// section 3.1 proposes. Exact where light and receiver are parallel.
    Linear,
    /// Equation 1: the fraction of the segment at which the ray from the receiver past the
    /// blocker's edge meets the light. Exact for one edge and any receiver; one divide per texel.
    #[default]
    Rational,
}

/// How visibility channels are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinOptions {
    /// How visibility changes across a skin.
    pub transition: Transition,
    /// Where skins hang.
    pub discontinuity: Discontinuity,
    /// SIMD instructions to use. Every level gives the same bits.
    pub level: Level,
    /// Threads to use. Any number gives the same bits.
    pub threads: Threads,
}

impl Default for SkinOptions {
    fn default() -> Self {
        SkinOptions {
            transition: Transition::default(),
            discontinuity: Discontinuity::default(),
            level: Level::detect(),
            threads: Threads::default(),
        }
    }
}
