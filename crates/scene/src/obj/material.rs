//! MTL materials in glTF's terms.
//!
//! | MTL | becomes |
//! | --- | --- |
//! | `Kd`, `map_Kd` | base colour (linear factor, sRGB image) |
//! | `Ks`, `map_Ks` | colour of the dielectric's reflection, relative: 0.5 is an ordinary dielectric (F0 = 0.04), as modelling tools write it |
//! | `Ns` | roughness r: a Blinn-Phong lobe of exponent n is about as wide as GGX with α² = 2 / (n + 2), r = √α    \[Walter07] 5.2 |
//! | `Ni` | index of refraction, for transparent materials |
//! | `d`, `Tr`, `map_d` | transmission where `illum` is 4, 6, 7 or 9 (glass), else coverage |
//! | `Ke`, `map_Ke` | emitted radiance |
//! | `norm` | normal map |
//! | `Pr`, `Pm`, `Ps`, `Pc`, `Pcr`, `aniso`, `anisor` and their maps | the fields of the same meaning; then `Ks` and `Ns` have no effect |

use super::Notes;
use super::texture::{Images, Statement, combine, use_image};
use crate::{AlphaMode, ColorSpace, Material, Scene, SceneError, TextureRef};
use glam::Vec4;
use kajo_units::{LinearRgb, Radians};

/// What faces without a material get: a matt grey.
pub fn default() -> Material {
    Material { name: "default".into(), base_color: LinearRgb::splat(0.8), metallic: 0.0, ..Material::default() }
}

/// Converts one material, with its textures.
///
/// # Errors
/// A texture that is there and cannot be decoded.
pub fn convert(source: &tobj::Material, scene: &mut Scene, images: &mut Images, notes: &mut Notes) -> Result<Material, SceneError> {
    let place = format!("material \"{}\"", source.name);
    let mut reader = Reader { source, place, used: Vec::new(), scene, images, notes };
    let mut material = Material {
        name: source.name.clone(),
        base_color: reader.color("Kd", source.diffuse, 1.0).unwrap_or(LinearRgb::splat(0.8)),
        emission: reader.color("Ke", source.emissive, f32::MAX).unwrap_or_default(),
        metallic: 0.0,
        ..Material::default()
    };
    reader.opacity(&mut material)?;
    reader.reflection(&mut material)?;
    if let Some(statement) = reader.statement("map_Ke") {
        material.emission_texture = reader.image(&statement, ColorSpace::Srgb)?;
        if material.emission_texture.is_some() && material.emission.is_black() {
            material.emission = LinearRgb::WHITE;
        }
    }
    if let Some(statement) = reader.statement("norm") {
        material.normal_scale = statement.multiplier;
        material.normal_texture = reader.image(&statement, ColorSpace::Linear)?;
    }
    reader.rest();
    Ok(material)
}

/// Reads one material and keeps track of what was used.
struct Reader<'a, 'i, 'n> {
    source: &'a tobj::Material,
    place: String,
    used: Vec<&'static str>,
    scene: &'a mut Scene,
    images: &'a mut Images<'i>,
    notes: &'a mut Notes<'n>,
}

