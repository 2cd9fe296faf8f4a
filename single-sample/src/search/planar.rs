//! Tiles of the image that show one plane and nothing else: most of them.

use shadowmap_core::{Camera, Surface, Surfaces};

use super::adaptive::{Grid, TILE};
use super::geometry::Geometry;
use super::kernels::{Ops, Work};
use super::reach::Extent;
use super::receiver::{Place, Receiver, plane, receiver};

/// How much nearness may differ from the plane, relatively.
const FLAT: f32 = 1.0 / 131072.0;

/// What a tile shows.
pub(crate) enum Shown {
    Nothing,
    /// One plane and nothing else.
    Plane(Planar),
    Other,
}

/// What is known of a planar tile.
pub(crate) struct Planar {
    pub surface: Surface,
    /// The receiver of its first pixel.
    pub first: Receiver,
    pub extent: Extent,
}

/// Looks whether a tile shows nothing, or one plane by its surface and the nearness of all pixels.
pub(crate) struct FindPlanar<'a> {
    pub camera: &'a Camera<'a>,
    pub geometry: &'a Geometry,
    /// The first pixel.
    pub pixel: [u32; 2],
    pub grid: &'a Grid,
    pub found: &'a mut Shown,
}

impl Work for FindPlanar<'_> {
    #[inline(always)]
    fn run(self, _: &impl Ops) {
        *self.found = match self.plane() {
            Some(planar) => Shown::Plane(planar),
            None if self.is_empty() => Shown::Nothing,
            None => Shown::Other,
        };
    }
}

impl FindPlanar<'_> {
    /// Whether the camera sees nothing in all of the tile.
    #[inline(always)]
    fn is_empty(&self) -> bool {
        let Grid { width, height, .. } = *self.grid;
        let [left, top] = self.pixel.map(|at| at as usize);
        let map = self.camera.map();
        (top..top + height).all(|y| {
            let row = &map.nearness()[y * map.width() as usize + left..][..width];
            // False for NaN.
            !row.iter().fold(false, |any, &nearness| any | (nearness > 0.0))
        })
    }

    #[inline(always)]
    fn plane(&self) -> Option<Planar> {
        let Grid { width, height, .. } = *self.grid;
        let [left, top] = self.pixel;
        let map = self.camera.map();
        let image = map.width() as usize;
        let start = top as usize * image + left as usize;
        let nearness = |x: usize, y: usize| map.nearness()[start + y * image + x];
        // False for NaN.
        let sees_something = nearness(0, 0) > 0.0;
        if width < TILE || !sees_something {
            return None;
        }
        let surface = self.surface(start, height)?;

        // Nearness is affine in the image on a plane.
        let first = nearness(0, 0);
        let (last_x, last_y) = (width - 1, height - 1);
        let dx = (nearness(last_x, 0) - first) / last_x as f32;
        let dy = if height > 1 { (nearness(0, last_y) - first) / last_y as f32 } else { 0.0 };
        let mut is_flat = [true; TILE];
        for y in 0..height {
            let row: &[f32; TILE] = map.nearness()[start + y * image..].first_chunk()?;
            for x in 0..TILE {
                let n = row[x];
                let off = n - (first + (dx * x as f32 + dy * y as f32));
                is_flat[x] &= (n > 0.0) & (off.abs() <= FLAT * n);
            }
        }
        if is_flat.contains(&false) {
            return None;
        }
        let point = |x: usize, y: usize| {
            let (px, py) = ((left as usize + x) as f32 + 0.5, (top as usize + y) as f32 + 0.5);
            (px, py, nearness(x, y))
        };
        let mut extent = Extent::EMPTY;
        for corner in [[0, 0], [last_x, 0], [0, last_y], [last_x, last_y]] {
            let (x, y, n) = point(corner[0], corner[1]);
            let Place { u, v, nearness, is_somewhere } = Place::of(self.geometry, x, y, n);
            if !is_somewhere {
                return None;
            }
            extent.add(u, v, nearness);
        }
        let (x, y, n) = point(0, 0);
        let plane = plane(self.geometry, x, y, n, surface.normal.to_array());
        let first = receiver(self.geometry, x, y, n, plane);
        Some(Planar { surface, first, extent })
    }

    /// The surface of all pixels of the tile.
    #[inline(always)]
    fn surface(&self, start: usize, height: usize) -> Option<Surface> {
        let map = self.camera.map();
        let id = map.ids().get(start).copied();
        if id.is_some_and(|id| !self.all_rows(map.ids(), start, height, id)) {
            return None;
        }
        match self.camera.surfaces() {
            Surfaces::Table(table) => Some(*table.get(id? as usize).unwrap_or(&Surface::UNKNOWN)),
            Surfaces::Normals(normals) => {
                let normal = normals[start];
                let is_same = self.all_rows(normals, start, height, normal);
                is_same.then_some(Surface { normal, id: id.unwrap_or(0) })
            }
            Surfaces::FromDepth => None,
        }
    }

    /// Whether a value is that of all pixels of the tile.
    #[inline(always)]
    fn all_rows<T: Copy + PartialEq>(
        &self,
        values: &[T],
        start: usize,
        height: usize,
        value: T,
    ) -> bool {
        let image = self.camera.map().width() as usize;
        let mut is_same = [true; TILE];
        for y in 0..height {
            let row = &values[start + y * image..][..TILE];
            for x in 0..TILE {
                is_same[x] &= row[x] == value;
            }
        }
        !is_same.contains(&false)
    }
}
