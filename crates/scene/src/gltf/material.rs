//! Materials with the ratified KHR_materials_* extensions.    glTF 2.0, section 3.9

use super::json::{self, MaterialExtensions, Num, TextureInfo, floats};
use super::mesh::MaterialNeeds;
use super::notes::Notes;
use super::resources::{Resources, label};
use super::texture::{Textures, UvSlots};
use crate::{AlphaMode, ColorSpace, Material, SceneError, TextureRef};
use kajo_units::{LinearRgb, LuminousEfficacy, Nits, Radians};

/// Reads one material; textures and notes as it goes.
struct Reader<'t, 'r, 'a> {
    textures: &'t mut Textures<'r, 'a>,
    notes: &'t mut Notes,
    slots: UvSlots,
    place: String,
}

/// A material of the file, and what meshes must know of it. `index` is that in the scene.
pub fn read(
    resources: &Resources<'_>,
    textures: &mut Textures<'_, '_>,
    notes: &mut Notes,
    material: usize,
    index: usize,
) -> Result<(Material, MaterialNeeds), SceneError> {
    let json = &resources.document.materials[material];
    let place = label("material", material, &json.name);
    notes.unknown_extensions(&place, json.extensions.other.keys());
    let mut reader = Reader { textures, notes, slots: UvSlots::default(), place };
    let mut out = Material { name: json.name.clone(), ..Material::default() };
    reader.core(resources, json, &mut out)?;
    reader.layers(&json.extensions, &mut out)?;
    reader.volume(&json.extensions, &mut out)?;
    reader.specular_glossiness(&json.extensions, &mut out)?;
    Ok((out.clone(), needs(&out, &reader.slots, index)))
}

/// What a mesh with the glTF default material must know.
pub fn default_needs(index: usize) -> MaterialNeeds {
    needs(&Material::default(), &UvSlots::default(), index)
}

fn needs(material: &Material, slots: &UvSlots, index: usize) -> MaterialNeeds {
    let along = [&material.normal_texture, &material.clearcoat_normal_texture, &material.anisotropy_texture];
    let along = along.into_iter().flatten().map(|texture| texture.uv_set).next();
    let tangent_uvs = along.or((material.anisotropy != 0.0).then_some(0));
    MaterialNeeds { material: index, uv_sets: slots.sets(), uses_uvs: slots.used(), tangent_uvs }
}

