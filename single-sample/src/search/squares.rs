//! Marching squares: the outline between the centres of four texels.

/// A piece of the outline: from the midpoint between two texel centres, one blocking and one
/// not, to the next such midpoint, blockers to its right (seen down the map).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    /// Its ends, from the centre of the upper left of the four texels.
    pub ends: [[f32; 2]; 2],
    /// The blocking texel at each end, as an index of [`CORNERS`].
    pub blockers: [usize; 2],
}

/// Columns and rows of the four texels, clockwise from the upper left.
pub(crate) const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];
/// The midpoint between each of them and the next.
const MIDPOINTS: [[f32; 2]; 4] = [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]];

const NO_PIECE: Piece = Piece { ends: [[0.0; 2]; 2], blockers: [0; 2] };

/// The pieces between four texels, of which bit i of the index says whether the i-th of
/// [`CORNERS`] blocks; and how many. Two blocking texels that touch only diagonally are separate.
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
                table[code].0[table[code].1] = Piece {
                    ends: [MIDPOINTS[enter], MIDPOINTS[leave]],
                    blockers: [(enter + 1) % 4, leave],
                };
                table[code].1 += 1;
            }
            leave += 1;
        }
        code += 1;
    }
    table
};
