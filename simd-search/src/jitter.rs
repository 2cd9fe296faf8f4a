//! Texel centres moved by a hash of their coordinates.

/// By how much the centre of texel (x, y) is moved: each part within `amplitude` / 2 of 0.
#[inline(always)]
pub(crate) fn jitter(x: u32, y: u32, amplitude: f32) -> [f32; 2] {
    if amplitude == 0.0 {
        return [0.0; 2];
    }
    let hash = mix(x ^ mix(y));
    [hash & 0xffff, hash >> 16].map(|half| amplitude * ((half as f32 - 32767.5) / 65536.0))
}

/// The 32-bit finalizer of MurmurHash3: every input bit flips every output bit with probability
/// close to one half.
#[inline(always)]
fn mix(mut h: u32) -> u32 {
    h ^= h >> 16;
    h = h.wrapping_mul(0x85eb_ca6b);
    h ^= h >> 13;
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^ (h >> 16)
}
