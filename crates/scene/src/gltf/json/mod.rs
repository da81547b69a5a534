//! The JSON of glTF 2.0 and of the extensions that Kajo reads, as it stands in files: names and defaults are those of the specification.
//!
//! Numbers that do not fit a 32-bit float are refused here, so that everything behind this module is finite. Extensions that are not
//! listed end in `other`, by name, for the list of what is ignored.

mod material;

pub use material::*;

use serde::Deserialize;
use serde::de::{Error, IgnoredAny, Unexpected};
use std::collections::BTreeMap;

/// A finite number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Num(pub f32);

impl<'de> Deserialize<'de> for Num {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let wide = f64::deserialize(deserializer)?;
        let narrow = wide as f32;
        if narrow.is_finite() {
            Ok(Self(narrow))
        } else {
            Err(D::Error::invalid_value(Unexpected::Float(wide), &"a number within the range of 32-bit floats"))
        }
    }
}

/// The bare numbers of an array.
pub fn floats<const N: usize>(array: [Num; N]) -> [f32; N] {
    array.map(|number| number.0)
}

/// Extensions of an object that has none that Kajo reads.
pub type NoExtensions = BTreeMap<String, IgnoredAny>;

/// What is needed to tell the version of a file before the rest is parsed.
#[derive(Deserialize)]
pub struct Probe {
    pub asset: Asset,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Asset {
    pub version: String,
    pub min_version: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Document {
    #[serde(default)]
    pub extensions_used: Vec<String>,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub animations: Vec<Animation>,
    #[serde(default)]
    pub buffers: Vec<Buffer>,
    #[serde(default)]
    pub buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub cameras: Vec<Camera>,
    #[serde(default)]
    pub images: Vec<Image>,
    #[serde(default)]
    pub materials: Vec<Material>,
    #[serde(default)]
    pub meshes: Vec<Mesh>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub samplers: Vec<Sampler>,
    pub scene: Option<usize>,
    #[serde(default)]
    pub scenes: Vec<Scene>,
    #[serde(default)]
    pub skins: Vec<Skin>,
    #[serde(default)]
    pub textures: Vec<Texture>,
    #[serde(default)]
    pub extensions: DocumentExtensions,
}

#[derive(Default, Deserialize)]
pub struct DocumentExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub lights: Option<Lights>,
    #[serde(flatten)]
    pub other: NoExtensions,
}

#[derive(Deserialize)]
pub struct Lights {
    pub lights: Vec<Light>,
}

#[derive(Deserialize)]
pub struct Light {
    #[serde(default)]
    pub name: String,
    #[serde(default = "white")]
    pub color: [Num; 3],
    #[serde(default = "one")]
    pub intensity: Num,
    #[serde(rename = "type")]
    pub kind: String,
    pub range: Option<Num>,
    pub spot: Option<Spot>,
    #[serde(default)]
    pub extensions: NoExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Spot {
    #[serde(default)]
    pub inner_cone_angle: Option<Num>,
    #[serde(default)]
    pub outer_cone_angle: Option<Num>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub kind: String,
    pub sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub struct Sparse {
    pub count: u64,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseIndices {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseValues {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Buffer {
    pub uri: Option<String>,
    pub byte_length: u64,
    #[serde(default)]
    pub extensions: BufferExtensions,
}

#[derive(Default, Deserialize)]
pub struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub meshopt: Option<MeshoptBuffer>,
}

#[derive(Deserialize)]
pub struct MeshoptBuffer {
    #[serde(default)]
    pub fallback: bool,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
    #[serde(default)]
    pub extensions: BufferViewExtensions,
}

#[derive(Default, Deserialize)]
pub struct BufferViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub meshopt: Option<MeshoptView>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct MeshoptView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: u64,
    pub count: u64,
    pub mode: String,
    pub filter: Option<String>,
}

#[derive(Deserialize)]
pub struct Animation {
    #[serde(default)]
    pub name: String,
    pub channels: Vec<Channel>,
    pub samplers: Vec<AnimationSampler>,
}

#[derive(Deserialize)]
pub struct Channel {
    pub sampler: usize,
    pub target: ChannelTarget,
}

#[derive(Deserialize)]
pub struct ChannelTarget {
    pub node: Option<usize>,
    pub path: String,
}

#[derive(Deserialize)]
pub struct AnimationSampler {
    pub input: usize,
    #[serde(default)]
    pub interpolation: Option<String>,
    pub output: usize,
}

#[derive(Deserialize)]
pub struct Camera {
    #[serde(default)]
    pub name: String,
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
    #[serde(default)]
    pub extensions: NoExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Perspective {
    pub aspect_ratio: Option<Num>,
    pub yfov: Num,
    pub zfar: Option<Num>,
    pub znear: Num,
}

#[derive(Deserialize)]
pub struct Orthographic {
    pub xmag: Num,
    pub ymag: Num,
    pub zfar: Num,
    pub znear: Num,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Image {
    #[serde(default)]
    pub name: String,
    pub uri: Option<String>,
    pub buffer_view: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Sampler {
    pub mag_filter: Option<u32>,
    pub wrap_s: Option<u32>,
    pub wrap_t: Option<u32>,
}

#[derive(Deserialize)]
pub struct Texture {
    #[serde(default)]
    pub name: String,
    pub sampler: Option<usize>,
    pub source: Option<usize>,
    #[serde(default)]
    pub extensions: TextureExtensions,
}

#[derive(Default, Deserialize)]
pub struct TextureExtensions {
    #[serde(rename = "KHR_texture_basisu")]
    pub basisu: Option<TextureSource>,
    #[serde(rename = "EXT_texture_webp")]
    pub webp: Option<TextureSource>,
    #[serde(flatten)]
    pub other: NoExtensions,
}

#[derive(Deserialize)]
pub struct TextureSource {
    pub source: Option<usize>,
}

#[derive(Deserialize)]
pub struct Scene {
    #[serde(default)]
    pub name: String,
    #[serde(default)]
    pub nodes: Vec<usize>,
    #[serde(default)]
    pub extensions: NoExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Skin {
    #[serde(default)]
    pub name: String,
    pub inverse_bind_matrices: Option<usize>,
    pub joints: Vec<usize>,
}

#[derive(Deserialize)]
pub struct Node {
    #[serde(default)]
    pub name: String,
    pub camera: Option<usize>,
    #[serde(default)]
    pub children: Vec<usize>,
    pub skin: Option<usize>,
    pub matrix: Option<[Num; 16]>,
    pub mesh: Option<usize>,
    pub rotation: Option<[Num; 4]>,
    pub scale: Option<[Num; 3]>,
    pub translation: Option<[Num; 3]>,
    #[serde(default)]
    pub weights: Vec<Num>,
    #[serde(default)]
    pub extensions: NodeExtensions,
}

#[derive(Default, Deserialize)]
pub struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub light: Option<NodeLight>,
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Option<Visibility>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
    #[serde(flatten)]
    pub other: NoExtensions,
}

#[derive(Deserialize)]
pub struct NodeLight {
    pub light: usize,
}

#[derive(Deserialize)]
pub struct Visibility {
    #[serde(default = "yes")]
    pub visible: bool,
}

#[derive(Deserialize)]
pub struct Instancing {
    pub attributes: BTreeMap<String, usize>,
}

#[derive(Deserialize)]
pub struct Mesh {
    #[serde(default)]
    pub name: String,
    pub primitives: Vec<Primitive>,
    #[serde(default)]
    pub weights: Vec<Num>,
    #[serde(default)]
    pub extensions: NoExtensions,
}

#[derive(Deserialize)]
pub struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    #[serde(default = "triangles")]
    pub mode: u32,
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, usize>>,
    #[serde(default)]
    pub extensions: PrimitiveExtensions,
}

#[derive(Default, Deserialize)]
pub struct PrimitiveExtensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub draco: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_variants")]
    pub variants: Option<IgnoredAny>,
    #[serde(flatten)]
    pub other: NoExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureInfo {
    pub index: usize,
    #[serde(default)]
    pub tex_coord: usize,
    /// Of a normal texture.
    #[serde(default = "one")]
    pub scale: Num,
    /// Of an occlusion texture.
    #[serde(default = "one")]
    pub strength: Num,
    #[serde(default)]
    pub extensions: TextureInfoExtensions,
}

#[derive(Default, Deserialize)]
pub struct TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub transform: Option<TextureTransform>,
    #[serde(flatten)]
    pub other: NoExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureTransform {
    #[serde(default = "origin")]
    pub offset: [Num; 2],
    #[serde(default = "zero")]
    pub rotation: Num,
    #[serde(default = "unit")]
    pub scale: [Num; 2],
    pub tex_coord: Option<usize>,
}

fn zero() -> Num {
    Num(0.0)
}

fn one() -> Num {
    Num(1.0)
}

fn white() -> [Num; 3] {
    [Num(1.0); 3]
}

fn origin() -> [Num; 2] {
    [Num(0.0); 2]
}

fn unit() -> [Num; 2] {
    [Num(1.0); 2]
}

fn triangles() -> u32 {
    4
}

fn yes() -> bool {
    true
}
