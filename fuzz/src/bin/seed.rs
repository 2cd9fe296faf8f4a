//! Starts the corpora with files that the tests make.

use std::fs;
use std::io::Result;
use std::path::Path;

#[allow(dead_code)] // The tests use more of it.
#[path = "../../../renderer/tests/load/generate.rs"]
mod generate;

fn main() -> Result<()> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let folder = corpus.join(target);
        fs::create_dir_all(&folder)?;
        fs::write(folder.join(name), bytes)
    };
    let file = generate::everything();
    write("gltf", "everything.glb", &file.glb())?;
    write("gltf", "everything.gltf", &file.gltf())?;
    write("obj", "everything.obj", generate::OBJ.as_bytes())?;
    // The parts alone, which are short.
    for node in 1..5 {
        let mut part = file.clone();
        *part.at("/nodes/0/children") = serde_json::json!([node]);
        write("gltf", &format!("node{node}.glb"), &part.glb())?;
    }
    Ok(())
}
