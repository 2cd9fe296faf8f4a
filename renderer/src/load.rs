//! Scene files: glTF 2.0 (`.glb`, `.gltf`) and Wavefront OBJ (`.obj` with `.mtl`).
//!
//! Files may come from strangers. Every size, offset, count, stride, index and matrix is checked
//! before it is used and before memory is taken for it; nothing outside the file's own folder is
//! opened and nothing remote; whatever goes wrong is a [`LoadError`] of one line. What a file has
//! beyond the shapes, looks, lights and cameras that are drawn (animations, skins, unknown
//! optional extensions) is left out with a warning in [`Scene::warnings`].
//!
//! The JSON of glTF is read with `serde_json` into types of our own, and OBJ line by line. The
//! crates `gltf` and `tobj` were tried first. `gltf` wraps indices past 2^32, refuses files over
//! animations nobody draws, and its accessor iterators panic on data that lies outside a buffer;
//! `tobj` panics on `f 1/-5 ...` and on `Kd 0.5`, and cannot say in which line a fault lies.
//!
//! Object IDs: one per mesh node of a glTF scene, or one per primitive where the scene has a
//! single mesh node; one per `o` or `g` of an OBJ file. What shares an ID is one object, whose
//! parts cast no outer penumbra on each other.
//!
//! Triangles with a corner that is not finite, or farther than 1e18 m from the origin, are
//! dropped with a warning.

mod builder;
mod error;
mod files;
mod gltf;
mod images;
mod limits;
mod obj;

use std::path::Path;

pub use error::{Fault, LoadError};
pub use limits::Limits;

use crate::scene::Scene;
use files::Files;
use limits::Budget;

/// The kinds of scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// glTF 2.0, binary or text.
    Gltf,
    /// Wavefront OBJ.
    Obj,
}

impl Format {
    /// By the ending of the file's name, in any case; `None` for all but `.glb`, `.gltf`, `.obj`.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "glb" | "gltf" => Some(Self::Gltf),
            "obj" => Some(Self::Obj),
            _ => None,
        }
    }
}

/// Loads a scene file.
///
/// # Errors
///
/// When the file or one that it needs cannot be read, is malformed, needs an extension that is
/// not supported, exceeds a limit, or has nothing to render. Missing or broken pictures and
/// material files are warnings.
pub fn load(path: &Path, limits: &Limits) -> Result<Scene, LoadError> {
    let fail = |fault| LoadError { path: path.to_owned(), fault };
    let Some(format) = Format::from_path(path) else {
        let endings = "the name of a scene file ends in .glb, .gltf or .obj";
        return Err(fail(Fault::Malformed(endings.into())));
    };
    let mut budget = Budget::new(limits);
    let bytes = files::read_regular(path, &mut budget, "the file").map_err(fail)?;
    let mut scene = read(format, &bytes, &Files::beside(path), budget).map_err(fail)?;
    scene.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(scene)
}

/// Loads a scene from the bytes of a file. References to other files are refused.
///
/// # Errors
///
/// As [`load`]; the path of the error is empty.
pub fn load_bytes(format: Format, bytes: &[u8], limits: &Limits) -> Result<Scene, LoadError> {
    let fail = |fault| LoadError { path: "".into(), fault };
    read(format, bytes, &Files::none(), Budget::new(limits)).map_err(fail)
}

fn read(format: Format, bytes: &[u8], files: &Files, budget: Budget) -> Result<Scene, Fault> {
    match format {
        Format::Gltf => gltf::read(bytes, files, budget),
        Format::Obj => obj::read(bytes, files, budget),
    }
}
