//! The receivers of one tile, as structures of arrays.

use super::adaptive::TILE;
use super::geometry::Geometry;
use super::receiver::{Receiver, receiver};

const COUNT: usize = TILE * TILE;

/// Every field of [`Receiver`], pixel by pixel.
pub(crate) struct Receivers {
    pub u: [f32; COUNT],
    pub v: [f32; COUNT],
    pub nearness: [f32; COUNT],
    pub hu: [f32; COUNT],
    pub hv: [f32; COUNT],
    pub hn: [f32; COUNT],
    pub above: [f32; COUNT],
    pub sky: [f32; COUNT],
    qxx: [f32; COUNT],
    qxy: [f32; COUNT],
    qyy: [f32; COUNT],
    area: [f32; COUNT],
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
            qxx: zero,
            qxy: zero,
            qyy: zero,
            area: zero,
        }
    }

    /// Sets row `row`, whose first pixel's centre is (x, y), from nearness and planes.
    #[inline(always)]
    pub fn set_row(
        &mut self,
        g: &Geometry,
        row: usize,
        [x, y]: [f32; 2],
        nearness: &[f32; TILE],
        planes: &[[f32; TILE]; 4],
    ) {
        let start = row * TILE;
        for i in 0..TILE {
            let plane = [planes[0][i], planes[1][i], planes[2][i], planes[3][i]];
            let r = receiver(g, x + i as f32, y, nearness[i], plane);
            let k = start + i;
            self.u[k] = r.u;
            self.v[k] = r.v;
            self.nearness[k] = r.nearness;
            self.hu[k] = r.hu;
            self.hv[k] = r.hv;
            self.hn[k] = r.hn;
            self.above[k] = r.above;
            self.sky[k] = r.sky;
            self.qxx[k] = r.qxx;
            self.qxy[k] = r.qxy;
            self.qyy[k] = r.qyy;
            self.area[k] = r.area;
        }
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
            qxx: self.qxx[i],
            qxy: self.qxy[i],
            qyy: self.qyy[i],
            area: self.area[i],
        }
    }
}
