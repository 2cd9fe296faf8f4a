//! Broken files of our own making. Each ends in one line that says what is wrong, at once.

use std::time::{Duration, Instant};

use renderer::load::{Fault, Format, Limits, load, load_bytes};
use serde_json::{Value, json};
use test_models::{Gltf, OBJ, everything, glb};

/// What was done to a file, and what its error must say.
type Case = (&'static str, fn(&mut Gltf), &'static str);

fn set(file: &mut Gltf, pointer: &str, member: &str, value: impl Into<Value>) {
    file.at(pointer)[member] = value.into();
}

/// Breaks [`everything`]. Accessors: 0 position, 1 normal, 2 texture coordinates, 3 colour,
/// 4 indices, 5 strip, 6 sparse, 7 quantized.
#[rustfmt::skip]
const GLTF: &[Case] = &[
    ("no asset", |g| { g.json.as_object_mut().unwrap().remove("asset"); }, "asset"),
    ("asset without version", |g| g.json["asset"] = json!({}), "version"),
    ("version 1", |g| set(g, "/asset", "version", "1.0"), "\"1.0\""),
    ("version 3", |g| set(g, "/asset", "version", "3.0"), "\"3.0\""),
    ("later minimum", |g| set(g, "/asset", "minVersion", "2.1"), "\"2.1\""),
    ("required extension", |g| g.json["extensionsRequired"] = json!(["A_b", "C_d"]), "\"A_b\", \"C_d\""),
    ("control characters", |g| g.json["extensionsRequired"] = json!(["a\n\u{1b}[2J"]), "\\u{1b}"),
    ("nodes are an object", |g| g.json["nodes"] = json!({}), "JSON"),
    ("a node is a number", |g| g.json["nodes"][0] = 1.into(), "JSON"),
    ("negative index", |g| set(g, "/nodes/1", "mesh", -1), "JSON"),
    ("fractional index", |g| set(g, "/nodes/1", "mesh", 0.5), "JSON"),
    ("index of 2^32", |g| set(g, "/nodes/1", "mesh", 1_u64 << 32), "mesh 4294967296"),
    ("index of 2^64", |g| set(g, "/nodes/1", "mesh", 1.9e19), "JSON"),
    ("no such mesh", |g| set(g, "/nodes/1", "mesh", 4), "mesh 4"),
    ("no such camera", |g| set(g, "/nodes/9", "camera", 1), "camera 1"),
    ("no such light", |g| set(g, "/nodes/8/extensions/KHR_lights_punctual", "light", 3), "light 3"),
    ("no such child", |g| g.at("/nodes/0/children")[0] = 99.into(), "child node 99"),
    ("no such scene", |g| g.json["scene"] = 2.into(), "scene 2"),
    ("no such root", |g| g.at("/scenes/1/nodes")[0] = 11.into(), "node 11"),
    ("no such view", |g| set(g, "/accessors/0", "bufferView", 77), "bufferView 77"),
    ("no such buffer", |g| set(g, "/bufferViews/0", "buffer", 1), "buffer 1"),
    ("no such attribute", |g| set(g, "/meshes/0/primitives/0/attributes", "NORMAL", 50), "accessor 50"),
    ("no such indices", |g| set(g, "/meshes/0/primitives/0", "indices", 50), "accessor 50"),
    ("no such material", |g| set(g, "/meshes/0/primitives/0", "material", 1), "material 1"),
    ("no such texture", |g| set(g, "/materials/0/pbrMetallicRoughness/baseColorTexture", "index", 1), "texture 1"),
    ("no such image", |g| set(g, "/textures/0", "source", 1), "image 1"),
    ("no such sampler", |g| set(g, "/textures/0", "sampler", 1), "sampler 1"),
    ("no such image view", |g| set(g, "/images/0", "bufferView", 99), "bufferView 99"),
    ("no such mode", |g| set(g, "/meshes/0/primitives/0", "mode", 7), "mode 7"),
    ("no such alpha mode", |g| set(g, "/materials/0", "alphaMode", "GLASS"), "\"GLASS\""),
    ("no such component", |g| set(g, "/accessors/0", "componentType", 5124), "5124"),
    ("no such type", |g| set(g, "/accessors/0", "type", "VEC5"), "\"VEC5\""),
    ("own child", |g| g.at("/nodes/0/children")[0] = 0.into(), "ancestor"),
    ("loop of two", |g| { set(g, "/nodes/0", "children", json!([1])); set(g, "/nodes/1", "children", json!([0])); }, "ancestor"),
    ("two parents", |g| set(g, "/nodes/5", "children", json!([1])), "two parents"),
    ("child twice", |g| set(g, "/nodes/0", "children", json!([1, 1])), "two parents"),
    ("root twice", |g| set(g, "/scenes/1", "nodes", json!([0, 0])), "twice"),
    ("root and child", |g| set(g, "/scenes/1", "nodes", json!([0, 1])), "twice"),
    ("perspective matrix", |g| g.at("/nodes/2/matrix")[3] = 1.into(), "affine"),
    ("short matrix", |g| set(g, "/nodes/2", "matrix", json!([1, 0])), "JSON"),
    ("view past its buffer", |g| set(g, "/bufferViews/0", "byteLength", 1_000_000), "past the end"),
    ("view offset overflows", |g| set(g, "/bufferViews/0", "byteOffset", u64::MAX), "past the end"),
    ("stride 0", |g| set(g, "/bufferViews/0", "byteStride", 0), "byteStride"),
    ("stride 1000", |g| set(g, "/bufferViews/0", "byteStride", 1000), "byteStride"),
    ("stride below size", |g| set(g, "/bufferViews/0", "byteStride", 8), "overlap"),
    ("count past its view", |g| set(g, "/accessors/0", "count", 5), "past the end"),
    ("count overflows", |g| set(g, "/accessors/0", "count", u64::MAX), "past the end"),
    ("offset past its view", |g| set(g, "/accessors/1", "byteOffset", 13), "past the end"),
    ("offset overflows", |g| set(g, "/accessors/1", "byteOffset", u64::MAX - 8), "past the end"),
    ("counts differ", |g| set(g, "/accessors/2", "count", 3), "different counts"),
    ("positions of two numbers", |g| set(g, "/accessors/0", "type", "VEC2"), "type of its attribute"),
    ("positions of u32", |g| set(g, "/accessors/0", "componentType", 5125), "type of its attribute"),
    ("normals of four numbers", |g| set(g, "/meshes/0/primitives/0/attributes", "NORMAL", 3), "type of its attribute"),
    ("signed indices", |g| set(g, "/accessors/4", "componentType", 5122), "unsigned"),
    ("indices are vectors", |g| set(g, "/meshes/0/primitives/0", "indices", 0), "unsigned"),
    ("index out of range", |g| { let n = index_bytes(g); g.binary[n] = 4; }, "index 4 of 4"),
    ("restart index", |g| { let n = index_bytes(g); g.binary[n..n + 2].fill(255); }, "restart"),
    ("positions without data", |g| { g.at("/accessors/0").as_object_mut().unwrap().remove("bufferView"); }, "no data"),
    ("endless zeros", |g| set(g, "/accessors/6", "count", 1_u64 << 40), "no data for them"),
    ("more replaced than there are", |g| set(g, "/accessors/6", "count", 1), "2 of 1"),
    ("sparse index out of range", |g| set(g, "/accessors/6", "count", 2), "do not increase"),
    ("sparse indices not in order", |g| { let n = view_bytes(g, 6); g.binary.swap(n, n + 2); }, "do not increase"),
    ("sparse indices past their view", |g| set(g, "/accessors/6/sparse", "count", 3), "past the end"),
    ("sparse values past their view", |g| set(g, "/accessors/6/sparse/values", "byteOffset", 8), "past the end"),
    ("sparse indices are floats", |g| set(g, "/accessors/6/sparse/indices", "componentType", 5126), "unsigned"),
    ("sparse view", |g| set(g, "/accessors/6/sparse/values", "bufferView", 99), "bufferView 99"),
    ("buffer longer than the file", |g| set(g, "/buffers/0", "byteLength", 1_000_000_000_000_u64), "holds"),
    ("no second chunk", |g| g.json["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": 4 })), "buffers[1] has no data"),
    ("remote buffer", |g| set(g, "/buffers/0", "uri", "https://example.com/x.bin"), "folder"),
    ("data URI without comma", |g| set(g, "/buffers/0", "uri", "data:;base64"), "comma"),
    ("data URI not base64", |g| set(g, "/buffers/0", "uri", "data:;base64,????"), "base64"),
    ("positions all NaN", |g| positions(g, f32::NAN), "nothing to render"),
    ("positions all infinite", |g| positions(g, f32::INFINITY), "nothing to render"),
    ("everything in one point", |g| set(g, "/nodes/0", "scale", json!([0, 0, 0])), "nothing to render"),
    ("everything infinitely large", |g| set(g, "/nodes/0", "scale", json!([1e300, 1e300, 1e300])), "nothing to render"),
    ("an empty scene", |g| set(g, "/scenes/1", "nodes", json!([])), "nothing to render"),
    ("no primitives", |g| g.json["meshes"] = json!(vec![json!({}); 4]), "nothing to render"),
    ("a long string", |g| g.json["nodes"] = "\n".repeat(100_000).into(), "... at line 1"),
    ("huge picture", |g| picture(g, 60_000, 60_000), "60000 x 60000"),
    ("endless picture", |g| picture(g, u32::MAX >> 1, u32::MAX >> 1), "picture"),
];

