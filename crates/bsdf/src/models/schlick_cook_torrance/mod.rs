//! Cook and Torrance's model in rational functions: nothing but + − · /.

use crate::models::blocks::distribution::{Distribution, Facets};
use crate::models::blocks::fresnel;
use crate::models::blocks::masking::schlick_k;
use crate::models::phong::conserves;
use crate::models::{
    Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, diffuse_and, make,
};
use kajo_params::Params;
use std::f64::consts::{FRAC_1_PI, PI};

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "schlick-cook-torrance",
    title: "Cook-Torrance in Schlick's rational functions",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Schlick94survey", "Schlick94", "Cook82"],
    claims: Some(Claims { parameters: Parameters::Physical, plausible: true, anisotropic: false, off_specular: true }),
    has_printed_form: true,
    params: Params::SPEC,
    aliases: &[("rd", &["kd"]), ("rs", &["ks"]), ("f", &["f0"])],
    wesl: Some(include_str!("schlick_cook_torrance.wesl")),
    make: make::<SchlickCookTorrance>,
};

/// The model.
pub struct SchlickCookTorrance;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse reflectance.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Weight of the specular reflection.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Root mean square slope: 0.01 is smooth and sharp, 0.6 rough and spread.
    #[param(default = 0.2, range = 0.001..=10.0)]
    pub m: f64,
    /// Reflectance at normal incidence.
    #[param(default = 0.04, range = 0.0..=1.0)]
    pub f0: [f64; 3],
}

/// f = d + s F D/((cos θ_i − k cos θ_i + k)(cos θ_r − k cos θ_r + k)).
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    diffuse: Rgb<T>,
    /// k_s f times the prefactor, and k_s (1 − f) times it.
    base: Rgb<T>,
    rest: Rgb<T>,
    facets: Facets<T>,
    k: T,
    one_minus_k: T,
    /// Mean k_d, k_s and f, for the sampler.
    weights: [T; 3],
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let t = (T::one() - g.cos_beta).max(T::zero());
        let t2 = t.squared();
        let fresnel = self.base + self.rest * (t2.squared() * t);
        // G/(cos θ_i cos θ_r) with the cosines cancelled.
        let seen = (g.cos_i() * self.one_minus_k + self.k) * (g.cos_r() * self.one_minus_k + self.k);
        self.diffuse + fresnel * (self.facets.d(g) / seen)
    }
}

impl Model for SchlickCookTorrance {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        conserves(params.kd, params.ks)
    }

    fn formula<T: Real>(p: &Params, form: Form) -> Formula<T> {
        let prefactor = match form {
            Form::Printed => 1.0 / PI,
            Form::Corrected => 0.25 / PI,
        };
        let channel = |f: fn(f64) -> f64| [0, 1, 2].map(|c| p.ks[c] * f(p.f0[c]) * prefactor);
        let k = schlick_k(p.m);
        Formula {
            diffuse: Rgb::of(p.kd.map(|kd| kd * FRAC_1_PI)),
            base: Rgb::of(channel(|f| f)),
            rest: Rgb::of(channel(|f| 1.0 - f)),
            facets: Facets::new(Distribution::Schlick, &[[1.0, p.m, p.m]]),
            k: T::of(k),
            one_minus_k: T::of(1.0 - k),
            weights: [p.kd, p.ks, p.f0].map(|k| T::of(k.iter().sum::<f64>() / 3.0)),
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        let [kd, ks, f] = formula.weights;
        let glossy = ks * fresnel::schlick(wo.z, f, T::one() - f);
        formula.facets.lobes().next().map_or_else(|| Mixture::new(&[(T::one(), Lobe::Cosine)]), |(_, lobe)| diffuse_and(kd, glossy, lobe))
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (d, b, r) = (formula.diffuse, formula.base, formula.rest);
        let (_, [[inverse_m2, _, peak], _]) = formula.facets.constants();
        vec![d.x, d.y, d.z, formula.k, b.x, b.y, b.z, inverse_m2, r.x, r.y, r.z, peak]
    }
}
