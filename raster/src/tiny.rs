//! Triangles of a few texels, turned into fragments: as many triangles at a time as a vector has
//! lanes, texel by texel of their bounds.

use crate::bins::{Bins, Grid};
use crate::lanes::{self, Lanes, Planes, inside};
use crate::line::clamp;
use crate::simd::{MAX_LANES, Simd, set_bits};

/// The most columns and rows of bounds, at any level.
const SIDE: usize = 4;

/// Where the centres of texels lie, from the start of the first one.
const CENTERS: [f64; SIDE] = [0.5, 1.5, 2.5, 3.5];

/// What the tiny ones of a vector of triangles cover.
#[derive(Clone, Copy)]
pub(crate) struct Tiny {
    /// The lanes that cover each texel of their bounds, row by row.
    lanes: [u32; SIDE * SIDE],
    /// One bit for each texel that any lane covers, or once did.
    any: u32,
    /// The first row of each lane.
    rows: [u32; MAX_LANES],
    /// The band that all rows of all lanes lie in, if they do.
    band: Option<u32>,
}

impl Tiny {
    pub(crate) const NONE: Tiny =
        Tiny { lanes: [0; SIDE * SIDE], any: 0, rows: [0; MAX_LANES], band: None };

    /// Of the `wanted` lanes, all of them at most [`lanes::tiny`] columns and rows. In place: what
    /// is written number by number must not be copied as vectors at once.
    #[inline(always)]
    pub(crate) fn find<S: Simd>(&mut self, s: S, lanes: &Lanes<S>, wanted: u32, grid: &Grid) {
        self.any = 0;
        if wanted == 0 {
            return;
        }
        let Lanes { x, y, .. } = lanes;
        s.store_u(&mut self.rows, y[0]);
        let band = self.rows[wanted.trailing_zeros() as usize % MAX_LANES] >> grid.shift;
        let start = (band << grid.shift) as i32;
        let end = s.splat_i(start + grid.rows() as i32);
        let here = s.and_m(s.greater_i(y[0], s.splat_i(start - 1)), s.greater_i(end, y[1]));
        self.band = (wanted & !s.bits(here) == 0).then_some(band);
        self.cover::<S, 0, 0>(s, lanes, wanted);
        if lanes::tiny::<S>() > 2 {
            let wide = wanted & s.bits(s.greater_i(x[1], s.add_i(x[0], s.splat_i(1))));
            let high = wanted & s.bits(s.greater_i(y[1], s.add_i(y[0], s.splat_i(1))));
            if wide | high != 0 {
                self.cover::<S, 0, 2>(s, lanes, wide);
                self.cover::<S, 2, 0>(s, lanes, high);
                self.cover::<S, 2, 2>(s, lanes, wide & high);
            }
        }
    }

    /// Forgets all but the lanes whose bits are set.
    pub(crate) fn keep(&mut self, bits: u32) {
        self.lanes.iter_mut().for_each(|lanes| *lanes &= bits);
    }

    /// Whether anything is covered.
    pub(crate) fn is_any(&self) -> bool {
        self.any != 0
    }

    /// Two rows and two columns of the bounds of the `wanted` lanes.
    #[inline(always)]
    fn cover<S: Simd, const DOWN: usize, const RIGHT: usize>(
        &mut self,
        s: S,
        lanes: &Lanes<S>,
        wanted: u32,
    ) {
        let Lanes { x, y, edges, delta, .. } = lanes;
        let mut edges = *edges;
        let (mut right, mut down) = (edges, edges);
        for k in 0..3 {
            let [dx, dy] = delta[k];
            (right[k], down[k]) = (s.shift_left::<8>(dy), s.shift_left::<8>(dx));
            if RIGHT > 0 {
                edges[k] = s.sub_i(edges[k], s.shift_left::<9>(dy));
            }
            if DOWN > 0 {
                edges[k] = s.add_i(edges[k], s.shift_left::<9>(dx));
            }
        }
        let wide = s.bits(s.greater_i(x[1], s.add_i(x[0], s.splat_i(RIGHT as i32))));
        let high = s.bits(s.greater_i(y[1], s.add_i(y[0], s.splat_i(DOWN as i32))));
        for (i, in_row) in [wanted, wanted & high].iter().enumerate() {
            let mut texel = edges;
            for (j, in_column) in [u32::MAX, wide].iter().enumerate() {
                let index = (DOWN + i) * SIDE + RIGHT + j;
                self.lanes[index] = in_row & in_column & inside(s, texel);
                self.any |= u32::from(self.lanes[index] != 0) << index;
                for k in 0..3 {
                    texel[k] = s.sub_i(texel[k], right[k]);
                }
            }
            for k in 0..3 {
                edges[k] = s.add_i(edges[k], down[k]);
            }
        }
    }

    /// Adds all that is covered to the fragments of its bands.
    #[inline(always)]
    pub(crate) fn push<S: Simd>(
        &self,
        s: S,
        lanes: &Lanes<S>,
        planes: &Planes<S>,
        payload: S::I,
        grid: &Grid,
        bins: &mut Bins,
    ) {
        let (x, y, width) = (lanes.x[0], lanes.y[0], grid.width as i32);
        let first = s.add_i(s.mul_i(y, s.splat_i(width)), x);
        let (fx, fy) = (s.d_from_f(s.f_from_i(x)), s.d_from_f(s.f_from_i(y)));
        for index in set_bits(self.any) {
            let (right, down) = (index % SIDE, index / SIDE);
            let px = s.add_d(fx, s.splat_d(CENTERS[right]));
            let py = s.add_d(fy, s.splat_d(CENTERS[down]));
            let row = s.add_d(s.mul_d(planes.b, py), planes.c);
            let near = s.f_from_d(s.add_d(s.mul_d(planes.a, px), row));
            let near = clamp(s, near, planes.low, planes.high);
            let offset = down as i32 * width + right as i32;
            let mut rest = self.lanes[index];
            if let Some(band) = self.band {
                let start = (band << grid.shift) as i32 * width;
                let texel = s.add_i(first, s.splat_i(offset - start));
                bins.bands[band as usize].fragments.push(s, rest, texel, near, payload);
                continue;
            }
            let texel = s.add_i(first, s.splat_i(offset));
            while rest != 0 {
                // The lanes in the band of the first one that is left.
                let lane = rest.trailing_zeros() as usize % MAX_LANES;
                let band = (self.rows[lane] as usize + down) >> grid.shift;
                let start = (band << grid.shift) as i32;
                let before = s.splat_i(start - 1 - down as i32);
                let end = s.splat_i(start + grid.rows() as i32 - down as i32);
                let here = s.and_m(s.greater_i(y, before), s.greater_i(end, y));
                let here = rest & s.bits(here);
                rest &= !here;
                let texel = s.sub_i(texel, s.splat_i(start * width));
                bins.bands[band].fragments.push(s, here, texel, near, payload);
            }
        }
    }
}
