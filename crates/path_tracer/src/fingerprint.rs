//! Hashes of what a rendering depends on, so that a film is never continued with another scene or other settings.

use crate::film::Fingerprint;
use crate::{EnvironmentSampler, LightSampler, Settings};
use kajo_scene::{Mesh, Scene, Snapshot, Texels};

/// A 64-bit hash that is the same on every platform and in every version; not for adversaries.
pub(crate) struct StableHasher(u64);

impl StableHasher {
    /// Odd, from the digits of the golden ratio.
    const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;

    pub(crate) fn new() -> Self {
        Self(0x6b61_6a6f)
    }

    pub(crate) fn hash(bytes: &[u8]) -> u64 {
        let mut hasher = Self::new();
        hasher.bytes(bytes);
        hasher.0
    }

    #[inline]
    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(Self::MULTIPLIER);
        self.0 ^= self.0 >> 29;
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.word(bytes.len() as u64);
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|w| self.word(u64::from_le_bytes(*w)));
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        self.word(u64::from_le_bytes(last));
    }

    fn pod<T: bytemuck::NoUninit>(&mut self, values: &[T]) {
        self.bytes(bytemuck::cast_slice(values));
    }

    /// By its `Debug` form, which prints every field.
    fn debug(&mut self, value: &dyn std::fmt::Debug) {
        self.bytes(format!("{value:?}").as_bytes());
    }
}

/// The fingerprint of everything that `Tracer` and `Settings` give to a picture.
pub(crate) fn fingerprint(scene: u64, settings: &Settings) -> Fingerprint {
    let mut hasher = StableHasher::new();
    hasher.debug(settings);
    Fingerprint { scene, settings: hasher.0 }
}

/// Hash of geometry, materials, textures, lights, cameras and environment.
pub(crate) fn scene_hash(
    scene: &Scene,
    snapshot: &Snapshot,
    previous: Option<&Snapshot>,
    (environment_sampler, light_sampler): (EnvironmentSampler, LightSampler),
) -> u64 {
    let mut h = StableHasher::new();
    h.debug(&light_sampler);
    h.debug(&(&scene.materials, &scene.textures));
    for image in &scene.images {
        image_hash(&mut h, image);
    }
    if let Some(environment) = &scene.environment {
        h.debug(&(environment.scale, environment.rotation, environment_sampler));
        environment.image.iter().for_each(|image| image_hash(&mut h, image));
    }
    for snapshot in std::iter::once(snapshot).chain(previous) {
        snapshot.meshes.iter().for_each(|mesh| mesh_hash(&mut h, mesh));
        h.debug(&(&snapshot.instances, &snapshot.lights, &snapshot.cameras));
    }
    h.0
}

fn image_hash(h: &mut StableHasher, image: &kajo_scene::TextureImage) {
    h.debug(&(image.width, image.height));
    match &image.texels {
        Texels::Rgba8(texels) => h.pod(texels),
        Texels::Rgba16(texels) => h.pod(texels),
        Texels::Rgba32F(texels) => h.pod(texels),
        Texels::Rgb32F(texels) => h.pod(texels),
    }
}

fn mesh_hash(h: &mut StableHasher, mesh: &Mesh) {
    h.pod(&mesh.positions);
    h.pod(&mesh.normals);
    h.pod(&mesh.tangents);
    mesh.uvs.iter().for_each(|uvs| h.pod(uvs));
    h.pod(&mesh.colors);
    h.pod(&mesh.indices);
    h.word(mesh.material as u64);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_and_the_length_count() {
        let text = b"seventeen letters";
        let hash = StableHasher::hash(text);
        for i in 0..text.len() {
            let mut other = *text;
            other[i] ^= 1;
            assert_ne!(StableHasher::hash(&other), hash);
        }
        assert_ne!(StableHasher::hash(b"a"), StableHasher::hash(b"a\0"));
    }

    #[test]
    fn the_hash_never_changes_between_versions() {
        assert_eq!(StableHasher::hash(b""), 0x1ea4_5221_93af_6d2a);
    }

    #[test]
    fn settings_change_the_fingerprint() {
        let base = Settings::default();
        let other = Settings { seed: 1, ..Settings::default() };
        assert_eq!(fingerprint(1, &base), fingerprint(1, &base.clone()));
        assert_ne!(fingerprint(1, &base), fingerprint(1, &other));
        assert_ne!(fingerprint(1, &base), fingerprint(2, &base));
    }
}
