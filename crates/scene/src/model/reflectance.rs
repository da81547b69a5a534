//! A reflectance model of the library that takes the place of the glTF material's reflection.

use crate::Material;
use glam::{DVec3, Vec3};
use kajo_bsdf::models::{Form, ModelEntry, ModelError, Reflectance};
use kajo_params::ParamValues;
use kajo_sampling::hammersley_2d;
use kajo_units::LinearRgb;
use std::fmt;
use std::sync::Arc;

/// A model with its parameters. Normal map, coverage, emission and the direction of anisotropy stay the material's. The surface is opaque, and both
/// faces reflect alike.
#[derive(Clone)]
pub struct ReflectanceModel {
    /// Which model.
    pub entry: &'static ModelEntry,
    /// Its parameters.
    pub values: ParamValues,
    /// As printed, or corrected.
    pub form: Form,
    /// The model, ready to evaluate.
    pub reflectance: Arc<dyn Reflectance>,
}

impl ReflectanceModel {
    /// Prepares a model from `name = value` pairs.
    ///
    /// # Errors
    /// Those of [`ModelEntry::from_pairs`].
    pub fn new(entry: &'static ModelEntry, pairs: &[(&str, &str)], form: Form) -> Result<Self, ModelError> {
        let values = entry.values(pairs)?;
        Ok(Self { entry, reflectance: (entry.make)(&values, form)?, values, form })
    }

    /// The material with this model for its reflection. Its base colour becomes the model's albedo at normal incidence, for whoever asks no more
    /// of a surface; the ambient model, which adds radiance and reflects nothing, makes it unlit.
    pub fn replace_reflection(&self, material: Material) -> Material {
        let ambient = self.reflectance.ambient();
        let color = if ambient == DVec3::ZERO { self.normal_albedo() } else { ambient };
        Material {
            name: material.name,
            base_color: LinearRgb(color.as_vec3().clamp(Vec3::ZERO, Vec3::ONE)),
            alpha: material.alpha,
            alpha_mode: material.alpha_mode,
            double_sided: material.double_sided,
            normal_texture: material.normal_texture,
            normal_scale: material.normal_scale,
            emission: material.emission,
            emission_texture: material.emission_texture,
            anisotropy_rotation: material.anisotropy_rotation,
            metallic: 0.0,
            unlit: ambient != DVec3::ZERO,
            model: Some(self.clone()),
            ..Material::default()
        }
    }

    /// Reflectance at normal incidence, to about a percent.
    fn normal_albedo(&self) -> DVec3 {
        const SAMPLES: u32 = 1024;
        let model = &self.reflectance;
        let weight = |i: u32| {
            let u = hammersley_2d(i, SAMPLES);
            // A third number for the choice of lobe, independent of the other two: the golden ratio's multiples.
            let choice = (f64::from(i) * 0.618_033_988_749_895).fract();
            let wi = model.sample(DVec3::Z, [choice, f64::from(u.x), f64::from(u.y)])?;
            Some(model.f_cos(wi, DVec3::Z) / model.pdf(wi, DVec3::Z))
        };
        (0..SAMPLES).filter_map(weight).sum::<DVec3>() / f64::from(SAMPLES) + model.mirror(DVec3::Z)
    }
}

impl PartialEq for ReflectanceModel {
    fn eq(&self, other: &Self) -> bool {
        (self.entry.id, &self.values, self.form) == (other.entry.id, &other.values, other.form)
    }
}

/// Everything that tells two models apart: hashes of scenes are made of it.
impl fmt::Debug for ReflectanceModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {:?}", self.entry.id, self.values, self.form)
    }
}
