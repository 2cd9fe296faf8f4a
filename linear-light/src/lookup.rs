//! Receivers in the maps of a light's samples.
//!
//! A receiver at column u of the first rectified map, with the plane of nearness
//! `n + sx (s - u) + sy (t - v)`, lies at column `u - shift n` of another, where the same plane is
//! sheared: a texel (s, m) of it is a texel (s + shift m, m) of the first. So it is in front of the
//! plane where `m (1 - shift sx) > n + sx (s - u) + sy (t - v)`, without a division per sample.

use glam::Vec2;
use shadowmap_core::{Bias, DepthMap, LightPoint};

/// An edge that keeps to its row for this many texels either way lies along the light.
pub(crate) const STRAIGHT: usize = 16;

/// A receiver and its plane in one sample's map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    u: f32,
    v: f32,
    /// The rows of texels above and below the receiver.
    rows: [usize; 2],
    /// Nearness of the plane at column 0 of either row, times `shear`.
    base: [f32; 2],
    /// Its change per column, times `shear`.
    slope: f32,
    /// The tolerance, times `shear`.
    offset: f32,
    /// Positive where the sample is above the receiver's plane.
    shear: f32,
}

/// The two texels next to a coordinate, by their centres, within `len` texels.
#[inline(always)]
fn next_to(at: f32, len: usize) -> [usize; 2] {
    let after = (at + 0.5) as usize;
    [after.saturating_sub(1), after.min(len - 1)]
}

/// How far a coordinate is from the centre of the first of those texels to that of the second.
#[inline(always)]
pub(crate) fn between(at: f32) -> f32 {
    (at + 0.5) - (at + 0.5) as u32 as f32
}

impl Sample {
    /// The receiver `point` of one map in another, in which nearness 1 is `shift` columns further
    /// left. `None` outside that map.
    #[inline(always)]
    pub fn new(point: &LightPoint, shift: f32, bias: Bias, map: &DepthMap<'_>) -> Option<Sample> {
        let (width, height) = (map.width() as usize, map.height() as usize);
        let (u, v) = (point.u - shift * point.nearness, point.v);
        // Written so that NaN falls outside.
        let inside = u >= 0.0 && v >= 0.0 && u < width as f32 && v < height as f32;
        if !inside {
            return None;
        }
        let Vec2 { x: slope, y: down } = point.slope;
        let shear = 1.0 - shift * slope;
        let rows = next_to(v, height);
        let at_column_0 = point.nearness - slope * point.u;
        let base = rows.map(|y| at_column_0 + down * ((y as f32 + 0.5) - v));
        let offset =
            bias.constant * point.nearness * shear + bias.slope * (slope.abs() + down.abs());
        Some(Sample { u, v, rows, base, slope, offset, shear })
    }

    /// How far in front of the receiver's plane a texel of its row 0 or 1 is, times `shear`.
    #[inline(always)]
    fn in_front(&self, map: &DepthMap<'_>, x: usize, row: usize) -> f32 {
        let texel = map.nearness()[self.rows[row] * map.width() as usize + x];
        texel * self.shear - (self.base[row] + self.slope * (x as f32 + 0.5))
    }

    /// Whether the texels of a column do not block the receiver, in either row. A NaN never blocks,
    /// nor does anything where the sample is below the receiver's plane.
    #[inline(always)]
    fn lit_at(&self, map: &DepthMap<'_>, x: usize) -> [bool; 2] {
        [0, 1].map(|row| {
            let blocked = self.in_front(map, x, row) > self.offset && self.shear > 0.0;
            !blocked
        })
    }

    /// Whether the sample sees the receiver, by the texel it falls on, in either row.
    #[inline(always)]
    pub fn lit(&self, map: &DepthMap<'_>) -> [bool; 2] {
        let x = self.u as usize;
        let lit = self.lit_at(map, x);
        if lit[0] == lit[1] { lit } else { self.lit_beside_edge(map, x, lit) }
    }

    /// Where the two rows differ. An edge along the light casts a hard shadow and lies somewhere
    /// between the rows: the nearer one decides. Any other edge goes on in the other row, and both
    /// have a say.
    #[inline(never)]
    fn lit_beside_edge(&self, map: &DepthMap<'_>, x: usize, lit: [bool; 2]) -> [bool; 2] {
        let goes_on = |x: Option<usize>| {
            x.is_some_and(|x| x < map.width() as usize && self.lit_at(map, x) == lit)
        };
        if goes_on(x.checked_sub(STRAIGHT)) && goes_on(x.checked_add(STRAIGHT)) {
            [lit[self.nearest_row()]; 2]
        } else {
            lit
        }
    }

    /// Texel coordinate down the map.
    #[inline(always)]
    pub fn v(&self) -> f32 {
        self.v
    }

    /// The row, 0 or 1, that the receiver falls on.
    #[inline(always)]
    pub fn nearest_row(&self) -> usize {
        usize::from(between(self.v) > 0.5)
    }

    /// What a channel says at the receiver: the mean over the texels around it in the `rows` (0, 1)
    /// given with their weights, as far as they show the receiver's surface. That is where they are
    /// no further from its plane than the tolerance or `texel_in_nearness`, which moves a skin by
    /// one texel.
    #[inline(never)]
    pub fn seen<'c>(
        &self,
        map: &DepthMap<'_>,
        rows: &[(usize, f32)],
        texel_in_nearness: f32,
        channel: impl Fn(usize) -> &'c [f32],
    ) -> f32 {
        let tolerance = self.offset.max(texel_in_nearness * self.shear);
        let columns = next_to(self.u, map.width() as usize);
        let right = between(self.u);
        let (mut sum, mut weights) = (0.0, 0.0);
        for &(row, weight) in rows {
            for (x, weight) in [(columns[0], (1.0 - right) * weight), (columns[1], right * weight)]
            {
                if self.in_front(map, x, row).abs() <= tolerance {
                    sum += weight * channel(self.rows[row])[x];
                    weights += weight;
                }
            }
        }
        if weights > 0.0 { sum / weights } else { channel(self.rows[rows[0].0])[self.u as usize] }
    }
}
