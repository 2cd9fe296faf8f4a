//! Files of any bytes. What is read must hold together.

use std::path::Path;

use renderer::Error;
use renderer::load::{Format, Limits, load_bytes};
use renderer::mask::buffer::{Buffer, Kind};
use renderer::picture::{self, Display, Picture, Values, floats};
use renderer::scene::Scene;
use shadowmap_core::{DepthConvention, ForeignDepth};
use test_models::{OBJ, everything, png};

use crate::any::Bytes;

/// Small, so that a file that asks for more is told so at once.
const LIMITS: Limits = Limits { max_triangles: 100_000, max_memory: 64 << 20 };

pub fn gltf(bytes: &[u8]) {
    load(Format::Gltf, bytes);
}

pub fn gltf_seeds() -> Vec<Vec<u8>> {
    let file = everything();
    // The whole, and its parts alone, which are short.
    let parts = (1..5).map(|node| {
        let mut part = file.clone();
        *part.at("/nodes/0/children") = serde_json::json!([node]);
        part.glb()
    });
    [file.glb(), file.gltf()].into_iter().chain(parts).collect()
}

pub fn obj(bytes: &[u8]) {
    load(Format::Obj, bytes);
}

pub fn obj_seeds() -> Vec<Vec<u8>> {
    vec![OBJ.as_bytes().to_vec()]
}

pub fn load(format: Format, bytes: &[u8]) {
    match load_bytes(format, bytes, &LIMITS) {
        Ok(scene) => check_scene(scene),
        Err(error) => check_line(&error.to_string()),
    }
}

fn check_line(line: &str) {
    assert!(!line.is_empty() && !line.contains(char::is_control), "{line:?}");
}

fn check_scene(mut scene: Scene) {
    let mesh = &scene.mesh;
    assert!(!mesh.triangles.is_empty());
    for &i in mesh.triangles.iter().flatten() {
        assert!(mesh.positions[i as usize].is_finite());
        assert!(scene.normals.get(i as usize).is_none_or(|n| n.is_finite()));
    }
    assert_eq!(mesh.ids.len(), mesh.triangles.len());
    assert!(mesh.ids.iter().all(|&id| (1..=scene.object_names.len()).contains(&(id as usize))));
    assert_eq!(scene.triangle_materials.len(), mesh.triangles.len());
    assert!(scene.triangle_materials.iter().all(|&m| (m as usize) < scene.materials.len()));
    for length in [scene.normals.len(), scene.uvs.len(), scene.colors.len()] {
        assert!(length == 0 || length == mesh.positions.len());
    }
    for material in &scene.materials {
        assert!(material.base_color.is_finite() && material.emissive.is_finite());
        assert!(material.texture.is_none_or(|t| t < scene.textures.len()));
    }
    for texture in &scene.textures {
        assert_eq!(texture.texels.len(), texture.width as usize * texture.height as usize);
    }
    for light in &scene.lights {
        assert!(light.intensity.is_finite() && light.color.is_finite());
        assert!(light.light.center().is_none_or(|c| c.is_finite()));
    }
    assert!(scene.camera.is_none_or(|c| c.eye.is_finite() && c.eye != c.target));
    // Fitting and grounding hold up too.
    scene.fit();
    scene.add_ground();
}

/// The kinds of buffers, by the first byte of a case.
const KINDS: [&str; 4] = ["x.npy", "x.png", "x.pfm", "x.exr"];

/// Depth buffers and pictures: a byte for the kind, one for the channels, and the file.
pub fn buffers(bytes: &[u8]) {
    let [kind, channels, file @ ..] = bytes else { return };
    let path = Path::new(KINDS[usize::from(*kind) % KINDS.len()]);
    let channels = usize::from(*channels) % 5;
    let buffer = Buffer::decode(Kind::of(path).expect("a kind"), file.to_vec(), channels, 1 << 20);
    match buffer {
        Ok(mut buffer) => {
            buffer.bottom_up = *kind > 127;
            let width = buffer.width as usize * channels;
            for y in 0..buffer.height {
                buffer.ids(y, &mut vec![0; width]);
                buffer.floats(y, &mut vec![0.0; width]);
            }
        }
        Err(why) => check_line(&Error::new(why).to_string()),
    }
    if let Ok(format) = picture::Format::of(path) {
        match picture::decode(format, file, 1 << 20) {
            Ok(picture) => {
                let pixels = picture.width as usize * picture.height as usize;
                assert_eq!(picture.to_floats().len(), pixels * picture.channels);
                let (bytes, channels) = picture.to_bytes();
                assert_eq!(bytes.len(), pixels * channels);
            }
            Err(why) => check_line(&Error::new(why).to_string()),
        }
    }
}

pub fn buffer_seeds() -> Vec<Vec<u8>> {
    let with = |kind: u8, channels: u8, file: Vec<u8>| [vec![kind, channels], file].concat();
    let npy = |kind: &str, shape: &str, data: usize| {
        let header =
            format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.bytes());
        file.extend((0..data).map(|i| i as u8));
        file
    };
    let mut seeds = vec![
        with(0, 1, npy("<f4", "2, 3", 24)),
        with(0, 1, npy(">f8", "2, 1", 16)),
        with(0, 3, npy("<u2", "1, 2, 3", 12)),
        with(0, 1, npy("|u1", "3, 3", 9)),
        with(1, 1, png()),
    ];
    let grey = Picture { width: 2, height: 2, channels: 1, values: Values::Bytes(vec![9; 4]) };
    seeds.extend(grey.encode(picture::Format::Png).map(|file| with(1, 1, file)));
    for channels in [1, 3] {
        let values = (0..4 * channels).map(|i| i as f32).collect();
        let picture = floats([2, 2], channels, values, Display::Unit);
        for (kind, format) in [(2, picture::Format::Pfm), (3, picture::Format::Exr)] {
            seeds.extend(picture.encode(format).map(|file| with(kind, channels as u8, file)));
        }
    }
    seeds
}

/// Depth of other renderers: any matrix, any convention, any value.
pub fn foreign(bytes: &[u8]) {
    let bytes = &mut Bytes::new(bytes);
    let conventions = [
        DepthConvention::Linear,
        DepthConvention::Distance,
        DepthConvention::OpenGl,
        DepthConvention::ZeroToOne,
        DepthConvention::ReversedZ,
    ];
    let convention = conventions[usize::from(bytes.byte()) % conventions.len()];
    let [width, height] = bytes.size(64);
    let Some(depth) = ForeignDepth::new(bytes.matrix(), convention, width, height) else { return };
    for _ in 0..8 {
        let nearness = depth.nearness(bytes.number(), bytes.number(), bytes.number());
        assert!(nearness >= 0.0 && nearness.is_finite(), "{nearness}");
    }
}
