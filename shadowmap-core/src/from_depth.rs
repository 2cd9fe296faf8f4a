//! Planes and normals from depth alone.

use glam::Vec3;

use crate::{BandSlice, Camera, Plane, Threads, for_each_band};

/// Side of the tiles that normals are shared in.
const TILE: usize = 16;

/// How much nearness may differ from a plane, relatively.
const FLAT: f32 = 1.0 / 131_072.0;

/// How much less a large step counts against a neighbour than one that its own neighbour does not
/// continue.
const STEEP: f32 = 1.0 / 16.0;

/// A plane of the camera's image: nearness at the centre of a pixel, and its slopes.
#[derive(Clone, Copy)]
struct Facet {
    pixel: [usize; 2],
    nearness: f32,
    slopes: [f32; 2],
    normal: Vec3,
}

impl Facet {
    const NONE: Facet =
        Facet { pixel: [0; 2], nearness: f32::NAN, slopes: [0.0; 2], normal: Vec3::ZERO };

    /// Whether a pixel lies on it.
    #[inline(always)]
    fn holds(&self, x: usize, y: usize, nearness: f32) -> bool {
        let (dx, dy) = (x as f32 - self.pixel[0] as f32, y as f32 - self.pixel[1] as f32);
        let expected = self.nearness + (self.slopes[0] * dx + self.slopes[1] * dy);
        (nearness - expected).abs() <= FLAT * nearness
    }
}

impl Camera<'_> {
    /// Writes the unit normal of the surface in every pixel, derived from the nearness of the
    /// pixels around it; zero where nothing is seen. For
    /// [`Surfaces::Normals`](crate::Surfaces::Normals): neighbouring pixels on one plane get the
    /// very same normal here, and whatever takes pixels of one plane together is faster than with
    /// [`Surfaces::FromDepth`](crate::Surfaces::FromDepth).
    ///
    /// # Panics
    ///
    /// If there is not one normal per pixel.
    pub fn normals_from_depth(&self, threads: Threads, normals: &mut [Vec3]) {
        let width = self.map().width() as usize;
        assert_eq!(normals.len(), self.map().nearness().len(), "one normal per pixel");
        let bands = BandSlice { data: normals, len: (width * TILE).max(1) };
        for_each_band(threads, bands, &|index, band| {
            for left in (0..width).step_by(TILE) {
                self.tile(left, index * TILE, width, band.data);
            }
        });
    }

    fn tile(&self, left: usize, top: usize, width: usize, band: &mut [Vec3]) {
        let columns = left..(left + TILE).min(width);
        let mut above = [Facet::NONE; TILE];
        for (row, out) in band.chunks_exact_mut(width).enumerate() {
            let y = top + row;
            let nearness = &self.map().nearness()[y * width..][..width];
            let mut before = Facet::NONE;
            for x in columns.clone() {
                let (n, above) = (nearness[x], &mut above[x - left]);
                let seen = n > 0.0;
                if seen && above.holds(x, y, n) {
                    before = *above;
                } else if seen && !before.holds(x, y, n) {
                    before = self.facet(x, y, n);
                }
                *above = before;
                out[x] = if seen { before.normal } else { Vec3::ZERO };
            }
        }
    }

    fn facet(&self, x: usize, y: usize, nearness: f32) -> Facet {
        let slopes = self.slopes(x, y, nearness);
        let Plane([a, b, c, _]) = self.plane_with(x, y, nearness, slopes);
        let normal = Vec3::new(a, b, c);
        let length = libm::sqrtf((a * a + b * b) + c * c);
        let normal = normal / length;
        let normal = if normal.is_finite() { normal } else { Vec3::ZERO };
        Facet { pixel: [x, y], nearness, slopes, normal }
    }

    /// The plane through a pixel and its neighbours: nearness is affine in the image on every
    /// plane.
    pub(crate) fn plane_from_depth(&self, x: u32, y: u32, nearness: f32) -> Plane {
        let (x, y) = (x as usize, y as usize);
        self.plane_with(x, y, nearness, self.slopes(x, y, nearness))
    }

    fn slopes(&self, x: usize, y: usize, nearness: f32) -> [f32; 2] {
        let (width, height) = (self.map().width() as usize, self.map().height() as usize);
        let along_x = &self.map().nearness()[y * width..][..width];
        let along_y = &self.map().nearness()[x..];
        [
            slope(nearness, x, width, |x| along_x[x]),
            slope(nearness, y, height, |y| along_y[y * width]),
        ]
    }

    fn plane_with(&self, x: usize, y: usize, nearness: f32, [dx, dy]: [f32; 2]) -> Plane {
        // dx u + dy v - n + e = 0 in the camera's texel space, pulled back to the world.
        let e = nearness - (dx * (x as f32 + 0.5) + dy * (y as f32 + 0.5));
        let [u, v, n, q] = self.view().rows();
        Plane(core::array::from_fn(|i| ((dx * u[i] + dy * v[i]) - n[i]) + e * q[i]))
    }
}

