//! How far apart two pictures are.

use std::path::Path;

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};
use serde::Serialize;

use crate::Error;
use crate::picture::{Display, Picture, Values, read};

/// Visibilities of the reference between these two lie in the penumbra.
pub const PENUMBRA: [f32; 2] = [0.002, 0.998];

/// What `compare` prints.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Root of the mean squared difference, over all values of all pixels.
    pub rmse: f64,
    /// The largest difference.
    pub max: f64,
    /// Where the largest difference is: column and row.
    pub max_at: [u32; 2],
    /// Root of the mean squared difference over the pixels in the penumbra of the reference; 0
    /// without any.
    pub penumbra_rmse: f64,
    /// Pixels in the penumbra of the reference.
    pub penumbra_pixels: u64,
    /// Pixels left out because a value is not finite in one of the pictures.
    pub not_finite: u64,
    /// Mean of NVIDIA's FLIP (Andersson et al. 2020), 0 = no visible difference.
    pub flip: f64,
}

/// Compares `a` with `b`; the penumbra is that of `reference`. Grey pictures count as coloured if
/// another one is.
///
/// # Errors
///
/// If the pictures are not of one size.
pub fn compare(a: &Picture, b: &Picture, reference: &Picture) -> Result<Comparison, Error> {
    for other in [b, reference] {
        if (a.width, a.height) != (other.width, other.height) {
            return Err(Error::new(format_args!(
                "the pictures have different sizes: {} x {} and {} x {}",
                a.width, a.height, other.width, other.height
            )));
        }
    }
    let [pa, pb, pr] = [a, b, reference].map(colored);
    let (mut squares, mut penumbra_squares) = (0.0, 0.0);
    let (mut count, mut penumbra_pixels, mut not_finite) = (0_u64, 0_u64, 0_u64);
    let (mut max, mut max_at) = (0.0, 0);
    for (i, ((a, b), r)) in pa.iter().zip(&pb).zip(&pr).enumerate() {
        if !a.iter().chain(b).chain(r).all(|value| value.is_finite()) {
            not_finite += 1;
            continue;
        }
        let differences = [0, 1, 2].map(|c| (f64::from(a[c]) - f64::from(b[c])).abs());
        let square = differences.iter().map(|d| d * d).sum::<f64>() / 3.0;
        count += 1;
        squares += square;
        let worst = differences.into_iter().fold(0.0, f64::max);
        if worst > max {
            (max, max_at) = (worst, i as u32);
        }
        let value = (r[0] + r[1] + r[2]) / 3.0;
        if value > PENUMBRA[0] && value < PENUMBRA[1] {
            penumbra_pixels += 1;
            penumbra_squares += square;
        }
    }
    Ok(Comparison {
        rmse: (squares / count.max(1) as f64).sqrt(),
        max,
        max_at: [max_at % a.width.max(1), max_at / a.width.max(1)],
        penumbra_rmse: (penumbra_squares / penumbra_pixels.max(1) as f64).sqrt(),
        penumbra_pixels,
        not_finite,
        flip: mean_flip(a, b),
    })
}

/// The absolute difference of two pictures of one size, per pixel the mean over the colours.
#[must_use]
pub fn difference(a: &Picture, b: &Picture) -> Picture {
    let (pa, pb) = (colored(a), colored(b));
    let mean = |(a, b): (&[f32; 3], &[f32; 3])| {
        ((a[0] - b[0]).abs() + (a[1] - b[1]).abs() + (a[2] - b[2]).abs()) / 3.0
    };
    let values = Values::Floats(pa.iter().zip(&pb).map(mean).collect(), Display::Heat);
    Picture { width: a.width, height: a.height, channels: 1, values }
}

/// Reads a picture and compares; see [`compare`].
///
/// # Errors
///
/// If a file cannot be read, or the pictures are not of one size.
pub fn compare_files(
    a: &Path,
    b: &Path,
    reference: Option<&Path>,
    max_memory: u64,
) -> Result<(Comparison, Picture), Error> {
    let read = |path| read(path, max_memory);
    let with_name = |why| Error::new(format_args!("{}: {why}", a.display()));
    let (a, b) = (read(a)?, read(b)?);
    let reference = reference.map(read).transpose()?;
    let comparison = compare(&a, &b, reference.as_ref().unwrap_or(&b)).map_err(with_name)?;
    Ok((comparison, difference(&a, &b)))
}

fn mean_flip(a: &Picture, b: &Picture) -> f64 {
    let [test, reference] = [a, b].map(|picture| {
        let (bytes, channels) = picture.to_bytes();
        let rgb = if channels == 3 { bytes } else { bytes.iter().flat_map(|&v| [v; 3]).collect() };
        FlipImageRgb8::with_data(picture.width, picture.height, &rgb)
    });
    let errors = flip(reference, test, DEFAULT_PIXELS_PER_DEGREE);
    f64::from(FlipPool::from_image(&errors).mean())
}

/// Three values per pixel.
fn colored(picture: &Picture) -> Vec<[f32; 3]> {
    let values = picture.to_floats();
    match picture.channels {
        1 => values.into_iter().map(|value| [value; 3]).collect(),
        _ => values.as_chunks::<3>().0.to_vec(),
    }
}
