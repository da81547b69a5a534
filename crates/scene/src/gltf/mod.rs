//! glTF 2.0 import: `.gltf` with its files or embedded data, and `.glb`.    \[glTF2]
//!
//! The file is read in layers: the container (`glb`), the JSON as it stands (`json`), bytes (`resources`, `meshopt`), typed arrays
//! (`accessor`), and from those the parts of a [`Scene`]. Whatever the bytes are, the answer is a scene or one sentence that says what is
//! wrong where; what is left out of a scene is on its list of ignored things (`notes`).

mod accessor;
mod animation;
mod extensions;
mod glb;
mod json;
mod material;
mod mesh;
mod meshopt;
mod node;
mod notes;
mod resources;
pub(crate) mod tangents;
mod texture;
mod uri;

pub use resources::{Folder, NoResources, ResourceReader};

use crate::limits::{Budget, ImportLimits};
use crate::{Material, Mesh, Node, Scene, SceneError};
use animation::AnimatedNode;
use json::Document;
use mesh::MaterialNeeds;
use notes::Notes;
use rayon::prelude::*;
use resources::{Resources, label};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use texture::Textures;

/// Loads a `.gltf` or `.glb` file.
///
/// # Errors
/// [`SceneError`] when the file or one that it refers to cannot be read, breaks the rules of glTF, or requires what Kajo does not do.
pub fn load_gltf(path: &Path) -> Result<Scene, SceneError> {
    let file = path.display().to_string();
    let bytes = kajo_image::read_file(path).map_err(|source| SceneError::Read { file: file.clone(), source })?;
    let folder = Folder(path.parent().unwrap_or(Path::new("")).to_owned());
    load_gltf_bytes(&file, &bytes, &folder, ImportLimits::default())
}

/// Loads the bytes of a `.gltf` or `.glb` file. `file` is its name in messages; `reader` hands out the files beside it.
///
/// # Errors
/// As [`load_gltf`].
pub fn load_gltf_bytes(file: &str, bytes: &[u8], reader: &dyn ResourceReader, limits: ImportLimits) -> Result<Scene, SceneError> {
    let (text, binary_chunk) = glb::split(file, bytes)?;
    let document = parse(file, text)?;
    extensions::check_required(file, &document)?;
    let budget = Budget::new(limits);
    let resources = Resources::new(file, &document, binary_chunk, reader, &budget);
    import(&resources)
}

/// The JSON of a glTF 2 file.
fn parse(file: &str, text: &[u8]) -> Result<Document, SceneError> {
    let syntax = |error: serde_json::Error| {
        let message = error.to_string();
        let problem = message.rsplit_once(" at line ").map_or(message.as_str(), |(problem, _)| problem).to_owned();
        SceneError::Syntax { file: file.into(), line: error.line(), column: error.column(), problem }
    };
    let probe: json::Probe = serde_json::from_slice(text).map_err(syntax)?;
    let version = probe.asset.min_version.as_deref().unwrap_or(&probe.asset.version);
    if !(version == "2.0" || probe.asset.min_version.is_none() && version.starts_with("2.")) {
        return Err(SceneError::Unsupported {
            file: file.into(),
            feature: format!("glTF {}", uri::short(version)),
            advice: "convert it to glTF 2.0".into(),
        });
    }
    serde_json::from_slice(text).map_err(syntax)
}

fn import(resources: &Resources<'_>) -> Result<Scene, SceneError> {
    let document = resources.document;
    let mut notes = Notes::new(resources.file);
    notes.unknown_extensions("", document.extensions.other.keys());
    let mut scene = Scene { name: resources.file.into(), ..Scene::default() };
    let visible = import_nodes(resources, &mut notes, &mut scene)?;
    let meshes_of = import_meshes(resources, &mut notes, &mut scene, &visible)?;

    for index in 0..document.skins.len() {
        scene.skins.push(animation::read_skin(resources, index)?);
    }
    place_meshes(resources, &mut notes, &mut scene, &visible, &meshes_of)?;
    let animated: Vec<AnimatedNode> = document
        .nodes
        .iter()
        .map(|node| AnimatedNode {
            has_matrix: node.matrix.is_some(),
            morph_targets: node
                .mesh
                .and_then(|mesh| document.meshes[mesh].primitives.first())
                .map_or(0, |primitive| primitive.targets.len()),
        })
        .collect();
    for index in 0..document.animations.len() {
        scene.animations.push(animation::read_animation(resources, &mut notes, index, &animated)?);
    }
    extensions::note_unused(document, &mut notes);
    scene.ignored = notes.finish();
    Ok(scene)
}

/// All nodes, at their indices in the file, with the cameras and lights of the visible ones; returns which are visible.
fn import_nodes(resources: &Resources<'_>, notes: &mut Notes, scene: &mut Scene) -> Result<Vec<bool>, SceneError> {
    let nodes = &resources.document.nodes;
    let parents = node::parents(resources)?;
    let visible = node::visible(resources, &parents, notes)?;
    for (index, json) in nodes.iter().enumerate() {
        let place = label("node", index, &json.name);
        if let Some(mesh) = json.mesh {
            resources.get(&resources.document.meshes, "mesh", mesh, &place)?;
        }
        if let Some(skin) = json.skin {
            resources.get(&resources.document.skins, "skin", skin, &place)?;
        }
        let mut node = Node {
            name: json.name.clone(),
            parent: parents[index],
            transform: node::transform(resources, index)?,
            morph_weights: json.weights.iter().map(|weight| weight.0).collect(),
            ..Node::default()
        };
        if visible[index] {
            notes.unknown_extensions(&place, json.extensions.other.keys());
            if let Some(camera) = json.camera {
                node.camera = Some(scene.cameras.len());
                scene.cameras.push(node::camera(resources, notes, camera, &json.name)?);
            }
            if let Some(light) = &json.extensions.light {
                node.light = Some(scene.lights.len());
                scene.lights.push(node::light(resources, notes, light.light, &json.name)?);
            }
        }
        scene.nodes.push(node);
    }
    Ok(visible)
}

