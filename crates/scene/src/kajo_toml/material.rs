//! `[[material]]`: fields that replace those of a material of an asset.

use super::format::{AlphaModeName, Color, FilterName, MaterialTable, TextureTable, TextureValue, WrapName};
use super::placement::{ABOVE_ZERO, ANY, FROM_ZERO};
use super::source::Table;
use crate::{AlphaMode, ColorSpace, Filter, Material, SceneError, TextureRef, Wrap};
use glam::{Affine2, Vec2};
use kajo_units::{LinearRgb, Radians};
use std::ops::RangeInclusive;

const UNIT: RangeInclusive<f32> = 0.0..=1.0;

/// Decodes a texture file and adds it to the scene; returns the index of a texture with this sampler.
pub type AddTexture<'a> = dyn FnMut(&TextureTable, [Wrap; 2], Filter, ColorSpace) -> Result<usize, SceneError> + 'a;

/// Replaces the fields that the table has.
pub fn apply(table: &Table, values: &MaterialTable, material: &mut Material, add_texture: &mut AddTexture) -> Result<(), SceneError> {
    if values.model.is_none() && (values.params.is_some() || values.form.is_some()) {
        return Err(table.error("`params` and `form` belong to a `model`; name one, e.g. `model = \"ward\"`"));
    }
    let number = |key: &str, slot: &mut f32, value: Option<f32>, range: RangeInclusive<f32>| match value {
        Some(value) => table.number(key, value, range).map(|value| *slot = value),
        None => Ok(()),
    };
    let color = |key: &str, slot: &mut LinearRgb, value: Option<Color>, range: RangeInclusive<f32>| match value {
        Some(value) => table.numbers(key, value.0, range).map(|rgb| *slot = LinearRgb(rgb.into())),
        None => Ok(()),
    };
    let m = material;
    color("base_color", &mut m.base_color, values.base_color, UNIT)?;
    number("alpha", &mut m.alpha, values.alpha, UNIT)?;
    number("metallic", &mut m.metallic, values.metallic, UNIT)?;
    number("roughness", &mut m.roughness, values.roughness, UNIT)?;
    number("normal_scale", &mut m.normal_scale, values.normal_scale, ANY)?;
    number("occlusion_strength", &mut m.occlusion_strength, values.occlusion_strength, UNIT)?;
    color("emission", &mut m.emission, values.emission, FROM_ZERO)?;
    // 0 is the special value of KHR_materials_ior.
    if values.ior != Some(0.0) {
        number("ior", &mut m.ior, values.ior, 1.0..=f32::MAX)?;
    } else {
        m.ior = 0.0;
    }
    number("specular", &mut m.specular, values.specular, UNIT)?;
    color("specular_color", &mut m.specular_color, values.specular_color, FROM_ZERO)?;
    number("clearcoat", &mut m.clearcoat, values.clearcoat, UNIT)?;
    number("clearcoat_roughness", &mut m.clearcoat_roughness, values.clearcoat_roughness, UNIT)?;
    number("clearcoat_normal_scale", &mut m.clearcoat_normal_scale, values.clearcoat_normal_scale, ANY)?;
    color("sheen_color", &mut m.sheen_color, values.sheen_color, UNIT)?;
    number("sheen_roughness", &mut m.sheen_roughness, values.sheen_roughness, UNIT)?;
    number("anisotropy", &mut m.anisotropy, values.anisotropy, UNIT)?;
    number("anisotropy_rotation_deg", &mut m.anisotropy_rotation.0, values.anisotropy_rotation_deg, ANY)?;
    if values.anisotropy_rotation_deg.is_some() {
        m.anisotropy_rotation = Radians::from_degrees(m.anisotropy_rotation.0);
    }
    number("transmission", &mut m.transmission, values.transmission, UNIT)?;
    number("thickness", &mut m.thickness, values.thickness, FROM_ZERO)?;
    if values.attenuation_distance == Some(f32::INFINITY) {
        m.attenuation_distance = f32::INFINITY;
    } else {
        number("attenuation_distance", &mut m.attenuation_distance, values.attenuation_distance, ABOVE_ZERO)?;
    }
    color("attenuation_color", &mut m.attenuation_color, values.attenuation_color, UNIT)?;
    number("iridescence", &mut m.iridescence, values.iridescence, UNIT)?;
    number("iridescence_ior", &mut m.iridescence_ior, values.iridescence_ior, 1.0..=f32::MAX)?;
    if let Some(range) = values.iridescence_thickness {
        m.iridescence_thickness = table.numbers("iridescence_thickness", range, FROM_ZERO)?;
    }
    number("dispersion", &mut m.dispersion, values.dispersion, FROM_ZERO)?;
    m.double_sided = values.double_sided.unwrap_or(m.double_sided);
    m.unlit = values.unlit.unwrap_or(m.unlit);
    alpha_mode(table, values, m)?;

    use ColorSpace::{Linear, Srgb};
    for (key, slot, value, color_space) in [
        ("base_color_texture", &mut m.base_color_texture, &values.base_color_texture, Srgb),
        ("metallic_roughness_texture", &mut m.metallic_roughness_texture, &values.metallic_roughness_texture, Linear),
        ("normal_texture", &mut m.normal_texture, &values.normal_texture, Linear),
        ("occlusion_texture", &mut m.occlusion_texture, &values.occlusion_texture, Linear),
        ("emission_texture", &mut m.emission_texture, &values.emission_texture, Srgb),
        ("specular_texture", &mut m.specular_texture, &values.specular_texture, Linear),
        ("specular_color_texture", &mut m.specular_color_texture, &values.specular_color_texture, Srgb),
        ("clearcoat_texture", &mut m.clearcoat_texture, &values.clearcoat_texture, Linear),
        ("clearcoat_roughness_texture", &mut m.clearcoat_roughness_texture, &values.clearcoat_roughness_texture, Linear),
        ("clearcoat_normal_texture", &mut m.clearcoat_normal_texture, &values.clearcoat_normal_texture, Linear),
        ("sheen_color_texture", &mut m.sheen_color_texture, &values.sheen_color_texture, Srgb),
        ("sheen_roughness_texture", &mut m.sheen_roughness_texture, &values.sheen_roughness_texture, Linear),
        ("anisotropy_texture", &mut m.anisotropy_texture, &values.anisotropy_texture, Linear),
        ("transmission_texture", &mut m.transmission_texture, &values.transmission_texture, Linear),
        ("thickness_texture", &mut m.thickness_texture, &values.thickness_texture, Linear),
        ("iridescence_texture", &mut m.iridescence_texture, &values.iridescence_texture, Linear),
        ("iridescence_thickness_texture", &mut m.iridescence_thickness_texture, &values.iridescence_thickness_texture, Linear),
    ] {
        match value {
            None => {}
            Some(TextureValue::Off) => *slot = None,
            Some(TextureValue::On(texture)) => *slot = Some(use_texture(table, key, texture, color_space, add_texture)?),
        }
    }
    Ok(())
}

