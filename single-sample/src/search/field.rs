//! The light's texels, as the search reads them.

use shadowmap_core::View;

use super::receiver::Receiver;
use super::segments::is_within;
use crate::LightMap;

/// Texels that are tested at a time.
pub(crate) const WINDOW: usize = 16;

/// One texel of a map in either layout. Its nearness is in the unit that
/// [`super::geometry::Geometry::unit`] says.
pub(crate) trait Texel: Copy + Sync {
    /// Nearness of the map per nearness of the view.
    fn unit(view: &View) -> f32;
    fn nearness(self) -> f32;
    fn window(texels: &[Self; WINDOW]) -> [f32; WINDOW];
}

impl Texel for f32 {
    fn unit(_: &View) -> f32 {
        1.0
    }
    #[inline(always)]
    fn nearness(self) -> f32 {
        self
    }
    #[inline(always)]
    fn window(texels: &[f32; WINDOW]) -> [f32; WINDOW] {
        *texels
    }
}

/// A texel of a [`shadowmap_core::PackedMap`].
impl Texel for u32 {
    fn unit(view: &View) -> f32 {
        16_777_215.0 / view.max_nearness()
    }
    #[inline(always)]
    fn nearness(self) -> f32 {
        // Through a signed number, for which every instruction set has a conversion.
        (self >> 8) as i32 as f32
    }
    #[inline(always)]
    fn window(texels: &[u32; WINDOW]) -> [f32; WINDOW] {
        let mut window = [0.0; WINDOW];
        for (nearness, texel) in window.iter_mut().zip(texels) {
            *nearness = texel.nearness();
        }
        window
    }
}

/// A map of texels. Outside of it nothing blocks.
#[derive(Clone, Copy)]
pub(crate) struct Field<'a, T> {
    pub texels: &'a [T],
    pub width: i32,
    pub height: i32,
}

/// Which texels block: those above a receiver's plane and nearer than it. For several receivers at
/// once, what all of their planes lie between, and the range of their nearness.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Test {
    pub hu: f32,
    pub hv: f32,
    pub hn: f32,
    /// The least and the greatest [`Receiver::above`].
    pub above: [f32; 2],
    /// The least and the greatest nearness.
    pub nearness: [f32; 2],
}

impl Test {
    pub fn of(receiver: &Receiver) -> Test {
        let Receiver { hu, hv, hn, above, nearness, .. } = *receiver;
        Test { hu, hv, hn, above: [above; 2], nearness: [nearness; 2] }
    }
}

impl<'a, T: Texel> Field<'a, T> {
    /// The texels of a map of `light`.
    pub fn new(light: &LightMap<'_>, texels: &'a [T]) -> Self {
        Field { texels, width: light.view().width() as i32, height: light.view().height() as i32 }
    }

    /// Nearness of texel (x, y); NaN outside the map.
    #[inline(always)]
    pub fn nearness(&self, x: i32, y: i32) -> f32 {
        if (0..self.width).contains(&x) && (0..self.height).contains(&y) {
            self.texels[y as usize * self.width as usize + x as usize].nearness()
        } else {
            f32::NAN
        }
    }

    /// Nearness of `WINDOW` texels of a row, from column x on.
    #[inline(always)]
    pub fn window(&self, x: i32, y: i32) -> [f32; WINDOW] {
        if x >= 0 && x <= self.width - WINDOW as i32 && (0..self.height).contains(&y) {
            let start = y as usize * self.width as usize + x as usize;
            let texels: &[T; WINDOW] =
                self.texels[start..].first_chunk().expect("a window lies within its row");
            T::window(texels)
        } else {
            let mut window = [f32::NAN; WINDOW];
            for (nearness, x) in window.iter_mut().zip(x..) {
                *nearness = self.nearness(x, y);
            }
            window
        }
    }

    /// Which of the four texels with their centres around (u, v) block the receiver, as an index
    /// of [`super::segments::PIECES`].
    #[inline(always)]
    pub fn corner(&self, receiver: &Receiver, x: i32, y: i32) -> usize {
        let blocks = |x: i32, y: i32| {
            let nearness = self.nearness(x, y);
            usize::from(receiver.is_blocked_by(x as f32 + 0.5, y as f32 + 0.5, nearness))
        };
        blocks(x, y) | blocks(x + 1, y) << 1 | blocks(x + 1, y + 1) << 2 | blocks(x, y + 1) << 3
    }

    /// Whether the middle of the disc is hidden: the receiver's place lies within the outline.
    #[inline(always)]
    pub fn hides_center(&self, receiver: &Receiver) -> bool {
        let (x, y) = (receiver.u - 0.5, receiver.v - 0.5);
        let floor = |value: f32| {
            let cut = value as i32;
            if cut as f32 > value { cut - 1 } else { cut }
        };
        let (column, row) = (floor(x), floor(y));
        let code = self.corner(receiver, column, row);
        is_within(code, x - column as f32, y - row as f32)
    }
}
