//! Materials and their extensions.

use super::{NoExtensions, Num, TextureInfo};
use serde::Deserialize;
use serde::de::IgnoredAny;

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Material {
    pub name: String,
    pub pbr_metallic_roughness: Option<MetallicRoughness>,
    pub normal_texture: Option<TextureInfo>,
    pub occlusion_texture: Option<TextureInfo>,
    pub emissive_texture: Option<TextureInfo>,
    pub emissive_factor: Option<[Num; 3]>,
    pub alpha_mode: Option<String>,
    pub alpha_cutoff: Option<Num>,
    pub double_sided: bool,
    pub extensions: MaterialExtensions,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct MetallicRoughness {
    pub base_color_factor: Option<[Num; 4]>,
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: Option<Num>,
    pub roughness_factor: Option<Num>,
    pub metallic_roughness_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
pub struct MaterialExtensions {
    #[serde(rename = "KHR_materials_anisotropy")]
    pub anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub clearcoat: Option<Clearcoat>,
    #[serde(rename = "KHR_materials_dispersion")]
    pub dispersion: Option<Dispersion>,
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_ior")]
    pub ior: Option<Ior>,
    #[serde(rename = "KHR_materials_iridescence")]
    pub iridescence: Option<Iridescence>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub specular_glossiness: Option<SpecularGlossiness>,
    #[serde(rename = "KHR_materials_sheen")]
    pub sheen: Option<Sheen>,
    #[serde(rename = "KHR_materials_specular")]
    pub specular: Option<Specular>,
    #[serde(rename = "KHR_materials_transmission")]
    pub transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_unlit")]
    pub unlit: Option<IgnoredAny>,
    #[serde(rename = "KHR_materials_volume")]
    pub volume: Option<Volume>,
    #[serde(flatten)]
    pub other: NoExtensions,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Anisotropy {
    pub anisotropy_strength: Option<Num>,
    pub anisotropy_rotation: Option<Num>,
    pub anisotropy_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Clearcoat {
    pub clearcoat_factor: Option<Num>,
    pub clearcoat_texture: Option<TextureInfo>,
    pub clearcoat_roughness_factor: Option<Num>,
    pub clearcoat_roughness_texture: Option<TextureInfo>,
    pub clearcoat_normal_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub struct Dispersion {
    pub dispersion: Option<Num>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct EmissiveStrength {
    pub emissive_strength: Option<Num>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub struct Ior {
    pub ior: Option<Num>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Iridescence {
    pub iridescence_factor: Option<Num>,
    pub iridescence_texture: Option<TextureInfo>,
    pub iridescence_ior: Option<Num>,
    pub iridescence_thickness_minimum: Option<Num>,
    pub iridescence_thickness_maximum: Option<Num>,
    pub iridescence_thickness_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct SpecularGlossiness {
    pub diffuse_factor: Option<[Num; 4]>,
    pub diffuse_texture: Option<TextureInfo>,
    pub specular_factor: Option<[Num; 3]>,
    pub glossiness_factor: Option<Num>,
    pub specular_glossiness_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Sheen {
    pub sheen_color_factor: Option<[Num; 3]>,
    pub sheen_color_texture: Option<TextureInfo>,
    pub sheen_roughness_factor: Option<Num>,
    pub sheen_roughness_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Specular {
    pub specular_factor: Option<Num>,
    pub specular_texture: Option<TextureInfo>,
    pub specular_color_factor: Option<[Num; 3]>,
    pub specular_color_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Transmission {
    pub transmission_factor: Option<Num>,
    pub transmission_texture: Option<TextureInfo>,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct Volume {
    pub thickness_factor: Option<Num>,
    pub thickness_texture: Option<TextureInfo>,
    pub attenuation_distance: Option<Num>,
    pub attenuation_color: Option<[Num; 3]>,
}
