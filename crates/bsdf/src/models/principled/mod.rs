//! An opaque material by names that artists know, made of the layers of the glTF material: coat, cloth, film, metal, plastic.
//!
//! It is [`crate::Bsdf`] behind the parameters of the Disney and OpenPBR models, and so computes in f32; there is no second GGX here.

use crate::models::{Form, Kind, ModelEntry, ModelError, Reflectance};
use crate::{Bsdf, MaterialParams};
use glam::{DVec3, Vec2, Vec3};
use kajo_params::{ParamValues, Params};
use kajo_units::{LinearRgb, PerceptualRoughness, Radians};
use std::sync::Arc;

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "principled",
    title: "Principled (opaque layers)",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Burley12", "Kulla17", "Estevez17", "Belcour17"],
    claims: None,
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[
        ("base_colour", &["base_color"]),
        ("metallic", &["metalness"]),
        ("base_metalness", &["metalness"]),
        ("specular_roughness", &["roughness"]),
        ("specular_weight", &["specular"]),
        ("eta", &["ior"]),
        ("specular_ior", &["ior"]),
        ("anisotropic", &["anisotropy"]),
        ("specular_roughness_anisotropy", &["anisotropy"]),
        ("fuzz", &["sheen"]),
        ("fuzz_weight", &["sheen"]),
        ("fuzz_color", &["sheen_color"]),
        ("fuzz_roughness", &["sheen_roughness"]),
        ("coat", &["clearcoat"]),
        ("coat_weight", &["clearcoat"]),
        ("coat_roughness", &["clearcoat_roughness"]),
        ("thin_film_weight", &["film"]),
        ("thin_film_thickness", &["film_thickness"]),
        ("thin_film_ior", &["film_ior"]),
    ],
    wesl: Some(include_str!("principled.wesl")),
    make,
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse albedo of a dielectric, reflectance at normal incidence of a metal.
    #[param(default = 0.8, range = 0.0..=1.0)]
    pub base_color: [f64; 3],
    /// 0 dielectric, 1 metal.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub metalness: f64,
    /// Perceptual roughness of the base, √α. Below 0.032 it is 0.032, a highlight of 0.06°.
    #[param(default = 0.5, range = 0.0..=1.0)]
    pub roughness: f64,
    /// Strength of the dielectric's reflection.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub specular: f64,
    /// Colour of the dielectric's reflection at normal incidence.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub specular_color: [f64; 3],
    /// Index of refraction of the dielectric.
    #[param(default = 1.5, range = 1.0..=5.0)]
    pub ior: f64,
    /// Strength of the anisotropy: how far the roughness along the tangent goes to 1.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub anisotropy: f64,
    /// Direction of the larger roughness, counter-clockwise from the tangent.
    #[param(default = 0.0, range = -6.3..=6.3, unit = "rad")]
    pub anisotropy_rotation: f64,
    /// Strength of the sheen of upright fibres.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub sheen: f64,
    /// Colour of the sheen.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub sheen_color: [f64; 3],
    /// Perceptual roughness of the sheen.
    #[param(default = 0.5, range = 0.0..=1.0)]
    pub sheen_roughness: f64,
    /// Coverage by a clear coat of index 1.5.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub clearcoat: f64,
    /// Perceptual roughness of the clear coat. Below 0.032 it is 0.032.
    #[param(default = 0.1, range = 0.0..=1.0)]
    pub clearcoat_roughness: f64,
    /// Strength of interference in a thin film on the base.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub film: f64,
    /// Thickness of the film.
    #[param(default = 400.0, range = 0.0..=3000.0, unit = "nm")]
    pub film_thickness: f64,
    /// Index of refraction of the film.
    #[param(default = 1.3, range = 1.0..=5.0)]
    pub film_ior: f64,
}

/// Narrower lobes would be mirrors, which the material keeps apart and a reflectance has no value for.
const SMOOTHEST: f64 = 0.032;

