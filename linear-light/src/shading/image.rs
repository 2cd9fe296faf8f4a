//! Shading of all that a camera sees.

use glam::Vec3;
use shadowmap_core::{BandSlice, Camera, Level, Surfaces, Threads, Warp, for_each_band};

use super::sixteen::{LANES, Sixteen};
use super::{Receiver, Samples, SkinShadow, Surface};
use crate::counters::Tally;
use crate::views::choose;
use crate::{Counters, MAX_FRUSTA};

/// Writes the visibility of a light from every pixel of the camera, row-major. `frusta` are those
/// of one light, at most [`MAX_FRUSTA`]. Pixels that see nothing get 0, and so do surfaces that turn away
/// from the whole light.
///
/// The instructions are those that the channels of the first frustum were drawn with. Every level and
/// every number of threads gives the same bits.
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
    let tally = Tally::default();
    for_each_band(threads, BandSlice { data: out, len: width.max(1) }, &|y, row| {
        let mut line = Line {
            camera,
            frusta,
            y,
            // Entries of a table are flat: neighbouring pixels with the same one share a plane.
            flat: matches!(camera.surfaces(), Surfaces::Table(_)),
            run: None,
            counters: Counters::default(),
        };
        line.shade_row(frusta[0].channels.level, &warps, row.data);
        tally.add(&line.counters);
    });
    tally.total()
}

/// One row of the camera's pixels.
struct Line<'a> {
    camera: &'a Camera<'a>,
    frusta: &'a [SkinShadow<'a>],
    y: usize,
    flat: bool,
    /// The pixel before.
    run: Option<Run>,
    counters: Counters,
}

/// Neighbouring pixels of one surface in one frustum.
#[derive(Clone, Copy)]
struct Run {
    id: Option<u32>,
    frustum: usize,
    surface: Surface,
}

/// Sixteen pixels side by side.
struct Pixels {
    nearness: [f32; LANES],
    surface: [Surface; LANES],
    /// The frustum that each belongs to: none of them if nothing is to be asked there.
    frustum: [usize; LANES],
    /// Whether all lie on one surface in the only frustum.
    share_surface: bool,
}

