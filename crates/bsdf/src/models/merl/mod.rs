//! Measured isotropic materials: tables in the format of the MERL database.

mod coordinates;
mod file;
mod table;
#[cfg(test)]
mod tests;

pub use coordinates::HalfDifference;
pub use table::{BINS, Interpolation, Table};

use crate::models::blocks::half_vectors::HalfVectors;
use crate::models::{Form, Kind, Made, ModelEntry, ModelError, Reflectance};
use glam::{DVec3, Vec3};
use kajo_params::{ParamValues, Params};
use std::sync::Arc;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "merl",
    title: "Measured (MERL)",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Matusik03", "Rusinkiewicz98", "Walter07"],
    claims: None,
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("path", &["file"])],
    wesl: None,
    make,
};

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// A `.binary` file of the MERL database.
    #[param(default = 0)]
    pub file: &'static str,
    /// How values between the centres of bins are found.
    #[param(default = Interpolation::Linear)]
    pub interpolation: Interpolation,
}

fn make(values: &ParamValues, _form: Form) -> Made {
    let params = Params::from_values(values);
    if params.file.is_empty() {
        return Err(ModelError::Constraint("`file` is not given; give the path of a .binary file of the MERL database".to_owned()));
    }
    Ok(Arc::new(Merl::new(Table::read(params.file)?, params.interpolation)))
}

/// A table, ready to evaluate and to sample.
#[derive(Clone, Debug)]
pub struct Merl {
    table: Table,
    interpolation: Interpolation,
    half_vectors: HalfVectors,
}

impl Merl {
    /// Tabulates what is sampled.
    pub fn new(table: Table, interpolation: Interpolation) -> Self {
        let half_vectors = HalfVectors::new(|wi, wo| table.value(wi, wo, interpolation).element_sum() * wi.z);
        Self { table, interpolation, half_vectors }
    }
}

impl Reflectance for Merl {
    fn kind(&self) -> Kind {
        Kind::Brdf
    }

    fn value(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        if wi.z > 0.0 && wo.z > 0.0 { self.table.value(wi, wo, self.interpolation) } else { DVec3::ZERO }
    }

    fn value_f32(&self, wi: Vec3, wo: Vec3) -> Vec3 {
        self.value(wi.as_dvec3(), wo.as_dvec3()).as_vec3()
    }

    fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if wo.z > 0.0 { self.half_vectors.sample(wo, u) } else { None }
    }

    fn sample_f32(&self, wo: Vec3, u: [f32; 3]) -> Option<Vec3> {
        self.sample(wo.as_dvec3(), u.map(f64::from)).map(|wi| wi.as_vec3())
    }

    fn pdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        self.half_vectors.pdf(wi, wo)
    }

    fn pdf_f32(&self, wi: Vec3, wo: Vec3) -> f32 {
        self.pdf(wi.as_dvec3(), wo.as_dvec3()) as f32
    }

    fn mirror(&self, _wo: DVec3) -> DVec3 {
        DVec3::ZERO
    }

    fn ambient(&self) -> DVec3 {
        DVec3::ZERO
    }

    fn constants(&self) -> Vec<f32> {
        Vec::new()
    }
}
