//! Meshes: from accessors to triangles in the space of their node.

use glam::{Mat3, Vec2, Vec3, Vec4};

use super::super::builder::{Builder, Part};
use super::super::error::{Fault, malformed};
use super::super::limits::Budget;
use super::Document;
use super::accessors::{Component, Elements};
use super::json::{Primitive, Root};
use super::materials::{self, TextureCoordinates};

const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

/// Position, normal, texture coordinates and colour.
const VERTEX_BYTES: u64 = 12 + 12 + 8 + 16;

/// How many triangles a mesh has, from its accessors' counts alone.
pub(super) fn count_triangles(root: &Root, mesh: usize) -> u64 {
    let primitives = root.meshes[mesh].primitives.iter();
    primitives.fold(0, |sum, p| sum.saturating_add(triangles_of(root, p)))
}

fn triangles_of(root: &Root, primitive: &Primitive) -> u64 {
    let accessor = primitive.indices.or(primitive.attributes.get("POSITION").copied());
    let corners = accessor.map_or(0, |a| root.accessors[a].count);
    match primitive.mode.unwrap_or(TRIANGLES) {
        TRIANGLES => corners / 3,
        STRIP | FAN => corners.saturating_sub(2),
        _ => 0,
    }
}

/// Renumbers the vertices that a primitive uses, so that each instance stores only those. Kept
/// between primitives: many may share one long array of vertices.
#[derive(Default)]
pub(super) struct Remap {
    /// The primitive that last used a vertex, and the number it got there.
    slots: Vec<(u32, u32)>,
    primitive: u32,
}

/// Reads the primitives of a mesh that have triangles, each with its index in the mesh.
pub(super) fn read_mesh(
    document: &Document<'_>,
    mesh: usize,
    remap: &mut Remap,
    builder: &mut Builder,
) -> Result<Vec<(usize, Part)>, Fault> {
    let primitives = document.root.meshes[mesh].primitives.iter().enumerate();
    let mut parts = Vec::new();
    for (i, primitive) in primitives {
        let place = format!("meshes[{mesh}].primitives[{i}]");
        let part = read_primitive(document, primitive, &place, remap, builder)?;
        if !part.triangles.is_empty() {
            parts.push((i, part));
        }
    }
    Ok(parts)
}

fn read_primitive(
    document: &Document<'_>,
    primitive: &Primitive,
    place: &str,
    remap: &mut Remap,
    builder: &mut Builder,
) -> Result<Part, Fault> {
    let mode = primitive.mode.unwrap_or(TRIANGLES);
    if mode < TRIANGLES {
        builder.scene.warn("points and lines are not drawn");
        return Ok(Part::default());
    }
    let Some(&position) = primitive.attributes.get("POSITION") else {
        builder.scene.warn("primitives without positions are not drawn");
        return Ok(Part::default());
    };
    let root = &document.root;
    if primitive.extensions.draco.is_some() && root.accessors[position].buffer_view.is_none() {
        return Err(Fault::Unsupported(format!(
            "{place}: its geometry is compressed with KHR_draco_mesh_compression"
        )));
    }
    let count = vertex_count(root, position, place)?;
    let triangles = triangles_of(root, primitive);
    builder.budget.memory(triangles * 12 + (3 * triangles).min(count.into()) * 4, place)?;
    let indices = primitive.indices;
    let indices = indices.map(|i| Elements::of(document, i, &mut builder.budget)).transpose()?;
    if mode == TRIANGLES && indices.as_ref().map_or(count as usize, Elements::count) % 3 != 0 {
        builder.scene.warn("corners that do not make up a whole triangle are not drawn");
    }
    let material = materials::index(root, primitive.material);
    let mut part = Part { material, ..Part::default() };
    let mut used = Vec::new();
    let mut numbering = remap.start(count as usize, &mut builder.budget)?;
    // The memory for them was granted.
    for i in 0..triangles as usize {
        let corners = match mode {
            STRIP => [i, i + 1 + i % 2, i + 2 - i % 2],
            FAN => [i + 1, i + 2, 0],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        };
        let mut triangle = [0; 3];
        for (number, corner) in triangle.iter_mut().zip(corners) {
            let vertex = vertex_at(indices.as_ref(), corner, count, place)?;
            *number = numbering.number(vertex, &mut used);
        }
        part.triangles.push(triangle);
    }
    builder.budget.memory(used.len() as u64 * VERTEX_BYTES, place)?;

    let positions = attribute(document, position, &["VEC3"], place, &mut builder.budget)?;
    let used = || used.iter().map(|&i| i as usize);
    part.positions = used().map(|i| Vec3::from(positions.floats(i))).collect();
    if let Some(&normals) = primitive.attributes.get("NORMAL") {
        let normals = attribute(document, normals, &["VEC3"], place, &mut builder.budget)?;
        part.normals = used().map(|i| Vec3::from(normals.floats(i))).collect();
    }
    if let Some(coordinates) = materials::coordinates(root, primitive.material) {
        let TextureCoordinates { set, matrix } = coordinates;
        match primitive.attributes.get(&format!("TEXCOORD_{set}")) {
            Some(&uvs) => {
                let uvs = attribute(document, uvs, &["VEC2"], place, &mut builder.budget)?;
                let placed = |uv: Vec2| Mat3::transform_point2(&matrix, uv);
                part.uvs = used().map(|i| placed(Vec2::from(uvs.floats(i)))).collect();
            }
            None => builder.scene.warn("a textured primitive has no texture coordinates"),
        }
    }
    if let Some(&colors) = primitive.attributes.get("COLOR_0") {
        let colors = attribute(document, colors, &["VEC3", "VEC4"], place, &mut builder.budget)?;
        let opaque = colors.components() == 3;
        let color = |i| {
            let color = Vec4::from(colors.floats(i));
            if opaque { color.with_w(1.0) } else { color }
        };
        part.colors = used().map(color).collect();
    }
    Ok(part)
}

