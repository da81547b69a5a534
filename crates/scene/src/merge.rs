//! Putting one scene into another.

use crate::{Material, Scene, TextureRef};

impl Scene {
    /// Adds everything of `other`; its root nodes become children of `parent`. Returns the index of its first node.
    ///
    /// Names stay as they are. The environment, the exposure and the choice of animation of `self` are kept where it has them, else those of `other`
    /// taken.
    ///
    /// # Panics
    /// When `parent` is no node of `self`.
    pub fn append(&mut self, other: Scene, parent: Option<usize>) -> usize {
        assert!(parent.is_none_or(|p| p < self.nodes.len()), "parent {parent:?} of {} nodes", self.nodes.len());
        let nodes = self.nodes.len();
        let (meshes, materials) = (self.meshes.len(), self.materials.len());
        let (textures, images) = (self.textures.len(), self.images.len());
        let (skins, lights, cameras) = (self.skins.len(), self.lights.len(), self.cameras.len());

        self.nodes.extend(other.nodes.into_iter().map(|mut node| {
            node.parent = node.parent.map(|p| p + nodes).or(parent);
            node.meshes.iter_mut().for_each(|mesh| *mesh += meshes);
            node.skin = node.skin.map(|skin| skin + skins);
            node.light = node.light.map(|light| light + lights);
            node.camera = node.camera.map(|camera| camera + cameras);
            node
        }));
        self.meshes.extend(other.meshes.into_iter().map(|mut mesh| {
            if materials > 0 {
                std::sync::Arc::make_mut(&mut mesh).material += materials;
            }
            mesh
        }));
        self.materials.extend(other.materials.into_iter().map(|mut material| {
            material.textures_mut().into_iter().flatten().for_each(|use_| use_.texture += textures);
            material
        }));
        self.textures.extend(other.textures.into_iter().map(|mut texture| {
            texture.image += images;
            texture
        }));
        self.images.extend(other.images);
        self.skins.extend(other.skins.into_iter().map(|mut skin| {
            skin.joints.iter_mut().for_each(|joint| *joint += nodes);
            skin
        }));
        if self.animations.is_empty() {
            self.animation = other.animation;
        }
        self.animations.extend(other.animations.into_iter().map(|mut animation| {
            animation.channels.iter_mut().for_each(|channel| channel.node += nodes);
            animation
        }));
        self.lights.extend(other.lights);
        self.cameras.extend(other.cameras);
        self.environment = self.environment.take().or(other.environment);
        self.exposure = self.exposure.or(other.exposure);
        self.ignored.extend(other.ignored);
        nodes
    }
}

impl Material {
    /// Every texture of the material, in the order of its fields.
    pub fn textures_mut(&mut self) -> [Option<&mut TextureRef>; 17] {
        [
            self.base_color_texture.as_mut(),
            self.metallic_roughness_texture.as_mut(),
            self.normal_texture.as_mut(),
            self.occlusion_texture.as_mut(),
            self.emission_texture.as_mut(),
            self.specular_texture.as_mut(),
            self.specular_color_texture.as_mut(),
            self.clearcoat_texture.as_mut(),
            self.clearcoat_roughness_texture.as_mut(),
            self.clearcoat_normal_texture.as_mut(),
            self.sheen_color_texture.as_mut(),
            self.sheen_roughness_texture.as_mut(),
            self.anisotropy_texture.as_mut(),
            self.transmission_texture.as_mut(),
            self.thickness_texture.as_mut(),
            self.iridescence_texture.as_mut(),
            self.iridescence_thickness_texture.as_mut(),
        ]
    }
}
