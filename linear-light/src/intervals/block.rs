//! Blocks of the camera's image, divided into groups of receivers on one plane.

use shadowmap_core::{Camera, Plane, Surfaces};

use super::bounds::BAND;
use super::frame::{Facing, Frame, Frustum, UNKNOWN};
use super::group::{Group, Part, Scratch};
use super::receivers::{Pixels, Receivers, from_row, in_row, warp_row};
use crate::MAX_FRUSTA;
use crate::lanes::{INDEX, Ids, LANES, Lanes, Ops, lanes, put, take};

/// What was done for the receivers of a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counters {
    /// Pixels where the camera sees something.
    pub receivers: u64,
    /// Receivers outside the map from the middle of the light. They are lit as far as the maps show
    /// nothing that hides it.
    pub outside: u64,
    /// Receivers for which rows of the maps were searched; all others were decided as a whole.
    pub searched: u64,
}

/// Two receivers lie on one plane if the nearness of one differs from that of the other's plane by
/// less than this, relative to it: no more than single precision can tell.
const COPLANAR: f32 = 1.0 / 262_144.0;

/// The pixels of one block, and their receivers in the map from the middle of the light.
struct Block {
    x: usize,
    y: usize,
    nearness: [Lanes; BAND],
    ids: [Ids; BAND],
}

/// Judges all receivers of a band of the camera's image, from row `first_row` on.
#[inline(always)]
pub(crate) fn judge_band(
    ops: impl Ops,
    frame: &Frame<'_>,
    first_row: usize,
    out: &mut [f32],
    scratch: &mut Scratch,
    counters: &mut Counters,
) {
    let width = frame.camera.map().width() as usize;
    let height = out.len() / width;
    scratch.hidden.clear();
    scratch.hidden.resize(out.len(), 0.0);
    for x in (0..width).step_by(LANES) {
        let block = Block::load(&frame.camera, x, first_row, [width, height]);
        let mut open = [0.0; LANES * BAND];
        block.judge(ops, frame, scratch, counters, &mut open);
        for (line, open) in out.chunks_exact_mut(width).zip(open.as_chunks().0) {
            put(&mut line[x..], open);
        }
    }
    for (out, hidden) in out.iter_mut().zip(&scratch.hidden) {
        // Written so that NaN is lit.
        let seen = *out - *hidden;
        let seen = if seen < 1.0 { seen } else { 1.0 };
        *out = if seen > 0.0 { seen } else { 0.0 };
    }
}

impl Block {
    #[inline(always)]
    fn load(camera: &Camera<'_>, x: usize, y: usize, [width, height]: [usize; 2]) -> Block {
        let mut block = Block { x, y, nearness: [[0.0; LANES]; BAND], ids: [[0; LANES]; BAND] };
        let map = camera.map();
        for row in 0..height {
            let pixels = (y + row) * width + x..(y + row + 1) * width;
            block.nearness[row] = take(&map.nearness()[pixels.clone()]);
            if let Some(ids) = map.ids().get(pixels) {
                block.ids[row] = take(ids);
            }
        }
        block
    }

    /// Judges the receivers of the block, group after group: writes how much of the light is above
    /// their horizon to `open`.
    #[inline(always)]
    fn judge(
        &self,
        ops: impl Ops,
        frame: &Frame<'_>,
        scratch: &mut Scratch,
        counters: &mut Counters,
        open: &mut [f32; LANES * BAND],
    ) {
        let width = frame.camera.map().width() as usize;
        let all = self.receivers(ops);
        counters.receivers += u64::from(all.count_ones());
        let shares = if all == 0 { [0; MAX_FRUSTA] } else { self.shares(ops, &frame.frusta) };
        for (frustum, share) in frame.frusta.iter().flatten().zip(shares) {
            let left = all & share;
            if left != 0 {
                self.divide(ops, frame, frustum, left, scratch, counters, open);
            }
            let alone = frame.frusta[1].is_some() || self.x + LANES >= width;
            scratch.end_block(self.x / LANES, alone);
            while let Some(group) = scratch.ready.pop() {
                group.judge(ops, frame, frustum, scratch, width);
            }
        }
    }

    /// Divides the pixels `left`, which belong to one frustum, into groups.
    #[inline(always)]
    fn divide(
        &self,
        ops: impl Ops,
        frame: &Frame<'_>,
        frustum: &Frustum<'_>,
        mut left: Pixels,
        scratch: &mut Scratch,
        counters: &mut Counters,
        open: &mut [f32; LANES * BAND],
    ) {
        let block = self.x / LANES;
        let slot = block % scratch.receivers.len();
        scratch.receivers[slot].warp(ops, frustum, [self.x, self.y], &self.nearness);
        while left != 0 {
            let leader = left.trailing_zeros() as usize;
            let (plane, pixels) = self.group(ops, &frame.camera, leader, left);
            left &= !pixels;
            let Some(facing) = Facing::new(frame, plane) else { continue };
            fill(ops, open, pixels, facing.open());
            let Receivers { inside, beside, .. } = scratch.receivers[slot];
            let pixels_inside = pixels & inside;
            counters.outside += u64::from((pixels & !(inside & !beside)).count_ones());
            if pixels_inside == 0 {
                continue;
            }
            let part = Part { block, pixels: pixels_inside };
            let whole = Group::new(ops, part, facing, frustum, &scratch.receivers);
            if whole.is_lit(ops, frame, frustum, scratch) {
                continue;
            }
            counters.searched += u64::from(pixels_inside.count_ones());
            if !whole.tilt.steep {
                scratch.add(whole);
                continue;
            }
            // Receivers on a plane that is too steep are judged one by one.
            let mut waiting = pixels_inside;
            while waiting != 0 {
                let part = Part { block, pixels: waiting & waiting.wrapping_neg() };
                scratch.ready.push(Group::new(ops, part, facing, frustum, &scratch.receivers));
                waiting &= waiting - 1;
            }
        }
    }

