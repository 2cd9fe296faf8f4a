//! Finding the outline of the blockers in a part of the map.

use super::field::{Field, Test, Texel, WINDOW};
use super::kernels::Ops;
use super::segments::{PIECES, Segments};

/// A box of places between four texels each: place (x, y) has texel (x, y) at its upper left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Places {
    pub columns: [i32; 2],
    pub rows: [i32; 2],
}

/// How an attempt at an outline ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All of it was found.
    Complete,
    /// Some texel blocks some of the receivers and not others.
    Ambiguous,
    /// There was no room for all of it.
    Full,
}

/// Places in a row that are looked at together.
const STRIP: i32 = 63;

/// Adds the outline within `places` to `segments`, and pads them. When they are full, `flush` may
/// empty them; if it does not, the attempt ends.
#[inline(always)]
pub(crate) fn outline<T: Texel>(
    ops: &impl Ops,
    field: &Field<'_, T>,
    test: &Test,
    places: Places,
    segments: &mut Segments,
    mut flush: impl FnMut(&mut Segments),
) -> Outcome {
    let [left, right] = places.columns;
    let [top, bottom] = places.rows;
    let mut x = left;
    while x < right {
        let count = (right - x).min(STRIP);
        let Some(mut upper) = blocking(ops, field, test, x, top, count + 1) else {
            return Outcome::Ambiguous;
        };
        for y in top..bottom {
            let Some(lower) = blocking(ops, field, test, x, y + 1, count + 1) else {
                return Outcome::Ambiguous;
            };
            let differs = (upper ^ lower) | (upper ^ upper >> 1) | (lower ^ lower >> 1);
            let mut places = differs & !(u64::MAX << count);
            while places != 0 {
                let i = places.trailing_zeros();
                places &= places - 1;
                let (two, next) = (upper >> i & 3, lower >> i & 3);
                let code = (two | next >> 1 << 2 | (next & 1) << 3) as usize;
                if segments.is_full() {
                    flush(segments);
                    if segments.is_full() {
                        return Outcome::Full;
                    }
                }
                add(field, x + i as i32, y, code, segments);
            }
            upper = lower;
        }
        x += STRIP;
    }
    segments.pad();
    Outcome::Complete
}

/// Which of the first `count <= 64` texels of a row block; `None` if the receivers do not agree.
#[inline(always)]
fn blocking<T: Texel>(
    ops: &impl Ops,
    field: &Field<'_, T>,
    test: &Test,
    x: i32,
    y: i32,
    count: i32,
) -> Option<u64> {
    let t = y as f32 + 0.5;
    let rows = test.above.map(|above| above - test.hv * t);
    let (mut all, mut disputed) = (0_u64, 0_u64);
    let mut done = 0;
    while done < count {
        let window = field.window(x + done, y);
        let [some, every] = ops.blocking(test, rows, (x + done) as f32 + 0.5, &window);
        all |= u64::from(every) << done;
        disputed |= u64::from(some ^ every) << done;
        done += WINDOW as i32;
    }
    let used = u64::MAX >> (64 - count);
    (disputed & used == 0).then_some(all & used)
}

#[inline(always)]
fn add<T: Texel>(field: &Field<'_, T>, x: i32, y: i32, code: usize, segments: &mut Segments) {
    let (pieces, count) = &PIECES[code];
    for piece in &pieces[..*count] {
        let [a, b] =
            piece.blockers.map(|[dx, dy]| field.nearness(x + i32::from(dx), y + i32::from(dy)));
        let [dx, dy] = piece.middle;
        let middle = [(x as f32 + 0.5) + dx, (y as f32 + 0.5) + dy];
        segments.push(middle, piece.half, (a + b) * 0.5);
    }
}