/// Where a buffer view starts.
fn view_bytes(g: &Gltf, view: usize) -> usize {
    g.json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize
}

fn index_bytes(g: &Gltf) -> usize {
    view_bytes(g, g.json["accessors"][4]["bufferView"].as_u64().unwrap() as usize)
}

/// Shows the square only, with this in all of its positions.
fn positions(g: &mut Gltf, value: f32) {
    set(g, "/nodes/0", "children", json!([1]));
    let start = view_bytes(g, 0);
    for vertex in 0..4 {
        g.binary[start + vertex * 24..][..4].copy_from_slice(&value.to_le_bytes());
    }
}

/// Rewrites the header of the picture to this size.
fn picture(g: &mut Gltf, width: u32, height: u32) {
    let start = view_bytes(g, g.json["images"][0]["bufferView"].as_u64().unwrap() as usize);
    let header = &mut g.binary[start + 12..][..21];
    header[4..8].copy_from_slice(&width.to_be_bytes());
    header[8..12].copy_from_slice(&height.to_be_bytes());
    let crc = crc32(&header[..17]);
    header[17..].copy_from_slice(&crc.to_be_bytes());
}

/// As PNG has it.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| (c >> 1) ^ (0xedb8_8320 * (c & 1)))
    })
}

/// Whole files of glTF that are broken as bytes.
fn containers() -> Vec<(&'static str, Vec<u8>)> {
    let sound = everything().glb();
    let patched = |at: usize, with: &[u8]| {
        let mut bytes = sound.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        bytes
    };
    let deep = |open: &str| format!("{{\"asset\":{}", open.repeat(100_000)).into_bytes();
    vec![
        ("empty", Vec::new()),
        ("white space", b" \n ".to_vec()),
        ("not JSON", b"hello".to_vec()),
        ("a JSON array", b"[]".to_vec()),
        ("an empty object", b"{}".to_vec()),
        ("not UTF-8", b"{\"asset\":{\"version\":\"\xff\"}}".to_vec()),
        ("deep arrays", deep("[")),
        ("deep objects", deep("{\"a\":")),
        ("a repeated member", b"{\"nodes\":[],\"nodes\":[]}".to_vec()),
        ("only the magic", b"glTF".to_vec()),
        ("wrong version", patched(4, &[1])),
        ("cut off", sound[..sound.len() / 2].to_vec()),
        ("one byte short", sound[..sound.len() - 1].to_vec()),
        ("no length", patched(8, &[0; 4])),
        ("endless length", patched(8, &[255; 4])),
        ("endless chunk", patched(12, &[255; 4])),
        ("first chunk not JSON", patched(16, b"BIN\0")),
        ("JSON cut off", patched(12, &100_u32.to_le_bytes())),
        ("no binary chunk", glb(everything().json.to_string().as_bytes(), &[])),
    ]
}

