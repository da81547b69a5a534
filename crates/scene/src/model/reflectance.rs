//! A reflectance model of the library that takes the place of the glTF material's reflection.

use kajo_bsdf::models::{Form, ModelEntry, ModelError, Reflectance};
use kajo_params::ParamValues;
use std::fmt;
use std::sync::Arc;

/// A model with its parameters. Normal maps, coverage, emission and culling stay the material's; base colour, roughness and all the rest of what
/// glTF says of reflection do not count. The surface is opaque, and both faces look the same.
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
