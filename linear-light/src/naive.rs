//! The channel of rectified maps in the plainest words, to compare the fast one with.

use std::vec::Vec;

use proptest::prelude::*;
use shadowmap_core::Level;

use crate::discontinuity::{Rows, Side, depth_step, laplacian, zero_crossing};
use crate::silhouette::{across_rows, in_both};
use crate::skin_spans::SpanRow;
use crate::{Discontinuity, EdgeFilter, Transition};

/// The fraction of the segment that texel `i` of the destination sees: by the nearest of the skins
/// that hide it.
fn texel(row: &SpanRow<'_>, i: usize) -> f32 {
    let pairs = 0..row.to.len().saturating_sub(1);
    let mut skins = pairs.filter_map(|x| skin(row, x, i));
    let nearest = match row.side {
        Side::Left => skins.next_back(),
        Side::Right => skins.next(),
    };
    nearest.unwrap_or(1.0)
}

/// What the skin between columns `x` and `x + 1` of the source says of texel `i`, if it hides it.
fn skin(row: &SpanRow<'_>, x: usize, i: usize) -> Option<f32> {
    let n = row.from.middle;
    let at = |row: &[f32], x: isize| row[x.clamp(0, row.len() as isize - 1) as usize];
    let least = row.discontinuity.threshold / row.disparity;
    let x_ = x as isize;
    let found = match row.discontinuity.filter {
        EdgeFilter::DepthStep => {
            depth_step([x_ - 1, x_, x_ + 1, x_ + 2].map(|x| at(n, x)), row.side, least)
        }
        EdgeFilter::Laplacian => {
            let three = |row: &[f32], x: isize| [x - 1, x, x + 1].map(|x| at(row, x));
            let rows = row.from;
            let response =
                |x| laplacian(three(rows.above, x), three(rows.middle, x), three(rows.below, x));
            zero_crossing([n[x], n[x + 1]], [response(x_), response(x_ + 1)], row.side, least)
        }
    };
    if !found {
        return None;
    }
    let (sign, blocker, receiver, blocker_column) = match row.side {
        Side::Left => (1.0, n[x], n[x + 1], x as f32 + 0.5),
        Side::Right => (-1.0, n[x + 1], n[x], x as f32 + 1.5),
    };
    let shift = row.disparity * sign;
    let guess = across_rows(&row.from, x, row.side);
    let start = in_both(row.to, guess - shift * blocker, blocker, row.side, row.disparity);
    let edge = guess + (start - (guess - shift * blocker));
    let end = edge - shift * receiver;
    // Texels whose centres the skin covers.
    let covered = |i: usize| {
        let [low, high] = if start < end { [start, end] } else { [end, start] };
        i >= (low + 0.5) as usize && i < (high + 0.5) as usize
    };
    let u = i as f32 + 0.5;
    let in_source = u + shift * row.to[i];
    let hidden = match row.side {
        Side::Left => in_source < edge.min(blocker_column),
        Side::Right => in_source > edge.max(blocker_column),
    };
    let seen = match row.transition {
        Transition::Linear => (u - start) * (1.0 / (end - start)),
        Transition::Rational => (u - start) / (shift * (blocker - row.to[i])),
    };
    (covered(i) && hidden).then_some(if seen > 0.0 { seen.min(1.0) } else { 0.0 })
}

/// Rows as maps have them: pieces of planes, and now and then anything at all.
fn map_row(len: usize) -> impl Strategy<Value = Vec<f32>> {
    let piece = (1_usize..12, 0.0_f32..1.0, -0.02_f32..0.02);
    let texel = prop_oneof![20 => Just(None), 1 => any::<f32>().prop_map(Some)];
    let pieces = proptest::collection::vec(piece, len);
    (pieces, proptest::collection::vec(texel, len)).prop_map(move |(pieces, texels)| {
        let planes = pieces
            .into_iter()
            .flat_map(|(count, n, slope)| (0..count).map(move |i| n + slope * i as f32));
        planes.zip(texels).map(|(plane, texel)| texel.unwrap_or(plane)).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn spans_equal_the_plain_words(
        rows in (1_usize..160).prop_flat_map(|len| {
            [map_row(len), map_row(len), map_row(len), map_row(len)]
        }),
        disparity in prop_oneof![4 => 1.0_f32..80.0, 1 => any::<f32>()],
        threshold in prop_oneof![4 => 0.5_f32..3.0, 1 => any::<f32>()],
        left in any::<bool>(),
        filter in prop_oneof![Just(EdgeFilter::DepthStep), Just(EdgeFilter::Laplacian)],
        transition in prop_oneof![Just(Transition::Linear), Just(Transition::Rational)],
    ) {
        let [above, middle, below, to] = &rows;
        let row = SpanRow {
            from: Rows { above, middle, below },
            to,
            disparity,
            side: if left { Side::Left } else { Side::Right },
            discontinuity: Discontinuity { filter, threshold },
            transition,
        };
        let expected: Vec<_> = (0..to.len()).map(|i| texel(&row, i).to_bits()).collect();
        for level in Level::available() {
            let (mut out, mut touched) = (std::vec![1.0; to.len()], 0..0);
            row.draw(level, &mut out, &mut touched);
            for (i, seen) in out.iter().enumerate() {
                prop_assert!(*seen == 1.0 || touched.contains(&i), "{} beside {:?}", i, touched);
            }
            let found: Vec<_> = out.iter().map(|seen| seen.to_bits()).collect();
            prop_assert_eq!(&found, &expected, "{}", level.kind().name());
        }
    }
}
