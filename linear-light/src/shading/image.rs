//! Shading of all that a camera sees.

use shadowmap_core::{BandSlice, Camera, Surfaces, Threads, Warp, for_each_band};

use super::planes::{Planes, SurfaceLanes};
use super::sixteen::Sixteen;
use super::{Receiver, Samples, SkinShadow};
use crate::counters::Tally;
use crate::kernels::{Job, run};
use crate::lanes::{Ids, LANES, Lanes, Ops, put, take};
use crate::views::choose;
use crate::{Counters, MAX_FRUSTA};

/// Writes the visibility of a light from every pixel of the camera, row-major. `frusta` are those
/// of one light, at most [`MAX_FRUSTA`]. Pixels that see nothing get 0, and so do surfaces that
/// turn away from the whole light.
///
/// The instructions are those that the channels of the first frustum were drawn with. Every level
/// and every number of threads gives the same bits.
///
/// # Panics
///
/// If there is no frustum or more than [`MAX_FRUSTA`], or `out` has another length than the camera
/// has pixels.
pub fn visibility(
    camera: &Camera<'_>,
    frusta: &[SkinShadow<'_>],
    threads: Threads,
    out: &mut [f32],
) -> Counters {
    assert!((1..=MAX_FRUSTA).contains(&frusta.len()), "a light has from 1 to {MAX_FRUSTA} frusta");
    assert_eq!(out.len(), camera.map().nearness().len(), "one visibility per pixel");
    let width = camera.map().width() as usize;
    let mut warps = [Warp::new(camera.view(), &frusta[0].views()[0]); MAX_FRUSTA];
    for (warp, shadow) in warps.iter_mut().zip(frusta) {
        *warp = Warp::new(camera.view(), &shadow.views()[0]);
    }
    let (image, level) = (Image { camera, frusta, warps }, frusta[0].channels.level);
    let tally = Tally::default();
    for_each_band(threads, BandSlice { data: out, len: width.max(1) }, &|y, row| {
        let mut counters = Counters::default();
        run(level, Job::Shade { image: &image, y, out: row.data, counters: &mut counters });
        tally.add(&counters);
    });
    tally.total()
}

/// What a camera sees under one light.
pub(crate) struct Image<'a> {
    camera: &'a Camera<'a>,
    frusta: &'a [SkinShadow<'a>],
    /// From the camera to the first sample of each frustum.
    warps: [Warp; MAX_FRUSTA],
}

/// Sixteen pixels side by side.
struct Pixels {
    x: usize,
    y: usize,
    nearness: Lanes,
    ids: Ids,
    /// Those where the camera sees something.
    receivers: u32,
}

/// What neighbouring blocks share that lie on one triangle.
struct Triangle {
    id: u32,
    surfaces: SurfaceLanes,
}