impl Line<'_> {
    /// Shades the row with the instructions of `level`.
    fn shade_row(&mut self, level: Level, warps: &[Warp; MAX_FRUSTA], out: &mut [f32]) {
        match level.kind() {
            #[cfg(target_feature = "sse2")]
            // SAFETY: a `Level` of that kind is the proof that the machine has its instructions.
            #[allow(unsafe_code)]
            shadowmap_core::LevelKind::Avx512 => unsafe { self.shade_avx512(warps, out) },
            #[cfg(target_feature = "sse2")]
            // SAFETY: as above.
            #[allow(unsafe_code)]
            shadowmap_core::LevelKind::Avx2 => unsafe { self.shade_avx2(warps, out) },
            #[cfg(target_feature = "sse2")]
            // SAFETY: as above.
            #[allow(unsafe_code)]
            shadowmap_core::LevelKind::Sse41 => unsafe { self.shade_sse41(warps, out) },
            // NEON and simd128 are on for the whole crate wherever they are at all.
            _ => self.shade_all(warps, out),
        }
    }

    #[cfg(target_feature = "sse2")]
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
    fn shade_avx512(&mut self, warps: &[Warp; MAX_FRUSTA], out: &mut [f32]) {
        self.shade_all(warps, out);
    }

    #[cfg(target_feature = "sse2")]
    #[target_feature(enable = "avx2")]
    fn shade_avx2(&mut self, warps: &[Warp; MAX_FRUSTA], out: &mut [f32]) {
        self.shade_all(warps, out);
    }

    #[cfg(target_feature = "sse2")]
    #[target_feature(enable = "sse4.1")]
    fn shade_sse41(&mut self, warps: &[Warp; MAX_FRUSTA], out: &mut [f32]) {
        self.shade_all(warps, out);
    }

    #[inline(always)]
    fn shade_all(&mut self, warps: &[Warp; MAX_FRUSTA], out: &mut [f32]) {
        for (block, out) in out.chunks_mut(LANES).enumerate() {
            self.shade(warps, block * LANES, out);
        }
    }

    /// Shades at most sixteen pixels from column `x` on.
    #[inline(always)]
    fn shade(&mut self, warps: &[Warp; MAX_FRUSTA], x: usize, out: &mut [f32]) {
        out.fill(0.0);
        let pixels = self.pixels(x, out.len());
        for (frustum, shadow) in self.frusta.iter().enumerate() {
            if !pixels.frustum.contains(&frustum) {
                continue;
            }
            let Pixels { nearness, surface, .. } = &pixels;
            let sixteen = Sixteen::new(&warps[frustum], [x, self.y], nearness, surface);
            let tests = shadow.test_sixteen(&sixteen);
            if pixels.share_surface
                && let Some(tests) = &tests
                && let Some(seen) = tests.of_all(&surface[0])
            {
                self.counters.outside += tests.count_outside();
                out.fill(seen);
                return;
            }
            for (i, out) in out.iter_mut().enumerate() {
                let above = surface[i].above.filter(|_| pixels.frustum[i] == frustum);
                let Some(above) = above else { continue };
                let receiver = Receiver {
                    point: sixteen.point(i),
                    position: self.position(x + i, nearness[i]),
                    plane: &surface[i].plane,
                    above,
                };
                let test = match &tests {
                    Some(tests) => tests.of(i),
                    None => shadow.test_all(&receiver),
                };
                *out = shadow.seen_by(&receiver, test, |_, _| {});
                self.counters.outside += u32::from(test.outside);
            }
        }
    }

    /// At most sixteen pixels from column `x` on.
    #[inline(always)]
    fn pixels(&mut self, x: usize, count: usize) -> Pixels {
        let map = self.camera.map();
        let first = self.y * map.width() as usize + x;
        let mut nearness = [0.0; LANES];
        nearness[..count].copy_from_slice(&map.nearness()[first..first + count]);
        let ids = map.ids().get(first..first + count).unwrap_or_default();
        let share_surface = self.flat
            && self.frusta.len() == 1
            && ids.len() == LANES
            && ids.iter().all(|id| *id == ids[0])
            && nearness.iter().all(|n| *n > 0.0);
        if share_surface {
            self.counters.receivers += LANES as u32;
            let surface = self.run_of(x, nearness[0]).surface;
            return Pixels {
                nearness,
                surface: [surface; LANES],
                frustum: [if surface.above.is_some() { 0 } else { MAX_FRUSTA }; LANES],
                share_surface,
            };
        }
        let mut pixels = Pixels {
            nearness,
            surface: [Surface::HIDDEN; LANES],
            frustum: [MAX_FRUSTA; LANES],
            share_surface,
        };
        for (i, &n) in nearness.iter().enumerate() {
            // Not where the camera sees nothing, nor at a NaN.
            if n > 0.0 {
                self.counters.receivers += 1;
                let run = self.run_of(x + i, n);
                (pixels.surface[i], pixels.frustum[i]) = (run.surface, run.frustum);
            }
        }
        pixels
    }

    /// Where a pixel's receiver is; the origin if nothing needs to know.
    #[inline(always)]
    fn position(&self, x: usize, nearness: f32) -> Vec3 {
        let needed =
            self.frusta.len() > 1 || matches!(self.frusta[0].samples, Samples::Unrelated(_));
        let (u, v) = (x as f32 + 0.5, self.y as f32 + 0.5);
        if needed { self.camera.view().world_from_texel(u, v, nearness) } else { Vec3::ZERO }
    }

    /// Surface and frustum of a pixel.
    #[inline(always)]
    fn run_of(&mut self, x: usize, nearness: f32) -> Run {
        let frustum = match self.frusta {
            [_] => 0,
            frusta => {
                let position = self.position(x, nearness);
                choose(frusta.iter().map(|shadow| shadow.rank(position)))
            }
        };
        let map = self.camera.map();
        let id = map.ids().get(self.y * map.width() as usize + x).copied().filter(|_| self.flat);
        if let Some(run) = self.run
            && id.is_some()
            && (run.id, run.frustum) == (id, frustum)
        {
            return run;
        }
        let plane = self.camera.plane(x as u32, self.y as u32, nearness).1;
        let side = plane.side_of(self.camera.view().eye());
        let surface = self.frusta[frustum].surface(plane, side);
        *self.run.insert(Run { id, frustum, surface })
    }
}
