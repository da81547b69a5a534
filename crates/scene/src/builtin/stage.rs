//! Puts a built-in scene together: materials, placed meshes, lights and cameras by name.

use crate::{
    Animation, Camera, ColorSpace, Environment, Filter, Light, LightShape, Material, Mesh, Node, Projection, Scene, Texels, Texture,
    TextureImage, TextureRef, Transform, Wrap,
};
use glam::{Affine2, Mat3, Quat, Vec2, Vec3};
use kajo_units::{LinearRgb, Meters, Radians};
use std::sync::Arc;

/// A scene under construction.
pub(super) struct Stage {
    scene: Scene,
}

impl Stage {
    /// An empty scene; `exposure` in stops.
    pub fn new(exposure: f32) -> Self {
        Self { scene: Scene { exposure: Some(exposure), ..Scene::default() } }
    }

    /// Adds a material and returns its index.
    pub fn material(&mut self, name: &str, material: Material) -> usize {
        self.scene.materials.push(Material { name: name.into(), ..material });
        self.scene.materials.len() - 1
    }

    /// Adds a mesh with one placement; returns its node.
    pub fn place(&mut self, name: &str, mesh: Mesh, material: usize, transform: Transform) -> usize {
        let mesh = self.mesh(name, mesh, material);
        self.instance(name, mesh, transform)
    }

    /// Adds a mesh without placing it.
    pub fn mesh(&mut self, name: &str, mesh: Mesh, material: usize) -> usize {
        self.scene.meshes.push(Arc::new(Mesh { name: name.into(), material, ..mesh }));
        self.scene.meshes.len() - 1
    }

    /// Places a mesh; returns the node.
    pub fn instance(&mut self, name: &str, mesh: usize, transform: Transform) -> usize {
        self.node(Node { name: name.into(), transform, meshes: vec![mesh], ..Node::default() })
    }

    /// Places a light; returns the node.
    pub fn light(&mut self, name: &str, shape: LightShape, emission: LinearRgb, transform: Transform) -> usize {
        self.scene.lights.push(Light { name: name.into(), shape, emission });
        let light = Some(self.scene.lights.len() - 1);
        self.node(Node { name: name.into(), transform, light, ..Node::default() })
    }

    /// Adds a perspective camera at `eye` that looks at `target`, +y up; returns the node.
    pub fn camera(&mut self, name: &str, eye: Vec3, target: Vec3, yfov_degrees: f32, aspect: Option<f32>) -> usize {
        self.scene.cameras.push(Camera {
            name: name.into(),
            projection: Projection::Perspective { yfov: Radians::from_degrees(yfov_degrees), aspect },
            lens_radius: Meters(0.0),
            focus_distance: Meters(eye.distance(target)),
            near: Meters(0.01),
        });
        let camera = Some(self.scene.cameras.len() - 1);
        self.node(Node { name: name.into(), transform: looking(eye, target), camera, ..Node::default() })
    }

    /// Sets the light from infinity.
    pub fn environment(&mut self, radiance: LinearRgb) {
        self.scene.environment = Some(Environment::uniform(radiance));
    }

    /// Adds an image of `size × size` sRGB-encoded texels; returns a use of it that repeats `repeat` times over a unit of uv.
    pub fn texture(&mut self, name: &str, size: u32, repeat: f32, texel: impl Fn(u32, u32) -> [u8; 4]) -> TextureRef {
        let texels = (0..size).flat_map(|y| (0..size).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
        self.scene.images.push(Arc::new(TextureImage { name: name.into(), width: size, height: size, texels: Texels::Rgba8(texels) }));
        let image = self.scene.images.len() - 1;
        self.scene.textures.push(Texture { image, wrap: [Wrap::Repeat; 2], filter: Filter::Nearest, color_space: ColorSpace::Srgb });
        TextureRef { texture: self.scene.textures.len() - 1, uv_set: 0, transform: Affine2::from_scale(Vec2::splat(repeat)) }
    }

    /// Adds an animation that plays with the scene.
    pub fn animation(&mut self, animation: Animation) {
        self.scene.animations.push(animation);
    }

    /// Adds a node as it is.
    pub fn node(&mut self, node: Node) -> usize {
        self.scene.nodes.push(node);
        self.scene.nodes.len() - 1
    }

    /// The finished scene.
    pub fn finish(self) -> Scene {
        self.scene
    }
}

/// A surface that only scatters: pure Lambert with the given albedo (no specular reflection, no metal).
pub(super) fn lambert(albedo: LinearRgb) -> Material {
    Material { base_color: albedo, metallic: 0.0, roughness: 1.0, specular: 0.0, ..Material::default() }
}

/// A shiny dielectric: a coloured body under a clear surface of index 1.5.
pub(super) fn plastic(color: LinearRgb, roughness: f32) -> Material {
    Material { base_color: color, metallic: 0.0, roughness, ..Material::default() }
}

/// A metal of the given reflectance at normal incidence.
pub(super) fn metal(f0: LinearRgb, roughness: f32) -> Material {
    Material { base_color: f0, metallic: 1.0, roughness, ..Material::default() }
}

/// A translation.
pub(super) fn at(x: f32, y: f32, z: f32) -> Transform {
    Transform::Trs { translation: Vec3::new(x, y, z), rotation: Quat::IDENTITY, scale: Vec3::ONE }
}

/// A translation after a rotation.
pub(super) fn turned(translation: Vec3, rotation: Quat) -> Transform {
    Transform::Trs { translation, rotation, scale: Vec3::ONE }
}

/// At `eye`, with −z towards `target` and +y upwards as far as that allows: for cameras and lights.
pub(super) fn looking(eye: Vec3, target: Vec3) -> Transform {
    let back = (eye - target).normalize_or(Vec3::Z);
    let up = if back.y.abs() > 0.999 { Vec3::NEG_Z } else { Vec3::Y };
    let right = up.cross(back).normalize();
    let rotation = Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back));
    Transform::Trs { translation: eye, rotation, scale: Vec3::ONE }
}
