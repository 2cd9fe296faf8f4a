//! The receivers of one tile, as structures of arrays.

use super::adaptive::{COUNT, TILE};
use super::geometry::Geometry;
use super::groups::Groups;
use super::kernels::{Ops, Work};
use super::pixels::Pixels;
use super::receiver::{Horizon, Receiver, plane, receiver_and_horizon};

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

/// A tile that shows one plane.
#[derive(Clone, Copy)]
pub(crate) struct OnePlane {
    /// How many pixels show it; all of them see all of the light.
    pub pixels: usize,
    pub normal: [f32; 3],
}

/// Sets the receivers of a tile's pixels, the first of which has its centre at `first`, and their
/// groups.
pub(crate) struct SetReceivers<'a> {
    pub geometry: &'a Geometry,
    pub first: [f32; 2],
    pub pixels: &'a Pixels,
    pub receivers: &'a mut Receivers,
    pub groups: &'a mut Groups,
    /// Then nothing is asked of the pixels but their nearness.
    pub one_plane: Option<OnePlane>,
}

impl Work for SetReceivers<'_> {
    #[inline(always)]
    fn run(mut self, _: &impl Ops) {
        if let Some(OnePlane { pixels, normal }) = self.one_plane {
            self.set_on_plane(normal);
            self.groups.set_one(pixels);
        } else {
            for row in 0..TILE {
                self.set_row(row);
            }
            self.groups.set(&self.pixels.surfaces, self.receivers);
        }
    }
}

impl SetReceivers<'_> {
    /// Sets receivers that all have this normal and see all of the light.
    #[inline(always)]
    fn set_on_plane(&mut self, normal: [f32; 3]) {
        for i in 0..COUNT {
            let (x, y, n) = self.point(i);
            let plane = plane(self.geometry, x, y, n, normal);
            let (receiver, _) = receiver_and_horizon(self.geometry, x, y, n, plane);
            self.receivers.set(i, &receiver);
        }
    }

    /// Sets the receivers in a row. Few rows have any whose horizon cuts the disc.
    #[inline(always)]
    fn set_row(&mut self, row: usize) {
        let mut may_cut = [false; TILE];
        for lane in 0..TILE {
            let (receiver, horizon) = self.receiver_and_horizon(row * TILE + lane);
            self.receivers.set(row * TILE + lane, &receiver);
            may_cut[lane] = horizon.may_cut(self.geometry);
        }
        if may_cut.contains(&true) {
            for lane in 0..TILE {
                let (_, horizon) = self.receiver_and_horizon(row * TILE + lane);
                self.receivers.sky[row * TILE + lane] = horizon.sky(self.geometry);
            }
        }
    }

    #[inline(always)]
    fn receiver_and_horizon(&self, i: usize) -> (Receiver, Horizon) {
        let (x, y, n) = self.point(i);
        let [a, b, c, d] = &self.pixels.planes;
        let through = plane(self.geometry, x, y, n, [a[i], b[i], c[i]]);
        let d = if self.pixels.planes_are_normals { through[3] } else { d[i] };
        receiver_and_horizon(self.geometry, x, y, n, [a[i], b[i], c[i], d])
    }

    /// The camera's point that a pixel shows.
    #[inline(always)]
    fn point(&self, i: usize) -> (f32, f32, f32) {
        let [left, top] = self.first;
        (left + (i % TILE) as f32, top + (i / TILE) as f32, self.pixels.nearness[i])
    }
}
