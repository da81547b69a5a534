//! Primitives to triangle meshes.    glTF 2.0, section 3.7

use super::accessor::Selection;
use super::json::Primitive;
use super::notes::Notes;
use super::resources::{Resources, label};
use crate::{Mesh, MorphTarget, SceneError, SkinWeights};
use glam::{Vec2, Vec3, Vec4};
use std::collections::BTreeMap;

/// What a mesh must know of its material.
#[derive(Clone, Copy)]
pub struct MaterialNeeds {
    /// Index into the scene's materials.
    pub material: usize,
    /// Which `TEXCOORD_n` the two slots of [`Mesh::uvs`] hold.
    pub uv_sets: [usize; 2],
    /// Whether a texture reads the slot.
    pub uses_uvs: [bool; 2],
    /// The slot along which tangents run, where the material needs tangents.
    pub tangent_uvs: Option<usize>,
}

/// Reads one primitive.
pub struct PrimitiveReader<'r, 'a> {
    resources: &'r Resources<'a>,
    primitive: &'a Primitive,
    /// `mesh 3 "name", primitive 1`, for messages.
    place: String,
    /// Vertices that the accessors must have.
    vertices: u64,
    /// The vertices that triangles use, ascending; `None` for all.
    used: Option<Vec<u32>>,
}

/// The mesh of a primitive, or `None` where it shows nothing (points, lines, no positions, no triangles), with a note. Its normals are
/// there, its tangents not yet where [`tangents::generate`](super::tangents::generate) has to make them.
pub fn read_primitive(
    resources: &Resources<'_>,
    notes: &mut Notes,
    mesh: usize,
    primitive: usize,
    needs: &MaterialNeeds,
) -> Result<Option<Mesh>, SceneError> {
    let document_mesh = &resources.document.meshes[mesh];
    let json = &document_mesh.primitives[primitive];
    let place = format!("{}, primitive {primitive}", label("mesh", mesh, &document_mesh.name));
    notes.unknown_extensions(&place, json.extensions.other.keys());
    if json.extensions.variants.is_some() {
        notes.add("", "KHR_materials_variants", super::extensions::consequence("KHR_materials_variants"));
    }
    match json.mode {
        0 => return Ok(skip(notes, place, "points", "only triangles are shown")),
        1..=3 => return Ok(skip(notes, place, "lines", "only triangles are shown")),
        4..=6 => {}
        mode => return Err(resources.invalid(place, format!("its mode {mode} is none of 0 to 6"))),
    }
    let Some(&position) = json.attributes.get("POSITION") else {
        return Ok(skip(notes, place, "no POSITION", "nothing is shown"));
    };
    if json.extensions.draco.is_some() {
        if resources.get(&resources.document.accessors, "accessor", position, &place)?.buffer_view.is_none() {
            return Err(SceneError::Unsupported {
                file: resources.file.into(),
                feature: format!("KHR_draco_mesh_compression ({place})"),
                advice: "export it without Draco compression (EXT_meshopt_compression is supported)".into(),
            });
        }
        notes.add(&place, "KHR_draco_mesh_compression", super::extensions::consequence("KHR_draco_mesh_compression"));
    }

    let vertices = resources.count(position, &place)?;
    let mut reader = PrimitiveReader { resources, primitive: json, place, vertices, used: None };
    let triangles = reader.triangles()?;
    if triangles.is_empty() {
        return Ok(skip(notes, reader.place, "no triangles", "nothing is shown"));
    }
    let mut out = reader.mesh(triangles, needs, notes)?;
    out.name = if document_mesh.primitives.len() == 1 {
        document_mesh.name.clone()
    } else {
        format!("{}.{primitive}", if document_mesh.name.is_empty() { "mesh" } else { &document_mesh.name })
    };
    out.material = needs.material;
    if !out.morph_targets.is_empty() {
        out.morph_weights = document_mesh.weights.iter().map(|weight| weight.0).collect();
        out.morph_weights.resize(out.morph_targets.len(), 0.0);
    }
    finish(&mut out, needs, notes, &reader.place, resources)?;
    Ok(Some(out))
}

fn skip(notes: &mut Notes, place: String, feature: &str, consequence: &str) -> Option<Mesh> {
    notes.add(place, feature, consequence);
    None
}

