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

impl Places {
    /// Texel coordinates around all texels of the places.
    pub fn corners(&self) -> [[f32; 2]; 4] {
        let [left, right] = [self.columns[0] as f32, self.columns[1] as f32 + 1.0];
        let [top, bottom] = [self.rows[0] as f32, self.rows[1] as f32 + 1.0];
        [[left, top], [right, top], [left, bottom], [right, bottom]]
    }
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
pub(crate) const STRIP: i32 = 48;

/// Adds the outline within `places`, no wider than [`STRIP`], to `segments`.
#[inline(always)]
pub(crate) fn outline<T: Texel>(
    ops: &impl Ops,
    field: &Field<'_, T>,
    test: &Test,
    places: Places,
    segments: &mut Segments,
) -> Outcome {
    let [x, end] = places.columns;
    let [top, bottom] = places.rows;
    let count = end - x;
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
                return Outcome::Full;
            }
            add(field, x + i as i32, y, code, segments);
        }
        upper = lower;
    }
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
