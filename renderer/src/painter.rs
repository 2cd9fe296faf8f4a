//! Colour of the camera's pixels, block by block: surfaces looked up, light added.

use glam::Vec3;
use shadowmap_core::Level;
#[cfg(target_arch = "x86_64")]
use shadowmap_core::LevelKind;

use crate::facet::Facet;
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

/// Facets that are kept: about those that a row of pixels sees, since the next row sees most of
/// them again.
const KEPT: usize = 256;

/// Shades blocks of pixels of the camera.
pub struct Painter<'a> {
    shading: &'a Shading<'a>,
    level: Level,
    nearness: Lane,
    visibility: Lane,
    block: Block,
    /// Linear RGB, the result.
    pub color: [Lane; 3],
    facets: &'a mut Facets<'a>,
}

impl<'a> Painter<'a> {
    /// A painter of pictures of `shading`.
    #[must_use]
    pub fn new(shading: &'a Shading<'a>, level: Level, facets: &'a mut Facets<'a>) -> Painter<'a> {
        let lane = [0.0; BLOCK + PADDING];
        Painter {
            shading,
            level,
            nearness: lane,
            visibility: lane,
            block: Block::new(),
            color: [lane; 3],
            facets,
        }
    }

    /// Shades the pixels (x, y) to (x + count - 1, y).
    pub fn paint(&mut self, x: usize, y: usize, count: usize) {
        let (camera, level) = (self.shading.camera, self.level);
        let start = y * camera.width() as usize + x;
        let pixels = start..start + count;
        let backdrop = {
            let t = (y as f32 + 0.5) / camera.height() as f32;
            BACKDROP[0] * (1.0 - t) + BACKDROP[1] * t
        };
        let triangles = &self.shading.map.ids()[pixels.clone()];
        if are_all(triangles, 0) {
            for (color, value) in self.color.iter_mut().zip(backdrop.to_array()) {
                *color = [value; BLOCK + PADDING];
            }
            return;
        }
        self.nearness[count..].fill(0.0);
        self.nearness[..count].copy_from_slice(&self.shading.map.nearness()[pixels.clone()]);
        positions(level, camera, x as u32, y as u32, &self.nearness, &mut self.block.position);
        look_up(level, self.facets, triangles, backdrop, &mut self.block);
        surround(level, &mut self.block, SKY, BOUNCE);
        let lights = self.shading.emitters.iter().zip(self.shading.visibility);
        for (emitters, visibility) in lights {
            self.visibility[..count].copy_from_slice(&visibility[pixels.clone()]);
            for emitter in emitters {
                add_light(level, &mut self.block, emitter, &self.visibility);
            }
        }
        reflected(level, &self.block, &mut self.color);
    }
}

/// The facets that were seen last, each at its index modulo [`KEPT`].
pub struct Facets<'a> {
    prepared: &'a Prepared<'a>,
    eye: [f32; 4],
    kept: [Facet<'a>; KEPT],
}

impl<'a> Facets<'a> {
    /// None yet.
    #[must_use]
    pub fn new(shading: &Shading<'a>) -> Facets<'a> {
        Facets {
            prepared: shading.prepared,
            eye: shading.camera.eye(),
            kept: [Facet::glowing(Vec3::ZERO); KEPT],
        }
    }

    /// That of the triangle `index - 1`.
    #[inline(always)]
    fn get(&mut self, index: u32) -> &Facet<'a> {
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
    while starts != 0 {
        let start = starts.trailing_zeros() as usize;
        starts &= starts - 1;
        let end = triangles.len().min(starts.trailing_zeros() as usize);
        match triangles[start] {
            0 => Facet::glowing(backdrop).fill(prepared, block, start..end),
            index => facets.get(index).fill(prepared, block, start..end),
        }
    }
}

/// Bit `i` says whether entry `i` differs from the one before; bit 0 is set.
#[inline(always)]
fn starts_of_runs(triangles: &[u32]) -> u64 {
    let pairs = triangles.iter().zip(&triangles[1..]).enumerate();
    pairs.fold(1, |starts, (i, (a, b))| starts | u64::from(a != b) << (i + 1))
}

/// Whether all have this index. It looks at all of them, which vector code does faster than to
/// stop at the first that differs.
fn are_all(triangles: &[u32], index: u32) -> bool {
    triangles.iter().fold(0, |different, triangle| different | (triangle ^ index)) == 0
}
