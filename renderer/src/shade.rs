//! Colour of every pixel: surfaces under the lights, as far as they see them, and a sky.

use shadowmap_core::{BandSlice, DepthMap, Level, Threads, View, for_each_band_with};

use crate::emitters::Emitter;
use crate::light_block::{BLOCK, Lane, PADDING, steps};
use crate::painter::Painter;
use crate::prepared::Prepared;
use crate::tone::ToneTable;

/// Rows of the picture that are shaded together: what one row sees, the next sees again. So few
/// that threads end at about the same time.
const ROWS: usize = 16;

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
fn interleave<S: Copy, T, const N: usize>(
    [r, g, b]: &[[S; N]; 3],
    out: &mut [T],
    convert: impl Fn(S) -> T,
) {
    let (pixels, _) = out.as_chunks_mut::<3>();
    for (((out, &r), &g), &b) in pixels.iter_mut().zip(r).zip(g).zip(b) {
        *out = [convert(r), convert(g), convert(b)];
    }
}

/// Shades row by row of the picture; `write` puts linear RGB, pixel by pixel, into the bands.
fn rows<T: Copy + Send>(
    shading: &Shading<'_>,
    level: Level,
    threads: Threads,
    picture: BandSlice<'_, T>,
    write: &(impl Fn(&[Lane; 3], &mut [T]) + Sync),
) {
    let aa = shading.aa as usize;
    let (row, step) = (picture.len, BLOCK / aa);
    let bands = BandSlice { len: ROWS * row, ..picture };
    let start = || Painter::new(shading, level);
    for_each_band_with(threads, bands, start, &|painter, band, rows| {
        for (y, row) in (ROWS * band..).zip(rows.data.chunks_mut(row)) {
            // Where in the row a block that sees nothing is done.
            let mut nothing = None;
            for start in (0..row.len()).step_by(3 * step) {
                let end = row.len().min(start + 3 * step);
                let (x, count) = (start / 3 * aa, (end - start) / 3);
                if aa > 1 {
                    write(&mean(painter, aa, x, y, count), &mut row[start..end]);
                } else if !painter.sees_nothing(x, y, count) {
                    painter.paint(x, y, count);
                    write(painter.color(), &mut row[start..end]);
                } else if let Some(nothing) = nothing {
                    row.copy_within(nothing..nothing + (end - start), start);
                } else {
                    painter.paint(x, y, count);
                    write(painter.color(), &mut row[start..end]);
                    nothing = Some(start);
                }
            }
        }
    });
}

/// Linear RGB of `count` pixels of the picture from (x, y) on, each the mean over `aa` times `aa`
/// pixels of the camera.
fn mean(painter: &mut Painter<'_>, aa: usize, x: usize, y: usize, count: usize) -> [Lane; 3] {
    let mut sum = [[0.0_f32; BLOCK + PADDING]; 3];
    for sub_row in 0..aa {
        painter.paint(x, y * aa + sub_row, count * aa);
        for (sum, color) in sum.iter_mut().zip(painter.color()) {
            for (sum, samples) in sum.iter_mut().zip(color.chunks_exact(aa)) {
                *sum += samples.iter().sum::<f32>();
            }
        }
    }
    let weight = 1.0 / (aa * aa) as f32;
    sum.iter_mut().flatten().for_each(|value| *value *= weight);
    sum
}