    /// The pixels where there is something.
    #[inline(always)]
    fn receivers(&self, ops: impl Ops) -> Pixels {
        let mut pixels = 0;
        for (y, nearness) in self.nearness.iter().enumerate() {
            pixels |= from_row(ops.greater(nearness, &[0.0; LANES]), y);
        }
        pixels
    }

    /// The plane of pixel `leader`, and which of the pixels `among` lie on it.
    #[inline(always)]
    fn group(
        &self,
        ops: impl Ops,
        camera: &Camera<'_>,
        leader: usize,
        among: Pixels,
    ) -> (Plane, Pixels) {
        let (x, y) = (leader % LANES, leader / LANES);
        let (_, plane) =
            camera.plane((self.x + x) as u32, (self.y + y) as u32, self.nearness[y][x]);
        let alone = 1 << leader;
        let known = plane.0.iter().all(|p| p.is_finite()) && plane.0[..3] != [0.0; 3];
        if !known {
            return (UNKNOWN, alone);
        }
        let mut group = 0;
        match camera.surfaces() {
            Surfaces::Table(_) => {
                let id = self.ids[y][x];
                for (row, ids) in self.ids.iter().enumerate() {
                    group |= from_row(ops.equal(ids, id), row);
                }
            }
            _ => {
                let pull = camera.view().inverse_rows();
                let [a, b, c, d] =
                    [0, 1, 2, 3].map(|column| plane.side_of(pull.map(|row| row[column])));
                for (row, nearness) in self.nearness.iter().enumerate() {
                    let middle = (self.y + row) as f32 + 0.5;
                    let off = lanes(|i| {
                        let column = self.x as f32 + (INDEX[i] + 0.5);
                        (((a * column + b * middle) + c * nearness[i]) + d).abs()
                    });
                    let within = lanes(|i| COPLANAR * (c * nearness[i]).abs());
                    group |= from_row(ops.greater(&within, &off), row);
                }
                if let Surfaces::Normals(normals) = camera.surfaces() {
                    group = self.with_normal(camera, normals, leader, group & among);
                }
            }
        }
        (plane, (group & among) | alone)
    }

    /// Those of the pixels `among` that have the normal of pixel `leader`.
    fn with_normal(
        &self,
        camera: &Camera<'_>,
        normals: &[glam::Vec3],
        leader: usize,
        among: Pixels,
    ) -> Pixels {
        let width = camera.map().width() as usize;
        let normal =
            |pixel: usize| normals[(self.y + pixel / LANES) * width + self.x + pixel % LANES];
        let mut same = among;
        let mut left = among;
        while left != 0 {
            let pixel = left.trailing_zeros() as usize;
            left &= left - 1;
            if normal(pixel) != normal(leader) {
                same &= !(1 << pixel);
            }
        }
        same
    }

    /// The pixels that belong to each frustum, as [`crate::RectifiedLight::frustum_of`] has it.
    #[inline(always)]
    fn shares(
        &self,
        ops: impl Ops,
        frusta: &[Option<Frustum<'_>>; MAX_FRUSTA],
    ) -> [Pixels; MAX_FRUSTA] {
        let mut shares = [0; MAX_FRUSTA];
        shares[0] = Pixels::MAX;
        if frusta[1].is_none() {
            return shares;
        }
        for (y, nearness) in self.nearness.iter().enumerate() {
            let at = [self.x, self.y + y];
            let mut best = [f32::NEG_INFINITY; LANES];
            for (index, frustum) in frusta.iter().flatten().enumerate() {
                let depth = warp_row(&frustum.warp[3], at, nearness);
                let mut better = ops.greater(&depth, &best);
                if let Some(beyond) = &frustum.beyond {
                    let [a, b] =
                        beyond.planes.each_ref().map(|plane| warp_row(plane, at, nearness));
                    let is_beyond = ops.greater(&a, &[0.0; LANES]) & ops.greater(&b, &[0.0; LANES]);
                    better |= is_beyond & !ops.greater(&best, &depth);
                }
                best = ops.select(better, &depth, &best);
                for share in &mut shares[..index] {
                    *share &= !from_row(better, y);
                }
                shares[index] |= from_row(better, y);
            }
        }
        shares
    }
}

/// Writes to the pixels of a block.
#[inline(always)]
fn fill(ops: impl Ops, visibility: &mut [f32; LANES * BAND], pixels: Pixels, value: f32) {
    for (y, line) in visibility.as_chunks_mut().0.iter_mut().enumerate() {
        *line = ops.select(in_row(pixels, y), &[value; LANES], line);
    }
}
