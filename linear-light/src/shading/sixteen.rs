//! Sixteen receivers at once: which samples of a rectified light see them.
//!
//! The same arithmetic as that of one receiver ([`crate::lookup::Sample`]), lane by lane. Loops
//! stand where `map` of an array would be shorter: its closures are compiled on their own, without
//! the caller's instructions.

use shadowmap_core::{Bias, DepthMap, Warp};

use super::planes::SurfaceLanes;
use crate::lanes::{INDEX, LANES, Lanes, Ops, gather, lanes};
use crate::lookup::STRAIGHT;

/// A whole number in each lane: a column or a row.
pub(super) type Whole = [i32; LANES];

/// Receivers as the first sample sees them.
pub(super) struct Sixteen {
    u: Lanes,
    nearness: Lanes,
    /// The slopes of their planes along the map, and the part of the tolerance that slopes make.
    along: Lanes,
    steep: Lanes,
    /// The rows of texels above and below them.
    rows: [Whole; 2],
    /// Nearness of their planes at column 0 of either row.
    base: [Lanes; 2],
    /// How far they are from the row above towards the row below: what that one counts for.
    pub below: Lanes,
    /// Those in front of the light and between the first and the last row.
    between: u32,
    bias: Bias,
}

/// Sixteen receivers in the map of one sample.
pub(super) struct SampleLanes {
    /// Those inside the map.
    pub inside: u32,
    /// Those that the sample sees, by the texels of either row next to them. It sees all outside
    /// the map.
    pub lit: [u32; 2],
    column: Lanes,
    /// See [`crate::lookup::Sample`].
    shear: Lanes,
    offset: Lanes,
}

/// Which samples see each of sixteen receivers, by the texels in the rows next to it.
pub(super) struct Tests {
    /// Whether no texel hides it.
    pub all: u32,
    /// Whether not all texels hide it.
    pub any: u32,
    /// Whether some sample has it outside its map, where it counts as lit.
    pub outside: u32,
}

/// Numbers from 0 to below 2^22, rounded down.
#[inline(always)]
fn whole(of: &Lanes) -> Whole {
    // From 2^23 to 2^24 there is one float per whole number, and its low bits are that number. A
    // sum there rounds to nearest. A cast would be taken apart, lane by lane.
    const ONES: f32 = 8_388_608.0;
    lanes(|i| {
        let nearest = (of[i] + ONES) - ONES;
        let down = if nearest > of[i] { nearest - 1.0 } else { nearest };
        (down + ONES).to_bits() as i32 & 0x7f_ffff
    })
}

impl Sixteen {
    /// The receivers at the camera's pixels from (`x`, `y`) on, for maps of the given size.
    #[inline(always)]
    pub fn new(
        ops: impl Ops,
        warp: &Warp,
        [x, y]: [usize; 2],
        nearness: &Lanes,
        surfaces: &SurfaceLanes,
        [width, height]: [u32; 2],
        bias: Bias,
    ) -> Sixteen {
        debug_assert!(width > 0 && height > 0, "rows are told apart");
        let row = y as f32 + 0.5;
        let warped = |r: &[f32; 4]| {
            lanes(|i| {
                let column = x as f32 + (INDEX[i] + 0.5);
                ((r[0] * column + r[1] * row) + r[2] * nearness[i]) + r[3]
            })
        };
        let [u, v, n, q] = warp.rows();
        let q = warped(q);
        let over_q = |of: Lanes| lanes(|i| of[i] / q[i]);
        let (u, v, n) = (over_q(warped(u)), over_q(warped(v)), over_q(warped(n)));
        let (zero, rows) = ([0.0; LANES], [height as f32; LANES]);
        let finite = |of: &Lanes| ops.greater(&[f32::INFINITY; LANES], &lanes(|i| of[i].abs()));
        let there = ops.greater(&q, &zero) & finite(&u) & finite(&n);
        let between = there & ops.greater(&rows, &v) & !ops.greater(&zero, &v);
        let after = ops.select(between, &lanes(|i| v[i] + 0.5), &zero);
        let after_row = whole(&after);
        let rows =
            [lanes(|i| (after_row[i] - 1).max(0)), lanes(|i| after_row[i].min(height as i32 - 1))];
        let SurfaceLanes { along, down, .. } = surfaces;
        let at_column_0 = lanes(|i| n[i] - along[i] * u[i]);
        let base =
            |row: &Whole| lanes(|i| at_column_0[i] + down[i] * ((row[i] as f32 + 0.5) - v[i]));
        Sixteen {
            base: [base(&rows[0]), base(&rows[1])],
            rows,
            steep: lanes(|i| bias.slope * (along[i].abs() + down[i].abs())),
            below: lanes(|i| after[i] - after_row[i] as f32),
            along: *along,
            u,
            nearness: n,
            between,
            bias,
        }
    }