impl Reader<'_, '_, '_> {
    fn core(&mut self, resources: &Resources<'_>, json: &json::Material, out: &mut Material) -> Result<(), SceneError> {
        if let Some(pbr) = &json.pbr_metallic_roughness {
            if let Some(factor) = pbr.base_color_factor {
                let [r, g, b, a] = floats(factor);
                out.base_color = self.rgb("baseColorFactor", Some([Num(r), Num(g), Num(b)]), out.base_color, 1.0);
                out.alpha = self.number("baseColorFactor", Some(Num(a)), 1.0, 0.0, 1.0);
            }
            out.base_color_texture = self.srgb(&pbr.base_color_texture)?;
            out.metallic = self.number("metallicFactor", pbr.metallic_factor, 1.0, 0.0, 1.0);
            out.roughness = self.number("roughnessFactor", pbr.roughness_factor, 1.0, 0.0, 1.0);
            out.metallic_roughness_texture = self.linear(&pbr.metallic_roughness_texture)?;
        }
        out.normal_texture = self.linear(&json.normal_texture)?;
        out.normal_scale = json.normal_texture.as_ref().map_or(1.0, |info| info.scale.0);
        out.occlusion_texture = self.linear(&json.occlusion_texture)?;
        let strength = json.occlusion_texture.as_ref().map(|info| info.strength);
        out.occlusion_strength = self.number("occlusionTexture.strength", strength, 1.0, 0.0, 1.0);

        let factor = self.rgb("emissiveFactor", json.emissive_factor, LinearRgb::BLACK, f32::MAX);
        let strength = json.extensions.emissive_strength.as_ref().and_then(|extension| extension.emissive_strength);
        let luminance = Nits(self.number("emissiveStrength", strength, 1.0, 0.0, f32::MAX));
        let emission = factor * luminance.to_radiance(LuminousEfficacy::IMPORT).0;
        if !emission.is_finite() {
            return Err(resources.invalid(&self.place, "emissiveFactor × emissiveStrength exceeds the range of 32-bit floats"));
        }
        out.emission = emission;
        out.emission_texture = self.srgb(&json.emissive_texture)?;

        out.alpha_mode = match json.alpha_mode.as_deref() {
            None | Some("OPAQUE") => AlphaMode::Opaque,
            Some("MASK") => AlphaMode::Mask(json.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0)),
            Some("BLEND") => AlphaMode::Blend,
            Some(other) => return Err(resources.invalid(&self.place, format!("its alphaMode {other:?} is none of OPAQUE, MASK and BLEND"))),
        };
        out.double_sided = json.double_sided;
        out.unlit = json.extensions.unlit.is_some();
        Ok(())
    }

    /// Specular, clear coat, sheen, anisotropy, iridescence.
    fn layers(&mut self, extensions: &MaterialExtensions, out: &mut Material) -> Result<(), SceneError> {
        if let Some(json) = &extensions.specular {
            out.specular = self.number("specularFactor", json.specular_factor, 1.0, 0.0, 1.0);
            out.specular_texture = self.linear(&json.specular_texture)?;
            out.specular_color = self.rgb("specularColorFactor", json.specular_color_factor, LinearRgb::WHITE, f32::MAX);
            out.specular_color_texture = self.srgb(&json.specular_color_texture)?;
        }
        if let Some(json) = &extensions.clearcoat {
            out.clearcoat = self.number("clearcoatFactor", json.clearcoat_factor, 0.0, 0.0, 1.0);
            out.clearcoat_texture = self.linear(&json.clearcoat_texture)?;
            out.clearcoat_roughness = self.number("clearcoatRoughnessFactor", json.clearcoat_roughness_factor, 0.0, 0.0, 1.0);
            out.clearcoat_roughness_texture = self.linear(&json.clearcoat_roughness_texture)?;
            out.clearcoat_normal_texture = self.linear(&json.clearcoat_normal_texture)?;
            out.clearcoat_normal_scale = json.clearcoat_normal_texture.as_ref().map_or(1.0, |info| info.scale.0);
        }
        if let Some(json) = &extensions.sheen {
            out.sheen_color = self.rgb("sheenColorFactor", json.sheen_color_factor, LinearRgb::BLACK, 1.0);
            out.sheen_color_texture = self.srgb(&json.sheen_color_texture)?;
            out.sheen_roughness = self.number("sheenRoughnessFactor", json.sheen_roughness_factor, 0.0, 0.0, 1.0);
            out.sheen_roughness_texture = self.linear(&json.sheen_roughness_texture)?;
        }
        if let Some(json) = &extensions.anisotropy {
            out.anisotropy = self.number("anisotropyStrength", json.anisotropy_strength, 0.0, 0.0, 1.0);
            out.anisotropy_rotation = Radians(json.anisotropy_rotation.map_or(0.0, |rotation| rotation.0));
            out.anisotropy_texture = self.linear(&json.anisotropy_texture)?;
        }
        if let Some(json) = &extensions.iridescence {
            out.iridescence = self.number("iridescenceFactor", json.iridescence_factor, 0.0, 0.0, 1.0);
            out.iridescence_texture = self.linear(&json.iridescence_texture)?;
            out.iridescence_ior = self.number("iridescenceIor", json.iridescence_ior, 1.3, 1.0, f32::MAX);
            out.iridescence_thickness = [
                self.number("iridescenceThicknessMinimum", json.iridescence_thickness_minimum, 100.0, 0.0, f32::MAX),
                self.number("iridescenceThicknessMaximum", json.iridescence_thickness_maximum, 400.0, 0.0, f32::MAX),
            ];
            out.iridescence_thickness_texture = self.linear(&json.iridescence_thickness_texture)?;
        }
        Ok(())
    }

    /// Index of refraction, transmission, volume, dispersion.
    fn volume(&mut self, extensions: &MaterialExtensions, out: &mut Material) -> Result<(), SceneError> {
        if let Some(ior) = extensions.ior.as_ref().and_then(|json| json.ior) {
            // 0 is a special value: the Fresnel factor is 1.    KHR_materials_ior
            out.ior = if ior.0 == 0.0 { 0.0 } else { self.number("ior", Some(ior), 1.5, 1.0, f32::MAX) };
        }
        if let Some(json) = &extensions.transmission {
            out.transmission = self.number("transmissionFactor", json.transmission_factor, 0.0, 0.0, 1.0);
            out.transmission_texture = self.linear(&json.transmission_texture)?;
        }
        if let Some(json) = &extensions.volume {
            out.thickness = self.number("thicknessFactor", json.thickness_factor, 0.0, 0.0, f32::MAX);
            out.thickness_texture = self.linear(&json.thickness_texture)?;
            out.attenuation_distance = json.attenuation_distance.map_or(f32::INFINITY, |distance| distance.0);
            if out.attenuation_distance <= 0.0 {
                self.notes.add(&self.place, "attenuationDistance of 0 or less", "the volume is clear");
                out.attenuation_distance = f32::INFINITY;
            }
            out.attenuation_color = self.rgb("attenuationColor", json.attenuation_color, LinearRgb::WHITE, 1.0);
        }
        if let Some(json) = &extensions.dispersion {
            out.dispersion = self.number("dispersion", json.dispersion, 0.0, 0.0, f32::MAX);
        }
        Ok(())
    }

    /// KHR_materials_pbrSpecularGlossiness as a dielectric whose F0 is the specular colour: an index of refraction of 0 makes the Fresnel
    /// factor 1, and KHR_materials_specular scales it.    KHR_materials_ior, "Interaction with other extensions"
    fn specular_glossiness(&mut self, extensions: &MaterialExtensions, out: &mut Material) -> Result<(), SceneError> {
        let Some(json) = &extensions.specular_glossiness else { return Ok(()) };
        let feature = "KHR_materials_pbrSpecularGlossiness";
        self.notes.add(&self.place, feature, "converted to a dielectric with KHR_materials_specular; the core material is not used");
        let [r, g, b, a] = floats(json.diffuse_factor.unwrap_or([Num(1.0); 4]));
        out.base_color = self.rgb("diffuseFactor", Some([Num(r), Num(g), Num(b)]), LinearRgb::WHITE, 1.0);
        out.alpha = self.number("diffuseFactor", Some(Num(a)), 1.0, 0.0, 1.0);
        out.base_color_texture = self.srgb(&json.diffuse_texture)?;
        out.metallic = 0.0;
        out.ior = 0.0;
        out.specular_color = self.rgb("specularFactor", json.specular_factor, LinearRgb::WHITE, 1.0);
        out.specular_color_texture = self.srgb(&json.specular_glossiness_texture)?;
        let glossiness = self.number("glossinessFactor", json.glossiness_factor, 1.0, 0.0, 1.0);
        out.roughness = 1.0 - glossiness;
        out.metallic_roughness_texture = None;
        if let Some(info) = &json.specular_glossiness_texture {
            out.metallic_roughness_texture = self.textures.roughness_of(info, glossiness, &mut self.slots, &self.place, self.notes)?;
            out.roughness = 1.0;
        }
        Ok(())
    }

    fn srgb(&mut self, info: &Option<TextureInfo>) -> Result<Option<TextureRef>, SceneError> {
        self.texture(info, ColorSpace::Srgb)
    }

    fn linear(&mut self, info: &Option<TextureInfo>) -> Result<Option<TextureRef>, SceneError> {
        self.texture(info, ColorSpace::Linear)
    }

    fn texture(&mut self, info: &Option<TextureInfo>, color_space: ColorSpace) -> Result<Option<TextureRef>, SceneError> {
        match info {
            None => Ok(None),
            Some(info) => self.textures.reference(info, color_space, &mut self.slots, &self.place, self.notes),
        }
    }

    /// A factor, clamped to its range with a note.
    fn number(&mut self, name: &str, value: Option<Num>, default: f32, low: f32, high: f32) -> f32 {
        let value = value.map_or(default, |value| value.0);
        let clamped = value.clamp(low, high);
        if clamped != value {
            self.notes.add(&self.place, format!("{name} {value}"), format!("outside its range, {clamped} is used"));
        }
        clamped
    }

    /// A colour factor, each channel clamped to [0, high] with a note.
    fn rgb(&mut self, name: &str, value: Option<[Num; 3]>, default: LinearRgb, high: f32) -> LinearRgb {
        let Some(value) = value else { return default };
        let [r, g, b] = value.map(|channel| self.number(name, Some(channel), 0.0, 0.0, high));
        LinearRgb::new(r, g, b)
    }
}
