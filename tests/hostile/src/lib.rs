//! What no input may break.
//!
//! Each [`Check`] makes a case of any bytes whatsoever, runs it, and panics if a promise is broken:
//! no panic, no hang, nothing out of bounds, every visibility in \[0, 1\], the same bits at every
//! SIMD level, a NaN in a map never blocks. The fuzz targets run nothing else, and this crate's
//! tests run all checks on their seeds and on random bytes, with any compiler.
#![forbid(unsafe_code)]

mod any;
mod edits;
mod files;
mod frame;
mod intervals;
mod raster;
mod search;
mod shadow;
mod skins;

/// A promise, and how to try to break it.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// The name of the fuzz target.
    pub name: &'static str,
    /// Makes a case of the bytes and runs it.
    pub run: fn(&[u8]),
    /// Bytes to start from; empty where any bytes are as good.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All of them.
pub const CHECKS: [Check; 11] = [
    Check { name: "gltf", run: files::gltf, seeds: files::gltf_seeds },
    Check { name: "gltf_edits", run: edits::gltf_edits, seeds: random_seeds },
    Check { name: "obj", run: files::obj, seeds: files::obj_seeds },
    Check { name: "buffers", run: files::buffers, seeds: files::buffer_seeds },
    Check { name: "raster", run: raster::check, seeds: random_seeds },
    Check { name: "search", run: search::check, seeds: random_seeds },
    Check { name: "single_sample", run: shadow::check, seeds: random_seeds },
    Check { name: "skins", run: skins::check, seeds: random_seeds },
    Check { name: "intervals", run: intervals::check, seeds: random_seeds },
    Check { name: "frame", run: frame::check, seeds: random_seeds },
    Check { name: "foreign", run: files::foreign, seeds: random_seeds },
];

/// The check of that name.
///
/// # Panics
///
/// If there is none.
#[must_use]
pub fn named(name: &str) -> Check {
    CHECKS.into_iter().find(|check| check.name == name).expect("the name of a check")
}

/// Bytes for checks that make a case of any.
fn random_seeds() -> Vec<Vec<u8>> {
    let mut random = Random(1);
    (0..24).map(|i| random.bytes(32 << (i % 5))).collect()
}

/// Random numbers (Knuth's MMIX), the same in every run.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// From 0 to before `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n
    }

    /// So many bytes.
    pub fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.below(256) as u8).collect()
    }
}
