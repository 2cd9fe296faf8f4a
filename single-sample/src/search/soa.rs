//! The receivers of one tile, as structures of arrays.

use super::adaptive::{COUNT, TILE};
use super::geometry::Geometry;
use super::groups::Groups;
use super::kernels::{Ops, Work};
use super::receiver::{Receiver, plane, receiver};

/// A value per pixel.
pub(crate) type Lane = [f32; COUNT];

/// Every field of [`Receiver`], pixel by pixel.
pub(crate) struct Receivers {
    pub u: Lane,
    pub v: Lane,
    pub nearness: Lane,
    pub hu: Lane,
    pub hv: Lane,
    pub hn: Lane,
    pub above: Lane,
    pub sky: Lane,
}

impl Receivers {
    pub const fn new() -> Receivers {
        let zero = [0.0; COUNT];
        Receivers {
            u: zero,
            v: zero,
            nearness: zero,
            hu: zero,
            hv: zero,
            hn: zero,
            above: zero,
            sky: zero,
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, r: &Receiver) {
        self.u[i] = r.u;
        self.v[i] = r.v;
        self.nearness[i] = r.nearness;
        self.hu[i] = r.hu;
        self.hv[i] = r.hv;
        self.hn[i] = r.hn;
        self.above[i] = r.above;
        self.sky[i] = r.sky;
    }

    #[inline(always)]
    pub fn get(&self, i: usize) -> Receiver {
        Receiver {
            u: self.u[i],
            v: self.v[i],
            nearness: self.nearness[i],
            hu: self.hu[i],
            hv: self.hv[i],
            hn: self.hn[i],
            above: self.above[i],
            sky: self.sky[i],
        }
    }
}

/// What the camera sees in a tile.
pub(crate) struct Pixels {
    pub nearness: Lane,
    /// The planes, or their normals if `planes_are_normals`.
    pub planes: [Lane; 4],
    pub planes_are_normals: bool,
    pub ids: [u32; COUNT],
}

impl Pixels {
    pub const fn new() -> Pixels {
        let zero = [0.0; COUNT];
        Pixels { nearness: zero, planes: [zero; 4], planes_are_normals: true, ids: [0; COUNT] }
    }

    /// Sets the object and the plane, or normal, of a pixel.
    #[inline(always)]
    pub fn set_plane(&mut self, i: usize, id: u32, plane: [f32; 4]) {
        self.ids[i] = id;
        for (lane, value) in self.planes.iter_mut().zip(plane) {
            lane[i] = value;
        }
    }
}

/// Sets the receivers of a tile's pixels, the first of which has its centre at `first`, and their
/// groups.
pub(crate) struct SetReceivers<'a> {
    pub geometry: &'a Geometry,
    pub first: [f32; 2],
    pub pixels: &'a Pixels,
    pub receivers: &'a mut Receivers,
    pub groups: &'a mut Groups,
    /// The number of pixels if they all show one plane and see all of the light.
    pub one_plane: Option<usize>,
}

impl Work for SetReceivers<'_> {
    #[inline(always)]
    fn run(self, _: &impl Ops) {
        let SetReceivers { geometry: g, first: [left, top], pixels, receivers, .. } = self;
        let [a, b, c, d] = &pixels.planes;
        for i in 0..COUNT {
            let (x, y) = (left + (i % TILE) as f32, top + (i / TILE) as f32);
            let n = pixels.nearness[i];
            let through = plane(g, x, y, n, [a[i], b[i], c[i]]);
            let d = if pixels.planes_are_normals { through[3] } else { d[i] };
            receivers.set(i, &receiver(g, x, y, n, [a[i], b[i], c[i], d]));
        }
        match self.one_plane {
            Some(count) => self.groups.set_one(count),
            None => self.groups.set(pixels, receivers),
        }
    }
}
