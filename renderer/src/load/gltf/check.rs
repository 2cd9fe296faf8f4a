//! Every index of the file refers to something, before anything is read through it.

use std::fmt::Display;

use super::super::error::{Fault, malformed, quoted};
use super::accessors::{Component, component_count};
use super::extensions;
use super::json::{Accessor, Material, Mesh, Root};

/// Elements of an accessor that has no data but what a sparse accessor replaces: a few bytes in
/// the file may ask for any number of them.
const MOST_IMPLIED: u64 = 1 << 22;

pub(super) fn check(root: &Root) -> Result<(), Fault> {
    check_version(root)?;
    extensions::check_required(root)?;
    for (i, view) in root.buffer_views.iter().enumerate() {
        let place = format!("bufferViews[{i}]");
        refers(&root.buffers, Some(view.buffer), &place, "buffer")?;
        let length = root.buffers[view.buffer].byte_length;
        if view.byte_offset.checked_add(view.byte_length).is_none_or(|end| end > length) {
            return Err(malformed(format!(
                "{place}: {} bytes at {} reach past the end of buffer {} ({length} bytes)",
                view.byte_length, view.byte_offset, view.buffer
            )));
        }
        if view.byte_stride.is_some_and(|stride| !(4..=252).contains(&stride)) {
            return Err(malformed(format!("{place}: the byteStride is not in 4..=252")));
        }
    }
    for (i, accessor) in root.accessors.iter().enumerate() {
        check_accessor(root, accessor, &format!("accessors[{i}]"))?;
    }
    for (i, mesh) in root.meshes.iter().enumerate() {
        check_mesh(root, mesh, i)?;
    }
    for (i, material) in root.materials.iter().enumerate() {
        check_material(root, material, &format!("materials[{i}]"))?;
    }
    for (i, texture) in root.textures.iter().enumerate() {
        let place = format!("textures[{i}]");
        refers(&root.samplers, texture.sampler, &place, "sampler")?;
        refers(&root.images, texture.source, &place, "source image")?;
    }
    for (i, image) in root.images.iter().enumerate() {
        refers(&root.buffer_views, image.buffer_view, &format!("images[{i}]"), "bufferView")?;
    }
    for (i, node) in root.nodes.iter().enumerate() {
        let place = format!("nodes[{i}]");
        refers(&root.meshes, node.mesh, &place, "mesh")?;
        refers(&root.cameras, node.camera, &place, "camera")?;
        let light = node.extensions.light.as_ref().map(|l| l.light);
        refers(root.lights(), light, &place, "light")?;
        node.children
            .iter()
            .try_for_each(|&n| refers(&root.nodes, Some(n), &place, "child node"))?;
    }
    for (i, scene) in root.scenes.iter().enumerate() {
        let place = format!("scenes[{i}]");
        scene.nodes.iter().try_for_each(|&n| refers(&root.nodes, Some(n), &place, "node"))?;
    }
    refers(&root.scenes, root.scene, "scene", "default scene")
}

fn check_version(root: &Root) -> Result<(), Fault> {
    let Some(asset) = &root.asset else {
        return Err(malformed("not glTF: the member \"asset\" is missing"));
    };
    let is_2 = |version: &str| version == "2" || version.starts_with("2.");
    // A later 2.x is drawn as far as it is 2.0, unless it says that it cannot be.
    if !is_2(&asset.version) || asset.min_version.as_ref().is_some_and(|v| v != "2.0") {
        let version = asset.min_version.as_ref().unwrap_or(&asset.version);
        return Err(Fault::Unsupported(format!("glTF version {}, not 2.0", quoted(version))));
    }
    Ok(())
}

fn refers<T>(
    list: &[T],
    index: Option<usize>,
    place: &(impl Display + ?Sized),
    what: &str,
) -> Result<(), Fault> {
    match index {
        Some(index) if index >= list.len() => Err(malformed(format!(
            "{place}: {what} {index} does not exist (the file has {})",
            list.len()
        ))),
        _ => Ok(()),
    }
}

