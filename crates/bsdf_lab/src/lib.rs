//! Measures reflectance models: albedo, reciprocity, energy, sampling.
//!
//! Everything here works on [`kajo_bsdf::models::Reflectance`], so a model that is registered is measured without a line here.

mod albedo;
pub mod bench;
pub mod checks;
mod claims;
mod errata;
pub mod factor;
pub mod figures;
pub mod fit;
pub mod plot;
mod quadrature;
mod table;

pub use albedo::{SampledAlbedo, albedo, sampled_albedo};
pub use claims::{Claim, Measured, claims};
pub use errata::{Erratum, errata};
pub use quadrature::{Cell, angles, integrate};
pub use table::{TableRow, probe, survey_table};