fn alpha_mode(table: &Table, values: &MaterialTable, material: &mut Material) -> Result<(), SceneError> {
    let cutoff = values.alpha_cutoff.map(|cutoff| table.number("alpha_cutoff", cutoff, FROM_ZERO)).transpose()?;
    let known = match material.alpha_mode {
        AlphaMode::Mask(cutoff) => cutoff,
        _ => 0.5,
    };
    material.alpha_mode = match (values.alpha_mode, material.alpha_mode) {
        (Some(AlphaModeName::Mask), _) | (None, AlphaMode::Mask(_)) => AlphaMode::Mask(cutoff.unwrap_or(known)),
        (_, _) if cutoff.is_some() => return Err(table.error("`alpha_cutoff` belongs to `alpha_mode = \"mask\"`")),
        (Some(AlphaModeName::Opaque), _) => AlphaMode::Opaque,
        (Some(AlphaModeName::Blend), _) => AlphaMode::Blend,
        (None, kept) => kept,
    };
    Ok(())
}

fn use_texture(
    table: &Table,
    key: &str,
    texture: &TextureTable,
    color_space: ColorSpace,
    add_texture: &mut AddTexture,
) -> Result<TextureRef, SceneError> {
    if texture.uv_set > 1 {
        return Err(table.error(format!("`{key}`: `uv_set` is {}; give 0 or 1", texture.uv_set)));
    }
    let wrap = match texture.wrap {
        WrapName::Repeat => Wrap::Repeat,
        WrapName::Mirror => Wrap::Mirror,
        WrapName::Clamp => Wrap::Clamp,
    };
    let filter = match texture.filter {
        FilterName::Nearest => Filter::Nearest,
        FilterName::Linear => Filter::Linear,
    };
    let offset = Vec2::from_array(table.numbers(key, texture.offset, ANY)?);
    let scale = Vec2::from_array(table.numbers(key, texture.scale, ANY)?);
    let rotation = table.number(key, texture.rotation_deg, ANY)?.to_radians();
    // KHR_texture_transform turns counter-clockwise as seen in the image, whose v runs down.
    let transform = Affine2::from_translation(offset) * Affine2::from_angle(-rotation) * Affine2::from_scale(scale);
    Ok(TextureRef { texture: add_texture(texture, [wrap; 2], filter, color_space)?, uv_set: texture.uv_set, transform })
}