/// The slope of nearness at place `i` of a row or column of `len` values. Of the differences to
/// either side the one that the next value goes on with lies on the pixel's own surface, if that is
/// three pixels wide there; on a narrower one the smaller difference is likelier to.
#[inline(always)]
fn slope(nearness: f32, i: usize, len: usize, at: impl Fn(usize) -> f32) -> f32 {
    let side = |next: Option<usize>, after: Option<usize>| {
        let next = next.filter(|&i| i < len).map_or(f32::NAN, &at);
        let after = after.filter(|&i| i < len).map_or(next, &at);
        let (step, bend) = (next - nearness, (nearness - next) - (next - after));
        (step, bend.abs() + step.abs() * STEEP)
    };
    let (before, doubt_before) = side(i.checked_sub(1), i.checked_sub(2));
    let (after, doubt_after) = side(Some(i + 1), Some(i + 2));
    // Written so that a side that is not there, NaN, is not taken.
    if doubt_before < doubt_after || doubt_after.is_nan() {
        if before.is_finite() { -before } else { 0.0 }
    } else {
        after
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DepthMap, Surfaces, View};

    const SIDE: u32 = 40;

    /// A roof of two slopes that meets above x = 0, seen from above.
    fn roof(view: &View) -> [f32; (SIDE * SIDE) as usize] {
        core::array::from_fn(|i| {
            let (u, v) = ((i as u32 % SIDE) as f32 + 0.5, (i as u32 / SIDE) as f32 + 0.5);
            let ray = view.world_from_texel(u, v, 1.0) - Vec3::Y * 4.0;
            // 4 + ray.y t = -0.5 |ray.x t|
            let t = -4.0 / (ray.y + 0.5 * ray.x.abs());
            1.0 / t
        })
    }

    #[test]
    fn a_roof_has_two_normals() {
        let view = View::perspective(Vec3::Y * 4.0, Vec3::ZERO, Vec3::NEG_Z, 1.0, SIDE, SIDE, 0.1);
        let nearness = roof(&view);
        let map = DepthMap::new(SIDE, SIDE, &nearness, &[]).unwrap();
        let camera = Camera::new(&view, map, Surfaces::FromDepth).unwrap();
        let mut normals = [Vec3::ZERO; (SIDE * SIDE) as usize];
        camera.normals_from_depth(Threads::One, &mut normals);
        for (i, normal) in normals.iter().enumerate() {
            let right = i as u32 % SIDE >= SIDE / 2;
            let expected = Vec3::new(if right { 0.5 } else { -0.5 }, 1.0, 0.0).normalize();
            assert!(normal.dot(expected).abs() > 0.999, "{i}: {normal}");
        }
        let tile = |x: usize, y: usize| normals[y * SIDE as usize + x];
        assert_eq!(tile(1, 1), tile(14, 14), "one normal within a tile");
    }

    #[test]
    fn any_number_is_survived() {
        let view = View::perspective(Vec3::Y * 4.0, Vec3::ZERO, Vec3::NEG_Z, 1.0, 5, 3, 0.1);
        let odd = [0.0, f32::NAN, f32::INFINITY, -1.0, f32::MAX, 1e-45, 0.25];
        let nearness: [f32; 15] = core::array::from_fn(|i| odd[i % odd.len()]);
        let map = DepthMap::new(5, 3, &nearness, &[]).unwrap();
        let camera = Camera::new(&view, map, Surfaces::FromDepth).unwrap();
        let mut normals = [Vec3::NAN; 15];
        camera.normals_from_depth(Threads::One, &mut normals);
        assert!(normals.iter().all(|normal| normal.is_finite()));
    }
}