impl Image<'_> {
    /// Shades row `y`.
    #[inline(always)]
    pub(crate) fn shade_row(
        &self,
        ops: impl Ops,
        y: usize,
        out: &mut [f32],
        counters: &mut Counters,
    ) {
        let map = self.camera.map();
        let start = y * map.width() as usize;
        let ids = map.ids().get(start..).unwrap_or_default();
        let mut triangle = None;
        for (block, out) in out.chunks_mut(LANES).enumerate() {
            let x = block * LANES;
            let nearness = take(&map.nearness()[start + x..][..out.len()]);
            let ids = ids.get(x..x + out.len()).map_or([0; LANES], take);
            // Not where the camera sees nothing, nor at a NaN.
            let receivers = ops.greater(&nearness, &[0.0; LANES]);
            let pixels = Pixels { x, y, nearness, ids, receivers };
            counters.receivers += receivers.count_ones();
            let seen = if receivers == 0 {
                [0.0; LANES]
            } else {
                self.shade(ops, &pixels, &mut triangle, counters)
            };
            put(out, &seen);
        }
    }

    /// The visibility of sixteen pixels. `triangle` is what the last ones lay on, if on one.
    #[inline(always)]
    fn shade(
        &self,
        ops: impl Ops,
        pixels: &Pixels,
        triangle: &mut Option<Triangle>,
        counters: &mut Counters,
    ) -> Lanes {
        let Pixels { x, y, nearness, ids, receivers } = pixels;
        let (camera, eye) = (self.camera, self.camera.view().eye());
        // Entries of a table are flat: pixels with the same one share a plane.
        let is_flat = matches!(camera.surfaces(), Surfaces::Table(_)) && self.frusta.len() == 1;
        if is_flat && *receivers == 0xffff && ops.equal(ids, ids[0]) == 0xffff {
            let is_last = triangle.as_ref().is_some_and(|triangle| triangle.id == ids[0]);
            if !is_last {
                let plane = camera.plane(*x as u32, *y as u32, nearness[0]).1;
                let surface = self.frusta[0].surface(plane, plane.side_of(eye));
                *triangle = Some(Triangle { id: ids[0], surfaces: SurfaceLanes::splat(&surface) });
            }
            if let Some(triangle) = triangle {
                return self.seen(ops, pixels, 0, *receivers, &triangle.surfaces, counters);
            }
        }
        let planes = Planes::new(camera, [*x, *y], nearness, ids, *receivers);
        let mut visibility = [0.0; LANES];
        let shares = self.shares(pixels, &planes);
        for (frustum, (shadow, share)) in self.frusta.iter().zip(shares).enumerate() {
            if share != 0 {
                let surfaces = SurfaceLanes::new(ops, &planes, eye, shadow);
                let seen = self.seen(ops, pixels, frustum, share, &surfaces, counters);
                visibility = ops.select(share, &seen, &visibility);
            }
        }
        visibility
    }

    /// The receivers that belong to each frustum.
    #[inline(always)]
    fn shares(&self, pixels: &Pixels, planes: &Planes) -> [u32; MAX_FRUSTA] {
        let mut shares = [0; MAX_FRUSTA];
        if self.frusta.len() == 1 {
            shares[0] = pixels.receivers;
            return shares;
        }
        for i in (0..LANES).filter(|i| pixels.receivers >> i & 1 != 0) {
            let position = planes.position(i);
            shares[choose(self.frusta.iter().map(|shadow| shadow.rank(position)))] |= 1 << i;
        }
        shares
    }

    /// What the receivers `of` see of the light in the maps of a frustum. Other lanes hold
    /// anything.
    #[inline(always)]
    fn seen(
        &self,
        ops: impl Ops,
        pixels: &Pixels,
        frustum: usize,
        of: u32,
        surfaces: &SurfaceLanes,
        counters: &mut Counters,
    ) -> Lanes {
        let (shadow, zero) = (&self.frusta[frustum], [0.0; LANES]);
        let facing = of & !surfaces.hidden;
        if facing == 0 {
            return zero;
        }
        let map = &shadow.maps[0];
        let views = match shadow.samples {
            Samples::Rectified(views) if !map.nearness().is_empty() => views,
            _ => return self.one_by_one(pixels, frustum, facing, counters),
        };
        let (at, size) = ([pixels.x, pixels.y], [map.width(), map.height()]);
        let (warp, nearness) = (&self.warps[frustum], &pixels.nearness);
        let sixteen = Sixteen::new(ops, warp, at, nearness, surfaces, size, shadow.bias);
        let tests = sixteen.test(ops, views.disparity(), shadow.maps);
        counters.outside += (tests.outside & facing).count_ones();
        // Most receivers are seen by all samples, or by none.
        let whole = tests.all & surfaces.open;
        let mut seen = ops.select(whole, &[1.0; LANES], &zero);
        let partly = tests.any & facing & !whole;
        if partly != 0 {
            let some = shadow.sum_sixteen(ops, views.disparity(), &sixteen, surfaces, partly);
            seen = ops.select(partly, &some, &seen);
        }
        ops.select(facing, &seen, &zero)
    }

    /// [`Image::seen`] for maps that have nothing in common.
    fn one_by_one(
        &self,
        pixels: &Pixels,
        frustum: usize,
        of: u32,
        counters: &mut Counters,
    ) -> Lanes {
        let shadow = &self.frusta[frustum];
        let mut seen = [0.0; LANES];
        for i in (0..LANES).filter(|i| of >> i & 1 != 0) {
            let (x, y, nearness) = (pixels.x + i, pixels.y, pixels.nearness[i]);
            let view = self.camera.view();
            let plane = self.camera.plane(x as u32, y as u32, nearness).1;
            let surface = shadow.surface(plane, plane.side_of(view.eye()));
            let Some(above) = surface.above else { continue };
            let (u, v) = (x as f32 + 0.5, y as f32 + 0.5);
            let receiver = Receiver {
                point: surface.point(self.warps[frustum].at(u, v, nearness)),
                position: view.world_from_texel(u, v, nearness),
                plane: &surface.plane,
                above,
            };
            let test = shadow.test_all(&receiver);
            seen[i] = shadow.seen_by(&receiver, test, |_, _| {});
            counters.outside += u32::from(test.outside);
        }
        seen
    }
}