/// Broken OBJ files and what their error must say.
const BROKEN_OBJ: &[(&str, &str)] = &[
    ("", "nothing to render"),
    ("hello\nworld\n", "nothing to render"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "nothing to render"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "nothing to render"),
    ("v 0 0 0\nf 1 1 1\n", "nothing to render"),
    ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "nothing to render"),
    ("v 1e39 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "nothing to render"),
    ("v 0 0\n", "line 1: v needs 3 numbers"),
    ("\nv 0 0 x\n", "line 2: \"x\" is not a number"),
    ("vn 0 0\n", "line 1: vn"),
    ("vt\n", "line 1: vt"),
    ("v 0 0 0\nf 1 2 1\n", "line 2: vertex 2"),
    ("v 0 0 0\nf 1 0 1\n", "line 2: vertex 0"),
    ("v 0 0 0\nf 1 -2 1\n", "line 2: vertex -2"),
    ("v 0 0 0\nf 1/1 1/1 1/1\n", "line 2: texture coordinate 1"),
    ("v 0 0 0\nf 1/-5 1/1 1/1\n", "line 2: texture coordinate -5"),
    ("v 0 0 0\nf 1//3 1 1\n", "line 2: normal 3"),
    ("v 0 0 0\nf 1/1/1/1 1 1\n", "line 2"),
    ("v 0 0 0\nf / 1 1\n", "line 2"),
    ("v 0 0 0\nf a 1 1\n", "line 2: \"a\""),
    ("v 0 0 0\nf 1.0 1 1\n", "line 2: \"1.0\""),
    ("v 0 0 0\nf 4294967296 1 1\n", "line 2: vertex 4294967296"),
    ("v 0 0 0\nf 99999999999999999999 1 1\n", "line 2"),
    ("v 0 0 0\nf -9223372036854775808 1 1\n", "line 2"),
    ("\0\0\0", "not text"),
];