    /// The receivers in a map in which nearness 1 is `shift` columns further left.
    #[inline(always)]
    pub fn sample(&self, ops: impl Ops, shift: f32, map: &DepthMap<'_>) -> SampleLanes {
        let Sixteen { u, nearness, along, steep, .. } = self;
        let (zero, columns) = ([0.0; LANES], [map.width() as f32; LANES]);
        let column = lanes(|i| u[i] - shift * nearness[i]);
        let inside = self.between & ops.greater(&columns, &column) & !ops.greater(&zero, &column);
        let column = ops.select(inside, &column, &zero);
        let shear = lanes(|i| 1.0 - shift * along[i]);
        let constant = self.bias.constant;
        let offset = lanes(|i| constant * nearness[i] * shear[i] + steep[i]);
        let mut sample = SampleLanes { inside, lit: [0; 2], column, shear, offset };
        let x = whole(&column);
        sample.lit = self.lit_at(ops, &sample, map, &x);
        let differ = sample.lit[0] ^ sample.lit[1];
        if differ != 0 {
            self.decide_beside_edges(ops, &mut sample, map, &x, differ);
        }
        sample
    }

    /// Nearness of the texels in columns `x` of row 0 or 1 next to the receivers, and how far in
    /// front of the receivers' planes they are, times `shear`.
    #[inline(always)]
    pub fn in_front(
        &self,
        sample: &SampleLanes,
        map: &DepthMap<'_>,
        x: &Whole,
        row: usize,
    ) -> Lanes {
        let (base, along, shear) = (&self.base[row], &self.along, &sample.shear);
        let texel = gather(map.nearness(), self.index(x, row, map.width() as usize));
        lanes(|i| texel[i] * shear[i] - (base[i] + along[i] * (x[i] as f32 + 0.5)))
    }

    /// Where columns `x` of row 0 or 1 are in memory, rows being `stride` apart.
    #[inline(always)]
    pub fn index(&self, x: &Whole, row: usize, stride: usize) -> [usize; LANES] {
        let rows = &self.rows[row];
        lanes(|i| rows[i] as usize * stride + x[i] as usize)
    }

    /// Whether the texels of columns `x` do not block the receivers, in either row.
    #[inline(always)]
    fn lit_at(
        &self,
        ops: impl Ops,
        sample: &SampleLanes,
        map: &DepthMap<'_>,
        x: &Whole,
    ) -> [u32; 2] {
        let above = sample.inside & ops.greater(&sample.shear, &[0.0; LANES]);
        let mut lit = [0xffff; 2];
        for (row, lit) in lit.iter_mut().enumerate() {
            let front = self.in_front(sample, map, x, row);
            *lit &= !(above & ops.greater(&front, &sample.offset));
        }
        lit
    }

    /// Where the two rows differ. An edge along the light casts a hard shadow and lies somewhere
    /// between the rows: the nearer one decides. Any other edge goes on in the other row, and both
    /// have a say.
    #[inline(always)]
    fn decide_beside_edges(
        &self,
        ops: impl Ops,
        sample: &mut SampleLanes,
        map: &DepthMap<'_>,
        x: &Whole,
        differ: u32,
    ) {
        const FAR: i32 = STRAIGHT as i32;
        let column = lanes(|i| x[i] as f32);
        let last = [map.width() as f32 - STRAIGHT as f32; LANES];
        let mut straight = differ
            & ops.greater(&column, &[STRAIGHT as f32 - 1.0; LANES])
            & ops.greater(&last, &column);
        if straight == 0 {
            return;
        }
        for far in [lanes(|i| (x[i] - FAR).max(0)), lanes(|i| x[i] + FAR)] {
            let lit = self.lit_at(ops, sample, map, &far);
            straight &= !((lit[0] ^ sample.lit[0]) | (lit[1] ^ sample.lit[1]));
        }
        let nearer_below = ops.greater(&self.below, &[0.5; LANES]);
        let decided = nearer_below & sample.lit[1] | !nearer_below & sample.lit[0];
        sample.lit = sample.lit.map(|lit| lit & !straight | decided & straight);
    }

    /// Looks into the maps of all samples. Each is `disparity` columns per nearness further left
    /// than the one before.
    #[inline(always)]
    pub fn test(&self, ops: impl Ops, disparity: f32, maps: &[DepthMap<'_>]) -> Tests {
        let mut tests = Tests { all: 0xffff, any: 0, outside: 0 };
        for (k, map) in maps.iter().enumerate() {
            let SampleLanes { inside, lit: [above, below], .. } =
                self.sample(ops, disparity * k as f32, map);
            tests.all &= above & below;
            tests.any |= above | below;
            tests.outside |= !inside & 0xffff;
        }
        tests
    }
}

impl SampleLanes {
    /// The two columns of texels next to each receiver, the weight of the right one, and how far
    /// from a receiver's plane a texel may be to show the receiver's surface.
    #[inline(always)]
    pub fn around(&self, width: u32, texel_in_nearness: f32) -> ([Whole; 2], Lanes, Lanes) {
        let after = lanes(|i| self.column[i] + 0.5);
        let column = whole(&after);
        let right = lanes(|i| after[i] - column[i] as f32);
        let columns =
            [lanes(|i| (column[i] - 1).max(0)), lanes(|i| column[i].min(width as i32 - 1))];
        let (offset, shear) = (&self.offset, &self.shear);
        let tolerance = lanes(|i| offset[i].max(texel_in_nearness * shear[i]));
        (columns, right, tolerance)
    }
}
