//! The scene description: flat lists, indices between them, and no behaviour beyond looking things up.

mod animation;
mod camera;
mod environment;
mod ignored;
mod light;
mod material;
mod mesh;
mod node;
mod reflectance;
mod texture;

pub use animation::{Animation, Channel, Interpolation, Property};
pub use camera::{Camera, Projection};
pub use environment::Environment;
pub use ignored::Ignored;
pub use light::{Light, LightShape};
pub use material::{AlphaMode, Material};
pub use mesh::{Mesh, MorphTarget, SkinWeights};
pub use node::{Node, Skin, Transform};
pub use reflectance::ReflectanceModel;
pub use texture::{ColorSpace, Filter, Texels, Texture, TextureImage, TextureRef, Wrap};

use std::sync::Arc;

/// Everything that a renderer needs, in metres and radiometric units, y up, right-handed.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Where it came from, for messages: a path or `builtin:NAME`.
    pub name: String,
    /// Node hierarchy; a parent may stand after its children. Free of cycles.
    pub nodes: Vec<Node>,
    /// Triangle meshes, one material each (a glTF primitive is one mesh).
    pub meshes: Vec<Arc<Mesh>>,
    /// Materials, indexed by [`Mesh::material`].
    pub materials: Vec<Material>,
    /// Textures: an image and how it is sampled.
    pub textures: Vec<Texture>,
    /// Decoded images.
    pub images: Vec<Arc<TextureImage>>,
    /// Skins, indexed by [`Node::skin`].
    pub skins: Vec<Skin>,
    /// Animations, of which one plays.
    pub animations: Vec<Animation>,
    /// Index of the animation that plays, all its channels together; the first unless changed. Past the end, nothing moves.
    pub animation: usize,
    /// Lights, placed by the nodes that name them. Emissive meshes are lights too, but live in [`Scene::meshes`].
    pub lights: Vec<Light>,
    /// Cameras, placed by the nodes that name them.
    pub cameras: Vec<Camera>,
    /// Light from infinity, if any.
    pub environment: Option<Environment>,
    /// Exposure in stops that the scene's author chose (image value = radiance × 2^exposure); `None` asks for automatic exposure.
    pub exposure: Option<f32>,
    /// What the importer ignored or replaced.
    pub ignored: Vec<Ignored>,
}
