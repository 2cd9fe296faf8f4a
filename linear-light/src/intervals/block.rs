//! Blocks of the camera's image, divided into groups of receivers on one plane.

use shadowmap_core::{Camera, Plane, Surfaces};

use super::bounds::BAND;
use super::frame::{Facing, Frame, Frustum, MAX_FRUSTA, UNKNOWN};
use super::group::{MOST, Scratch, Tilt, judge};
use super::lanes::{Greater, INDEX, LANES, Lanes, lanes};

/// What was done for the receivers of a camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Pixels where the camera sees something.
    pub receivers: u64,
    /// Receivers outside all maps. They count as lit.
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
    /// Pixels per row of the image.
    width: usize,
    nearness: [Lanes; BAND],
    ids: [[u32; LANES]; BAND],
}

/// One bit per pixel of a block.
type Pixels = u128;

/// Judges all receivers of a band of the camera's image, from row `first_row` on.
#[inline(always)]
pub(super) fn judge_band(
    greater: impl Greater,
    frame: &Frame<'_>,
    first_row: usize,
    out: &mut [f32],
    scratch: &mut Scratch,
    counters: &mut Counters,
) {
    let width = frame.camera.map().width() as usize;
    let height = out.len() / width;
    out.fill(0.0);
    for x in (0..width).step_by(LANES) {
        let block = Block::load(&frame.camera, x, first_row, [width, height]);
        let mut left = block.receivers(greater);
        counters.receivers += u64::from(left.count_ones());
        while left != 0 {
            let leader = left.trailing_zeros() as usize;
            let (plane, group) = block.group(greater, &frame.camera, leader, left);
            left &= !group;
            let Some(facing) = Facing::new(frame, plane) else { continue };
            judge_group(greater, frame, &block, &facing, group, scratch, counters, out);
        }
    }
}

/// Judges the receivers of a group, frustum after frustum.
#[inline(always)]
fn judge_group(
    greater: impl Greater,
    frame: &Frame<'_>,
    block: &Block,
    facing: &Facing,
    group: Pixels,
    scratch: &mut Scratch,
    counters: &mut Counters,
    out: &mut [f32],
) {
    for (index, frustum) in frame.frusta.iter().flatten().enumerate() {
        let mine = group & block.in_frustum(greater, &frame.frusta, index);
        if mine == 0 {
            continue;
        }
        scratch.receivers.count = 0;
        let mut outside = mine;
        for y in 0..BAND {
            let pixels = (mine >> (y * LANES)) as u32 & 0xffff;
            if pixels == 0 {
                continue;
            }
            let ([u, v, w], inside) = block.warp(greater, frustum, y);
            let mut pixels = pixels & inside;
            outside &= !(Pixels::from(pixels) << (y * LANES));
            while pixels != 0 {
                let i = pixels.trailing_zeros() as usize;
                pixels &= pixels - 1;
                scratch.receivers.push([u[i], v[i], w[i]], y * LANES + i);
            }
        }
        counters.outside += u64::from(outside.count_ones());
        while outside != 0 {
            out[block.place(outside.trailing_zeros() as usize)] = facing.open();
            outside &= outside - 1;
        }
        if scratch.receivers.count == 0 {
            continue;
        }
        let tilt = Tilt::new(facing, frustum, scratch.receivers.nearness[0]);
        // Receivers on a plane that is too steep are judged one by one.
        let alone = if tilt.steep { scratch.receivers.count } else { 1 };
        if alone > 1 {
            scratch.waiting.clone_from(&scratch.receivers);
        }
        for i in 0..alone {
            if alone > 1 {
                let all = &scratch.waiting;
                scratch.receivers.count = 0;
                let place = [all.column[i], all.row[i], all.nearness[i]];
                scratch.receivers.push(place, usize::from(all.pixel[i]));
            }
            let searched = judge(greater, frame, frustum, facing, &tilt, scratch);
            let receivers = &scratch.receivers;
            counters.searched += if searched { receivers.count as u64 } else { 0 };
            for i in 0..receivers.count {
                // Written so that NaN is lit.
                let v = receivers.visibility[i];
                let v = if v < 1.0 { v } else { 1.0 };
                let v = if v > 0.0 { v } else { 0.0 };
                out[block.place(usize::from(receivers.pixel[i]))] = v;
            }
        }
    }
}

