//! The glTF 2.0 material with its ratified extensions: factors, and textures that multiply them.

use crate::{ReflectanceModel, TextureRef};
use kajo_units::{LinearRgb, Radians};

/// How alpha is used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Opaque where alpha ≥ the cutoff, absent elsewhere.
    Mask(f32),
    /// Coverage: the surface is there with probability alpha.
    Blend,
}

/// A material as the file has it. Each texture multiplies its factor, channels as glTF says.
///
/// [`Default`] is the glTF default material.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "fields carry the names, ranges and channels of glTF 2.0 and its KHR_materials_* extensions")]
pub struct Material {
    pub name: String,
    pub base_color: LinearRgb,
    pub alpha: f32,
    pub base_color_texture: Option<TextureRef>,
    pub metallic: f32,
    pub roughness: f32,
    pub metallic_roughness_texture: Option<TextureRef>,
    pub normal_texture: Option<TextureRef>,
    pub normal_scale: f32,
    /// Used by real-time techniques only; the path tracer computes occlusion.
    pub occlusion_texture: Option<TextureRef>,
    pub occlusion_strength: f32,
    /// Emitted radiance, W/(m² sr): factor × strength.
    pub emission: LinearRgb,
    pub emission_texture: Option<TextureRef>,
    pub alpha_mode: AlphaMode,
    pub double_sided: bool,
    pub unlit: bool,
    pub ior: f32,
    pub specular: f32,
    pub specular_texture: Option<TextureRef>,
    pub specular_color: LinearRgb,
    pub specular_color_texture: Option<TextureRef>,
    pub clearcoat: f32,
    pub clearcoat_texture: Option<TextureRef>,
    pub clearcoat_roughness: f32,
    pub clearcoat_roughness_texture: Option<TextureRef>,
    pub clearcoat_normal_texture: Option<TextureRef>,
    pub clearcoat_normal_scale: f32,
    pub sheen_color: LinearRgb,
    pub sheen_color_texture: Option<TextureRef>,
    pub sheen_roughness: f32,
    pub sheen_roughness_texture: Option<TextureRef>,
    pub anisotropy: f32,
    pub anisotropy_rotation: Radians,
    pub anisotropy_texture: Option<TextureRef>,
    pub transmission: f32,
    pub transmission_texture: Option<TextureRef>,
    /// Thickness, m; above 0 the surface bounds a volume.
    pub thickness: f32,
    pub thickness_texture: Option<TextureRef>,
    /// Mean free path scale, m; infinite means a clear volume.
    pub attenuation_distance: f32,
    pub attenuation_color: LinearRgb,
    pub iridescence: f32,
    pub iridescence_texture: Option<TextureRef>,
    pub iridescence_ior: f32,
    /// Film thickness at texture values 0 and 1, nm.
    pub iridescence_thickness: [f32; 2],
    pub iridescence_thickness_texture: Option<TextureRef>,
    pub dispersion: f32,
    /// A model of the library instead of the reflection that the fields above describe; glTF has none, `.kajo.toml` does.
    pub model: Option<ReflectanceModel>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: LinearRgb::WHITE,
            alpha: 1.0,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emission: LinearRgb::BLACK,
            emission_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            ior: 1.5,
            specular: 1.0,
            specular_texture: None,
            specular_color: LinearRgb::WHITE,
            specular_color_texture: None,
            clearcoat: 0.0,
            clearcoat_texture: None,
            clearcoat_roughness: 0.0,
            clearcoat_roughness_texture: None,
            clearcoat_normal_texture: None,
            clearcoat_normal_scale: 1.0,
            sheen_color: LinearRgb::BLACK,
            sheen_color_texture: None,
            sheen_roughness: 0.0,
            sheen_roughness_texture: None,
            anisotropy: 0.0,
            anisotropy_rotation: Radians(0.0),
            anisotropy_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            thickness: 0.0,
            thickness_texture: None,
            attenuation_distance: f32::INFINITY,
            attenuation_color: LinearRgb::WHITE,
            iridescence: 0.0,
            iridescence_texture: None,
            iridescence_ior: 1.3,
            iridescence_thickness: [100.0, 400.0],
            iridescence_thickness_texture: None,
            dispersion: 0.0,
            model: None,
        }
    }
}
