//! Torrance and Sparrow's facets, the root of all microfacet models, in the form that Blinn brought to graphics.

use crate::models::blocks::distribution::{Distribution, Facets};
use crate::models::blocks::fresnel::{Fresnel, FresnelForm};
use crate::models::blocks::masking::{Attenuation, Masking};
use crate::models::blocks::metals::Metal;
use crate::models::blocks::microfacet::Microfacets;
use crate::models::phong::conserves;
use crate::models::{Claims, Form, Kind, Mixture, Model, ModelEntry, Parameters, Real, Scalar, V3, make};
use kajo_params::Params;
use std::f64::consts::PI;

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "torrance-sparrow",
    title: "Torrance-Sparrow",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Torrance67", "Blinn77", "Smith67", "Schlick94survey"],
    claims: Some(Claims { parameters: Parameters::Physical, plausible: true, anisotropic: false, off_specular: true }),
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("rd", &["kd"]), ("rs", &["ks"]), ("n", &["eta"]), ("k", &["kappa"]), ("f", &["f0"])],
    wesl: Some(include_str!("torrance_sparrow.wesl")),
    make: make::<TorranceSparrow>,
};

/// The model.
pub struct TorranceSparrow;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse reflectance: light that facets reflect more than once.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Weight of the specular reflection.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Slope at which the distribution of facets has fallen to 1/e, rad.
    #[param(default = 0.2, range = 0.001..=10.0)]
    pub m: f64,
    /// Index of refraction, below over above.
    #[param(default = 1.5, range = 0.001..=100.0)]
    pub eta: [f64; 3],
    /// Extinction coefficient; 0 for what is no metal.
    #[param(default = 0.0, range = 0.0..=1e6)]
    pub kappa: [f64; 3],
    /// Reflectance at normal incidence, for the forms of Fresnel's term that take it instead of eta and kappa.
    #[param(default = 0.04, range = 0.0..=1.0)]
    pub f0: [f64; 3],
    /// A measured metal, in place of eta, kappa and f0.
    #[param(default = Metal::None)]
    pub metal: Metal,
    /// Distribution of facets D.
    #[param(default = Distribution::Gaussian)]
    pub distribution: Distribution,
    /// Geometrical attenuation G.
    #[param(default = Masking::VGroove)]
    pub masking: Masking,
    /// Fresnel's term F.
    #[param(default = FresnelForm::Exact)]
    pub fresnel: FresnelForm,
}

impl Model for TorranceSparrow {
    type Params = Params;
    type Formula<T: Real> = Microfacets<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        conserves(params.kd, params.ks)
    }

    fn formula<T: Real>(p: &Params, _form: Form) -> Microfacets<T> {
        Microfacets::new(
            p.kd,
            p.ks,
            0.25 / PI,
            Facets::new(p.distribution, &[[1.0, p.m, p.m]]),
            Attenuation::new(p.masking, p.m, p.m),
            Fresnel::new(p.fresnel, p.metal, p.eta, p.kappa, p.f0),
        )
    }

    fn lobes<T: Scalar>(formula: &Microfacets<T>, wo: V3<T>) -> Mixture<T> {
        formula.lobes(wo)
    }

    fn constants(formula: &Microfacets<f32>) -> Vec<f32> {
        formula.constants()
    }
}
