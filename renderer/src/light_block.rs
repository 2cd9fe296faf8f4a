//! A block of pixels under one light: the arithmetic of the shading, sixteen pixels at a time
//! where the machine can.
//!
//! Written once, as plain loops over arrays of a fixed length, which the compiler turns into
//! vector code for each level. It never contracts or reorders floating-point operations, so
//! all levels give the same bits.

use glam::Vec3;
#[cfg(target_arch = "x86_64")]
use shadowmap_core::LevelKind;
use shadowmap_core::{Level, View, Warp};

use crate::emitters::Emitter;
use crate::tone::STEPS;

/// Pixels per block.
pub const BLOCK: usize = 64;

/// Values after those of the block, so that surfaces can be looked up a whole vector at a time.
pub const PADDING: usize = 16;

/// One value per pixel of a block, and arbitrary ones after them.
pub type Lane = [f32; BLOCK + PADDING];

/// A block of neighbouring pixels of one row. None of its vectors lies in two lines of the cache.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Block {
    /// World position, x, y and z. Arbitrary where nothing is seen.
    pub position: [Lane; 3],
    /// Unit shading normal, x, y and z.
    pub normal: [Lane; 3],
    /// Linear RGB that arrives.
    pub irradiance: [Lane; 3],
    /// Linear RGB: the part of it that the surface sends on.
    pub albedo: [Lane; 3],
    /// Linear RGB that is there anyway.
    pub emission: [Lane; 3],
    /// Linear RGB, the result.
    pub color: [Lane; 3],
}

impl Block {
    /// A block that nothing arrives at.
    #[must_use]
    pub fn new() -> Block {
        let zero = [[0.0; BLOCK + PADDING]; 3];
        Block {
            position: zero,
            normal: zero,
            irradiance: zero,
            albedo: zero,
            emission: zero,
            color: zero,
        }
    }
}

impl Default for Block {
    fn default() -> Block {
        Block::new()
    }
}

/// Defines a function that takes a [`Level`] first and runs `body` compiled for it.
macro_rules! levels {
    ($(#[$doc:meta])* $name:ident, $body:ident, ($($arg:ident: $type:ty),*) $(-> $result:ty)?) => {
        $(#[$doc])*
        #[allow(unsafe_code)]
        pub fn $name(level: Level, $($arg: $type),*) $(-> $result)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $type),*) $(-> $result)? {
                    $body($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
                fn avx512($($arg: $type),*) $(-> $result)? {
                    $body($($arg),*)
                }
                match level.kind() {
                    // SAFETY: a `Level` of this kind is the proof that the machine has AVX2.
                    LevelKind::Avx2 => return unsafe { avx2($($arg),*) },
                    // SAFETY: and here that it has AVX-512 F, BW, DQ and VL.
                    LevelKind::Avx512 => return unsafe { avx512($($arg),*) },
                    _ => {}
                }
            }
            let _ = level;
            $body($($arg),*)
        }
    };
}

pub(crate) use levels;

levels!(
    /// World positions of the pixels (x, y), (x + 1, y), ... of a camera with the given nearness.
    positions, positions_body,
    (camera: &View, x: u32, y: u32, nearness: &[f32; BLOCK], position: &mut [Lane; 3])
);

#[inline(always)]
fn positions_body(
    camera: &View,
    x: u32,
    y: u32,
    nearness: &[f32; BLOCK],
    position: &mut [Lane; 3],
) {
    let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
    let rows = camera.inverse_rows();
    // Each row over (x, y, n, 1), what does not change along a row of pixels taken together.
    let fixed = rows.map(|r| r[1] * y + r[3]);
    let [out_x, out_y, out_z] = position;
    for i in 0..BLOCK {
        let (u, n) = (x + i as f32, nearness[i]);
        let at = |k: usize| (rows[k][0] * u + fixed[k]) + rows[k][2] * n;
        let scale = 1.0 / at(3);
        out_x[i] = at(0) * scale;
        out_y[i] = at(1) * scale;
        out_z[i] = at(2) * scale;
    }
}

