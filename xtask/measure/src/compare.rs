//! How far values are from the truth.

use renderer::compare::{self, Comparison};
use renderer::picture::{Display, Picture, Values};

/// How far `found` is from `truth`, both row-major with `width` pixels per row.
///
/// # Panics
///
/// If one of them has more rows.
pub fn compare(width: u32, found: &[f32], truth: &[f32]) -> Comparison {
    let [found, truth] = [found, truth].map(|values| Picture {
        width,
        height: values.len() as u32 / width,
        channels: 1,
        values: Values::Floats(values.to_vec(), Display::Unit),
    });
    compare::compare(&found, &truth, &truth).expect("both are of one size")
}
