//! Colour of every pixel: surfaces under the lights, as far as they see them, and a sky.

use std::ops::Range;

use glam::Vec3;
use shadowmap_core::{BandSlice, DepthMap, Level, Threads, View, for_each_band};

use crate::emitters::Emitter;
use crate::facet::Facet;
use crate::light_block::{BLOCK, Block, Lane, add_light, positions, reflected, steps, surround};
use crate::prepared::Prepared;
use crate::tone::ToneTable;

/// Light from above and from below that reaches everything, linear RGB.
const SKY: Vec3 = Vec3::new(0.150, 0.165, 0.190);
const BOUNCE: Vec3 = Vec3::new(0.085, 0.080, 0.075);

/// What is seen where there is nothing, at the top and at the bottom of the picture, linear RGB.
const BACKDROP: [Vec3; 2] = [Vec3::new(0.33, 0.39, 0.46), Vec3::new(0.68, 0.69, 0.69)];

/// What is shaded.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    /// The scene.
    pub prepared: &'a Prepared<'a>,
    /// The camera, with `aa` times as many pixels along each axis as the picture.
    pub camera: &'a View,
    /// Nearness and triangle index + 1 of every pixel of the camera.
    pub map: DepthMap<'a>,
    /// The points of each light.
    pub emitters: &'a [Vec<Emitter>],
    /// The visibility of each light, one value per pixel of the camera.
    pub visibility: &'a [Vec<f32>],
    /// Pixels of the camera per pixel of the picture along each axis, from 1 to [`MAX_AA`].
    pub aa: u32,
}

/// The most pixels of the camera per pixel of the picture along each axis.
pub const MAX_AA: u32 = 16;

/// A picture to write to, row-major, three values per pixel.
#[derive(Debug)]
pub enum Pixels<'a> {
    /// Tone-mapped, sRGB.
    Srgb(&'a mut [u8]),
    /// Linear light.
    Linear(&'a mut [f32]),
}

/// Shades the picture, `camera.width() / aa` pixels wide.
///
/// # Panics
///
/// If the picture, the map or a visibility has another size than the camera says.
pub fn shade(shading: &Shading<'_>, level: Level, threads: Threads, pixels: Pixels<'_>) {
    let pixels_of_camera = shading.camera.width() as usize * shading.camera.height() as usize;
    assert_eq!(shading.map.nearness().len(), pixels_of_camera, "one nearness per pixel");
    assert_eq!(shading.map.ids().len(), pixels_of_camera, "one triangle per pixel");
    assert_eq!(shading.emitters.len(), shading.visibility.len(), "one visibility per light");
    for visibility in shading.visibility {
        assert_eq!(visibility.len(), pixels_of_camera, "one visibility per pixel");
    }
    let width = (shading.camera.width() / shading.aa) as usize;
    let height = (shading.camera.height() / shading.aa) as usize;
    let len = 3 * width;
    match pixels {
        Pixels::Srgb(data) => {
            assert_eq!(data.len(), len * height, "three values per pixel");
            let table = ToneTable::get();
            rows(shading, level, threads, BandSlice { data, len }, &|linear, out| {
                let mut indices = [[0; BLOCK]; 3];
                for (linear, indices) in linear.iter().zip(&mut indices) {
                    steps(level, linear, indices);
                }
                interleave(&indices, out, |steps| table.byte(steps));
            });
        }
        Pixels::Linear(data) => {
            assert_eq!(data.len(), len * height, "three values per pixel");
            rows(shading, level, threads, BandSlice { data, len }, &|linear, out| {
                interleave(linear, out, |value| value);
            });
        }
    }
}

/// Writes red, green and blue of each pixel beside each other.
fn interleave<S: Copy, T>([r, g, b]: &[[S; BLOCK]; 3], out: &mut [T], convert: impl Fn(S) -> T) {
    let (pixels, _) = out.as_chunks_mut::<3>();
    for (((out, &r), &g), &b) in pixels.iter_mut().zip(r).zip(g).zip(b) {
        *out = [convert(r), convert(g), convert(b)];
    }
}

/// Shades row by row of the picture; `write` puts linear RGB, pixel by pixel, into the bands.
fn rows<T: Send>(
    shading: &Shading<'_>,
    level: Level,
    threads: Threads,
    picture: BandSlice<'_, T>,
    write: &(impl Fn(&[Lane; 3], &mut [T]) + Sync),
) {
    let aa = shading.aa as usize;
    let step = BLOCK / aa;
    for_each_band(threads, picture, &|y, row| {
        let mut painter = Painter::new(shading, level);
        for (index, out) in row.data.chunks_mut(3 * step).enumerate() {
            let (x, count) = (index * step * aa, out.len() / 3);
            if aa == 1 {
                painter.paint(x, y, count);
                write(&painter.color, out);
                continue;
            }
            let mut sum = [[0.0_f32; BLOCK]; 3];
            for sub_row in 0..aa {
                painter.paint(x, y * aa + sub_row, count * aa);
                for (sum, color) in sum.iter_mut().zip(&painter.color) {
                    for (sum, samples) in sum.iter_mut().zip(color.chunks_exact(aa)) {
                        *sum += samples.iter().sum::<f32>();
                    }
                }
            }
            let weight = 1.0 / (aa * aa) as f32;
            sum.iter_mut().flatten().for_each(|value| *value *= weight);
            write(&sum, out);
        }
    });
}

/// Shades blocks of pixels of the camera.
struct Painter<'a> {
    shading: &'a Shading<'a>,
    level: Level,
    nearness: Lane,
    visibility: Lane,
    block: Block,
    /// Linear RGB, the result.
    color: [Lane; 3],
    facet: Option<Facet<'a>>,
}

