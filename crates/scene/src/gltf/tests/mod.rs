//! The importer as a whole, on small files made here and on real scenes.

mod assets;
mod containers;
mod geometry;
mod graph;
mod malformed;
mod materials;
mod motion;

use crate::gltf::{NoResources, load_gltf_bytes};
use crate::{ImportLimits, Mesh, Scene, SceneError};
use base64::Engine;
use serde_json::{Value, json};

pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A glTF file in the making: its JSON, open to any change, and its one buffer.
pub struct File {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl File {
    pub fn new() -> Self {
        Self { json: json!({ "asset": { "version": "2.0" } }), binary: Vec::new() }
    }

    /// One triangle (0,0,0), (1,0,0), (0,1,0): mesh 0 on node 0 of scene 0, accessor 0.
    pub fn triangle() -> Self {
        let mut file = Self::new();
        let position = file.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        file.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": position } }] }));
        file.push("nodes", json!({ "mesh": 0 }));
        file.push("scenes", json!({ "nodes": [0] }));
        file
    }

    /// Appends to a list of the document; returns the index.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        let root = self.json.as_object_mut().unwrap();
        let list = root.entry(list).or_insert_with(|| json!([])).as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// A new buffer view on these bytes.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let offset = self.binary.len();
        self.binary.extend(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// A new accessor on these bytes.
    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.push("accessors", json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }))
    }

    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        self.accessor(kind, F32, values.len() / width, bytemuck::cast_slice(values))
    }

    pub fn indices(&mut self, values: &[u16]) -> usize {
        self.accessor("SCALAR", U16, values.len(), bytemuck::cast_slice(values))
    }

    /// The first primitive.
    pub fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// The document with its buffer.
    fn document(&self, uri: Option<String>) -> Vec<u8> {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() && !self.binary.is_empty() {
            json["buffers"] = json!([{ "byteLength": self.binary.len() }]);
            if let Some(uri) = uri {
                json["buffers"][0]["uri"] = uri.into();
            }
        }
        serde_json::to_vec(&json).unwrap()
    }

    /// As text, the buffer in a data URI.
    pub fn gltf(&self) -> Vec<u8> {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.binary);
        self.document(Some(format!("data:application/octet-stream;base64,{data}")))
    }

    /// As a binary file.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.document(None);
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut binary = self.binary.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut file = b"glTF\x02\0\0\0".to_vec();
        file.extend((12 + 8 + json.len() as u32 + 8 + binary.len() as u32).to_le_bytes());
        file.extend((json.len() as u32).to_le_bytes());
        file.extend(b"JSON");
        file.extend(json);
        file.extend((binary.len() as u32).to_le_bytes());
        file.extend(b"BIN\0");
        file.extend(binary);
        file
    }

    pub fn try_load(&self) -> Result<Scene, SceneError> {
        load_gltf_bytes("test.gltf", &self.gltf(), &NoResources, ImportLimits::default())
    }

    pub fn load(&self) -> Scene {
        self.try_load().unwrap_or_else(|error| panic!("{error}"))
    }

    /// The only mesh.
    pub fn mesh(&self) -> Mesh {
        let scene = self.load();
        assert_eq!(scene.meshes.len(), 1);
        (*scene.meshes[0]).clone()
    }

    pub fn error(&self) -> String {
        self.try_load().expect_err("the file is wrong").to_string()
    }
}

/// The entries of the list of ignored things, without the file.
pub fn ignored(scene: &Scene) -> Vec<String> {
    scene.ignored.iter().map(|entry| format!("{}: {}", entry.place, entry.feature)).collect()
}
