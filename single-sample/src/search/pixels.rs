//! What the camera sees in one tile of the image.

use glam::Vec3;
use shadowmap_core::{Camera, Surface, Surfaces};

use super::adaptive::{COUNT, Grid, TILE};
use super::kernels::{Ops, Work};
use super::soa::Lane;
use super::surfaces::{Distinct, Memo, each_run};

/// A value per pixel and arbitrary ones after them, so that runs of pixels can be set a whole row
/// at a time.
type Padded<T> = [T; COUNT + TILE];

/// What the camera sees in a tile.
pub(crate) struct Pixels {
    pub nearness: Lane,
    /// The planes; of those through the pixels' points only the normals if `planes_are_normals`.
    pub planes: [Padded<f32>; 4],
    pub planes_are_normals: bool,
    ids: Padded<u32>,
    /// The surfaces, unless there is only one.
    pub surfaces: Distinct,
}

impl Pixels {
    pub const fn new() -> Pixels {
        Pixels {
            nearness: [0.0; COUNT],
            planes: [[0.0; COUNT + TILE]; 4],
            planes_are_normals: true,
            ids: [0; COUNT + TILE],
            surfaces: Distinct::new(),
        }
    }

    /// The objects' IDs.
    pub fn ids(&self) -> &[u32; COUNT] {
        self.ids.first_chunk().expect("no fewer than the pixels of a tile")
    }

    #[inline(always)]
    fn set_normal(&mut self, i: usize, id: u32, normal: Vec3) {
        self.set_plane(i, id, [normal.x, normal.y, normal.z, 0.0]);
    }

    #[inline(always)]
    fn set_plane(&mut self, i: usize, id: u32, plane: [f32; 4]) {
        self.ids[i] = id;
        for (lane, value) in self.planes.iter_mut().zip(plane) {
            lane[i] = value;
        }
    }

    /// Sets the surfaces of pixels by their indices in a table.
    #[inline(always)]
    fn set_indexed(&mut self, table: &[Surface], indices: &[u32; COUNT]) {
        let Pixels { planes: [a, b, c, _], ids, surfaces, .. } = self;
        surfaces.clear();
        let mut memo = Memo::new();
        each_run(
            |i| indices[i] != indices[i - 1],
            |run| {
                let index = indices[run.start];
                let surface = table.get(index as usize).unwrap_or(&Surface::UNKNOWN);
                let Surface { normal, id } = *surface;
                let number = memo.number(index, || surfaces.number(id, normal));
                surfaces.add(&run, number);
                for start in run.step_by(TILE) {
                    ids[start..][..TILE].copy_from_slice(&[id; TILE]);
                    a[start..][..TILE].copy_from_slice(&[normal.x; TILE]);
                    b[start..][..TILE].copy_from_slice(&[normal.y; TILE]);
                    c[start..][..TILE].copy_from_slice(&[normal.z; TILE]);
                }
            },
        );
    }

    /// Tells the surfaces apart whose IDs and normals are set.
    #[inline(always)]
    fn find_surfaces(&mut self) {
        let Pixels { planes: [a, b, c, _], ids, surfaces, .. } = self;
        surfaces.clear();
        let differs = |i: usize| {
            (a[i] != a[i - 1]) | (b[i] != b[i - 1]) | (c[i] != c[i - 1]) | (ids[i] != ids[i - 1])
        };
        each_run(differs, |run| {
            let i = run.start;
            let number = surfaces.number(ids[i], Vec3::new(a[i], b[i], c[i]));
            surfaces.add(&run, number);
        });
    }
}

/// Reads what the camera sees in a tile. Pixels beyond the image see nothing.
pub(crate) struct ReadPixels<'a> {
    pub camera: &'a Camera<'a>,
    /// The first pixel.
    pub pixel: [u32; 2],
    pub grid: &'a Grid,
    /// The object of all pixels if they show one plane: their planes are of no interest.
    pub id: Option<u32>,
    pub pixels: &'a mut Pixels,
    /// Counts the pixels that see something.
    pub seen: &'a mut u32,
}

impl Work for ReadPixels<'_> {
    #[inline(always)]
    fn run(mut self, _: &impl Ops) {
        self.set_nearness();
        if let Some(id) = self.id {
            self.pixels.ids.fill(id);
            return;
        }
        let surfaces = self.camera.surfaces();
        self.pixels.planes_are_normals = !matches!(surfaces, Surfaces::FromDepth);
        match surfaces {
            Surfaces::Table(table) => {
                let indices = self.read(self.camera.map().ids());
                self.pixels.set_indexed(table, &indices);
            }
            Surfaces::Normals(normals) => self.set_normals(normals),
            Surfaces::FromDepth => self.set_planes(),
        }
    }
}

