//! Colour of the camera's pixels, block by block: surfaces looked up, light added.

use std::ops::Range;

use glam::Vec3;
#[cfg(target_arch = "x86_64")]
use shadowmap_core::LevelKind;
use shadowmap_core::{Level, View};

use crate::facet::{Facet, set_look};
use crate::light_block::{
    BLOCK, Block, Lane, PADDING, add_light, levels, positions, reflected, surround,
};
use crate::prepared::Prepared;
use crate::shade::Shading;

/// Light from above and from below that reaches everything, linear RGB.
const SKY: Vec3 = Vec3::new(0.150, 0.165, 0.190);
const BOUNCE: Vec3 = Vec3::new(0.085, 0.080, 0.075);

/// What is seen where there is nothing, at the top and at the bottom of the picture, linear RGB.
const BACKDROP: [Vec3; 2] = [Vec3::new(0.33, 0.39, 0.46), Vec3::new(0.68, 0.69, 0.69)];

/// Facets that are kept: some times those that a row of pixels sees, since the next rows see most
/// of them again.
const KEPT: usize = 1024;

/// Shades blocks of pixels of the camera.
pub struct Painter<'a> {
    shading: &'a Shading<'a>,
    level: Level,
    /// For the end of the map, where less than a block is left.
    padded: [f32; BLOCK],
    block: Block,
    filled: Option<Filled>,
    facets: Facets<'a>,
}

/// A flat surface that fills the whole block: the next block often sees the same.
struct Filled {
    triangle: u32,
    /// Linear RGB that arrives at it without the lights.
    surroundings: [f32; 3],
}

impl<'a> Painter<'a> {
    /// A painter of pictures of `shading`.
    #[must_use]
    pub fn new(shading: &'a Shading<'a>, level: Level) -> Painter<'a> {
        Painter {
            shading,
            level,
            padded: [0.0; BLOCK],
            block: Block::new(),
            filled: None,
            facets: Facets::new(shading),
        }
    }

    /// Linear RGB of the pixels that were shaded last.
    #[must_use]
    pub fn color(&self) -> &[Lane; 3] {
        &self.block.color
    }

    /// Whether the pixels (x, y) to (x + count - 1, y) see nothing: all of them, and all such
    /// pixels of a row, have the same colour.
    #[must_use]
    pub fn sees_nothing(&self, x: usize, y: usize, count: usize) -> bool {
        let triangles = &self.shading.map.ids()[self.pixels(x, y, count)];
        triangles[0] == 0 && are_all(self.level, triangles, 0)
    }

    /// Shades the pixels (x, y) to (x + count - 1, y).
    pub fn paint(&mut self, x: usize, y: usize, count: usize) {
        let (camera, level) = (self.shading.camera, self.level);
        let pixels = self.pixels(x, y, count);
        let start = pixels.start;
        let triangles = &self.shading.map.ids()[pixels];
        let of_all = are_all(level, triangles, triangles[0]).then_some(triangles[0]);
        if of_all == Some(0) {
            return fill(level, &mut self.block.color, backdrop(camera, y).to_array());
        }
        let nearness = block_from(self.shading.map.nearness(), start, &mut self.padded);
        positions(level, camera, x as u32, y as u32, nearness, &mut self.block.position);
        self.see(triangles, of_all, y);
        let lights = self.shading.emitters.iter().zip(self.shading.visibility);
        for (emitters, visibility) in lights {
            let visibility = block_from(visibility, start, &mut self.padded);
            for emitter in emitters {
                add_light(level, &mut self.block, emitter, visibility);
            }
        }
        reflected(level, &mut self.block);
    }

    /// Where the pixels (x, y) to (x + count - 1, y) lie in the map.
    fn pixels(&self, x: usize, y: usize, count: usize) -> Range<usize> {
        let start = y * self.shading.camera.width() as usize + x;
        start..start + count
    }

    /// Sets the surfaces of the block, and what arrives at them without the lights. `of_all` is the
    /// triangle that all pixels see, if they see the same.
    fn see(&mut self, triangles: &[u32], of_all: Option<u32>, y: usize) {
        if let Some(filled) = self.filled.as_ref().filter(|filled| of_all == Some(filled.triangle))
        {
            fill(self.level, &mut self.block.irradiance, filled.surroundings);
            return;
        }
        let backdrop = backdrop(self.shading.camera, y);
        look_up(self.level, &mut self.facets, triangles, backdrop, &mut self.block);
        surround(self.level, &mut self.block, SKY, BOUNCE);
        let of_all = of_all.filter(|_| triangles.len() == BLOCK);
        self.filled = of_all.and_then(|triangle| self.filled_by(triangle));
    }

    /// What is to be kept of a block that sees nothing but one triangle, before lights are added.
    fn filled_by(&mut self, triangle: u32) -> Option<Filled> {
        let surroundings = self.block.irradiance.each_ref().map(|lane| lane[0]);
        self.facets.get(triangle).is_flat().then_some(Filled { triangle, surroundings })
    }
}

