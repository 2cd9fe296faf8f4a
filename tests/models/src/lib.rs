//! Sound scene files made in code, for tests to read and to break; and the way to public ones.
#![forbid(unsafe_code)]

mod outside;

pub use outside::{public_models, skipped};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// A glTF file in the making: its JSON and its one buffer.
#[derive(Clone, Debug)]
pub struct Gltf {
    /// The JSON.
    pub json: Value,
    /// The buffer.
    pub binary: Vec<u8>,
}

impl Gltf {
    /// As a `.glb` file.
    #[must_use]
    pub fn glb(&self) -> Vec<u8> {
        glb(self.json.to_string().as_bytes(), &self.binary)
    }

    /// As a `.gltf` file with a data URI.
    #[must_use]
    pub fn gltf(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        let data = STANDARD.encode(&self.binary);
        json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{data}").into();
        json.to_string().into_bytes()
    }

    /// The JSON pointers of all values.
    #[must_use]
    pub fn pointers(&self) -> Vec<String> {
        let mut pointers = Vec::new();
        collect(&self.json, String::new(), &mut pointers);
        pointers
    }

    /// The value at a JSON pointer.
    ///
    /// # Panics
    ///
    /// If there is none.
    pub fn at(&mut self, pointer: &str) -> &mut Value {
        self.json.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer} does not exist"))
    }

    /// Adds data to the buffer and a view of it; returns the view's index.
    fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        let offset = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        let mut view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.push("bufferViews", view)
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    fn accessor(&mut self, view: usize, component: u32, kind: &str, count: usize) -> usize {
        let value = json!({
            "bufferView": view, "componentType": component, "type": kind, "count": count,
        });
        self.push("accessors", value)
    }
}

/// A `.glb` file of a JSON chunk and a binary chunk.
#[must_use]
pub fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, data) in [(b"JSON", &json[..]), (b"BIN\0", binary)] {
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(data);
    }
    let length = bytes.len() as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