fn check_accessor(root: &Root, accessor: &Accessor, place: &str) -> Result<(), Fault> {
    refers(&root.buffer_views, accessor.buffer_view, place, "bufferView")?;
    let Some(component) = Component::from_code(accessor.component_type) else {
        let code = accessor.component_type;
        return Err(malformed(format!("{place}: componentType {code} does not exist")));
    };
    let Some(components) = component_count(&accessor.kind) else {
        let kind = quoted(&accessor.kind);
        return Err(malformed(format!("{place}: type {kind} does not exist")));
    };
    let size = component.size() * components;
    if accessor.buffer_view.is_none() && accessor.count > MOST_IMPLIED {
        let count = accessor.count;
        return Err(Fault::TooLarge(format!("{place}: {count} elements and no data for them")));
    }
    if let Some(view) = accessor.buffer_view {
        let stride = root.buffer_views[view].byte_stride.unwrap_or(size);
        if stride < size {
            return Err(malformed(format!(
                "{place}: elements of {size} bytes overlap at the byteStride {stride}"
            )));
        }
        fits(root, view, accessor.byte_offset, stride, size, accessor.count, place)?;
    }
    if let Some(sparse) = &accessor.sparse {
        let place = &format!("{place}.sparse");
        if sparse.count > accessor.count {
            return Err(malformed(format!(
                "{place}: {} of {} elements are replaced",
                sparse.count, accessor.count
            )));
        }
        let (indices, values) = (&sparse.indices, &sparse.values);
        refers(&root.buffer_views, Some(indices.buffer_view), place, "bufferView")?;
        refers(&root.buffer_views, Some(values.buffer_view), place, "bufferView")?;
        let Some(index) = Component::from_code(indices.component_type).filter(|c| c.is_index())
        else {
            return Err(malformed(format!("{place}: the indices are not unsigned integers")));
        };
        let index = index.size();
        fits(root, indices.buffer_view, indices.byte_offset, index, index, sparse.count, place)?;
        fits(root, values.buffer_view, values.byte_offset, size, size, sparse.count, place)?;
    }
    Ok(())
}

/// An error unless `count` elements lie inside a buffer view.
fn fits(
    root: &Root,
    view: usize,
    offset: u64,
    stride: u64,
    size: u64,
    count: u64,
    place: &str,
) -> Result<(), Fault> {
    let length = root.buffer_views[view].byte_length;
    let end = match count.checked_sub(1) {
        Some(steps) => {
            stride.checked_mul(steps).and_then(|n| n.checked_add(size)?.checked_add(offset))
        }
        None => Some(0),
    };
    if end.is_none_or(|end| end > length) {
        return Err(malformed(format!(
            "{place}: {count} elements reach past the end of bufferView {view} ({length} bytes)"
        )));
    }
    Ok(())
}

fn check_mesh(root: &Root, mesh: &Mesh, index: usize) -> Result<(), Fault> {
    for (i, primitive) in mesh.primitives.iter().enumerate() {
        let place = &format!("meshes[{index}].primitives[{i}]");
        refers(&root.materials, primitive.material, place, "material")?;
        refers(&root.accessors, primitive.indices, &format!("{place}.indices"), "accessor")?;
        if let Some(mode) = primitive.mode.filter(|&m| m > 6) {
            return Err(malformed(format!("{place}: mode {mode} does not exist")));
        }
        let mut count = None;
        for (name, &accessor) in &primitive.attributes {
            let place = format!("{place}.{}", quoted(name));
            refers(&root.accessors, Some(accessor), &place, "accessor")?;
            let n = root.accessors[accessor].count;
            if *count.get_or_insert(n) != n {
                return Err(malformed(format!("{place}: attributes have different counts")));
            }
        }
        if let Some(indices) = primitive.indices {
            let accessor = &root.accessors[indices];
            let unsigned =
                Component::from_code(accessor.component_type).is_some_and(|c| c.is_index());
            if !unsigned || accessor.kind != "SCALAR" {
                return Err(malformed(format!("{place}: indices are not unsigned integers")));
            }
        }
    }
    Ok(())
}

fn check_material(root: &Root, material: &Material, place: &str) -> Result<(), Fault> {
    let base = material.pbr_metallic_roughness.as_ref();
    let diffuse = material.extensions.specular_glossiness.as_ref();
    let textures = [
        base.and_then(|m| m.base_color_texture.as_ref()),
        diffuse.and_then(|m| m.diffuse_texture.as_ref()),
    ];
    for texture in textures.into_iter().flatten() {
        refers(&root.textures, Some(texture.index), place, "texture")?;
    }
    match material.alpha_mode.as_deref() {
        None | Some("OPAQUE" | "MASK" | "BLEND") => Ok(()),
        Some(mode) => Err(malformed(format!("{place}: alphaMode {} does not exist", quoted(mode)))),
    }
}