levels!(
    /// Texel coordinates u, v and nearness in a light's view of the pixels (x, y), (x + 1, y), ...
    /// of a camera with the given nearness; u is NaN behind the light.
    warped, warped_body, (warp: &Warp, x: u32, y: u32, nearness: &Lane, seen: &mut [Lane; 3])
);

#[inline(always)]
fn warped_body(warp: &Warp, x: u32, y: u32, nearness: &Lane, seen: &mut [Lane; 3]) {
    let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
    let rows = warp.rows();
    let [out_u, out_v, out_n] = seen;
    for i in 0..BLOCK {
        let (x, n) = (x + i as f32, nearness[i]);
        let at = |k: usize| {
            let r = &rows[k];
            ((r[0] * x + r[1] * y) + r[2] * n) + r[3]
        };
        let q = at(3);
        out_u[i] = if q > 0.0 { at(0) / q } else { f32::NAN };
        out_v[i] = at(1) / q;
        out_n[i] = at(2) / q;
    }
}

levels!(
    /// Makes the normals unit vectors and sets what arrives to the light of the surroundings:
    /// `sky` from above, `bounce` from below. Normals of no length stay as they are.
    surround, surround_body, (block: &mut Block, sky: Vec3, bounce: Vec3)
);

#[inline(always)]
fn surround_body(block: &mut Block, sky: Vec3, bounce: Vec3) {
    let [nx, ny, nz] = &mut block.normal;
    let [r, g, b] = &mut block.irradiance;
    let (middle, half) = ((sky + bounce) * 0.5, (sky - bounce) * 0.5);
    for i in 0..BLOCK {
        let squared = (nx[i] * nx[i] + ny[i] * ny[i]) + nz[i] * nz[i];
        let scale = if squared > 0.0 { 1.0 / squared.sqrt() } else { 0.0 };
        (nx[i], ny[i], nz[i]) = (nx[i] * scale, ny[i] * scale, nz[i] * scale);
        r[i] = middle.x + half.x * ny[i];
        g[i] = middle.y + half.y * ny[i];
        b[i] = middle.z + half.z * ny[i];
    }
}

levels!(
    /// Adds the light that arrives from an emitter, times its visibility.
    add_light, add_light_body, (block: &mut Block, emitter: &Emitter, visibility: &[f32; BLOCK])
);

#[inline(always)]
fn add_light_body(block: &mut Block, emitter: &Emitter, visibility: &[f32; BLOCK]) {
    // Most shine all around: no need to ask for the cone.
    if (emitter.cone_scale, emitter.cone_offset) == (0.0, 1.0) {
        return add_arriving(block, emitter, visibility, |_, _| 1.0);
    }
    let Emitter { axis, cone_scale, cone_offset, .. } = *emitter;
    add_arriving(block, emitter, visibility, |[x, y, z], length| {
        // Between the cone's axis and the ray of light, which runs against (x, y, z).
        let along = -((x * axis.x + y * axis.y) + z * axis.z);
        let cone = cone_scale * (along / length) + cone_offset;
        let cone = if cone > 0.0 { if cone < 1.0 { cone } else { 1.0 } } else { 0.0 };
        cone * cone
    });
}

/// Adds the light of an emitter, of which the part `cone` gets to a receiver with the given offset
/// to the emitter and distance from it.
#[inline(always)]
fn add_arriving(
    block: &mut Block,
    emitter: &Emitter,
    visibility: &[f32; BLOCK],
    cone: impl Fn([f32; 3], f32) -> f32,
) {
    let [px, py, pz] = &block.position;
    let [nx, ny, nz] = &block.normal;
    let [r, g, b] = &mut block.irradiance;
    let ([ex, ey, ez, ew], color) = (emitter.place, emitter.color);
    for i in 0..BLOCK {
        let (x, y, z) = (ex - ew * px[i], ey - ew * py[i], ez - ew * pz[i]);
        let squared = (x * x + y * y) + z * z;
        let length = squared.sqrt();
        let facing = (x * nx[i] + y * ny[i]) + z * nz[i];
        let arriving = facing / (squared * length) * cone([x, y, z], length) * visibility[i];
        // Written so that a receiver at the light itself, 0 / 0, gets nothing.
        let arriving = if arriving > 0.0 { arriving } else { 0.0 };
        r[i] += color.x * arriving;
        g[i] += color.y * arriving;
        b[i] += color.z * arriving;
    }
}