impl ReadPixels<'_> {
    #[inline(always)]
    fn set_nearness(&mut self) {
        let nearness = self.read(self.camera.map().nearness());
        let mut seen = 0;
        for (pixel, nearness) in self.pixels.nearness.iter_mut().zip(nearness) {
            // False for NaN.
            let is_seen = nearness > 0.0;
            *pixel = if is_seen { nearness } else { 0.0 };
            seen += u32::from(is_seen);
        }
        *self.seen += seen;
    }

    #[inline(always)]
    fn set_normals(&mut self, normals: &[Vec3]) {
        let ids = self.read(self.camera.map().ids());
        let normals = self.read(normals);
        for i in 0..COUNT {
            self.pixels.set_normal(i, ids[i], normals[i]);
        }
        self.pixels.find_surfaces();
    }

    #[inline(always)]
    fn set_planes(&mut self) {
        let [left, top] = self.pixel;
        for i in 0..COUNT {
            let (x, y, nearness) = (i % TILE, i / TILE, self.pixels.nearness[i]);
            let (id, plane) = if nearness > 0.0 {
                let (id, plane) = self.camera.plane(left + x as u32, top + y as u32, nearness);
                (id, plane.0)
            } else {
                (0, [0.0; 4])
            };
            self.pixels.set_plane(i, id, plane);
        }
        self.pixels.find_surfaces();
    }

    /// The tile's part of an image; the default for pixels beyond it.
    #[inline(always)]
    fn read<T: Copy + Default>(&self, image: &[T]) -> [T; COUNT] {
        let Grid { width, height, .. } = *self.grid;
        let [left, top] = self.pixel.map(|at| at as usize);
        let stride = self.camera.map().width() as usize;
        let mut tile = [T::default(); COUNT];
        for row in 0..height {
            let Some(image) = image.get((top + row) * stride + left..) else { break };
            let to = &mut tile[row * TILE..][..TILE];
            if let (TILE, Some(image)) = (width, image.first_chunk::<TILE>()) {
                to.copy_from_slice(image);
            } else {
                let width = width.min(image.len());
                to[..width].copy_from_slice(&image[..width]);
            }
        }
        tile
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use shadowmap_core::{DepthMap, Level, View};

    use super::super::kernels;
    use super::*;

    #[test]
    fn a_tile_does_not_depend_on_the_one_before() {
        const WIDTH: u32 = 2 * TILE as u32;
        let view = View::perspective(Vec3::Y * 4.0, Vec3::ZERO, Vec3::Z, 1.0, WIDTH, 3, 0.1);
        // The second tile sees something in every third pixel only.
        let is_seen = |i: u32| i % WIDTH < TILE as u32 || i.is_multiple_of(3);
        let nearness: Vec<f32> =
            (0..WIDTH * 3).map(|i| if is_seen(i) { 0.25 + 0.01 * i as f32 } else { 0.0 }).collect();
        let ids: Vec<u32> = (0..WIDTH * 3).collect();
        let map = DepthMap::new(WIDTH, 3, &nearness, &ids).unwrap();
        let normals = [Vec3::Y; WIDTH as usize * 3];
        let table = [Surface { normal: Vec3::Y, id: 7 }; 40];
        for surfaces in [Surfaces::FromDepth, Surfaces::Normals(&normals), Surfaces::Table(&table)]
        {
            let camera = Camera::new(&view, map, surfaces).unwrap();
            let grid = Grid { width: TILE, height: 3, group: 8, tolerance: 0.0 };
            let read = |pixels: &mut Pixels, tile: u32| {
                let (camera, pixel) = (&camera, [tile * TILE as u32, 0]);
                let work =
                    ReadPixels { camera, pixel, grid: &grid, id: None, pixels, seen: &mut 0 };
                kernels::run(Level::SCALAR, work);
            };
            let (mut first, mut second) = (Pixels::new(), Pixels::new());
            read(&mut first, 1);
            read(&mut second, 0);
            read(&mut second, 1);
            assert_eq!(first.ids(), second.ids(), "{surfaces:?}");
            assert!(first.surfaces.iter().eq(second.surfaces.iter()), "{surfaces:?}");
        }
    }
}
