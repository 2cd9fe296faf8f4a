//! What vectors of lanes need that plain Rust has no instruction for.

use super::adaptive::{COUNT, TILE};

/// The lesser of two numbers, of no interest for NaN: [`f32::min`] takes several instructions.
#[inline(always)]
pub(crate) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The least of some lanes.
#[inline(always)]
pub(crate) fn least_of(mut lanes: [f32; TILE]) -> f32 {
    let mut half = TILE / 2;
    while half > 0 {
        for i in 0..half {
            lanes[i] = least(lanes[i], lanes[i + half]);
        }
        half /= 2;
    }
    lanes[0]
}

/// Of lane i, which is 0 or 1, bit i.
#[inline(always)]
pub(crate) fn bits_of_eight(lanes: [u8; 8]) -> u8 {
    // The product has the lanes' bits in its highest byte.
    (u64::from_le_bytes(lanes).wrapping_mul(0x0102_0408_1020_4080) >> (u64::BITS - 8)) as u8
}

/// The same of sixteen lanes.
#[inline(always)]
pub(crate) fn bits(lanes: &[u8; 16]) -> u16 {
    let [low, high] = [0, 1].map(|half| u16::from(bits_of_eight(lanes.as_chunks().0[half])));
    low | high << 8
}

/// Of pixel (x, y) of a tile, bit x of element y.
pub(crate) type Bits = [u16; TILE];

/// The same of a tile's pixels.
#[inline(always)]
pub(crate) fn rows_of_bits(pixels: &[u8; COUNT]) -> Bits {
    let mut rows = [0; TILE];
    for y in 0..TILE {
        rows[y] = bits(&pixels.as_chunks().0[y]);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lane_has_its_bit() {
        for expected in 0..=u16::MAX {
            let mut lanes = [0; 16];
            for (i, lane) in lanes.iter_mut().enumerate() {
                *lane = (expected >> i & 1) as u8;
            }
            assert_eq!(bits(&lanes), expected);
        }
    }
}
