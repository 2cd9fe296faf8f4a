//! How a run of blockers ends: before what lies behind it, or on the plane of the receivers.

use shadowmap_core::DepthMap;

use super::border::Neighbour;
use super::run::Vertex;
use super::scan::{REACH, row_of};

/// An end of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct End {
    /// The outermost point of the blocker.
    pub vertex: Vertex,
    /// Set if it stands on the receivers' plane.
    pub contact: Option<Contact>,
}

/// Where a blocker stands on the plane of the receivers.
///
/// A receiver next to it, moved along the plane into the middle of a row, may end up on the
/// other side of the blocker's surface: inside a box, say. What it would see there means nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    pub column: f32,
    /// Columns that the contact moves to the right from one row to the next.
    pub per_row: f32,
    /// Columns per nearness from the map of the middle of the light to the one that shows it.
    pub shift: f32,
}

impl Contact {
    /// How far to the right it is of a receiver that was moved into the middle of the row, and of
    /// the same receiver where it came from, `rows` further down: the receiver was moved through
    /// the blocker if one of them is positive alone. `nearness` changes by `slope` per row.
    #[inline(always)]
    pub fn away(&self, column: f32, nearness: f32, slope: f32, rows: f32) -> [f32; 2] {
        let away = self.column - (column + self.shift * nearness);
        [away, away + (self.per_row - self.shift * slope) * rows]
    }
}

/// A row of a map, and the plane of the receivers in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground<'a> {
    pub map: &'a DepthMap<'a>,
    pub y: usize,
    /// See [`super::search::MapSearch`].
    pub plane: [f32; 4],
    pub bias: f32,
    /// The least nearness of a blocker.
    pub behind: f32,
    /// The greatest step in nearness within a surface, as a fraction of the nearness.
    pub steepest: f32,
    /// See [`Contact`].
    pub shift: f32,
    /// Those of the map.
    pub neighbours: [Neighbour; 2],
}

impl Ground<'_> {
    /// How far in front of the plane a texel is.
    #[inline(always)]
    fn front(&self, x: usize, y: usize) -> f32 {
        let [a, b, c, d] = self.plane;
        let across = b * (y as f32 + 0.5);
        ((a * (x as f32 + 0.5) + d) + across) + c * row_of(self.map, y)[x]
    }

    /// The end of a run at texel `x` of `row`: the right one if `sign` is 1, the left one if it is
    /// -1. `inner` is the texel before, or `x` itself if the run has but one.
    ///
    /// The surface goes on as it has come, by [`REACH`], or across a gap between two windows, or
    /// until it meets the plane. If its next texel is too close to the plane to block, the blocker
    /// stands on the plane.
    #[inline(always)]
    pub fn end(&self, row: &[f32], x: usize, inner: usize, sign: f32) -> End {
        let [a, _, c, _] = self.plane;
        let (column, w) = (x as f32 + 0.5, row[x]);
        let slope = w - row[inner];
        let fall = -(sign * a + c * slope);
        let beyond = self.beyond(x, sign, w, slope);
        if inner != x && fall > 0.0 {
            let front = self.front(x, self.y);
            let contact =
                if front - fall < self.bias { Some(self.contact(x, inner, sign)) } else { None };
            let reach = beyond.unwrap_or(REACH);
            let reach = if front < reach * fall { front / fall } else { reach };
            let vertex = Vertex { column: column + sign * reach, nearness: w + slope * reach };
            return End { vertex, contact };
        }
        let (reach, slope) = beyond.map_or((REACH, 0.0), |reach| (reach, slope));
        let vertex = Vertex { column: column + sign * reach, nearness: w + slope * reach };
        End { vertex, contact: None }
    }

    /// How far a surface goes on from texel `x` across a gap between two windows, if there is one
    /// with a blocker on its other side too.
    #[inline(always)]
    fn beyond(&self, x: usize, sign: f32, nearness: f32, slope: f32) -> Option<f32> {
        let last = self.map.width() as usize - 1;
        let (border, neighbour) =
            if sign > 0.0 { (last, &self.neighbours[1]) } else { (0, &self.neighbours[0]) };
        if x != border {
            return None;
        }
        let [a, b, c, d] = self.plane;
        let shown = neighbour.shown(sign, last as f32);
        let front = ((a * shown.column + d) + b * (self.y as f32 + 0.5)) + c * shown.nearness;
        let blocks = front > self.bias && shown.nearness > self.behind;
        if blocks { neighbour.reach(nearness, slope, last as f32) } else { None }
    }

    /// Where a surface that comes from texel `inner` meets the plane beyond texel `x`.
    #[inline(never)]
    fn contact(&self, x: usize, inner: usize, sign: f32) -> Contact {
        let (front, before) = (self.front(x, self.y), self.front(inner, self.y));
        let fall = before - front;
        Contact {
            column: (x as f32 + 0.5) + sign * (front / fall),
            per_row: sign * self.rise(inner, before) / fall,
            shift: self.shift,
        }
    }

    /// By how much the surface at column `x`, there `front` in front of the plane, rises from row
    /// to row. 0 if neither the row above nor the one below shows it.
    fn rise(&self, x: usize, front: f32) -> f32 {
        let own = row_of(self.map, self.y)[x];
        let shown = |y: usize| {
            let w = row_of(self.map, y)[x];
            let linked = (w - own).abs() < self.steepest * own.max(w);
            let other = self.front(x, y);
            (linked && w > self.behind && other > self.bias).then_some(other)
        };
        let above = if self.y > 0 { shown(self.y - 1) } else { None };
        let below = if self.y + 1 < self.map.height() as usize { shown(self.y + 1) } else { None };
        match (above, below) {
            (Some(above), Some(below)) => 0.5 * (below - above),
            (Some(above), None) => front - above,
            (None, Some(below)) => below - front,
            (None, None) => 0.0,
        }
    }
}