/// What is seen in row y where there is nothing, linear RGB.
fn backdrop(camera: &View, y: usize) -> Vec3 {
    let t = (y as f32 + 0.5) / camera.height() as f32;
    BACKDROP[0] * (1.0 - t) + BACKDROP[1] * t
}

levels!(
    /// Sets all values of each lane.
    fill, fill_body, (lanes: &mut [Lane; 3], values: [f32; 3])
);

#[inline(always)]
fn fill_body(lanes: &mut [Lane; 3], values: [f32; 3]) {
    for (lane, value) in lanes.iter_mut().zip(values) {
        *lane = [value; BLOCK + PADDING];
    }
}

/// The values from `start` on; what follows the last one is arbitrary.
#[inline(always)]
fn block_from<'a>(
    values: &'a [f32],
    start: usize,
    padded: &'a mut [f32; BLOCK],
) -> &'a [f32; BLOCK] {
    let values = &values[start..];
    values.first_chunk().unwrap_or_else(|| {
        padded[..values.len()].copy_from_slice(values);
        padded
    })
}

/// The facets that were seen last, each at its index modulo [`KEPT`].
pub struct Facets<'a> {
    prepared: &'a Prepared<'a>,
    eye: [f32; 4],
    kept: Box<[Facet; KEPT]>,
}

impl<'a> Facets<'a> {
    /// None yet.
    #[must_use]
    pub fn new(shading: &Shading<'a>) -> Facets<'a> {
        let kept = vec![Facet::NONE; KEPT].try_into();
        let kept = kept.unwrap_or_else(|_| unreachable!("there are just that many"));
        Facets { prepared: shading.prepared, eye: shading.camera.eye(), kept }
    }

    /// That of the triangle `index - 1`.
    #[inline(always)]
    fn get(&mut self, index: u32) -> &Facet {
        let kept = &mut self.kept[index as usize % KEPT];
        if kept.index() != index {
            *kept = Facet::new(self.prepared, index, self.eye);
        }
        kept
    }
}

levels!(
    /// Looks up the surfaces that pixels with these triangle indices + 1 see, run by run of pixels
    /// on one triangle.
    look_up,
    look_up_body,
    (facets: &mut Facets<'_>, triangles: &[u32], backdrop: Vec3, block: &mut Block)
);

#[inline(always)]
fn look_up_body(facets: &mut Facets<'_>, triangles: &[u32], backdrop: Vec3, block: &mut Block) {
    let prepared = facets.prepared;
    let mut starts = starts_of_runs(triangles);
    // What the pixels from the last run on look like; most runs look like the one before.
    let mut look = None;
    while starts != 0 {
        let start = starts.trailing_zeros() as usize;
        starts &= starts - 1;
        let end = triangles.len().min(starts.trailing_zeros() as usize);
        let facet = match triangles[start] {
            0 => &Facet::NONE,
            index => facets.get(index),
        };
        if look != Some(facet.material()) {
            look = Some(facet.material());
            let (albedo, emission) = match triangles[start] {
                0 => (Vec3::ZERO, backdrop),
                _ => prepared.look(facet.material()),
            };
            set_look(block, start, albedo, emission);
        }
        facet.fill(prepared, block, start..end);
    }
}

/// Bit `i` says whether entry `i` differs from the one before; bit 0 is set.
#[inline(always)]
fn starts_of_runs(triangles: &[u32]) -> u64 {
    let pairs = triangles.iter().zip(&triangles[1..]).enumerate();
    pairs.fold(1, |starts, (i, (a, b))| starts | u64::from(a != b) << (i + 1))
}

levels!(
    /// Whether all have this index. It looks at all of them, which vector code does faster than to
    /// stop at the first that differs.
    are_all, are_all_body, (triangles: &[u32], index: u32) -> bool
);

#[inline(always)]
fn are_all_body(triangles: &[u32], index: u32) -> bool {
    triangles.iter().fold(0, |different, triangle| different | (triangle ^ index)) == 0
}
