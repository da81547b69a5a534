//! Cook and Torrance's model of rough metals and plastics, isotropic and elliptic, with every part exchangeable.

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
    id: "cook-torrance",
    title: "Cook-Torrance",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Cook82", "Beckmann63", "Torrance67", "Blinn77", "Smith67", "Schlick94survey", "Johnson72", "Johnson74", "Rakic95"],
    claims: Some(Claims { parameters: Parameters::Physical, plausible: true, anisotropic: false, off_specular: true }),
    has_printed_form: true,
    params: Params::SPEC,
    aliases: &[("m", &["mx", "my"]), ("rd", &["kd"]), ("rs", &["ks"]), ("n", &["eta"]), ("k", &["kappa"]), ("f", &["f0"])],
    wesl: Some(include_str!("cook_torrance.wesl")),
    make: make::<CookTorrance>,
};

/// The model.
pub struct CookTorrance;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse reflectance.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Weight of the specular reflection.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Root mean square slope along x: 0.01 is smooth and sharp, 0.6 rough and spread.
    #[param(default = 0.2, range = 0.001..=10.0)]
    pub mx: f64,
    /// Root mean square slope along y.
    #[param(default = 0.2, range = 0.001..=10.0)]
    pub my: f64,
    /// Share of a second scale of roughness, on top of the first.
    #[param(default = 0.0, range = 0.0..=1.0)]
    pub w2: f64,
    /// Root mean square slope of the second scale.
    #[param(default = 0.6, range = 0.001..=10.0)]
    pub m2: f64,
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
    #[param(default = Distribution::Beckmann)]
    pub distribution: Distribution,
    /// Geometrical attenuation G.
    #[param(default = Masking::VGroove)]
    pub masking: Masking,
    /// Fresnel's term F.
    #[param(default = FresnelForm::Exact)]
    pub fresnel: FresnelForm,
}

impl Model for CookTorrance {
    type Params = Params;
    type Formula<T: Real> = Microfacets<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        conserves(params.kd, params.ks)
    }

    fn formula<T: Real>(p: &Params, form: Form) -> Microfacets<T> {
        let prefactor = match form {
            Form::Printed => 1.0 / PI,
            Form::Corrected => 0.25 / PI,
        };
        let scales = [[1.0 - p.w2, p.mx, p.my], [p.w2, p.m2, p.m2]];
        let used = if p.w2 > 0.0 { &scales[..] } else { &scales[..1] };
        // One attenuation for both scales: of the root mean square of their slopes.
        let rms = |m: f64| ((1.0 - p.w2) * m * m + p.w2 * p.m2 * p.m2).sqrt();
        Microfacets::new(
            p.kd,
            p.ks,
            prefactor,
            Facets::new(p.distribution, used),
            Attenuation::new(p.masking, rms(p.mx), rms(p.my)),
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
