//! Wavefront OBJ: polygons, texture coordinates, normals, and materials of `.mtl` files.

mod mtl;
mod polygon;
mod smooth;
mod text;

use std::collections::HashMap;

use glam::{DMat4, Vec2, Vec3};

use super::builder::{Builder, Part};
use super::error::{Fault, malformed, quoted};
use super::files::Files;
use super::images;
use super::limits::Budget;
use crate::scene::{Material, Scene, Texture, Wrap};
use polygon::Triangulator;
use text::{Line, lines, number, words};

/// Material files that are read for one model.
const MOST_LIBRARIES: u32 = 256;

/// No index.
const NONE: u32 = u32::MAX;

/// A corner of a face: indices from 0 into positions, texture coordinates and normals.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Corner {
    position: u32,
    uv: u32,
    normal: u32,
}

/// A face: its corners follow those of the face before.
struct Face {
    end: usize,
    line: usize,
    object: u32,
    material: u32,
    smooth: bool,
}

/// The statements of a file.
#[derive(Default)]
struct Obj {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    corners: Vec<Corner>,
    faces: Vec<Face>,
    objects: Vec<String>,
    /// Materials by the order of their first use.
    materials: Vec<String>,
    libraries: Vec<String>,
}

pub(super) fn read(bytes: &[u8], files: &Files, mut budget: Budget) -> Result<Scene, Fault> {
    if bytes.contains(&0) {
        return Err(malformed("not an OBJ file: it is not text"));
    }
    // Bytes that are not UTF-8 appear in names only; each takes three as a replacement.
    budget.memory(bytes.len() as u64 * 3, "the text of the file")?;
    let text = String::from_utf8_lossy(bytes);
    let mut builder = Builder::new(budget);
    let obj = parse(&text, &mut builder)?;
    read_materials(&obj, files, &mut builder)?;
    draw(&obj, &mut builder)?;
    builder.finish()
}

/// Names and the index each got when it was first met.
#[derive(Default)]
struct Numbers(HashMap<String, u32>);

impl Numbers {
    fn get(&mut self, name: &str, names: &mut Vec<String>) -> u32 {
        let next = names.len() as u32;
        *self.0.entry(name.to_owned()).or_insert_with(|| {
            names.push(name.to_owned());
            next
        })
    }
}

fn parse(text: &str, builder: &mut Builder) -> Result<Obj, Fault> {
    let mut obj = Obj::default();
    let [mut objects, mut materials, mut libraries] = [(); 3].map(|()| Numbers::default());
    let (mut object, mut group) = ("", "");
    // The number of the object that these two name, once it has a face.
    let mut current = None;
    let mut material = materials.get("", &mut obj.materials);
    let mut smooth = true;
    for Line { number, keyword, rest } in lines(text) {
        let at = |what: String| malformed(format!("line {number}: {what}"));
        match keyword {
            "v" => {
                builder.budget.memory(12, "the vertices")?;
                obj.positions.push(Vec3::from(floats(rest, keyword).map_err(at)?));
            }
            "vn" => {
                builder.budget.memory(12, "the normals")?;
                obj.normals.push(Vec3::from(floats(rest, keyword).map_err(at)?));
            }
            "vt" => {
                builder.budget.memory(8, "the texture coordinates")?;
                let [u] = floats(rest, keyword).map_err(at)?;
                let v = words(rest).nth(1).and_then(text::number).unwrap_or(0.0);
                // OBJ counts v upwards.
                obj.uvs.push(Vec2::new(u, 1.0 - v));
            }
            "f" => {
                let before = obj.corners.len();
                for word in words(rest) {
                    builder.budget.memory(12, "the faces")?;
                    let corner = corner(&obj, word).map_err(at)?;
                    obj.corners.push(corner);
                }
                let corners = obj.corners.len() - before;
                if corners < 3 {
                    obj.corners.truncate(before);
                    builder.scene.warn("faces with fewer than three corners are not drawn");
                    continue;
                }
                builder.budget.triangles(corners as u64 - 2)?;
                builder.budget.memory(32, "the faces")?;
                let object = match current {
                    Some(known) => known,
                    None => {
                        let name = [object, group].join(if group.is_empty() { "" } else { "/" });
                        builder.budget.memory(name.len() as u64 * 2, "the names of objects")?;
                        *current.insert(objects.get(&name, &mut obj.objects))
                    }
                };
                let end = obj.corners.len();
                obj.faces.push(Face { end, line: number, object, material, smooth });
            }
            "o" => (object, group, current) = (rest, "", None),
            "g" => (group, current) = (rest, None),
            "s" => smooth = !matches!(rest, "off" | "0"),
            "usemtl" => material = materials.get(rest, &mut obj.materials),
            "mtllib" => {
                let library = libraries.get(rest, &mut obj.libraries);
                if library >= MOST_LIBRARIES {
                    let text = format!("the file names more than {MOST_LIBRARIES} material files");
                    return Err(Fault::TooLarge(text));
                }
            }
            "p" | "l" => builder.scene.warn("points and lines are not drawn"),
            "curv" | "curv2" | "surf" => builder.scene.warn("curves and surfaces are not drawn"),
            _ => {}
        }
    }
    Ok(obj)
}