fn le<const N: usize>(numbers: &[[f32; N]]) -> Vec<u8> {
    numbers.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

fn le16(numbers: &[u16]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A PNG of 2 x 1 texels, white and half transparent red.
///
/// # Panics
///
/// Never: it fits into memory.
#[must_use]
pub fn png() -> Vec<u8> {
    let texels = vec![255, 255, 255, 255, 255, 0, 0, 128];
    let image = image::RgbaImage::from_raw(2, 1, texels).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A glTF file with one of everything: an indexed square (node 1, a child) with normals, texture
/// coordinates, colours and a texture; a strip and a fan of 2 triangles (node 2); a triangle with
/// a sparse corner (node 3); quantized positions (node 4); lights and a camera (nodes 5 to 9).
/// 2 + 4 + 1 + 1 = 8 triangles.
#[must_use]
pub fn everything() -> Gltf {
    let mut g = Gltf { json: json!({}), binary: Vec::new() };
    for list in ["bufferViews", "accessors", "meshes", "nodes", "materials", "textures", "images"] {
        g.json[list] = json!([]);
    }
    g.json["asset"] = json!({ "version": "2.0" });
    g.json["extensionsUsed"] =
        json!(["KHR_lights_punctual", "KHR_texture_transform", "KHR_mesh_quantization"]);
    g.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);

    let square = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
    // Position and normal in turns.
    let interleaved = square.map(|[x, y, z]| [x, y, z, 0., 0., 1.]);
    let view = g.view(&le(&interleaved), Some(24));
    let position = g.accessor(view, 5126, "VEC3", 4);
    let normal = g.accessor(view, 5126, "VEC3", 4);
    g.json["accessors"][normal]["byteOffset"] = 12.into();
    let view = g.view(&le(&square.map(|[x, y, _]| [x, y])), None);
    let uv = g.accessor(view, 5126, "VEC2", 4);
    let view = g.view(&[[255, 0, 128, 255]; 4].concat(), None);
    let color = g.accessor(view, 5121, "VEC4", 4);
    g.json["accessors"][color]["normalized"] = true.into();
    let view = g.view(&le16(&[0, 1, 2, 0, 2, 3]), None);
    let indices = g.accessor(view, 5123, "SCALAR", 6);
    let view = g.view(&png(), None);
    g.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    g.json["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }]);
    g.push("textures", json!({ "source": 0, "sampler": 0 }));
    g.push(
        "materials",
        json!({
            "name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
            "emissiveFactor": [0.5, 0.0, 0.0],
            "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } },
            "pbrMetallicRoughness": {
                "baseColorFactor": [1.0, 0.5, 0.25, 1.0],
                "baseColorTexture": { "index": 0, "extensions": { "KHR_texture_transform": {
                    "offset": [0.25, 0.0], "rotation": 0.0, "scale": [2.0, 1.0],
                } } },
            },
        }),
    );
    let attributes =
        json!({ "POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv, "COLOR_0": color });
    let primitive = json!({ "attributes": attributes, "indices": indices, "material": 0 });
    g.push("meshes", json!({ "name": "square", "primitives": [primitive] }));

    let plain = json!({ "POSITION": position });
    let view = g.view(&[0, 1, 3, 2], None);
    let strip = g.accessor(view, 5121, "SCALAR", 4);
    let primitives = json!([
        { "attributes": plain, "indices": strip, "mode": 5 },
        { "attributes": plain, "mode": 6 },
        { "attributes": plain, "mode": 0 },
    ]);
    g.push("meshes", json!({ "primitives": primitives }));

    let view = g.view(&le16(&[1, 2]), None);
    let values = g.view(&le(&[[3., 0., 0.], [0., 3., 0.]]), None);
    let sparse = json!({
        "componentType": 5126, "type": "VEC3", "count": 3,
        "sparse": {
            "count": 2,
            "indices": { "bufferView": view, "componentType": 5123 },
            "values": { "bufferView": values },
        },
    });
    let sparse = g.push("accessors", sparse);
    g.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": sparse } }] }));

    let quantized = le16(&[0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0]);
    let view = g.view(&quantized, Some(8));
    let quantized = g.accessor(view, 5123, "VEC3", 3);
    g.json["accessors"][quantized]["normalized"] = true.into();
    g.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": quantized } }] }));

    let light = |kind: &str| json!({ "type": kind, "color": [1.0, 0.5, 0.25], "intensity": 40.0 });
    let mut spot = light("spot");
    spot["spot"] = json!({ "innerConeAngle": 0.2, "outerConeAngle": 0.6 });
    let mut sun = light("directional");
    sun["extras"] = json!({ "angle": 0.01 });
    g.json["extensions"] = json!({
        "KHR_lights_punctual": { "lights": [light("point"), spot, sun] },
    });
    let lit = |light: usize| json!({ "KHR_lights_punctual": { "light": light } });
    g.json["cameras"] =
        json!([{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }]);
    g.json["nodes"] = json!([
        { "name": "root", "children": [1, 2, 3, 4], "scale": [2.0, 2.0, 2.0] },
        { "name": "child", "mesh": 0, "translation": [1.0, 0.0, 0.0] },
        { "mesh": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1] },
        { "mesh": 2, "rotation": [0.0, 0.0, 1.0, 1.0] },
        { "mesh": 3, "scale": [-1.0, 1.0, 1.0] },
        { "name": "bulb", "extensions": lit(0), "translation": [0.0, 5.0, 0.0], "extras": { "radius": 0.5 } },
        { "name": "tube", "extensions": lit(0), "translation": [0.0, 6.0, 0.0], "extras": { "length": 4.0 } },
        { "name": "panel", "extensions": lit(1), "extras": { "width": 2.0, "height": 1.0 } },
        { "name": "sun", "extensions": lit(2) },
        { "name": "eye", "camera": 0, "translation": [0.0, 0.0, 10.0] },
        { "name": "elsewhere", "mesh": 0 },
    ]);
    g.json["scenes"] = json!([{ "nodes": [10] }, { "nodes": [0, 5, 6, 7, 8, 9] }]);
    g.json["scene"] = 1.into();
    g
}

/// An OBJ file with one of everything; 1 + 2 + 3 + 1 = 7 triangles.
pub const OBJ: &str = "\
# a comment
mtllib colors.mtl
v 0 0 0
v 1 0 0 # another
v 1 1 0
v 0 1 \\
  0
v 0.5 0.25 0
vt 0 0
vt 1 0.5
vn 0 0 1
o first
usemtl red
f 1/1/1 2/2/1 3//1
g group
f 1 2 3 4
usemtl blue
f -5 -4 -3 -2 -1
o second
s off
f 1/1 2/2 3/1
l 1 2
p 1
";

/// The materials of [`OBJ`].
pub const MTL: &str = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nd 0.5\n";

/// The JSON pointers of all values inside `value`.
fn collect(value: &Value, pointer: String, pointers: &mut Vec<String>) {
    let mut visit = |member: &str, value: &Value| {
        let pointer = format!("{pointer}/{member}");
        pointers.push(pointer.clone());
        collect(value, pointer, pointers);
    };
    match value {
        Value::Array(list) => list.iter().enumerate().for_each(|(i, v)| visit(&i.to_string(), v)),
        Value::Object(members) => members.iter().for_each(|(k, v)| visit(k, v)),
        _ => {}
    }
}