/// Makes normals that the file leaves out, and drops tangents that nobody needs.
fn finish(mesh: &mut Mesh, needs: &MaterialNeeds, notes: &mut Notes, place: &str, resources: &Resources<'_>) -> Result<(), SceneError> {
    if mesh.normals.is_empty() {
        let corners: Vec<u32> = mesh.indices.iter().flatten().copied().collect();
        resources.budget.claim(resources.file, place, corners.len() as u64, size_of::<Vec3>() as u64 * 2)?;
        *mesh = mesh.gather(&corners);
        mesh.indices = (0..corners.len() as u32 / 3).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner)).collect();
        mesh.make_faceted_normals();
        mesh.tangents.clear(); // without normals they are to be ignored: section 3.7.2.1
    }
    for slot in 0..2 {
        if needs.uses_uvs[slot] && mesh.uvs[slot].is_empty() {
            let feature = format!("a texture on TEXCOORD_{}, which the mesh lacks", needs.uv_sets[slot]);
            notes.add(place, feature, "its corner texel colours the whole mesh");
        }
    }
    if needs.tangent_uvs.is_none() {
        mesh.tangents.clear();
    }
    Ok(())
}

impl PrimitiveReader<'_, '_> {
    /// The triangles, with indices into the vertices that [`Self::used`] keeps; sets that.
    fn triangles(&mut self) -> Result<Vec<[u32; 3]>, SceneError> {
        let indices = match self.primitive.indices {
            Some(accessor) => {
                let purpose = format!("indices of {}", self.place);
                self.resources.integers::<1>(accessor, &purpose, Selection::All)?.into_iter().flatten().collect()
            }
            None => {
                // No more vertices than `claim` grants come out of the accessor, and u32 counts them.
                self.resources.budget.claim(self.resources.file, &self.place, self.vertices, 4)?;
                let count = u32::try_from(self.vertices)
                    .map_err(|_| self.resources.invalid(&self.place, format!("{} vertices are too many", self.vertices)))?;
                (0..count).collect::<Vec<u32>>()
            }
        };
        if let Some(&index) = indices.iter().find(|&&index| u64::from(index) >= self.vertices) {
            let problem = format!("its indices name vertex {index}, but it has {} vertices", self.vertices);
            return Err(self.resources.invalid(&self.place, problem));
        }
        let mut triangles: Vec<[u32; 3]> = match self.primitive.mode {
            4 => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            // Triangle i of a strip is (i, i + 1 + i % 2, i + 2 − i % 2); repeated vertices only connect strips.
            5 => indices.windows(3).enumerate().map(|(i, t)| [t[0], t[1 + i % 2], t[2 - i % 2]]).filter(distinct).collect(),
            _ => indices.windows(2).skip(1).map(|t| [t[0], t[1], indices[0]]).filter(distinct).collect(),
        };
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        if used.len() as u64 != self.vertices {
            for index in triangles.iter_mut().flatten() {
                *index = used.binary_search(index).expect("collected above") as u32;
            }
            self.used = Some(used);
        }
        Ok(triangles)
    }

    fn mesh(&self, triangles: Vec<[u32; 3]>, needs: &MaterialNeeds, notes: &mut Notes) -> Result<Mesh, SceneError> {
        let attributes = &self.primitive.attributes;
        let positions = self.vectors::<3, Vec3>(attributes, "POSITION")?;
        let mut normals = self.vectors::<3, Vec3>(attributes, "NORMAL")?;
        repair_normals(&mut normals, &positions, &triangles);
        let tangents = self.vectors::<4, Vec4>(attributes, "TANGENT")?;
        let [uv0, uv1] = needs.uv_sets.map(|set| self.vectors::<2, Vec2>(attributes, &format!("TEXCOORD_{set}")));
        for name in attributes.keys().filter(|name| matches!(name.as_str(), "COLOR_1" | "JOINTS_2" | "WEIGHTS_2")) {
            notes.add(&self.place, name, "only COLOR_0 and the first two sets of joints are used");
        }
        Ok(Mesh {
            tangents: if tangents.iter().all(|t| t.truncate().length_squared() > 0.0) { unit_tangents(tangents) } else { Vec::new() },
            positions,
            normals,
            uvs: [uv0?, uv1?],
            colors: self.colors(attributes)?,
            indices: triangles,
            skin_weights: self.skin_weights()?,
            morph_targets: self.primitive.targets.iter().map(|target| self.morph_target(target, needs)).collect::<Result<_, _>>()?,
            ..Mesh::default()
        })
    }

    fn morph_target(&self, target: &BTreeMap<String, usize>, needs: &MaterialNeeds) -> Result<MorphTarget, SceneError> {
        let [uv0, uv1] = needs.uv_sets.map(|set| self.vectors::<2, Vec2>(target, &format!("TEXCOORD_{set}")));
        Ok(MorphTarget {
            positions: self.vectors::<3, Vec3>(target, "POSITION")?,
            normals: self.vectors::<3, Vec3>(target, "NORMAL")?,
            tangents: self.vectors::<3, Vec3>(target, "TANGENT")?,
            uvs: [uv0?, uv1?],
            colors: self.colors_with_alpha(target, 0.0)?,
        })
    }