fn vertex_count(root: &Root, position: usize, place: &str) -> Result<u32, Fault> {
    let count = root.accessors[position].count;
    u32::try_from(count)
        .map_err(|_| Fault::TooLarge(format!("{place} has {count} vertices, more than 2^32")))
}

/// The vertex at a corner: through the indices, or one after the other.
fn vertex_at(
    indices: Option<&Elements<'_>>,
    corner: usize,
    count: u32,
    place: &str,
) -> Result<u32, Fault> {
    let Some(indices) = indices else { return Ok(corner as u32) };
    let restart = match indices.component() {
        Component::U8 => u32::from(u8::MAX),
        Component::U16 => u32::from(u16::MAX),
        _ => u32::MAX,
    };
    let index = indices.index(corner);
    if index == restart {
        return Err(malformed(format!("{place}: index {index} is the primitive restart value")));
    }
    if index >= count {
        return Err(malformed(format!("{place}: index {index} of {count} vertices")));
    }
    Ok(index)
}

/// The elements of a vertex attribute, one of `types`.
fn attribute<'a>(
    document: &'a Document<'_>,
    accessor: usize,
    types: &[&str],
    place: &str,
    budget: &mut Budget,
) -> Result<Elements<'a>, Fault> {
    let kind = document.root.accessors[accessor].kind.as_str();
    let elements = Elements::of(document, accessor, budget)?;
    if !types.contains(&kind) || elements.component() == Component::U32 {
        return Err(malformed(format!(
            "{place}: accessors[{accessor}] is not of the type of its attribute"
        )));
    }
    Ok(elements)
}

impl Remap {
    /// Starts over for a primitive with `count` vertices.
    fn start(&mut self, count: usize, budget: &mut Budget) -> Result<Numbering<'_>, Fault> {
        if count > self.slots.len() {
            let more = (count - self.slots.len()) as u64;
            budget.memory(more * 8, "the vertices of a mesh")?;
            self.slots.resize(count, (0, 0));
        }
        self.primitive += 1;
        Ok(Numbering(self))
    }
}

/// The numbers of one primitive's vertices.
struct Numbering<'a>(&'a mut Remap);

impl Numbering<'_> {
    /// The number of a vertex; a new one is added to `used`.
    fn number(&mut self, vertex: u32, used: &mut Vec<u32>) -> u32 {
        let slot = &mut self.0.slots[vertex as usize];
        if slot.0 != self.0.primitive {
            *slot = (self.0.primitive, used.len() as u32);
            used.push(vertex);
        }
        slot.1
    }
}
