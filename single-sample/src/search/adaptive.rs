//! Adaptive sampling (Brabec and Seidel 2002, section 4.3), within one tile of the image.

/// Pixels along each side of a tile.
pub(crate) const TILE: usize = 16;
/// Pixels of a tile.
pub(crate) const COUNT: usize = TILE * TILE;

/// A pixel that needs no search.
pub(crate) const NO_KEY: u32 = 0;

/// The blocked fractions of a tile's pixels, searched or interpolated.
///
/// Pixels are asked for in rounds: [`Samples::begin`] asks for the first, and as long as
/// [`Samples::wanted`] are searched, [`Samples::refine`] asks for more.
pub(crate) struct Samples {
    /// What pixels must have in common to be interpolated: the object and the hard shadow test.
    /// [`NO_KEY`] for those whose value does not matter.
    pub keys: [u32; COUNT],
    pub values: [f32; COUNT],
    wanted: [u8; COUNT],
    wanted_len: usize,
    known: [bool; COUNT],
    /// Which values come from a search.
    pub searched: [bool; COUNT],
    /// Groups to be looked at, and those they are split into.
    open: [[Group; COUNT]; 2],
    side: usize,
    open_len: usize,
}

/// Pixels in a line, the first and the last of which are known or wanted.
#[derive(Clone, Copy)]
struct Group {
    first: u8,
    last: u8,
    /// From one to the next: 1 along a row, [`TILE`] along a column.
    step: u8,
}

/// When pixels between two others are interpolated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Pixels of the tile, at most [`TILE`] along each side.
    pub width: usize,
    pub height: usize,
    /// Pixels from one searched column to the next.
    pub group: usize,
    /// The greatest difference of the two ends.
    pub tolerance: f32,
}

impl Grid {
    /// The next searched pixel of a line of `count`.
    fn next(&self, at: usize, count: usize) -> usize {
        (at + self.group).min(count - 1)
    }
}

impl Samples {
    pub const fn new() -> Samples {
        Samples {
            keys: [NO_KEY; COUNT],
            values: [0.0; COUNT],
            wanted: [0; COUNT],
            wanted_len: 0,
            known: [false; COUNT],
            searched: [false; COUNT],
            open: [[Group { first: 0, last: 0, step: 0 }; COUNT]; 2],
            side: 0,
            open_len: 0,
        }
    }

    /// The pixels to be searched now.
    pub fn wanted(&self) -> &[u8] {
        &self.wanted[..self.wanted_len]
    }

    /// Asks for the ends of all groups along every `group`-th column.
    pub fn begin(&mut self, grid: &Grid) {
        self.known = [false; COUNT];
        self.searched = [false; COUNT];
        self.wanted_len = 0;
        self.open_len = 0;
        let mut x = 0;
        loop {
            self.want(x);
            let mut y = 0;
            while y + 1 < grid.height {
                let next = grid.next(y, grid.height);
                self.want(next * TILE + x);
                self.open(y * TILE + x, next * TILE + x, TILE);
                y = next;
            }
            if x + 1 >= grid.width {
                return;
            }
            x = grid.next(x, grid.width);
        }
    }

    /// Interpolates what the pixels searched so far allow, and asks for the middles of the other
    /// groups. False once there are none; columns and rows each end that way.
    pub fn refine(&mut self, grid: &Grid) -> bool {
        self.wanted_len = 0;
        let count = self.open_len;
        if count == 0 {
            return false;
        }
        let side = self.side;
        (self.side, self.open_len) = (1 - side, 0);
        for i in 0..count {
            let Group { first, last, step } = self.open[side][i];
            let (first, last, step) = (usize::from(first), usize::from(last), usize::from(step));
            let length = (last - first) / step;
            if length <= 1 {
                continue;
            }
            let (start, stop) = (self.values[first], self.values[last]);
            let key = self.keys[first];
            let agrees = (first..=last).step_by(step).all(|i| self.keys[i] == key);
            if agrees && (stop - start).abs() <= grid.tolerance {
                let slope = (stop - start) / length as f32;
                for (i, pixel) in (first..last).step_by(step).enumerate().skip(1) {
                    self.values[pixel] = start + slope * i as f32;
                    self.known[pixel] = true;
                }
            } else {
                let middle = first + length / 2 * step;
                self.want(middle);
                self.open(first, middle, step);
                self.open(middle, last, step);
            }
        }
        true
    }

    /// After the columns: the groups along all rows between them.
    pub fn begin_rows(&mut self, grid: &Grid) {
        self.wanted_len = 0;
        self.open_len = 0;
        for row in 0..grid.height {
            let mut x = 0;
            while x + 1 < grid.width {
                let next = grid.next(x, grid.width);
                self.open(row * TILE + x, row * TILE + next, 1);
                x = next;
            }
        }
    }

    fn open(&mut self, first: usize, last: usize, step: usize) {
        self.open[self.side][self.open_len] =
            Group { first: first as u8, last: last as u8, step: step as u8 };
        self.open_len += 1;
    }

    fn want(&mut self, pixel: usize) {
        if !self.known[pixel] {
            self.known[pixel] = true;
            self.values[pixel] = 0.0;
            if self.keys[pixel] != NO_KEY {
                self.searched[pixel] = true;
                self.wanted[self.wanted_len] = pixel as u8;
                self.wanted_len += 1;
            }
        }
    }
}