    /// An attribute as vectors; empty where it is absent.
    fn vectors<const N: usize, V: From<[f32; N]>>(&self, attributes: &BTreeMap<String, usize>, name: &str) -> Result<Vec<V>, SceneError> {
        let Some(&accessor) = attributes.get(name) else { return Ok(Vec::new()) };
        let purpose = self.purpose(accessor, name)?;
        Ok(self.resources.floats::<N>(accessor, &purpose, self.selection())?.into_iter().map(V::from).collect())
    }

    fn colors(&self, attributes: &BTreeMap<String, usize>) -> Result<Vec<Vec4>, SceneError> {
        let mut colors = self.colors_with_alpha(attributes, 1.0)?;
        for color in &mut colors {
            *color = color.clamp(Vec4::ZERO, Vec4::ONE);
        }
        Ok(colors)
    }

    /// COLOR_0, which may lack alpha.
    fn colors_with_alpha(&self, attributes: &BTreeMap<String, usize>, alpha: f32) -> Result<Vec<Vec4>, SceneError> {
        match attributes.get("COLOR_0") {
            Some(&accessor) if self.resources.kind(accessor, &self.place)? == "VEC3" => {
                Ok(self.vectors::<3, Vec3>(attributes, "COLOR_0")?.into_iter().map(|rgb| rgb.extend(alpha)).collect())
            }
            _ => self.vectors::<4, Vec4>(attributes, "COLOR_0"),
        }
    }

    /// Joints and weights of both sets, the weights made to sum to 1.
    fn skin_weights(&self) -> Result<Vec<SkinWeights>, SceneError> {
        let mut out: Vec<SkinWeights> = Vec::new();
        for set in 0..2 {
            let names = [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")];
            let [Some(&joints), Some(&weights)] = names.each_ref().map(|name| self.primitive.attributes.get(name)) else { continue };
            let joints = self.resources.integers::<4>(joints, &self.purpose(joints, &names[0])?, self.selection())?;
            let weights = self.resources.floats::<4>(weights, &self.purpose(weights, &names[1])?, self.selection())?;
            out.resize(joints.len(), SkinWeights::default());
            for (vertex, (joints, weights)) in out.iter_mut().zip(joints.into_iter().zip(weights)) {
                for (slot, (joint, weight)) in joints.into_iter().zip(weights).enumerate().filter(|(_, (_, weight))| *weight > 0.0) {
                    let too_large = || self.resources.invalid(&self.place, format!("joint {joint} exceeds the limit of 65535"));
                    vertex.joints[4 * set + slot] = u16::try_from(joint).map_err(|_| too_large())?;
                    vertex.weights[4 * set + slot] = weight;
                }
            }
        }
        for vertex in &mut out {
            let sum: f32 = vertex.weights.iter().sum();
            match sum > 0.0 && sum.is_finite() {
                true => vertex.weights.iter_mut().for_each(|weight| *weight /= sum),
                false => *vertex = SkinWeights { weights: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], ..SkinWeights::default() },
            }
        }
        Ok(out)
    }

    /// What an accessor is for, in messages; checks that it has an element for every vertex.
    fn purpose(&self, accessor: usize, name: &str) -> Result<String, SceneError> {
        let purpose = format!("{name} of {}", self.place);
        match self.resources.count(accessor, &purpose)? {
            count if count == self.vertices => Ok(purpose),
            count => {
                let problem = format!("it has {count} elements, but POSITION has {}", self.vertices);
                Err(self.resources.invalid(format!("accessor {accessor} ({purpose})"), problem))
            }
        }
    }

    fn selection(&self) -> Selection<'_> {
        self.used.as_deref().map_or(Selection::All, Selection::Only)
    }
}

fn distinct(t: &[u32; 3]) -> bool {
    t[0] != t[1] && t[1] != t[2] && t[2] != t[0]
}

/// Makes normals unit; one of length 0 becomes that of a triangle at its vertex.
fn repair_normals(normals: &mut [Vec3], positions: &[Vec3], triangles: &[[u32; 3]]) {
    if normals.is_empty() {
        return;
    }
    for triangle in triangles {
        for &vertex in triangle {
            let normal = &mut normals[vertex as usize];
            if normal.try_normalize().is_none() {
                let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
                *normal = (b - a).cross(c - a);
            }
        }
    }
    for normal in normals {
        *normal = normal.normalize_or(Vec3::Y);
    }
}

fn unit_tangents(tangents: Vec<Vec4>) -> Vec<Vec4> {
    tangents.into_iter().map(|t| t.truncate().normalize_or(Vec3::X).extend(if t.w < 0.0 { -1.0 } else { 1.0 })).collect()
}
