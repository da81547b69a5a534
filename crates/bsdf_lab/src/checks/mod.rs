//! What a plausible model must pass: reciprocity, energy, agreement of samples with their density and with the value, and finite numbers everywhere.

mod furnace;
mod reciprocity;
mod robustness;
mod sampling;

pub use furnace::{Furnace, furnace};
pub use reciprocity::{Reciprocity, reciprocity};
pub use robustness::{Robustness, robustness};
#[cfg(test)]
pub(crate) use sampling::test_against;
pub use sampling::{SamplingTest, sampling_test};

use glam::DVec3;
use kajo_bsdf::models::{Kind, Reflectance, V3};
use kajo_sampling::{Rng, warp};

/// f in 1/sr; of a shading function S/cos θ_i, which is what reciprocity is asked of.
pub(crate) fn brdf(model: &dyn Reflectance, wi: DVec3, wo: DVec3) -> DVec3 {
    match model.kind() {
        Kind::Brdf => model.value(wi, wo),
        Kind::Bsf => model.value(wi, wo) / wi.z,
    }
}

pub(crate) fn random_direction(rng: &mut Rng) -> DVec3 {
    warp::uniform_hemisphere(rng.next_2d()).as_dvec3().normalize()
}

pub(crate) fn from_degrees(theta: f64, phi: f64) -> DVec3 {
    V3::from_angles(theta.to_radians(), phi.to_radians()).into()
}

#[cfg(test)]
mod tests;
