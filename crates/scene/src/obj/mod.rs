//! Wavefront OBJ and MTL.
//!
//! Faces become triangles (polygons as fans), one mesh for each group and material. Faces without normals are flat. Materials follow `material`;
//! what they cannot say in glTF's terms is on [`Scene::ignored`].

mod material;
mod scan;
#[cfg(test)]
mod tests;
mod texture;

use crate::gltf::{Folder, ResourceReader, tangents};
use crate::{Ignored, ImportLimits, Material, Mesh, Node, Scene, SceneError};
use glam::{Vec2, Vec3, Vec4};
use kajo_units::linear_from_srgb;
use std::cell::RefCell;
use std::io::{BufRead, Read};
use std::path::Path;
use std::sync::Arc;
use texture::Images;

/// Loads an OBJ file with the material libraries and textures it names, relative to itself.
///
/// # Errors
/// A missing file, a line that does not parse (with its number), an index out of range, a number that is not finite, a texture that cannot be
/// decoded. A missing material library or texture is no error: grey stands in, and [`Scene::ignored`] says so.
pub fn load_obj(path: &Path) -> Result<Scene, SceneError> {
    let file = path.display().to_string();
    let bytes = kajo_image::read_file(path).map_err(|source| SceneError::Read { file: file.clone(), source })?;
    let folder = Folder(path.parent().unwrap_or(Path::new("")).to_owned());
    parse_obj(&file, &bytes, &folder, ImportLimits::default())
}

/// [`load_obj`] of bytes in memory; `file` only names them in messages, `reader` hands out the files beside it.
///
/// # Errors
/// Those of [`load_obj`].
pub fn parse_obj(file: &str, bytes: &[u8], reader: &dyn ResourceReader, limits: ImportLimits) -> Result<Scene, SceneError> {
    let scan = scan::scan(file, bytes)?;
    let mut notes = Notes { file, list: scan.notes };
    let libraries = RefCell::new(Vec::new());
    let mut lines = Lines { rest: bytes, number: 0 };
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let parsed = tobj::load_obj_buf(&mut lines, &options, |name| {
        let (materials, note) = material_library(reader, name);
        libraries.borrow_mut().extend(note);
        Ok(materials)
    });
    let (models, materials) = parsed.map_err(|problem| SceneError::Syntax {
        file: file.into(),
        line: lines.number.max(1),
        column: 1,
        problem: format!("{problem}; indices are checked at the end of their group"),
    })?;
    for (name, consequence) in libraries.into_inner() {
        notes.add("", format!("mtllib {name}"), consequence);
    }

    let materials = materials.unwrap_or_default();
    for (name, line) in scan.materials.into_iter().filter(|(name, _)| !materials.iter().any(|m| m.name == *name)) {
        notes.add(format!("line {line}"), format!("usemtl {name}"), "no library has this material; grey stands in");
    }
    let mut images = Images::new(reader, limits);
    let mut scene = Scene { name: file.into(), ..Scene::default() };
    for material in materials {
        let converted = material::convert(&material, &mut scene, &mut images, &mut notes)?;
        scene.materials.push(converted);
    }
    let mut default_material = None;
    for model in models {
        if model.mesh.indices.is_empty() {
            continue;
        }
        let material = model.mesh.material_id.filter(|&id| id < scene.materials.len()).unwrap_or_else(|| {
            *default_material.get_or_insert_with(|| {
                scene.materials.push(material::default());
                scene.materials.len() - 1
            })
        });
        let mesh = mesh(file, model, material, &scene.materials[material], &mut notes)?;
        scene.nodes.push(Node { name: mesh.name.clone(), meshes: vec![scene.meshes.len()], ..Node::default() });
        scene.meshes.push(Arc::new(mesh));
    }
    if scene.meshes.is_empty() {
        return Err(SceneError::invalid(file, "file", "there are no faces in it; export triangles or polygons"));
    }
    scene.ignored = notes.list;
    Ok(scene)
}

/// What is ignored in one file.
struct Notes<'a> {
    file: &'a str,
    list: Vec<Ignored>,
}

impl Notes<'_> {
    fn add(&mut self, place: impl Into<String>, feature: impl Into<String>, consequence: impl Into<String>) {
        let note = Ignored { file: self.file.into(), place: place.into(), feature: feature.into(), consequence: consequence.into() };
        if !self.list.contains(&note) {
            self.list.push(note);
        }
    }
}