impl Block {
    #[inline(always)]
    fn load(camera: &Camera<'_>, x: usize, y: usize, [width, height]: [usize; 2]) -> Block {
        let mut block =
            Block { x, y, width, nearness: [[0.0; LANES]; BAND], ids: [[0; LANES]; BAND] };
        let columns = LANES.min(width - x);
        let map = camera.map();
        for row in 0..height {
            let from = (y + row) * width + x;
            block.nearness[row][..columns].copy_from_slice(&map.nearness()[from..from + columns]);
            if let Some(ids) = map.ids().get(from..from + columns) {
                block.ids[row][..columns].copy_from_slice(ids);
            }
        }
        block
    }

    /// Where a pixel is in its band of the image.
    #[inline(always)]
    fn place(&self, pixel: usize) -> usize {
        (pixel / LANES) * self.width + self.x + pixel % LANES
    }

    /// The pixels where there is something.
    #[inline(always)]
    fn receivers(&self, greater: impl Greater) -> Pixels {
        let mut pixels = 0;
        for (y, nearness) in self.nearness.iter().enumerate() {
            pixels |= Pixels::from(greater(nearness, &[0.0; LANES])) << (y * LANES);
        }
        pixels
    }

    /// The plane of pixel `leader`, and which of the pixels `among` lie on it.
    #[inline(always)]
    fn group(
        &self,
        greater: impl Greater,
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
                    let differs = lanes(|i| (ids[i] ^ id) as f32);
                    let same = greater(&[0.5; LANES], &differs);
                    group |= Pixels::from(same) << (row * LANES);
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
                    group |= Pixels::from(greater(&within, &off)) << (row * LANES);
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

    /// The pixels that belong to frustum `index`: those that no other frustum sees less from the
    /// side.
    #[inline(always)]
    fn in_frustum(
        &self,
        greater: impl Greater,
        frusta: &[Option<Frustum<'_>>; MAX_FRUSTA],
        index: usize,
    ) -> Pixels {
        let mut pixels = Pixels::MAX;
        let Some(own) = &frusta[index] else { return 0 };
        for (other_index, other) in frusta.iter().flatten().enumerate() {
            if other_index == index {
                continue;
            }
            for y in 0..BAND {
                let own_depth = self.row_of(&own.warp[3], y);
                let other_depth = self.row_of(&other.warp[3], y);
                let inside = if index < other_index {
                    !greater(&other_depth, &own_depth) & 0xffff
                } else {
                    greater(&own_depth, &other_depth)
                };
                let row = Pixels::from(0xffff_u32) << (y * LANES);
                pixels &= !row | Pixels::from(inside) << (y * LANES);
            }
        }
        pixels
    }

    /// One row of a warp for the pixels of row `y`.
    #[inline(always)]
    fn row_of(&self, r: &[f32; 4], y: usize) -> Lanes {
        let middle = (self.y + y) as f32 + 0.5;
        lanes(|i| {
            let column = self.x as f32 + (INDEX[i] + 0.5);
            ((r[0] * column + r[1] * middle) + r[2] * self.nearness[y][i]) + r[3]
        })
    }

    /// Column, row and nearness of the pixels of row `y` in the map from the middle of the light, and
    /// which of them lie between its first and last row.
    #[inline(always)]
    fn warp(&self, greater: impl Greater, frustum: &Frustum<'_>, y: usize) -> ([Lanes; 3], u32) {
        let q = self.row_of(&frustum.warp[3], y);
        let u = over(self.row_of(&frustum.warp[0], y), &q);
        let v = over(self.row_of(&frustum.warp[1], y), &q);
        let n = over(self.row_of(&frustum.warp[2], y), &q);
        let height = frustum.size[1] as f32;
        let most = [f32::MAX; LANES];
        let inside = greater(&q, &[0.0; LANES])
            & greater(&v, &[0.0; LANES])
            & greater(&[height; LANES], &v)
            & greater(&most, &lanes(|i| u[i].abs()))
            & greater(&most, &lanes(|i| n[i].abs()));
        ([u, v, n], inside)
    }
}

#[inline(always)]
fn over(x: Lanes, q: &Lanes) -> Lanes {
    lanes(|i| x[i] / q[i])
}

const _: () = assert!(MOST <= Pixels::BITS as usize && MOST <= u8::MAX as usize + 1);