/// The first `N` numbers of a statement.
fn floats<const N: usize>(rest: &str, keyword: &str) -> Result<[f32; N], String> {
    let mut numbers = [0.0; N];
    let mut words = words(rest);
    for value in &mut numbers {
        let Some(word) = words.next() else {
            return Err(format!("{keyword} needs {N} numbers"));
        };
        *value = number(word).ok_or_else(|| format!("{} is not a number", quoted(word)))?;
    }
    Ok(numbers)
}

/// `position`, `position/uv`, `position//normal` or `position/uv/normal`, each from 1, or
/// negative from the latest.
fn corner(obj: &Obj, word: &str) -> Result<Corner, String> {
    let mut parts = word.split('/');
    let mut part = |defined: usize, what: &str| match parts.next() {
        None | Some("") => Ok(NONE),
        Some(text) => {
            let index: i64 =
                text.parse().map_err(|_| format!("{} is not a corner of a face", quoted(word)))?;
            let from_zero = if index < 0 { index + defined as i64 } else { index - 1 };
            // Positive indices may run ahead of the file; they are checked when it is read.
            u32::try_from(from_zero)
                .ok()
                .filter(|&i| i != NONE)
                .ok_or_else(|| format!("{what} {index} does not exist"))
        }
    };
    let corner = Corner {
        position: part(obj.positions.len(), "vertex")?,
        uv: part(obj.uvs.len(), "texture coordinate")?,
        normal: part(obj.normals.len(), "normal")?,
    };
    if corner.position == NONE || parts.next().is_some() {
        return Err(format!("{} is not a corner of a face", quoted(word)));
    }
    Ok(corner)
}

/// The materials in the order of `obj.materials`.
fn read_materials(obj: &Obj, files: &Files, builder: &mut Builder) -> Result<(), Fault> {
    let mut found = HashMap::new();
    for name in &obj.libraries {
        match files.read_named(&name.replace('\\', "/"), &mut builder.budget) {
            Ok(bytes) => {
                for material in mtl::read(&String::from_utf8_lossy(&bytes)) {
                    found.insert(material.material.name.clone(), material);
                }
            }
            Err(limit @ Fault::TooLarge(_)) => return Err(limit),
            Err(fault) => builder.scene.warn(format!("materials are left out: {fault}")),
        }
    }
    let mut textures: HashMap<String, Option<usize>> = HashMap::new();
    for name in &obj.materials {
        let Some(read) = found.get(name) else {
            if !name.is_empty() && !obj.libraries.is_empty() {
                builder.scene.warn(format!("the material {} does not exist", quoted(name)));
            }
            builder.scene.materials.push(Material { name: name.clone(), ..Material::default() });
            continue;
        };
        let mut material = read.material.clone();
        if let Some(file) = &read.texture {
            material.texture = match textures.get(file) {
                Some(&known) => known,
                None => {
                    let texture = read_texture(file, files, builder)?;
                    *textures.entry(file.clone()).or_insert(texture)
                }
            };
        }
        builder.scene.materials.push(material);
    }
    Ok(())
}