levels!(
    /// What the surfaces send on, linear RGB.
    reflected, reflected_body, (block: &mut Block)
);

#[inline(always)]
fn reflected_body(block: &mut Block) {
    let Block { irradiance, albedo, emission, color, .. } = block;
    for (c, color) in color.iter_mut().enumerate() {
        for (i, color) in color[..BLOCK].iter_mut().enumerate() {
            *color = albedo[c][i] * irradiance[c][i] + emission[c][i];
        }
    }
}

levels!(
    /// Linear values as numbers of steps of a [`crate::tone::ToneTable`], a NaN as 0.
    steps, steps_body, (linear: &Lane, steps: &mut [u16; BLOCK])
);

#[inline(always)]
fn steps_body(linear: &Lane, steps: &mut [u16; BLOCK]) {
    for (steps, &linear) in steps.iter_mut().zip(linear) {
        let scaled = linear * STEPS;
        let scaled = if scaled > 0.0 { scaled } else { 0.0 };
        let scaled = if scaled < 65535.0 { scaled } else { 65535.0 };
        // Among floats of this size there is one per whole number, and its low bits are that
        // number: the sum rounds to nearest, and needs no conversion.
        *steps = (scaled + 8_388_608.0).to_bits() as u16;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_gives_the_same_bits() {
        let view =
            View::perspective(Vec3::new(1.0, 2.0, 5.0), Vec3::ZERO, Vec3::Y, 0.9, 640, 480, 0.01);
        let emitter = Emitter {
            place: [0.5, 3.0, 1.0, 1.0],
            color: Vec3::new(1.0, 0.7, 0.3),
            axis: Vec3::new(0.0, -0.8, -0.6),
            cone_scale: 3.0,
            cone_offset: -1.5,
        };
        let nearness: [f32; BLOCK] = std::array::from_fn(|i| 0.1 + 0.003 * i as f32);
        let visibility: [f32; BLOCK] = std::array::from_fn(|i| i as f32 / 63.0);
        let draw = |level| {
            let mut block = Block::new();
            for i in 0..BLOCK {
                let t = i as f32 * 0.1;
                (block.normal[0][i], block.normal[1][i], block.normal[2][i]) = (t - 3.0, 1.0, t);
            }
            block.normal[1][7] = f32::NAN;
            positions(level, &view, 100, 200, &nearness, &mut block.position);
            surround(level, &mut block, Vec3::splat(0.2), Vec3::splat(0.1));
            add_light(level, &mut block, &emitter, &visibility);
            let all_around = Emitter { cone_scale: 0.0, cone_offset: 1.0, ..emitter };
            add_light(level, &mut block, &all_around, &visibility);
            let bits = |lanes: [Lane; 3]| lanes.map(|lane| lane.map(f32::to_bits));
            (bits(block.position), bits(block.normal), bits(block.irradiance))
        };
        let expected = draw(Level::SCALAR);
        for level in Level::available() {
            assert!(draw(level) == expected, "{}", level.kind().name());
        }
    }

    #[test]
    fn light_arrives_by_cosine_over_distance_squared() {
        let all_around = Emitter {
            place: [3.0, 4.0, 0.0, 1.0],
            color: Vec3::new(100.0, 50.0, 0.0),
            axis: Vec3::ZERO,
            cone_scale: 0.0,
            cone_offset: 1.0,
        };
        // A cone so wide that its edge is nowhere.
        let cone = Emitter { axis: Vec3::NEG_Y, cone_scale: 1.0, cone_offset: 2.0, ..all_around };
        for emitter in [all_around, cone] {
            let mut block = Block::new();
            block.normal[1] = [1.0; BLOCK + PADDING];
            add_light(Level::SCALAR, &mut block, &emitter, &[0.5; BLOCK]);
            // 100 candela, 5 m away, at cosine 4 / 5, half seen.
            assert!((block.irradiance[0][9] - 100.0 / 25.0 * 0.8 * 0.5).abs() < 1e-6);
            assert!((block.irradiance[1][9] - 0.8).abs() < 1e-6);
            assert_eq!(block.irradiance[2][9], 0.0);
        }
    }
}
