//! The planes of sixteen receivers, and which part of a light is above them.

use glam::Vec3;
use shadowmap_core::{Camera, Surfaces};

use super::{SkinShadow, Surface};
use crate::lanes::{INDEX, Ids, LANES, Lanes, Ops, lanes};

/// The planes of sixteen pixels side by side, each through its pixel's receiver.
pub(super) struct Planes {
    rows: [Lanes; 4],
    position: [Lanes; 3],
}

impl Planes {
    /// Those of the camera's pixels from (`x`, `y`) on, of which `receivers` are any.
    #[inline(always)]
    pub fn new(
        camera: &Camera<'_>,
        [x, y]: [usize; 2],
        nearness: &Lanes,
        ids: &Ids,
        receivers: u32,
    ) -> Planes {
        let (u, v) = (lanes(|i| x as f32 + (INDEX[i] + 0.5)), y as f32 + 0.5);
        let row = |r: &[f32; 4]| lanes(|i| ((r[0] * u[i] + r[1] * v) + r[2] * nearness[i]) + r[3]);
        let [px, py, pz, w] = camera.view().inverse_rows();
        let w = row(w);
        let over_w = |of: Lanes| lanes(|i| of[i] / w[i]);
        let position = [over_w(row(px)), over_w(row(py)), over_w(row(pz))];
        let first = y * camera.map().width() as usize + x;
        let mut rows = [[0.0; LANES]; 4];
        for i in 0..LANES {
            let normal = match camera.surfaces() {
                Surfaces::Table(table) => table.get(ids[i] as usize).map(|surface| surface.normal),
                Surfaces::Normals(normals) => normals.get(first + i).copied(),
                Surfaces::FromDepth if receivers >> i & 1 != 0 => {
                    let plane = camera.plane((x + i) as u32, y as u32, nearness[i]).1;
                    [rows[0][i], rows[1][i], rows[2][i], rows[3][i]] = plane.0;
                    continue;
                }
                Surfaces::FromDepth => None,
            };
            [rows[0][i], rows[1][i], rows[2][i]] = normal.unwrap_or(Vec3::ZERO).to_array();
        }
        if !matches!(camera.surfaces(), Surfaces::FromDepth) {
            let ([nx, ny, nz, _], [px, py, pz]) = (&rows, &position);
            rows[3] = lanes(|i| -((nx[i] * px[i] + ny[i] * py[i]) + nz[i] * pz[i]));
        }
        Planes { rows, position }
    }

    /// Where one of the receivers is.
    #[inline(always)]
    pub fn position(&self, i: usize) -> Vec3 {
        Vec3::from_array(self.position.each_ref().map(|p| p[i]))
    }

    /// Each plane's product with a homogeneous vector.
    #[inline(always)]
    fn times(&self, [x, y, z, w]: [f32; 4]) -> Lanes {
        let [a, b, c, d] = &self.rows;
        lanes(|i| ((a[i] * x + b[i] * y) + c[i] * z) + d[i] * w)
    }
}

/// A [`Surface`] of each of sixteen receivers.
#[derive(Clone, Copy)]
pub(super) struct SurfaceLanes {
    /// The slopes of the planes along and down the first sample's map.
    pub along: Lanes,
    pub down: Lanes,
    /// The parameters between which the light is above each plane.
    pub above: [Lanes; 2],
    /// The receivers above whose planes all of the light is, and those with nothing of it.
    pub open: u32,
    pub hidden: u32,
}

impl SurfaceLanes {
    /// Those of one surface for all.
    #[inline(always)]
    pub fn splat(surface: &Surface) -> SurfaceLanes {
        let all = |is: bool| if is { 0xffff } else { 0 };
        let above = surface.above.unwrap_or([0.0; 2]);
        SurfaceLanes {
            along: [surface.slope.x; LANES],
            down: [surface.slope.y; LANES],
            above: above.map(|t| [t; LANES]),
            open: all(above == [0.0, 1.0]),
            hidden: all(surface.above.is_none()),
        }
    }

    /// [`SkinShadow::surface`] of planes whose side towards `eye` is looked at.
    #[inline(always)]
    pub fn new(
        ops: impl Ops,
        planes: &Planes,
        eye: [f32; 4],
        shadow: &SkinShadow<'_>,
    ) -> SurfaceLanes {
        let (views, zero, one) = (shadow.views(), [0.0; LANES], [1.0; LANES]);
        let side = planes.times(eye);
        let end = |eye: [f32; 4]| {
            let end = planes.times(eye);
            lanes(|i| end[i] * side[i])
        };
        let [first, last] = [end(views[0].eye()), end(views[views.len() - 1].eye())];
        let crossing = lanes(|i| first[i] / (first[i] - last[i]));
        let below = [ops.greater(&zero, &first), ops.greater(&zero, &last)];
        let above = [ops.select(below[0], &crossing, &zero), ops.select(below[1], &crossing, &one)];
        let [x, y, z, w] = views[0].inverse_rows();
        let pull = |k: usize| planes.times([x[k], y[k], z[k], w[k]]);
        let [a, b, c] = [pull(0), pull(1), pull(2)];
        let (along, down) = (lanes(|i| -a[i] / c[i]), lanes(|i| -b[i] / c[i]));
        let most = [f32::INFINITY; LANES];
        let finite = ops.greater(&most, &lanes(|i| along[i].abs()))
            & ops.greater(&most, &lanes(|i| down[i].abs()));
        SurfaceLanes {
            along: ops.select(finite, &along, &zero),
            down: ops.select(finite, &down, &zero),
            above,
            open: !(ops.greater(&above[0], &zero) | ops.greater(&one, &above[1])) & 0xffff,
            hidden: below[0] & below[1],
        }
    }
}