/// Reads a texture. One that cannot be used is left out with a warning.
fn read_texture(file: &str, files: &Files, builder: &mut Builder) -> Result<Option<usize>, Fault> {
    let read = match files.read_named(file, &mut builder.budget) {
        Ok(bytes) => images::decode(&bytes, &mut builder.budget)?,
        Err(limit @ Fault::TooLarge(_)) => return Err(limit),
        Err(fault) => Err(fault.to_string()),
    };
    match read {
        Ok(images::Picture { width, height, texels }) => {
            let wrap = [Wrap::Repeat; 2];
            builder.scene.textures.push(Texture { width, height, texels, wrap, nearest: false });
            Ok(Some(builder.scene.textures.len() - 1))
        }
        Err(why) => {
            builder.scene.warn(format!("the texture {} is left out: {why}", quoted(file)));
            Ok(None)
        }
    }
}

/// Cuts the faces into triangles, one part per object and material.
fn draw(obj: &Obj, builder: &mut Builder) -> Result<(), Fault> {
    check_indices(obj)?;
    let smooth_normals = smooth::normals(obj, &mut builder.budget)?;
    let mut triangulator = Triangulator::default();
    let mut cut = Vec::new();
    let mut parts: Vec<((u32, u32), Part)> = Vec::new();
    let mut part_of = HashMap::new();
    let mut vertices: HashMap<(usize, Corner, [u32; 3]), u32> = HashMap::new();
    let mut start = 0;
    for face in &obj.faces {
        let corners = &obj.corners[start..face.end];
        let positions: Vec<_> =
            corners.iter().map(|c| obj.positions[c.position as usize].as_dvec3()).collect();
        cut.clear();
        triangulator.cut(&positions, &mut cut)?;

        let key = (face.object, face.material);
        let index = *part_of.entry(key).or_insert_with(|| {
            let material = face.material;
            parts.push((key, Part { material, ..Part::default() }));
            parts.len() - 1
        });
        let part = &mut parts[index].1;
        let textured = builder.scene.materials[face.material as usize].texture.is_some();
        let mut numbers = Vec::with_capacity(corners.len());
        for (i, corner) in corners.iter().enumerate() {
            let normal = match corner.normal {
                NONE => smooth_normals[start + i],
                n => obj.normals[n as usize].normalize_or_zero(),
            };
            let uv = if textured { corner.uv } else { NONE };
            let corner = Corner { uv, ..*corner };
            let vertex = (index, corner, normal.to_array().map(f32::to_bits));
            let next = part.positions.len() as u32;
            let number = *vertices.entry(vertex).or_insert(next);
            if number == next {
                // The map takes about as much again as the vertex itself.
                builder.budget.memory(32 + 80, "the vertices")?;
                part.positions.push(obj.positions[corner.position as usize]);
                part.normals.push(normal);
                if textured {
                    let uv = obj.uvs.get(corner.uv as usize).copied();
                    part.uvs.push(uv.unwrap_or_default());
                }
            }
            numbers.push(number);
        }
        builder.budget.memory(cut.len() as u64 * 12, "the triangles")?;
        part.triangles.extend(cut.iter().map(|t| t.map(|i| numbers[i])));
        start = face.end;
    }
    drop(vertices);
    let mut ids = vec![None; obj.objects.len()];
    for ((object, _), part) in &parts {
        let id = match ids[*object as usize] {
            Some(id) => id,
            None => *ids[*object as usize]
                .insert(builder.object(obj.objects[*object as usize].clone())?),
        };
        builder.place(part, &DMat4::IDENTITY, id)?;
    }
    Ok(())
}

fn check_indices(obj: &Obj) -> Result<(), Fault> {
    if obj.corners.len() >= NONE as usize {
        return Err(Fault::TooLarge("the faces have more than 2^32 corners".into()));
    }
    let mut start = 0;
    for face in &obj.faces {
        for corner in &obj.corners[start..face.end] {
            for (index, defined, what) in [
                (corner.position, obj.positions.len(), "vertex"),
                (corner.uv, obj.uvs.len(), "texture coordinate"),
                (corner.normal, obj.normals.len(), "normal"),
            ] {
                if index != NONE && index as usize >= defined {
                    let (line, index) = (face.line, u64::from(index) + 1);
                    return Err(malformed(format!(
                        "line {line}: {what} {index} does not exist (the file has {defined})"
                    )));
                }
            }
        }
        start = face.end;
    }
    Ok(())
}