impl<'a> Painter<'a> {
    fn new(shading: &'a Shading<'a>, level: Level) -> Painter<'a> {
        Painter {
            shading,
            level,
            nearness: [0.0; BLOCK],
            visibility: [0.0; BLOCK],
            block: Block::new(),
            color: [[0.0; BLOCK]; 3],
            facet: None,
        }
    }

    /// Shades the pixels (x, y) to (x + count - 1, y).
    fn paint(&mut self, x: usize, y: usize, count: usize) {
        let camera = self.shading.camera;
        let start = y * camera.width() as usize + x;
        let pixels = start..start + count;
        let backdrop = {
            let t = (y as f32 + 0.5) / camera.height() as f32;
            BACKDROP[0] * (1.0 - t) + BACKDROP[1] * t
        };
        self.nearness = [0.0; BLOCK];
        self.nearness[..count].copy_from_slice(&self.shading.map.nearness()[pixels.clone()]);
        if self.nearness.iter().all(|&n| n == 0.0) {
            for (color, value) in self.color.iter_mut().zip(backdrop.to_array()) {
                *color = [value; BLOCK];
            }
            return;
        }
        positions(self.level, camera, x as u32, y as u32, &self.nearness, &mut self.block.position);
        self.gather(&self.shading.map.ids()[pixels.clone()], backdrop);
        surround(self.level, &mut self.block, SKY, BOUNCE);
        let lights = self.shading.emitters.iter().zip(self.shading.visibility);
        for (emitters, visibility) in lights {
            self.visibility[..count].copy_from_slice(&visibility[pixels.clone()]);
            for emitter in emitters {
                add_light(self.level, &mut self.block, emitter, &self.visibility);
            }
        }
        reflected(self.level, &self.block, &mut self.color);
    }

    /// Looks up the surfaces that the pixels with these triangle indices + 1 see, run by run of
    /// pixels on one triangle.
    fn gather(&mut self, triangles: &[u32], backdrop: Vec3) {
        // The last facet of one block is often the first of the next.
        let mut last = self.facet.take();
        let mut start = 0;
        while start < triangles.len() {
            let index = triangles[start];
            let others = triangles[start..].iter().position(|&other| other != index);
            let run = start..others.map_or(triangles.len(), |length| start + length);
            start = run.end;
            if index == 0 {
                self.fill(run, [Vec3::Y, Vec3::ZERO, backdrop]);
                continue;
            }
            let prepared = self.shading.prepared;
            if last.as_ref().is_none_or(|facet| facet.index() != index) {
                last = Some(Facet::new(prepared, index, self.shading.camera.eye()));
            }
            let Some(facet) = &last else { continue };
            match facet.uniform() {
                Some(surface) => self.fill(run, surface),
                None => {
                    for i in run {
                        let [x, y, z] = &self.block.position;
                        let surface = facet.at(prepared, Vec3::new(x[i], y[i], z[i]));
                        self.set(i, surface);
                    }
                }
            }
        }
        self.facet = last;
    }

    /// Sets normal, albedo and emission of a pixel.
    #[inline(always)]
    fn set(&mut self, i: usize, [normal, albedo, emission]: [Vec3; 3]) {
        let Block { normal: normals, albedo: albedos, emission: emissions, .. } = &mut self.block;
        for (lanes, value) in [(normals, normal), (albedos, albedo), (emissions, emission)] {
            (lanes[0][i], lanes[1][i], lanes[2][i]) = (value.x, value.y, value.z);
        }
    }

    /// Sets normal, albedo and emission of some pixels.
    #[inline(always)]
    fn fill(&mut self, run: Range<usize>, [normal, albedo, emission]: [Vec3; 3]) {
        for c in 0..3 {
            self.block.normal[c][run.clone()].fill(normal[c]);
            self.block.albedo[c][run.clone()].fill(albedo[c]);
            self.block.emission[c][run.clone()].fill(emission[c]);
        }
    }
}