impl Reader<'_, '_, '_> {
    fn note(&mut self, feature: &str, consequence: &str) {
        self.notes.add(self.place.clone(), feature, consequence);
    }

    /// A number in `range`; one outside is clamped, one that is not finite is left out, both with a note.
    fn limited(&mut self, key: &str, value: f32, low: f32, high: f32) -> Option<f32> {
        if !value.is_finite() {
            self.note(key, &format!("{value} is no number; left out"));
            return None;
        }
        if !(low..=high).contains(&value) {
            self.note(key, &format!("{value} is outside {low} to {high}; clamped"));
        }
        Some(value.clamp(low, high))
    }

    fn color(&mut self, key: &str, value: Option<[f32; 3]>, high: f32) -> Option<LinearRgb> {
        let [r, g, b] = value?;
        Some(LinearRgb::new(self.limited(key, r, 0.0, high)?, self.limited(key, g, 0.0, high)?, self.limited(key, b, 0.0, high)?))
    }

    /// A number among the parameters that the parser does not know.
    fn number(&mut self, key: &'static str, low: f32, high: f32) -> Option<f32> {
        self.used.push(key);
        let text = self.source.unknown_param.get(key)?;
        match text.split_whitespace().next().and_then(|word| word.parse::<f32>().ok()) {
            Some(value) => self.limited(key, value, low, high),
            None => {
                self.note(key, &format!("`{text}` is no number; left out"));
                None
            }
        }
    }

    fn statement(&mut self, key: &'static str) -> Option<Statement> {
        self.used.push(key);
        let text = self.source.unknown_param.get(key)?.clone();
        Some(self.parse(key, &text))
    }

    fn parse(&mut self, key: &str, text: &str) -> Statement {
        let statement = Statement::parse(text);
        for option in &statement.ignored {
            self.note(&format!("{key} {option}"), "this texture option is ignored");
        }
        statement
    }

    fn image(&mut self, statement: &Statement, color_space: ColorSpace) -> Result<Option<TextureRef>, SceneError> {
        let image = self.images.get(statement, &self.place, self.notes)?;
        Ok(image.map(|image| use_image(self.scene, image, color_space, statement)))
    }

    /// Base colour image, coverage and transmission.
    fn opacity(&mut self, material: &mut Material) -> Result<(), SceneError> {
        let transparency = self.number("Tr", 0.0, 1.0).map(|t| 1.0 - t);
        let alpha = self.source.dissolve.and_then(|d| self.limited("d", d, 0.0, 1.0)).or(transparency).unwrap_or(1.0);
        let illumination = self.source.illumination_model.unwrap_or(2);
        let glass = matches!(illumination, 4 | 6 | 7 | 9);
        if glass && alpha < 1.0 {
            material.transmission = 1.0 - alpha;
            // 6 and 7 are "refraction on": the surface bounds a volume.
            material.thickness = if matches!(illumination, 6 | 7) { 1.0 } else { 0.0 };
            if let Some(ior) = self.source.optical_density.and_then(|n| self.limited("Ni", n, 1.0, 10.0)) {
                material.ior = ior;
            }
        } else if alpha < 1.0 {
            material.alpha = alpha;
            material.alpha_mode = AlphaMode::Blend;
        }

        let color = self.source.diffuse_texture.clone().map(|text| self.parse("map_Kd", &text));
        let cover = self.source.dissolve_texture.clone().map(|text| self.parse("map_d", &text));
        let color_image = color.as_ref().map(|s| self.images.get(s, &self.place, self.notes)).transpose()?.flatten();
        let cover_image = cover.as_ref().map(|s| self.images.get(s, &self.place, self.notes)).transpose()?.flatten();
        if color_image.is_some() && self.source.diffuse.is_some_and(|d| d == [0.0; 3]) {
            self.note("Kd", "black with a texture: white is meant by the tools that write this, and taken");
            material.base_color = LinearRgb::WHITE;
        }
        let (image, statement) = match (&color_image, &cover_image) {
            (None, None) => return Ok(()),
            (Some(image), None) => (image.clone(), color),
            (_, Some(cover_image)) => {
                material.alpha_mode = AlphaMode::Blend;
                // An image of one file for both carries coverage in alpha; an image of its own in its grey.
                let same = color_image.as_ref().is_some_and(|c| std::sync::Arc::ptr_eq(c, cover_image));
                let name = format!("{} with coverage", self.source.name);
                let merged = combine(name, [color_image.as_deref(), Some(&**cover_image)], |color, cover| {
                    let coverage = if same { cover.w } else { cover.truncate().element_sum() / 3.0 * cover.w };
                    color.truncate().extend(coverage)
                });
                (merged, color.or(cover))
            }
        };
        let statement = statement.expect("an image comes from a statement");
        material.base_color_texture = Some(use_image(self.scene, image, ColorSpace::Srgb, &statement));
        Ok(())
    }

    /// Roughness, metal, specular colour and the layers.
    fn reflection(&mut self, material: &mut Material) -> Result<(), SceneError> {
        let roughness = self.number("Pr", 0.0, 1.0);
        let metallic = self.number("Pm", 0.0, 1.0);
        let maps = [self.statement("map_Pr"), self.statement("map_Pm")];
        let physical = roughness.is_some() || metallic.is_some() || maps.iter().any(Option::is_some);
        let specular = self.color("Ks", self.source.specular, 1.0);
        let exponent = self.source.shininess.and_then(|n| self.limited("Ns", n, 0.0, 1e6));
        if physical {
            material.roughness = roughness.unwrap_or(if maps[0].is_some() { 1.0 } else { 0.5 });
            material.metallic = metallic.unwrap_or(if maps[1].is_some() { 1.0 } else { 0.0 });
            material.metallic_roughness_texture = self.packed(&maps)?;
        } else if let Some(ks) = specular.filter(|ks| !ks.is_black()) {
            material.specular_color = ks * 2.0;
            material.roughness = (2.0 / (exponent.unwrap_or(10.0) + 2.0)).sqrt().sqrt();
            if let Some(text) = self.source.specular_texture.clone() {
                let statement = self.parse("map_Ks", &text);
                material.specular_color_texture = self.image(&statement, ColorSpace::Srgb)?;
            }
        } else {
            material.specular = 0.0;
        }
        if let Some(strength) = self.number("Ps", 0.0, 1.0) {
            material.sheen_color = LinearRgb::splat(strength);
            material.sheen_roughness = 0.5;
        }
        material.clearcoat = self.number("Pc", 0.0, 1.0).unwrap_or(0.0);
        material.clearcoat_roughness = self.number("Pcr", 0.0, 1.0).unwrap_or(0.0);
        material.anisotropy = self.number("aniso", 0.0, 1.0).unwrap_or(0.0);
        material.anisotropy_rotation = Radians(self.number("anisor", 0.0, 1.0).unwrap_or(0.0) * std::f32::consts::TAU);
        Ok(())
    }

    /// One image with roughness in green and metal in blue, from an image of each.
    fn packed(&mut self, maps: &[Option<Statement>; 2]) -> Result<Option<TextureRef>, SceneError> {
        let mut found = [None, None];
        for (slot, statement) in found.iter_mut().zip(maps) {
            if let Some(statement) = statement {
                *slot = self.images.get(statement, &self.place, self.notes)?;
            }
        }
        let [rough, metal] = &found;
        let Some(statement) = maps.iter().flatten().next().filter(|_| rough.is_some() || metal.is_some()) else { return Ok(None) };
        let name = format!("{} roughness and metal", self.source.name);
        let image = combine(name, [rough.as_deref(), metal.as_deref()], |rough, metal| Vec4::new(1.0, rough.x, metal.x, 1.0));
        Ok(Some(use_image(self.scene, image, ColorSpace::Linear, statement)))
    }

    /// Notes on everything the file says that has no effect.
    fn rest(&mut self) {
        if self.source.ambient.is_some_and(|ka| ka != [0.0; 3]) || self.source.ambient_texture.is_some() {
            self.note("Ka", "no ambient term: ambient light is computed");
        }
        if self.source.normal_texture.is_some() {
            self.note("bump", "a height map; only normal maps (`norm`) are read: the surface stays smooth");
        }
        if self.source.shininess_texture.is_some() {
            self.note("map_Ns", "the exponent does not vary over the surface");
        }
        if self.source.optical_density.is_some_and(|n| n != 1.0 && n != 1.5) && self.source.dissolve.is_none_or(|d| d >= 1.0) {
            self.note("Ni", "used for transparent materials only: an opaque one keeps 1.5 and the strength of Ks");
        }
        let mut unknown: Vec<_> = self.source.unknown_param.keys().filter(|key| !self.used.contains(&key.as_str())).cloned().collect();
        unknown.sort();
        for key in unknown {
            let consequence = match key.as_str() {
                "Tf" => "the transmission filter is ignored: transmitted light takes Kd",
                "disp" => "displacement is ignored: the surface stays as its triangles",
                "refl" | "map_refl" => "a reflection map; reflections are computed",
                "map_Ps" | "map_Pc" | "map_Pcr" | "map_aniso" => "its factor stands alone",
                _ => "unknown statement",
            };
            self.note(&key, consequence);
        }
    }
}