impl Params {
    /// The same material in the words of glTF.
    pub fn material(&self) -> MaterialParams {
        let color = |rgb: [f64; 3]| LinearRgb(DVec3::from_array(rgb).as_vec3());
        let roughness = |r: f64| PerceptualRoughness(r.max(SMOOTHEST) as f32);
        MaterialParams {
            base_color: color(self.base_color),
            metallic: self.metalness as f32,
            roughness: roughness(self.roughness),
            ior: self.ior as f32,
            specular: self.specular as f32,
            specular_color: color(self.specular_color),
            clearcoat: self.clearcoat as f32,
            clearcoat_roughness: roughness(self.clearcoat_roughness),
            sheen_color: color(self.sheen_color.map(|c| c * self.sheen)),
            sheen_roughness: PerceptualRoughness(self.sheen_roughness as f32),
            anisotropy: self.anisotropy as f32,
            anisotropy_rotation: Radians(self.anisotropy_rotation as f32),
            iridescence: self.film as f32,
            iridescence_ior: self.film_ior as f32,
            iridescence_thickness: self.film_thickness as f32,
            ..MaterialParams::default()
        }
    }
}

fn make(values: &ParamValues, _form: Form) -> Result<Arc<dyn Reflectance>, ModelError> {
    let material = Params::from_values(values).material();
    Ok(Arc::new(Principled { bsdf: Bsdf::new(&material), material }))
}

/// The material, prepared.
struct Principled {
    bsdf: Bsdf,
    material: MaterialParams,
}

impl Reflectance for Principled {
    fn kind(&self) -> Kind {
        Kind::Brdf
    }

    fn value(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        self.value_f32(wi.as_vec3(), wo.as_vec3()).as_dvec3()
    }

    fn value_f32(&self, wi: Vec3, wo: Vec3) -> Vec3 {
        let above = wi.z > 0.0 && wo.z > 0.0;
        if above { self.bsdf.f_cos(wo, wi).total().0 / wi.z } else { Vec3::ZERO }
    }

    fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<DVec3> {
        // A number near 1 must not become 1.
        let u = u.map(|u| (u as f32).min(1.0 - f32::EPSILON / 2.0));
        self.sample_f32(wo.as_vec3(), u).map(|wi| wi.as_dvec3().normalize())
    }

    fn sample_f32(&self, wo: Vec3, [choice, u, v]: [f32; 3]) -> Option<Vec3> {
        let sample = if wo.z > 0.0 { self.bsdf.sample(wo, choice, Vec2::new(u, v)) } else { None };
        sample.map(|sample| sample.wi).filter(|wi| wi.z > 0.0)
    }

    fn pdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        f64::from(self.pdf_f32(wi.as_vec3(), wo.as_vec3()))
    }

    fn pdf_f32(&self, wi: Vec3, wo: Vec3) -> f32 {
        if wi.z > 0.0 && wo.z > 0.0 { self.bsdf.pdf(wo, wi) } else { 0.0 }
    }

    fn mirror(&self, _wo: DVec3) -> DVec3 {
        DVec3::ZERO
    }

    fn ambient(&self) -> DVec3 {
        DVec3::ZERO
    }

    fn constants(&self) -> Vec<f32> {
        let m = &self.material;
        let rows = [
            m.base_color.0.extend(m.metallic),
            m.specular_color.0.extend(m.specular),
            m.sheen_color.0.extend(m.sheen_roughness.0),
            glam::Vec4::new(m.roughness.0, m.ior, m.anisotropy, m.anisotropy_rotation.0),
            glam::Vec4::new(m.clearcoat, m.clearcoat_roughness.0, m.iridescence, m.iridescence_thickness),
            glam::Vec4::new(m.iridescence_ior, 0.0, 0.0, 0.0),
        ];
        rows.into_iter().flat_map(|row| row.to_array()).collect()
    }
}