/// A name, and what its absence means for the picture.
type LibraryNote = (String, String);

/// The materials of one library, and what could not be had of it.
fn material_library(reader: &dyn ResourceReader, name: &Path) -> (Materials, Vec<LibraryNote>) {
    let label = name.display().to_string();
    let without = |reason: String| (Materials::default(), vec![(label.clone(), format!("{reason}; grey stands in"))]);
    let bytes = match reader.read(&portable(&label)) {
        Ok(bytes) => bytes,
        Err(error) => return without(format!("cannot be read ({error})")),
    };
    let (text, notes) = scan::library(&String::from_utf8_lossy(&bytes));
    let mut lines = Lines { rest: text.as_bytes(), number: 0 };
    match tobj::load_mtl_buf(&mut lines) {
        Ok(materials) => (materials, notes.into_iter().map(|note| (label.clone(), note)).collect()),
        Err(error) => without(format!("line {}: {error}", lines.number)),
    }
}

type Materials = (Vec<tobj::Material>, <tobj::MTLLoadResult as MapOf>::Map);

/// Names the map type of a parsed library, which `tobj` keeps to itself.
trait MapOf {
    type Map;
}

impl<A, M, E> MapOf for Result<(A, M), E> {
    type Map = M;
}

/// A path inside a file, which may be written with the separators of another system.
fn portable(name: &str) -> String {
    name.replace('\\', "/")
}

/// Reads from memory and counts lines, so that errors can name theirs.
struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = buffer.len().min(self.rest.len());
        buffer[..n].copy_from_slice(&self.rest[..n]);
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, n: usize) {
        self.number += self.rest[..n].iter().filter(|&&byte| byte == b'\n').count();
        self.rest = &self.rest[n..];
    }
}

fn mesh(file: &str, model: tobj::Model, material_index: usize, material: &Material, notes: &mut Notes) -> Result<Mesh, SceneError> {
    let place = format!("group \"{}\"", model.name);
    let source = model.mesh;
    let vertices = source.positions.len() / 3;
    for (what, list) in [("position", &source.positions), ("normal", &source.normals), ("texture coordinate", &source.texcoords)] {
        if let Some(value) = list.iter().find(|v| !v.is_finite()) {
            return Err(SceneError::invalid(file, place, format!("a {what} has the value {value}; every number must be finite")));
        }
    }
    let triples = |list: &[f32]| list.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    let mut mesh = Mesh {
        name: model.name,
        positions: triples(&source.positions),
        indices: source.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        material: material_index,
        ..Mesh::default()
    };
    if source.texcoords.len() == 2 * vertices {
        // OBJ counts v upwards.
        mesh.uvs[0] = source.texcoords.chunks_exact(2).map(|uv| Vec2::new(uv[0], 1.0 - uv[1])).collect();
    } else if !source.texcoords.is_empty() {
        notes.add(&place, "vt", "some faces have texture coordinates and some have none: all of the group's are ignored");
    }
    if source.vertex_color.len() == 3 * vertices {
        mesh.colors = triples(&source.vertex_color)
            .into_iter()
            .map(|c| c.map(|v| if v.is_finite() { linear_from_srgb(v.clamp(0.0, 1.0)) } else { 1.0 }).extend(1.0))
            .collect::<Vec<Vec4>>();
    }
    if source.normals.len() == 3 * vertices && vertices > 0 {
        mesh.normals = triples(&source.normals).into_iter().map(Vec3::normalize_or_zero).collect();
        if mesh.normals.contains(&Vec3::ZERO) {
            notes.add(&place, "vn", "a normal of length 0: all normals of the group are ignored, its faces are flat");
            mesh.normals.clear();
        }
    } else if !source.normals.is_empty() {
        notes.add(&place, "vn", "some faces have normals and some have none: all of the group's are ignored, its faces are flat");
    }
    if mesh.normals.is_empty() {
        let corners: Vec<u32> = mesh.indices.iter().flatten().copied().collect();
        let faces = mesh.indices.len() as u32;
        mesh = mesh.gather(&corners);
        mesh.indices = (0..faces).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        mesh.make_faceted_normals();
    }
    if material.normal_texture.is_some() && !mesh.uvs[0].is_empty() {
        tangents::generate(&mut mesh, 0);
    }
    Ok(mesh)
}
