//! Materials as `material.wesl` reads them.

use crate::gpu::{GpuMaterial, GpuModelConstants, GpuTextureRef, MATERIAL_TEXTURES};
use crate::upload::tables::ModelTables;
use crate::upload::textures::sampler_index;
use kajo_scene::{AlphaMode, Material, ReflectanceModel, Scene, TextureRef};
use kajo_shader_lib::models::{self, MOST_CONSTANTS};

/// Every material, and behind them the default one for meshes that name none.
pub(crate) fn pack_all(scene: &Scene, tables: &ModelTables) -> Vec<GpuMaterial> {
    let default = Material::default();
    scene.materials.iter().chain([&default]).map(|material| pack(scene, material, tables)).collect()
}

fn pack(scene: &Scene, material: &Material, tables: &ModelTables) -> GpuMaterial {
    // In the order of the constants in material.wesl.
    let textures: [&Option<TextureRef>; MATERIAL_TEXTURES] = [
        &material.base_color_texture,
        &material.metallic_roughness_texture,
        &material.normal_texture,
        &material.occlusion_texture,
        &material.emission_texture,
        &material.specular_texture,
        &material.specular_color_texture,
        &material.clearcoat_texture,
        &material.clearcoat_roughness_texture,
        &material.clearcoat_normal_texture,
        &material.sheen_color_texture,
        &material.sheen_roughness_texture,
        &material.anisotropy_texture,
        &material.transmission_texture,
        &material.iridescence_texture,
        &material.iridescence_thickness_texture,
    ];
    let (alpha_mode, cutoff) = match material.alpha_mode {
        AlphaMode::Opaque => (0, 0.0),
        AlphaMode::Mask(cutoff) => (1, cutoff),
        AlphaMode::Blend => (2, 0.0),
    };
    GpuMaterial {
        base_color: material.base_color.0.to_array(),
        alpha: material.alpha,
        emission: material.emission.0.to_array(),
        cutoff,
        specular_color: material.specular_color.0.to_array(),
        specular: material.specular,
        sheen_color: material.sheen_color.0.to_array(),
        sheen_roughness: material.sheen_roughness,
        metallic: material.metallic,
        roughness: material.roughness,
        normal_scale: material.normal_scale,
        occlusion_strength: material.occlusion_strength,
        ior: material.ior,
        clearcoat: material.clearcoat,
        clearcoat_roughness: material.clearcoat_roughness,
        clearcoat_normal_scale: material.clearcoat_normal_scale,
        anisotropy: material.anisotropy,
        anisotropy_rotation: material.anisotropy_rotation.0,
        transmission: material.transmission,
        thickness: material.thickness,
        iridescence: material.iridescence,
        iridescence_ior: material.iridescence_ior,
        iridescence_thickness_min: material.iridescence_thickness[0],
        iridescence_thickness_max: material.iridescence_thickness[1],
        alpha_mode,
        flags: if material.unlit { GpuMaterial::UNLIT } else { 0 } | if material.double_sided { GpuMaterial::DOUBLE_SIDED } else { 0 },
        model: material.model.as_ref().map_or(0, |model| models::number(model.entry)),
        padding: 0,
        constants: constants(material, tables),
        textures: textures.map(|texture| texture_ref(scene, texture.as_ref())),
    }
}

fn constants(material: &Material, tables: &ModelTables) -> GpuModelConstants {
    let own = |model: &ReflectanceModel| tables.of(model).map_or_else(|| model.reflectance.constants(), |table| table.constants.clone());
    let mut numbers = material.model.as_ref().map_or_else(Vec::new, own);
    assert!(numbers.len() <= MOST_CONSTANTS, "{:?}: {} constants, room for {MOST_CONSTANTS}", material.model, numbers.len());
    numbers.resize(MOST_CONSTANTS, 0.0);
    GpuModelConstants { data: std::array::from_fn(|i| std::array::from_fn(|j| numbers[4 * i + j])) }
}

fn texture_ref(scene: &Scene, texture: Option<&TextureRef>) -> GpuTextureRef {
    let Some(texture) = texture else {
        return GpuTextureRef { texture: u32::MAX, ..bytemuck::Zeroable::zeroed() };
    };
    let transform = texture.transform;
    GpuTextureRef {
        texture: texture.texture as u32,
        sampler: sampler_index(&scene.textures[texture.texture]),
        uv_set: texture.uv_set as u32,
        padding: 0,
        x_axis: transform.matrix2.x_axis.to_array(),
        y_axis: transform.matrix2.y_axis.to_array(),
        translation: transform.translation.to_array(),
        padding_b: [0.0; 2],
    }
}