/// The meshes of visible nodes with their materials, textures and images; returns the scene's meshes of each mesh of the file.
fn import_meshes(
    resources: &Resources<'_>,
    notes: &mut Notes,
    scene: &mut Scene,
    visible: &[bool],
) -> Result<BTreeMap<usize, Vec<usize>>, SceneError> {
    let document = resources.document;
    let shown = document.nodes.iter().zip(visible).filter(|&(_, &visible)| visible);
    let mut meshes_of: BTreeMap<usize, Vec<usize>> = shown.filter_map(|(node, _)| node.mesh).map(|mesh| (mesh, Vec::new())).collect();

    let mut textures = Textures::new(resources);
    let mut needs_of: BTreeMap<Option<usize>, MaterialNeeds> = BTreeMap::new();
    let used = meshes_of.keys().flat_map(|&mesh| document.meshes[mesh].primitives.iter().map(move |primitive| (mesh, primitive.material)));
    let mut used: Vec<(usize, Option<usize>)> = used.collect();
    used.sort_unstable_by_key(|&(mesh, material)| (material.is_none(), material, mesh));
    for (mesh, material) in used {
        if needs_of.contains_key(&material) {
            continue;
        }
        let index = scene.materials.len();
        let (read, needs) = match material {
            None => (Material::default(), material::default_needs(index)),
            Some(material) => {
                resources.get(&document.materials, "material", material, &label("mesh", mesh, &document.meshes[mesh].name))?;
                material::read(resources, &mut textures, notes, material, index)?
            }
        };
        scene.materials.push(read);
        needs_of.insert(material, needs);
    }
    (scene.textures, scene.images) = textures.finish(notes)?;

    let mut meshes: Vec<(Mesh, Option<usize>)> = Vec::new();
    for (&mesh, indices) in &mut meshes_of {
        let json = &document.meshes[mesh];
        notes.unknown_extensions(&label("mesh", mesh, &json.name), json.extensions.keys());
        for (number, primitive) in json.primitives.iter().enumerate() {
            let needs = &needs_of[&primitive.material];
            if let Some(mesh) = mesh::read_primitive(resources, notes, mesh, number, needs)? {
                indices.push(meshes.len());
                meshes.push((mesh, needs.tangent_uvs));
            }
        }
    }
    meshes.par_iter_mut().for_each(|(mesh, tangent_uvs)| {
        if let Some(slot) = tangent_uvs.filter(|&slot| mesh.tangents.is_empty() && !mesh.uvs[slot].is_empty()) {
            tangents::generate(mesh, slot);
        }
    });
    scene.meshes = meshes.into_iter().map(|(mesh, _)| Arc::new(mesh)).collect();
    Ok(meshes_of)
}

/// Puts meshes and skins on the visible nodes; instanced ones on new nodes below them.
fn place_meshes(
    resources: &Resources<'_>,
    notes: &mut Notes,
    scene: &mut Scene,
    visible: &[bool],
    meshes_of: &BTreeMap<usize, Vec<usize>>,
) -> Result<(), SceneError> {
    for (index, json) in resources.document.nodes.iter().enumerate().filter(|&(index, _)| visible[index]) {
        let Some(mesh) = json.mesh else { continue };
        let meshes = meshes_of[&mesh].clone();
        let place = label("node", index, &json.name);
        if let Some(skin) = json.skin {
            check_joints(resources, scene, &meshes, skin, &place)?;
            if meshes.iter().all(|&mesh| scene.meshes[mesh].skin_weights.is_empty()) {
                notes.add(&place, "a skin on a mesh without joints", "the mesh does not deform");
            } else {
                scene.nodes[index].skin = Some(skin);
            }
        }
        let bytes = (size_of::<Node>() + size_of_val(&meshes[..])) as u64;
        resources.budget.claim(resources.file, &place, 1, bytes)?;
        match &json.extensions.instancing {
            None => scene.nodes[index].meshes = meshes,
            Some(instancing) => {
                for (number, transform) in node::instances(resources, index, instancing, bytes, notes)?.into_iter().enumerate() {
                    scene.nodes.push(Node {
                        name: format!("{}[{number}]", json.name),
                        parent: Some(index),
                        transform,
                        meshes: meshes.clone(),
                        morph_weights: scene.nodes[index].morph_weights.clone(),
                        ..Node::default()
                    });
                }
            }
        }
    }
    Ok(())
}

/// Checks that a skin has every joint that the vertices of meshes name.
fn check_joints(resources: &Resources<'_>, scene: &Scene, meshes: &[usize], skin: usize, place: &str) -> Result<(), SceneError> {
    let joints = scene.skins[skin].joints.len();
    let vertices = meshes.iter().flat_map(|&mesh| &scene.meshes[mesh].skin_weights);
    match vertices.flat_map(|vertex| vertex.joints).max() {
        Some(largest) if usize::from(largest) >= joints => {
            Err(resources.invalid(place, format!("its mesh names joint {largest}, but skin {skin} has {joints}")))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
