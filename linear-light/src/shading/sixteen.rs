//! Sixteen receivers at once: which samples of a rectified light see them.
//!
//! The same arithmetic as that of one receiver ([`Sample`]), on plain arrays, which the compiler
//! turns into vector instructions.

use shadowmap_core::{Bias, DepthMap, LightPoint, Warp};

use super::{Surface, Test};
use crate::lookup::Sample;

/// Receivers at once.
pub(super) const LANES: usize = 16;

pub(super) type Lanes = [f32; LANES];

#[inline(always)]
fn lanes<T: Copy + Default>(f: impl Fn(usize) -> T) -> [T; LANES] {
    let mut out = [T::default(); LANES];
    for (i, out) in out.iter_mut().enumerate() {
        *out = f(i);
    }
    out
}

/// Receivers as the first sample sees them.
pub(super) struct Sixteen {
    u: Lanes,
    v: Lanes,
    nearness: Lanes,
    /// The slopes of their planes along and down the map.
    along: Lanes,
    down: Lanes,
    /// Whether they lie in front of the light.
    there: [bool; LANES],
}

/// A [`Test`] of each receiver.
pub(super) struct Tests {
    all: [bool; LANES],
    any: [bool; LANES],
    outside: [bool; LANES],
}

impl Tests {
    /// Those of one receiver.
    #[inline(always)]
    pub fn of(&self, i: usize) -> Test {
        Test { all: self.all[i], any: self.any[i], outside: self.outside[i] }
    }

    /// The visibility of all, if they lie on one surface and nothing has to be looked up further.
    #[inline(always)]
    pub fn of_all(&self, surface: &Surface) -> Option<f32> {
        if self.any == [false; LANES] {
            return Some(0.0);
        }
        (self.all == [true; LANES] && surface.above == Some([0.0, 1.0])).then_some(1.0)
    }

    #[inline(always)]
    pub fn count_outside(&self) -> u32 {
        self.outside.iter().map(|outside| u32::from(*outside)).sum()
    }
}

impl Sixteen {
    /// The receivers at the camera's pixels from (`x`, `y`) on.
    #[inline(always)]
    pub fn new(
        warp: &Warp,
        [x, y]: [usize; 2],
        nearness: &Lanes,
        surfaces: &[Surface; LANES],
    ) -> Sixteen {
        let row = y as f32 + 0.5;
        let warped = |r: &[f32; 4]| {
            lanes(|i| {
                let column = (x as f32 + i as f32) + 0.5;
                ((r[0] * column + r[1] * row) + r[2] * nearness[i]) + r[3]
            })
        };
        let [u, v, n, q] = warp.rows();
        let q = warped(q);
        let (u, v, n) = (warped(u), warped(v), warped(n));
        let (u, v, n) = (lanes(|i| u[i] / q[i]), lanes(|i| v[i] / q[i]), lanes(|i| n[i] / q[i]));
        Sixteen {
            there: lanes(|i| {
                q[i] > 0.0 && u[i].is_finite() && v[i].is_finite() && n[i].is_finite()
            }),
            u,
            v,
            nearness: n,
            along: lanes(|i| surfaces[i].slope.x),
            down: lanes(|i| surfaces[i].slope.y),
        }
    }

    /// One of them; `None` behind the light.
    #[inline(always)]
    pub fn point(&self, i: usize) -> Option<LightPoint> {
        let slope = glam::Vec2::new(self.along[i], self.down[i]);
        let point = LightPoint { u: self.u[i], v: self.v[i], nearness: self.nearness[i], slope };
        self.there[i].then_some(point)
    }

    /// Looks into the maps of all samples. Each is `disparity` columns per nearness further left
    /// than the one before.
    #[inline(always)]
    pub fn test(&self, disparity: f32, bias: Bias, maps: &[DepthMap<'_>]) -> Tests {
        let Sixteen { u, v, nearness, along, down, there } = self;
        let [width, height] = [maps[0].width() as i32, maps[0].height() as i32];
        let (columns, rows) = (width as f32, height as f32);
        let between = lanes(|i| there[i] & (v[i] >= 0.0) & (v[i] < rows));
        let after = lanes(|i| if between[i] { (v[i] + 0.5) as i32 } else { 0 });
        let above = lanes(|i| (after[i] - 1).max(0));
        let below = lanes(|i| after[i].min(height - 1));
        let at_column_0 = lanes(|i| nearness[i] - along[i] * u[i]);
        let base = |row: &[i32; LANES]| {
            lanes(|i| at_column_0[i] + down[i] * ((row[i] as f32 + 0.5) - v[i]))
        };
        let (base_above, base_below) = (base(&above), base(&below));
        let steep = lanes(|i| bias.slope * (along[i].abs() + down[i].abs()));
        let mut tests = Tests { all: [true; LANES], any: [false; LANES], outside: [false; LANES] };
        for (k, map) in maps.iter().enumerate() {
            let shift = disparity * k as f32;
            let column = lanes(|i| u[i] - shift * nearness[i]);
            let inside = lanes(|i| between[i] & (column[i] >= 0.0) & (column[i] < columns));
            let x = lanes(|i| if inside[i] { column[i] as i32 } else { 0 });
            let shear = lanes(|i| 1.0 - shift * along[i]);
            let offset = lanes(|i| bias.constant * nearness[i] * shear[i] + steep[i]);
            let texels = map.nearness();
            let lit = |row: &[i32; LANES], base: &Lanes| {
                let texel = lanes(|i| texels[row[i] as usize * width as usize + x[i] as usize]);
                lanes(|i| {
                    let plane = base[i] + along[i] * (x[i] as f32 + 0.5);
                    let blocked = (texel[i] * shear[i] - plane > offset[i]) & (shear[i] > 0.0);
                    !(blocked & inside[i])
                })
            };
            let (mut lit_above, mut lit_below) =
                (lit(&above, &base_above), lit(&below, &base_below));
            if lit_above != lit_below {
                for i in 0..LANES {
                    if lit_above[i] != lit_below[i]
                        && let Some(point) = self.point(i)
                    {
                        let sample = Sample::new(&point, shift, bias, map);
                        [lit_above[i], lit_below[i]] =
                            sample.map_or([true; 2], |sample| sample.lit(map));
                    }
                }
            }
            for i in 0..LANES {
                tests.all[i] &= lit_above[i] & lit_below[i];
                tests.any[i] |= lit_above[i] | lit_below[i];
                tests.outside[i] |= !inside[i];
            }
        }
        tests
    }
}
