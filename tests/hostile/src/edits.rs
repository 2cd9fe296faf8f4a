//! Sound JSON with a few values replaced reaches deeper than bytes, which rarely parse.

use std::sync::OnceLock;

use arbitrary::{Arbitrary, Unstructured};
use renderer::load::Format;
use serde_json::{Value, json};
use test_models::{Gltf, everything};

use crate::files::load;

#[derive(Arbitrary, Debug)]
enum Replacement {
    Removed,
    Null,
    Index(u8),
    Integer(u64),
    Negative(i32),
    Number(f32),
    Vector([f32; 3]),
    Matrix([f32; 16]),
    Indices(Vec<u8>),
    Component(u8),
    Word(u8),
    /// Another value of the file.
    Copy(u16),
}

#[derive(Arbitrary, Debug)]
struct Edits {
    values: Vec<(u16, Replacement)>,
    bytes: Vec<(u16, u8)>,
    text: bool,
}

const WORDS: [&str; 10] =
    ["SCALAR", "VEC2", "VEC3", "VEC4", "MASK", "BLEND", "spot", "directional", "TEXCOORD_1", "x"];

/// The sound file, and the JSON pointers of all of its values.
fn sound() -> &'static (Gltf, Vec<String>) {
    static SOUND: OnceLock<(Gltf, Vec<String>)> = OnceLock::new();
    SOUND.get_or_init(|| {
        let file = everything();
        let pointers = file.pointers();
        (file, pointers)
    })
}

pub fn gltf_edits(bytes: &[u8]) {
    let Ok(edits) = Edits::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    let (file, pointers) = sound();
    let mut file = file.clone();
    for (at, replacement) in edits.values.into_iter().take(8) {
        let pointer = &pointers[usize::from(at) % pointers.len()];
        let value = match replacement {
            Replacement::Removed => {
                remove(&mut file.json, pointer);
                continue;
            }
            Replacement::Null => Value::Null,
            Replacement::Index(i) => json!(i % 16),
            Replacement::Integer(i) => json!(i),
            Replacement::Negative(i) => json!(i),
            Replacement::Number(x) => json!(x),
            Replacement::Vector(v) => json!(v),
            Replacement::Matrix(m) => json!(m),
            Replacement::Indices(list) => json!(list),
            Replacement::Component(c) => json!(5120 + u32::from(c % 8)),
            Replacement::Word(w) => json!(WORDS[usize::from(w) % WORDS.len()]),
            Replacement::Copy(other) => {
                let other = &pointers[usize::from(other) % pointers.len()];
                file.json.pointer(other).cloned().unwrap_or_default()
            }
        };
        if let Some(place) = file.json.pointer_mut(pointer) {
            *place = value;
        }
    }
    for (at, byte) in edits.bytes {
        let at = usize::from(at) % file.binary.len();
        file.binary[at] = byte;
    }
    let text = edits.text && file.json.pointer("/buffers/0").is_some_and(Value::is_object);
    load(Format::Gltf, &if text { file.gltf() } else { file.glb() });
}

fn remove(json: &mut Value, pointer: &str) {
    let Some((parent, member)) = pointer.rsplit_once('/') else { return };
    match json.pointer_mut(parent) {
        Some(Value::Array(list)) => match member.parse() {
            Ok(i) if i < list.len() => drop(list.remove(i)),
            _ => {}
        },
        Some(Value::Object(members)) => drop(members.remove(member)),
        _ => {}
    }
}
