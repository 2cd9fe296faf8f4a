//! What is found in a tile, written to the image.

use super::adaptive::{COUNT, Grid, Samples, TILE};
use super::field::{Field, Texel};
use super::kernels::{Ops, Work};
use super::soa::Receivers;
use crate::{Counters, Found, Visibility};

/// Writes the visibility of a tile's pixels.
pub(crate) struct WriteTile<'a, T, V> {
    pub field: &'a Field<'a, T>,
    pub grid: &'a Grid,
    pub receivers: &'a Receivers,
    /// What hides the light from them; `None` if nothing but their horizon does.
    pub samples: Option<&'a Samples>,
    /// Rows of the image, from the tile's first pixel on.
    pub out: &'a mut [V],
    /// Pixels from one row of the image to the next.
    pub image: usize,
    /// Counts the receivers outside the map.
    pub counters: &'a mut Counters,
}

impl<T: Texel, V: Visibility> Work for WriteTile<'_, T, V> {
    #[inline(always)]
    fn run(self, _: &impl Ops) {
        self.counters.outside += self.outside();
        let Grid { width, height, .. } = *self.grid;
        for (row, out) in self.out.chunks_mut(self.image).take(height).enumerate() {
            let pixels = row * TILE..(row + 1) * TILE;
            let blocked = self.samples.map_or(&[0.0; TILE][..], |s| &s.values[pixels.clone()]);
            let found = self.samples.map_or([Found::Decided; TILE], |samples| found(samples, row));
            let pixels = self.receivers.sky[pixels].iter().zip(blocked).zip(&found).take(width);
            for (out, ((&sky, &blocked), &found)) in out.iter_mut().zip(pixels) {
                let visible = sky - blocked;
                *out = V::from_pixel(if visible > 0.0 { visible } else { 0.0 }, found);
            }
        }
    }
}

/// How the pixels in a row were found.
#[inline(always)]
fn found(samples: &Samples, row: usize) -> [Found; TILE] {
    let mut found = [Found::Decided; TILE];
    for (i, found) in found.iter_mut().enumerate() {
        let [is_needed, is_searched] =
            [samples.needed, samples.searched].map(|pixels| pixels[row] >> i & 1 == 1);
        *found = match (is_needed, is_searched) {
            (false, _) => Found::Decided,
            (_, true) => Found::Searched,
            (_, false) => Found::Interpolated,
        };
    }
    found
}

impl<T: Texel, V> WriteTile<'_, T, V> {
    /// How many receivers that see something of the light lie outside the map.
    #[inline(always)]
    fn outside(&self) -> u32 {
        let (width, height) = (self.field.width as f32, self.field.height as f32);
        let Receivers { u, v, sky, .. } = self.receivers;
        let mut outside = 0;
        for i in 0..COUNT {
            let inside = (u[i] >= 0.0) & (v[i] >= 0.0) & (u[i] < width) & (v[i] < height);
            outside += u32::from(!inside & (sky[i] > 0.0));
        }
        outside
    }
}