fn check(name: &str, format: Format, bytes: &[u8], expected: &str) {
    let start = Instant::now();
    let error = match load_bytes(format, bytes, &Limits::default()) {
        Err(error) => error.to_string(),
        Ok(scene) => panic!("{name}: loaded {} triangles", scene.mesh.triangles.len()),
    };
    println!("{name}: {error}");
    assert!(error.contains(expected), "{name}: {error}");
    assert!(!error.is_empty() && !error.contains(char::is_control), "{name}: {error}");
    // Far from what any of them takes: what is meant is a hang.
    assert!(start.elapsed() < Duration::from_secs(20), "{name}");
}

#[test]
fn broken_gltf() {
    for (name, break_it, expected) in GLTF {
        let mut file = everything();
        break_it(&mut file);
        check(name, Format::Gltf, &file.glb(), expected);
    }
}

#[test]
fn broken_containers() {
    for (name, bytes) in containers() {
        check(name, Format::Gltf, &bytes, "");
    }
}

#[test]
fn broken_obj() {
    for (text, expected) in BROKEN_OBJ {
        check(&text.escape_debug().to_string(), Format::Obj, text.as_bytes(), expected);
    }
}

#[test]
fn there_are_more_than_sixty() {
    assert!(GLTF.len() + containers().len() + BROKEN_OBJ.len() > 60);
}

/// 30 levels, each node the child of the one before, twice: 2^30 instances if it were drawn.
#[test]
fn shared_nodes_do_not_multiply() {
    let mut file = everything();
    let nodes: Vec<Value> =
        (0..30).map(|i| json!({ "children": [i + 1, i + 1], "mesh": 0 })).collect();
    file.json["nodes"] = nodes.into();
    file.at("/nodes").as_array_mut().unwrap().push(json!({ "mesh": 0 }));
    file.json["scenes"] = json!([{ "nodes": [0] }]);
    file.json["scene"] = 0.into();
    check("shared nodes", Format::Gltf, &file.glb(), "two parents");
}

