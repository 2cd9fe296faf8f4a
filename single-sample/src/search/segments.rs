//! The outline of the blockers around a receiver, as short straight pieces.

/// A piece of the outline: from the midpoint between two texel centres, one blocking and one
/// not, to the next such midpoint, blockers to its right (seen down the map).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    /// Its middle, from the centre of the upper left of the four texels it lies between.
    pub middle: [f32; 2],
    /// Half of the way along it.
    pub half: [f32; 2],
    /// The blocking texels at its two ends, as columns and rows from the upper left one.
    pub blockers: [[u8; 2]; 2],
}

/// The four texels around a corner of the grid, clockwise from the upper left.
const CORNERS: [[u8; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];
/// The midpoint between each of them and the next.
const MIDPOINTS: [[f32; 2]; 4] = [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]];

const NO_PIECE: Piece = Piece { middle: [0.0; 2], half: [0.0; 2], blockers: [[0; 2]; 2] };

/// The pieces between four texels, of which bit i of the index says whether the i-th of
/// `CORNERS` blocks; and how many. Two blocking texels that touch only diagonally are separate.
pub(crate) const PIECES: [([Piece; 2], usize); 16] = {
    let mut table = [([NO_PIECE; 2], 0); 16];
    let mut code = 0;
    while code < 16 {
        let mut leave = 0;
        while leave < 4 {
            // Clockwise, the outline of a blocking run is crossed where it is left ...
            if code >> leave & 1 == 1 && code >> ((leave + 1) % 4) & 1 == 0 {
                // ... and where it was entered.
                let mut enter = (leave + 3) % 4;
                while code >> enter & 1 == 1 {
                    enter = (enter + 3) % 4;
                }
                let (from, to) = (MIDPOINTS[enter], MIDPOINTS[leave]);
                table[code].0[table[code].1] = Piece {
                    middle: [(from[0] + to[0]) * 0.5, (from[1] + to[1]) * 0.5],
                    half: [(to[0] - from[0]) * 0.5, (to[1] - from[1]) * 0.5],
                    blockers: [CORNERS[(enter + 1) % 4], CORNERS[leave]],
                };
                table[code].1 += 1;
            }
            leave += 1;
        }
        code += 1;
    }
    table
};

/// Whether the point (x, y) in \[0, 1\]² between four texel centres lies within the outline.
#[inline(always)]
pub(crate) fn is_within(code: usize, x: f32, y: f32) -> bool {
    let nearest = match (x < 0.5, y < 0.5) {
        (true, true) => 0,
        (false, true) => 1,
        (false, false) => 2,
        (true, false) => 3,
    };
    let (dx, dy) = (if x < 0.5 { x } else { 1.0 - x }, if y < 0.5 { y } else { 1.0 - y });
    // The outline cuts off the corner of a texel that differs from its neighbours, and of two that
    // touch diagonally.
    let cut = dx + dy >= 0.5;
    let blocks = code >> nearest & 1 == 1;
    let beside = code >> ((nearest + 1) % 4) & 1 == 1 || code >> ((nearest + 3) % 4) & 1 == 1;
    let between = code >> ((nearest + 1) % 4) & 1 == 1 && code >> ((nearest + 3) % 4) & 1 == 1;
    let opposite = code >> ((nearest + 2) % 4) & 1 == 1;
    if blocks { !cut || beside } else { cut && between && opposite }
}

/// How many pieces [`Segments`] holds.
pub(crate) const CAPACITY: usize = 2048;
/// Pieces are visited this many at a time.
pub(crate) const LANES: usize = 16;

/// Pieces of the outline in the map, as structures of arrays.
pub(crate) struct Segments {
    pub x: [f32; CAPACITY],
    pub y: [f32; CAPACITY],
    pub half_x: [f32; CAPACITY],
    pub half_y: [f32; CAPACITY],
    /// Nearness of the blocker, the mean of the two ends.
    pub nearness: [f32; CAPACITY],
    pub len: usize,
}

impl Segments {
    pub const fn new() -> Segments {
        let zero = [0.0; CAPACITY];
        Segments { x: zero, y: zero, half_x: zero, half_y: zero, nearness: zero, len: 0 }
    }

    /// Whether the pieces of another four texels, and padding, may not fit.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.len + 2 + LANES > CAPACITY
    }

    #[inline(always)]
    pub fn push(&mut self, middle: [f32; 2], half: [f32; 2], nearness: f32) {
        let i = self.len;
        (self.x[i], self.y[i]) = (middle[0], middle[1]);
        (self.half_x[i], self.half_y[i]) = (half[0], half[1]);
        self.nearness[i] = nearness;
        self.len += 1;
    }

    /// Fills up to whole groups of lanes with pieces that count for nothing, until the next piece
    /// is added.
    #[inline(always)]
    pub fn pad(&mut self) {
        let len = self.len;
        while !self.len.is_multiple_of(LANES) {
            self.push([0.0; 2], [0.0; 2], f32::NEG_INFINITY);
        }
        self.len = len;
    }

    /// The first `count` groups of lanes of x, y, half_x, half_y and nearness.
    #[inline(always)]
    pub fn groups(&self, count: usize) -> [&[[f32; LANES]]; 5] {
        [
            &self.x.as_chunks().0[..count],
            &self.y.as_chunks().0[..count],
            &self.half_x.as_chunks().0[..count],
            &self.half_y.as_chunks().0[..count],
            &self.nearness.as_chunks().0[..count],
        ]
    }
}
