//! Sound files, broken at random and by rule: whatever comes out, nothing panics or hangs.

use glam::Vec3;
use renderer::load::{Format, Limits, load_bytes};
use serde_json::{Value, json};
use test_models::{OBJ, everything};

const LIMITS: Limits = Limits { max_triangles: 100_000, max_memory: 64 << 20 };

/// Loads; a scene that comes out must hold together.
fn survive(format: Format, bytes: &[u8]) {
    let Ok(scene) = load_bytes(format, bytes, &LIMITS) else { return };
    let mesh = &scene.mesh;
    let vertices = mesh.positions.len();
    assert!(!mesh.triangles.is_empty());
    for (triangle, &material) in mesh.triangles.iter().zip(&scene.triangle_materials) {
        for &i in triangle {
            assert!(mesh.positions[i as usize].is_finite());
            assert!(scene.normals.get(i as usize).is_none_or(|n| n.is_finite()));
        }
        let material = &scene.materials[material as usize];
        assert!(material.base_color.is_finite() && material.emissive.is_finite());
        assert!(material.texture.is_none_or(|t| t < scene.textures.len()));
    }
    assert_eq!(mesh.ids.len(), mesh.triangles.len());
    assert_eq!(scene.triangle_materials.len(), mesh.triangles.len());
    for length in [scene.normals.len(), scene.uvs.len(), scene.colors.len()] {
        assert!(length == 0 || length == vertices);
    }
    for light in &scene.lights {
        assert!(light.intensity.is_finite() && light.color.is_finite());
        assert!(light.light.center().is_none_or(Vec3::is_finite));
    }
    assert!(scene.camera.is_none_or(|c| c.eye.is_finite() && c.eye != c.target));
}

/// Random numbers (Knuth's MMIX), the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n
    }
}

/// Changes a few bytes, or cuts, or doubles a piece.
fn mutate(sound: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = sound.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len());
        match random.below(8) {
            0 => bytes.truncate(at + 1),
            1 => bytes[at] ^= 1 << random.below(8),
            2 => bytes[at] = [0, 1, 0x7f, 0x80, 0xff][random.below(5)],
            3 => bytes[at] = b"0123456789-.eE/ \n\\\"{}[],:"[random.below(25)],
            4 => {
                let end = (at + random.below(16)).min(bytes.len());
                bytes.drain(at..end);
            }
            5 => {
                let end = (at + random.below(64)).min(bytes.len());
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            6 => {
                let end = (at + 4).min(bytes.len());
                bytes[at..end].fill([0, 0xff][random.below(2)]);
            }
            _ => bytes[at] = random.below(256) as u8,
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

#[test]
fn random_bytes_of_gltf() {
    let mut random = Random(1);
    for sound in [everything().glb(), everything().gltf()] {
        for _ in 0..4000 {
            survive(Format::Gltf, &mutate(&sound, &mut random));
        }
        for length in 0..sound.len() {
            survive(Format::Gltf, &sound[..length]);
        }
    }
}

#[test]
fn random_bytes_of_obj() {
    let mut random = Random(2);
    for _ in 0..20_000 {
        survive(Format::Obj, &mutate(OBJ.as_bytes(), &mut random));
    }
}

/// Binary data only: positions, indices and sparse data of all kinds behind sound JSON.
#[test]
fn random_binary_data() {
    let mut random = Random(3);
    let sound = everything();
    for _ in 0..4000 {
        let mut file = sound.clone();
        for _ in 0..=random.below(12) {
            let at = random.below(file.binary.len());
            file.binary[at] = [0, 1, 0x7f, 0x80, 0xff, random.below(256) as u8][random.below(6)];
        }
        survive(Format::Gltf, &file.glb());
    }
}

/// Every value of the JSON replaced by every other kind of value, and left out.
#[test]
fn every_value_of_gltf() {
    let sound = everything();
    let replacements = [
        json!(null),
        json!(true),
        json!("x"),
        json!([]),
        json!({}),
        json!([[]]),
        json!(0),
        json!(1),
        json!(-1),
        json!(3),
        json!(255),
        json!(5121),
        json!(5126),
        json!(65_536),
        json!(1_u64 << 31),
        json!(1_u64 << 32),
        json!(u64::MAX),
        json!(0.5),
        json!(-0.0),
        json!(1e-310),
        json!(1e38),
        json!(1e300),
        json!([0, 0, 0]),
        json!([1e300, -1e300, 1e300]),
        json!([0, 0, 0, 0]),
        json!("VEC4"),
        json!("MASK"),
    ];
    let pointers = sound.pointers();
    assert!(pointers.len() > 200);
    for pointer in &pointers {
        for replacement in &replacements {
            let mut file = sound.clone();
            *file.at(pointer) = replacement.clone();
            survive(Format::Gltf, &file.glb());
        }
        let mut file = sound.clone();
        let (parent, member) = pointer.rsplit_once('/').unwrap();
        match file.at(parent) {
            Value::Array(list) => drop(list.remove(member.parse().unwrap())),
            Value::Object(members) => drop(members.remove(member)),
            _ => unreachable!(),
        }
        survive(Format::Gltf, &file.glb());
    }
}