#[test]
fn instances_beyond_the_limit_are_not_drawn_first() {
    let mut file = everything();
    let nodes = vec![json!({ "mesh": 0 }); 100_000];
    let count = nodes.len();
    file.json["nodes"] = nodes.into();
    file.json["scenes"] = json!([{ "nodes": (0..count).collect::<Vec<_>>() }]);
    file.json["scene"] = 0.into();
    let limits = Limits { max_triangles: 150_000, ..Limits::default() };
    let error = load_bytes(Format::Gltf, &file.glb(), &limits).unwrap_err().to_string();
    assert!(error.contains("150000 triangles"), "{error}");
    assert_eq!(
        load_bytes(Format::Gltf, &file.glb(), &Limits::default()).unwrap().mesh.ids.len(),
        200_000
    );
}

/// Small files that would multiply: a long name per node, many empty primitives per node, many
/// missing materials and material files.
#[test]
fn nothing_multiplies() {
    let limits = Limits { max_memory: 256 << 20, ..Limits::default() };
    let many = 30_000;
    let mut file = everything();
    file.json["nodes"] = vec![json!({ "mesh": 0 }); many].into();
    file.json["scenes"] = json!([{ "nodes": (0..many).collect::<Vec<_>>() }]);
    file.json["scene"] = 0.into();
    let mut long = file.clone();
    set(&mut long, "/meshes/0", "name", "n".repeat(100_000));
    let error = load_bytes(Format::Gltf, &long.glb(), &limits).unwrap_err();
    assert!(matches!(error.fault, Fault::TooLarge(_)), "{error}");

    let primitives = file.at("/meshes/0/primitives").as_array_mut().unwrap();
    primitives.extend(vec![json!({ "attributes": {} }); many]);
    let start = Instant::now();
    let scene = load_bytes(Format::Gltf, &file.glb(), &limits).unwrap();
    assert_eq!(scene.mesh.triangles.len(), 2 * many);
    assert!(start.elapsed() < Duration::from_secs(20));

    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nmtllib none.mtl\n".to_owned();
    for i in 0..many {
        text += &format!("usemtl m{i}\nf 1 2 3\n");
    }
    let scene = load_bytes(Format::Obj, text.as_bytes(), &limits).unwrap();
    assert!(scene.warnings.len() < 60);
    let libraries: String = (0..many).map(|i| format!("mtllib {i}.mtl\n")).collect();
    let error = load_bytes(Format::Obj, libraries.as_bytes(), &limits).unwrap_err();
    assert!(error.to_string().contains("material files"), "{error}");
}

#[test]
fn a_chain_of_any_depth() {
    let mut file = everything();
    let depth = 200_000;
    let mut nodes: Vec<Value> = (1..=depth).map(|i| json!({ "children": [i] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    file.json["nodes"] = nodes.into();
    file.json["scenes"] = json!([{ "nodes": [0] }]);
    file.json["scene"] = 0.into();
    let scene = load_bytes(Format::Gltf, &file.glb(), &Limits::default()).unwrap();
    assert_eq!(scene.mesh.triangles.len(), 2);
}

#[test]
fn files_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("folder.glb")).unwrap();
    std::fs::write(at("scene.fbx"), OBJ).unwrap();
    std::fs::write(at("large.obj"), OBJ).unwrap();
    let small = Limits { max_memory: 10, ..Limits::default() };
    for (name, limits, expected) in [
        ("missing.glb", Limits::default(), "no such file"),
        ("folder.glb", Limits::default(), "not a file"),
        ("scene.fbx", Limits::default(), ".glb, .gltf or .obj"),
        ("none", Limits::default(), ".glb, .gltf or .obj"),
        ("large.obj", small, "memory"),
    ] {
        let error = load(&at(name), &limits).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(expected), "{error}");
    }
}
