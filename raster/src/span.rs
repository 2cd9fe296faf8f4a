//! The exact span of texels that a triangle covers in each row.

use crate::coverage::{Bounds, Edge, Triangle};

/// Walks down the rows of a triangle. An edge function is affine in the column, so an edge bounds
/// the row from one side, at a quotient that moves from row to row by a whole number and a
/// remainder: integers throughout, no division after the set-up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spans {
    bounds: Bounds,
    edges: [Side; 3],
}

/// One edge's bound on a row.
#[derive(Clone, Copy, Debug)]
struct Side {
    kind: Kind,
    /// The greatest whole number not above the edge function / |its step per column|...
    quotient: i64,
    /// ...and what remains, at least 0 and less than the divisor.
    remainder: i64,
    quotient_step: i64,
    remainder_step: i64,
    divisor: i64,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Texels from `-quotient` on are covered.
    Left,
    /// Texels up to `quotient` are covered.
    Right,
    /// A level edge: all of the row, if `quotient` is not negative.
    Level,
}

impl Side {
    fn new(edge: &Edge, y: i32) -> Side {
        let (row, step_x, step_y) = edge.row(y);
        let kind = match step_x {
            0 => Kind::Level,
            s if s > 0 => Kind::Left,
            _ => Kind::Right,
        };
        let divisor = step_x.abs().max(1);
        Side {
            kind,
            quotient: row.div_euclid(divisor),
            remainder: row.rem_euclid(divisor),
            quotient_step: step_y.div_euclid(divisor),
            remainder_step: step_y.rem_euclid(divisor),
            divisor,
        }
    }

    #[inline(always)]
    fn narrow(&self, first: &mut i64, last: &mut i64) {
        match self.kind {
            Kind::Left => *first = (*first).max(-self.quotient),
            Kind::Right => *last = (*last).min(self.quotient),
            Kind::Level => {
                if self.quotient < 0 {
                    *last = *first - 1;
                }
            }
        }
    }

    #[inline(always)]
    fn next_row(&mut self) {
        self.quotient += self.quotient_step;
        self.remainder += self.remainder_step;
        if self.remainder >= self.divisor {
            self.remainder -= self.divisor;
            self.quotient += 1;
        }
    }
}

impl Spans {
    /// The spans in the rows from `first_row` to before `end_row`; `None` if the bounds miss them.
    #[inline(always)]
    pub(crate) fn new(
        triangle: &Triangle,
        width: u32,
        height: u32,
        rows: core::ops::Range<i32>,
    ) -> Option<Spans> {
        let mut bounds = triangle.bounds(width, height)?;
        bounds.y = (bounds.y.0.max(rows.start), bounds.y.1.min(rows.end - 1));
        if bounds.y.0 > bounds.y.1 {
            return None;
        }
        Some(Spans { bounds, edges: triangle.edges().map(|edge| Side::new(&edge, bounds.y.0)) })
    }
}

impl Iterator for Spans {
    /// Row, first and last column.
    type Item = (i32, i32, i32);

    #[inline(always)]
    fn next(&mut self) -> Option<(i32, i32, i32)> {
        while self.bounds.y.0 <= self.bounds.y.1 {
            let y = self.bounds.y.0;
            self.bounds.y.0 += 1;
            let (mut first, mut last) = (i64::from(self.bounds.x.0), i64::from(self.bounds.x.1));
            for edge in &mut self.edges {
                edge.narrow(&mut first, &mut last);
                edge.next_row();
            }
            if first <= last {
                return Some((y, first as i32, last as i32));
            }
        }
        None
    }
}
