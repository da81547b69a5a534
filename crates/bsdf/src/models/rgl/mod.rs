//! Measured materials, isotropic and anisotropic: tables in the format of the RGL material database.

mod file;
mod table;
mod tabulate;
mod tensor;
#[cfg(test)]
mod tests;
mod warp;

pub use table::{Symmetry, Table};
pub use tabulate::Resolution;

use crate::models::{Form, Kind, Lobe, Made, ModelEntry, ModelError, Reflectance, V3};
use glam::{DVec3, Vec3};
use kajo_params::{ParamValues, Params};
use std::sync::Arc;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "rgl",
    title: "Measured (RGL)",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Dupuy18", "CIE15", "Walter07"],
    claims: None,
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("path", &["file"])],
    wesl: None,
    make,
};

/// The share of samples by the cosine, which reaches every direction that the table's densities leave out.
const COSINE_SHARE: f64 = 0.1;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// A `.bsdf` file of the RGL material database.
    #[param(default = 0)]
    pub file: &'static str,
}

fn make(values: &ParamValues, _form: Form) -> Made {
    let params = Params::from_values(values);
    if params.file.is_empty() {
        return Err(ModelError::Constraint("`file` is not given; give the path of a .bsdf file of the RGL material database".to_owned()));
    }
    Ok(Arc::new(Rgl::new(Table::read(params.file)?)))
}

/// A table, ready to evaluate and to sample.
#[derive(Clone, Debug)]
pub struct Rgl {
    table: Table,
}

impl Rgl {
    /// Of a table.
    pub fn new(table: Table) -> Self {
        Self { table }
    }
}

impl Reflectance for Rgl {
    fn kind(&self) -> Kind {
        Kind::Brdf
    }

    fn value(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        if wi.z > 0.0 && wo.z > 0.0 { self.table.value(wi, wo) } else { DVec3::ZERO }
    }

    fn value_f32(&self, wi: Vec3, wo: Vec3) -> Vec3 {
        self.value(wi.as_dvec3(), wo.as_dvec3()).as_vec3()
    }

    fn sample(&self, wo: DVec3, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        if wo.z <= 0.0 {
            None
        } else if choice < COSINE_SHARE {
            Lobe::Cosine.sample(V3::from(wo), [u, v]).map(DVec3::from).filter(|wi| wi.z > 0.0)
        } else {
            self.table.sample(wo, [u, v])
        }
    }

    fn sample_f32(&self, wo: Vec3, u: [f32; 3]) -> Option<Vec3> {
        self.sample(wo.as_dvec3(), u.map(f64::from)).map(|wi| wi.as_vec3())
    }

    fn pdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z > 0.0 && wo.z > 0.0 {
            (1.0 - COSINE_SHARE) * self.table.pdf(wi, wo) + COSINE_SHARE * Lobe::Cosine.pdf(V3::from(wi), V3::from(wo))
        } else {
            0.0
        }
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
