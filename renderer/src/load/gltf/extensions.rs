//! What the file needs beyond glTF 2.0, and what of it is not drawn.

use super::super::error::{Fault, quoted};
use super::json::Root;
use crate::scene::Scene;

/// Extensions that are drawn.
const DRAWN: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Extensions that change the look of a surface only. Files that require them are drawn without.
fn changes_look_only(extension: &str) -> bool {
    extension.starts_with("KHR_materials_")
}

/// An error when the file requires what is not there.
pub(super) fn check_required(root: &Root) -> Result<(), Fault> {
    let missing: Vec<String> = root
        .extensions_required
        .iter()
        .filter(|name| !DRAWN.contains(&name.as_str()) && !changes_look_only(name))
        .take(8)
        .map(|name| quoted(name))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(Fault::Unsupported(format!(
        "the file requires {} not supported: {}",
        if missing.len() == 1 { "an extension that is" } else { "extensions that are" },
        missing.join(", ")
    )))
}

/// Warns once of every kind of thing that is left out.
pub(super) fn warn_of_ignored(root: &Root, scene: &mut Scene) {
    // Compressed data is an error where no uncompressed data stands beside it; instances have a
    // warning of their own.
    let silent = [
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "KHR_draco_mesh_compression",
        "KHR_meshopt_compression",
    ];
    let ignored: Vec<String> = root
        .extensions_used
        .iter()
        .filter(|name| !DRAWN.contains(&name.as_str()) && !silent.contains(&name.as_str()))
        .take(8)
        .map(|name| quoted(name))
        .collect();
    if !ignored.is_empty() {
        scene.warn(format!("extensions that are not supported: {}", ignored.join(", ")));
    }
    if root.nodes.iter().any(|n| n.extensions.instancing.is_some()) {
        scene.warn("instances of EXT_mesh_gpu_instancing are drawn once, at their node");
    }
    if !root.animations.is_empty() {
        scene.warn("animations are not played");
    }
    if root.nodes.iter().any(|n| n.skin.is_some()) {
        scene.warn("skins are not applied: skinned meshes stand in their bind pose");
    }
    if root.meshes.iter().flat_map(|m| &m.primitives).any(|p| p.targets.is_some()) {
        scene.warn("morph targets are not applied");
    }
}
