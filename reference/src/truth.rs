//! Truth images, computed once and kept on disk.

use std::path::{Path, PathBuf};
use std::{env, fs, process};

use glam::Vec3;
use shadowmap_core::{Light, Mesh, Threads};

use crate::{Samples, Tracer};

/// Raised whenever the same scene would give other numbers.
const VERSION: u8 = 1;

/// [`Tracer::visibility`] of all receivers, read from the cache if it has been computed before.
///
/// The cache is the folder named by the environment variable `PENUMBRA_TRUTH`, by default
/// `target/truth` of the workspace: files of raw little-endian `f32`, named by a hash of the
/// mesh, the receivers, the light and the samples. A cache that cannot be read or written costs
/// time, nothing else.
///
/// # Panics
///
/// If `positions` and `normals` differ in length.
#[must_use]
pub fn cached(
    mesh: &Mesh<'_>,
    positions: &[Vec3],
    normals: &[Vec3],
    light: &Light,
    samples: Samples,
) -> Vec<f32> {
    let mut hash = Fnv::new();
    hash.write(&[VERSION]);
    hash.vectors(mesh.positions);
    mesh.triangles.iter().flatten().for_each(|index| hash.write(&index.to_le_bytes()));
    hash.vectors(positions);
    hash.vectors(normals);
    // Floats print as the shortest digits that give the same bits again.
    hash.write(format!("{light:?} {samples:?}").as_bytes());
    let file = folder().join(format!("{:032x}.f32", hash.0));
    if let Some(values) = read(&file, positions.len()) {
        return values;
    }
    let mut values = vec![0.0; positions.len()];
    let tracer = Tracer::new(mesh);
    tracer.visibility(light, positions, normals, samples, Threads::Pool, &mut values);
    // Written under another name first, so that nobody reads half a file.
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let draft = file.with_extension(format!("{}.draft", process::id()));
    let written = fs::create_dir_all(folder()).and_then(|()| fs::write(&draft, bytes));
    if written.and_then(|()| fs::rename(&draft, &file)).is_err() {
        let _ = fs::remove_file(&draft);
    }
    values
}

fn folder() -> PathBuf {
    env::var_os("PENUMBRA_TRUTH").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/truth"),
        PathBuf::from,
    )
}

fn read(file: &Path, count: usize) -> Option<Vec<f32>> {
    let bytes = fs::read(file).ok()?;
    let (values, rest) = bytes.as_chunks::<4>();
    (values.len() == count && rest.is_empty())
        .then(|| values.iter().map(|&value| f32::from_le_bytes(value)).collect())
}

/// The 128-bit hash of Fowler, Noll and Vo (FNV-1a), which stays what it is from release to
/// release.
struct Fnv(u128);

impl Fnv {
    fn new() -> Fnv {
        Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x0100_0000_0000_0000_013b);
        }
    }

    fn vectors(&mut self, vectors: &[Vec3]) {
        self.write(&vectors.len().to_le_bytes());
        for value in vectors.iter().flat_map(|v| v.to_array()) {
            self.write(&value.to_bits().to_le_bytes());
        }
    }
}
