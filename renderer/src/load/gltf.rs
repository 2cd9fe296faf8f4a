//! glTF 2.0.

mod accessors;
mod buffers;
mod check;
mod container;
mod extensions;
mod json;
mod lights;
mod materials;
mod nodes;
mod primitives;

use super::builder::{Builder, Part};
use super::error::{Fault, malformed};
use super::files::Files;
use super::limits::Budget;
use crate::scene::Scene;
use buffers::Buffers;
use json::Root;
use nodes::Placed;
use primitives::Remap;

/// A checked file: every index refers to something, and every accessor lies inside its buffer.
struct Document<'a> {
    root: Root,
    buffers: Buffers<'a>,
}

pub(super) fn read(bytes: &[u8], files: &Files, mut budget: Budget) -> Result<Scene, Fault> {
    let container = container::split(bytes)?;
    let root = parse(container.json, &mut budget)?;
    check::check(&root)?;
    let buffers = Buffers::load(&root, container.binary, files, &mut budget)?;
    let document = Document { root, buffers };

    let mut builder = Builder::new(budget);
    extensions::warn_of_ignored(&document.root, &mut builder.scene);
    materials::read(&document, files, &mut builder)?;
    let placed = nodes::place(&document.root)?;
    lights::read(&document.root, &placed, &mut builder.scene);
    draw(&document, &placed, &mut builder)?;
    if builder.scene.mesh.triangles.is_empty() {
        explain_nothing(&document, &mut builder)?;
    }
    builder.finish()
}

fn parse(json: &[u8], budget: &mut Budget) -> Result<Root, Fault> {
    // The least JSON per byte of memory that it takes: an empty object or array element.
    let structure: u64 = json
        .iter()
        .map(|b| match b {
            b'{' => 512,
            b'[' | b',' => 64,
            _ => 0,
        })
        .sum();
    budget.memory(json.len() as u64 + structure, "the JSON of the file")?;
    serde_json::from_slice(json).map_err(|e| {
        // What is said of a long string holds the string.
        let (text, line, column) = (e.to_string(), e.line(), e.column());
        if text.chars().count() < 200 {
            return malformed(format!("malformed JSON: {text}"));
        }
        let text: String = text.chars().take(120).collect();
        malformed(format!("malformed JSON: {text}... at line {line} column {column}"))
    })
}

/// Places every mesh of every node.
fn draw(document: &Document, placed: &[Placed], builder: &mut Builder) -> Result<(), Fault> {
    let root = &document.root;
    let nodes = || placed.iter().filter_map(|p| Some((p, root.nodes[p.node].mesh?)));
    let triangles: Vec<u64> =
        (0..root.meshes.len()).map(|mesh| primitives::count_triangles(root, mesh)).collect();
    let mut uses = vec![0_usize; root.meshes.len()];
    for (_, mesh) in nodes() {
        uses[mesh] += 1;
        // Refuse what is too large before any of it is read.
        builder.budget.triangles(triangles[mesh])?;
    }
    let one_node = nodes().nth(1).is_none();

    let mut read: Vec<Option<Vec<(usize, Part)>>> = root.meshes.iter().map(|_| None).collect();
    let mut remap = Remap::default();
    for (Placed { node, world }, mesh) in nodes() {
        let parts = match read[mesh].take() {
            Some(parts) => parts,
            None => primitives::read_mesh(document, mesh, &mut remap, builder)?,
        };
        let name = root.node_name(*node);
        let id = if one_node { None } else { Some(builder.object(name.clone())?) };
        for (primitive, part) in &parts {
            let id = match id {
                Some(id) => id,
                None => {
                    let primitives = root.meshes[mesh].primitives.len();
                    builder.object(part_name(&name, *primitive, primitives))?
                }
            };
            builder.place(part, world, id)?;
        }
        uses[mesh] -= 1;
        if uses[mesh] > 0 {
            read[mesh] = Some(parts);
        }
    }
    Ok(())
}

fn part_name(node: &str, primitive: usize, primitives: usize) -> String {
    if primitives == 1 { node.to_owned() } else { format!("{node}/{primitive}") }
}

/// Says why nothing was drawn, where the reason is a fault in a mesh that no node shows.
fn explain_nothing(document: &Document, builder: &mut Builder) -> Result<(), Fault> {
    let mut remap = Remap::default();
    for mesh in 0..document.root.meshes.len() {
        builder.budget.triangles(primitives::count_triangles(&document.root, mesh))?;
        primitives::read_mesh(document, mesh, &mut remap, builder)?;
    }
    Ok(())
}
