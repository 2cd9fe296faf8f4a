//! Colour textures.

use std::sync::OnceLock;

use glam::{Vec2, Vec4};

/// What lies beyond the border of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// The texture mirrored, then again.
    Mirror,
    /// Its border texels.
    Clamp,
}

/// An sRGB picture with linear alpha.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// Row-major, top row first: sRGB-encoded red, green, blue, and linear alpha.
    pub texels: Vec<[u8; 4]>,
    /// What lies beyond the border, horizontally and vertically.
    pub wrap: [Wrap; 2],
    /// Nearest texel instead of bilinear interpolation.
    pub nearest: bool,
}

impl Texture {
    /// The colour at `uv` as linear RGBA, bilinear or nearest; (0, 0) is the top left corner of
    /// the picture and (1, 1) the bottom right one. Coordinates that are not finite count as 0.
    ///
    /// # Panics
    ///
    /// When `texels` does not hold `width * height` texels, or none.
    #[must_use]
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        // Far out, a coordinate has no fraction left; the limit keeps the products finite.
        let uv =
            if uv.is_finite() { uv.clamp(Vec2::splat(-1e9), Vec2::splat(1e9)) } else { Vec2::ZERO };
        let x = uv.x * self.width as f32;
        let y = uv.y * self.height as f32;
        if self.nearest {
            return self.linear(x.floor(), y.floor());
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (s, t) = (x - x0, y - y0);
        let top = self.linear(x0, y0) * (1.0 - s) + self.linear(x0 + 1.0, y0) * s;
        let bottom = self.linear(x0, y0 + 1.0) * (1.0 - s) + self.linear(x0 + 1.0, y0 + 1.0) * s;
        top * (1.0 - t) + bottom * t
    }

    /// One texel, of whole coordinates that may lie beyond the border, as linear RGBA.
    fn linear(&self, x: f32, y: f32) -> Vec4 {
        let x = wrapped(x, self.width, self.wrap[0]);
        let y = wrapped(y, self.height, self.wrap[1]);
        let [r, g, b, a] = self.texels[y * self.width as usize + x];
        let table = srgb_table();
        Vec4::new(
            table[usize::from(r)],
            table[usize::from(g)],
            table[usize::from(b)],
            f32::from(a) / 255.0,
        )
    }
}

fn wrapped(coordinate: f32, size: u32, wrap: Wrap) -> usize {
    // Saturates, so that coordinates of any magnitude have a texel.
    let i = coordinate as i64;
    let n = i64::from(size);
    let i = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Mirror => {
            let j = i.rem_euclid(2 * n);
            j.min(2 * n - 1 - j)
        }
        Wrap::Clamp => i.clamp(0, n - 1),
    };
    i as usize
}

/// Linear light of each 8-bit sRGB value (IEC 61966-2-1).
fn srgb_table() -> &'static [f32; 256] {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    TABLE.get_or_init(|| {
        std::array::from_fn(|i| {
            let s = i as f64 / 255.0;
            let l = if s <= 0.040_45 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
            l as f32
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_texels(wrap: Wrap, nearest: bool) -> Texture {
        let texels = vec![[0, 0, 0, 0], [255, 255, 255, 255]];
        Texture { width: 2, height: 1, texels, wrap: [wrap; 2], nearest }
    }

    #[test]
    fn bilinear_in_linear_light() {
        let texture = two_texels(Wrap::Clamp, false);
        assert_eq!(texture.sample(Vec2::new(0.25, 0.5)), Vec4::ZERO);
        assert_eq!(texture.sample(Vec2::new(0.5, 0.5)), Vec4::splat(0.5));
        assert_eq!(texture.sample(Vec2::new(0.75, 0.9)), Vec4::ONE);
        assert!((srgb_table()[188] - 0.5029).abs() < 1e-4);
    }

    #[test]
    fn beyond_the_border() {
        let at = |wrap, u| two_texels(wrap, true).sample(Vec2::new(u, 0.5)).w;
        assert_eq!([-0.2, 0.2, 0.7, 1.2, 1.7].map(|u| at(Wrap::Repeat, u)), [1., 0., 1., 0., 1.]);
        assert_eq!([-0.2, 0.2, 0.7, 1.2, 1.7].map(|u| at(Wrap::Mirror, u)), [0., 0., 1., 1., 0.]);
        assert_eq!([-0.2, 0.2, 0.7, 1.2, 1.7].map(|u| at(Wrap::Clamp, u)), [0., 0., 1., 1., 1.]);
    }

    #[test]
    fn any_coordinate_has_a_colour() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for u in [f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX, 1e18, -1e18] {
                for nearest in [false, true] {
                    let color = two_texels(wrap, nearest).sample(Vec2::new(u, -u));
                    assert!(color.is_finite());
                }
            }
        }
    }
}
