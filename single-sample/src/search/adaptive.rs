//! Adaptive sampling (Brabec and Seidel 2002, section 4.3), within one tile of the image.

/// Pixels along each side of a tile.
pub(crate) const TILE: usize = 16;

/// A pixel that needs no search.
pub(crate) const NO_KEY: u64 = 0;

/// The blocked fractions of a tile's pixels, searched or interpolated.
pub(crate) struct Samples {
    /// What pixels must have in common to be interpolated: the object and the hard shadow test.
    /// [`NO_KEY`] for those whose value does not matter.
    pub keys: [u64; TILE * TILE],
    pub values: [f32; TILE * TILE],
    known: [bool; TILE * TILE],
}

impl Samples {
    pub const fn new() -> Samples {
        Samples {
            keys: [NO_KEY; TILE * TILE],
            values: [0.0; TILE * TILE],
            known: [false; TILE * TILE],
        }
    }

    /// Finds the value of every pixel: along every `group`-th column pixel groups with both ends
    /// searched, split where keys differ, then along all rows between these columns. `width` and
    /// `height` are at most [`TILE`]; the last group of each line may be smaller.
    #[inline(always)]
    pub fn fill(
        &mut self,
        group: usize,
        width: usize,
        height: usize,
        mut search: impl FnMut(usize) -> f32,
    ) {
        self.known = [false; TILE * TILE];
        let mut column = 0;
        loop {
            self.line(column, TILE, height, group, &mut search);
            if column + 1 >= width {
                break;
            }
            column = (column + group).min(width - 1);
        }
        for row in 0..height {
            self.line(row * TILE, 1, width, group, &mut search);
        }
    }

    /// The `count` pixels from `first` on, `step` apart.
    #[inline(always)]
    fn line(
        &mut self,
        first: usize,
        step: usize,
        count: usize,
        group: usize,
        search: &mut impl FnMut(usize) -> f32,
    ) {
        let at = |i: usize| first + i * step;
        self.know(first, search);
        let mut begin = 0;
        while begin + 1 < count {
            let end = (begin + group).min(count - 1);
            self.know(at(end), search);
            // The ends of groups that are still to do, the nearest last.
            let mut ends = [0_usize; 8];
            ends[0] = end;
            let mut depth = 1;
            let mut from = begin;
            while depth > 0 {
                let to = ends[depth - 1];
                if to - from <= 1 {
                    from = to;
                    depth -= 1;
                    continue;
                }
                let key = self.keys[at(from)];
                if (from + 1..=to).all(|i| self.keys[at(i)] == key) {
                    let (start, stop) = (self.values[at(from)], self.values[at(to)]);
                    let slope = (stop - start) / (to - from) as f32;
                    for i in from + 1..to {
                        if !self.known[at(i)] {
                            self.values[at(i)] = start + slope * (i - from) as f32;
                            self.known[at(i)] = true;
                        }
                    }
                    from = to;
                    depth -= 1;
                } else {
                    let middle = (from + to) / 2;
                    self.know(at(middle), search);
                    ends[depth] = middle;
                    depth += 1;
                }
            }
            begin = end;
        }
    }

    #[inline(always)]
    fn know(&mut self, pixel: usize, search: &mut impl FnMut(usize) -> f32) {
        if !self.known[pixel] {
            self.values[pixel] = if self.keys[pixel] == NO_KEY { 0.0 } else { search(pixel) };
            self.known[pixel] = true;
        }
    }
}
