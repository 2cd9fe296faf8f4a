//! Materials and their base colour textures.

use std::collections::HashMap;

use glam::{Mat3, Vec2, Vec3, Vec4};

use super::super::builder::Builder;
use super::super::error::{Fault, quoted};
use super::super::files::Files;
use super::super::images;
use super::Document;
use super::json::{Material as JsonMaterial, Root, TextureReference};
use crate::scene::{AlphaMode, Material, Texture, Wrap};

/// The index of a primitive's material in the scene: the last one is for primitives without.
pub(super) fn index(root: &Root, material: Option<usize>) -> u32 {
    material.unwrap_or(root.materials.len()) as u32
}

/// Where a textured primitive takes its texture coordinates from.
pub(super) struct TextureCoordinates {
    /// The n of TEXCOORD_n.
    pub(super) set: u32,
    /// KHR_texture_transform.
    pub(super) matrix: Mat3,
}

/// Of the base colour texture; `None` without one.
pub(super) fn coordinates(root: &Root, material: Option<usize>) -> Option<TextureCoordinates> {
    let reference = base_color(&root.materials[material?]).1?;
    let transform = reference.extensions.transform.as_ref();
    let set = transform.and_then(|t| t.tex_coord).unwrap_or(reference.tex_coord);
    let matrix = transform.map_or(Mat3::IDENTITY, |t| {
        let (sin, cos) = (-t.rotation.unwrap_or(0.0)).sin_cos();
        let (sin, cos) = (sin as f32, cos as f32);
        let scale = t.scale.map_or(Vec2::ONE, vec2);
        let offset = t.offset.map_or(Vec2::ZERO, vec2);
        Mat3::from_cols(
            Vec3::new(cos * scale.x, sin * scale.x, 0.0),
            Vec3::new(-sin * scale.y, cos * scale.y, 0.0),
            offset.extend(1.0),
        )
    });
    Some(TextureCoordinates { set, matrix })
}

/// The factor and the texture of the base colour.
fn base_color(material: &JsonMaterial) -> (Option<[f64; 4]>, Option<&TextureReference>) {
    if let Some(pbr) = &material.pbr_metallic_roughness {
        return (pbr.base_color_factor, pbr.base_color_texture.as_ref());
    }
    let diffuse = material.extensions.specular_glossiness.as_ref();
    diffuse.map_or((None, None), |d| (d.diffuse_factor, d.diffuse_texture.as_ref()))
}

/// Reads all materials, and one more for primitives without.
pub(super) fn read(
    document: &Document<'_>,
    files: &Files,
    builder: &mut Builder,
) -> Result<(), Fault> {
    let mut textures = HashMap::new();
    for json in &document.root.materials {
        let (factor, reference) = base_color(json);
        let texture = match reference {
            Some(reference) => match textures.get(&reference.index) {
                Some(&known) => known,
                None => {
                    let read = texture(document, reference.index, files, builder)?;
                    *textures.entry(reference.index).or_insert(read)
                }
            },
            None => None,
        };
        builder.scene.materials.push(material(json, factor, texture));
    }
    let plain = Material { double_sided: false, ..Material::default() };
    builder.scene.materials.push(plain);
    Ok(())
}

fn material(json: &JsonMaterial, factor: Option<[f64; 4]>, texture: Option<usize>) -> Material {
    let strength = json.extensions.emissive_strength.as_ref();
    let strength = strength.and_then(|e| e.emissive_strength).unwrap_or(1.0);
    let alpha_mode = match json.alpha_mode.as_deref() {
        Some("MASK") => AlphaMode::Mask(json.alpha_cutoff.unwrap_or(0.5) as f32),
        Some("BLEND") => AlphaMode::Blend,
        _ => AlphaMode::Opaque,
    };
    let color = factor.unwrap_or([1.0; 4]).map(|c| c.clamp(0.0, 1.0) as f32);
    let emissive = json.emissive_factor.unwrap_or([0.0; 3]);
    Material {
        name: json.name.clone().unwrap_or_default(),
        base_color: Vec4::from(color),
        texture,
        alpha_mode,
        double_sided: json.double_sided,
        // Bright enough for any picture, and far from infinity.
        emissive: Vec3::from(emissive.map(|e| (e * strength).clamp(0.0, 1e9) as f32)),
    }
}

/// Reads a texture. One whose picture cannot be used is left out with a warning.
fn texture(
    document: &Document<'_>,
    index: usize,
    files: &Files,
    builder: &mut Builder,
) -> Result<Option<usize>, Fault> {
    let json = &document.root.textures[index];
    let read = match json.source {
        Some(source) => picture(document, source, files, builder)?,
        None => Err("its picture is of a kind that is not supported".into()),
    };
    let picture = match read {
        Ok(picture) => picture,
        Err(why) => {
            builder.scene.warn(format!("textures[{index}] is left out: {why}"));
            return Ok(None);
        }
    };
    let sampler = json.sampler.map(|s| &document.root.samplers[s]);
    let wrap = |code| match code {
        Some(33_071) => Wrap::Clamp,
        Some(33_648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    builder.scene.textures.push(Texture {
        width: picture.width,
        height: picture.height,
        texels: picture.texels,
        wrap: [wrap(sampler.and_then(|s| s.wrap_s)), wrap(sampler.and_then(|s| s.wrap_t))],
        nearest: sampler.and_then(|s| s.mag_filter) == Some(9728),
    });
    Ok(Some(builder.scene.textures.len() - 1))
}

fn picture(
    document: &Document<'_>,
    index: usize,
    files: &Files,
    builder: &mut Builder,
) -> Result<Result<images::Picture, String>, Fault> {
    let image = &document.root.images[index];
    let from_file;
    let bytes = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => match files.read_uri(uri, &mut builder.budget) {
            Ok(bytes) => {
                from_file = bytes;
                from_file.as_slice()
            }
            Err(limit @ Fault::TooLarge(_)) => return Err(limit),
            Err(fault) => return Ok(Err(fault.to_string())),
        },
        (None, Some(view)) => document.buffers.view(&document.root, view)?,
        (None, None) => return Ok(Err(format!("images[{index}] has no data"))),
    };
    let named = |why| match &image.uri {
        Some(uri) if !uri.starts_with("data:") => format!("{}: {why}", quoted(uri)),
        _ => why,
    };
    Ok(images::decode(bytes, &mut builder.budget)?.map_err(named))
}

fn vec2(v: [f64; 2]) -> Vec2 {
    Vec2::new(v[0] as f32, v[1] as f32)
}
