//! Phong's highlight about the mirror direction, as the normalised BRDF and as shading functions.

use crate::models::{
    Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, diffuse_and, make,
};
use kajo_params::Params;
use std::f64::consts::{FRAC_1_PI, PI};

mod bsf;
#[cfg(test)]
mod tests;

pub use bsf::{BSF, PhongBsf, SCHLICK_BSF, SchlickPhongBsf};

/// The BRDF's entry.
pub const BRDF: ModelEntry = ModelEntry {
    id: "phong",
    title: "Phong (normalised BRDF)",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Phong75", "Lafortune94"],
    claims: Some(Claims { parameters: Parameters::Empirical, plausible: true, anisotropic: false, off_specular: false }),
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("rho_d", &["kd"]), ("rd", &["kd"]), ("rho_s", &["ks"]), ("rs", &["ks"])],
    wesl: Some(include_str!("phong.wesl")),
    make: make::<Phong>,
};

/// The BRDF.
pub struct Phong;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse reflectance.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Reflectance of the highlight at normal incidence.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Exponent: 1 is broad, several hundred sharp.
    #[param(default = 50.0, range = 0.0..=1e6)]
    pub n: f64,
}

/// f = d + s cosⁿα.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    diffuse: Rgb<T>,
    highlight: Rgb<T>,
    n: T,
    /// Weights of the lobes.
    weights: [T; 2],
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.diffuse + self.highlight * g.cos_alpha().max(T::zero()).powf(self.n)
    }
}

impl Model for Phong {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        conserves(params.kd, params.ks)
    }

    fn formula<T: Real>(params: &Params, _form: Form) -> Formula<T> {
        Formula {
            diffuse: Rgb::of(params.kd.map(|k| k * FRAC_1_PI)),
            highlight: Rgb::of(params.ks.map(|k| k * (params.n + 2.0) / (2.0 * PI))),
            n: T::of(params.n),
            weights: [params.kd, params.ks].map(|k| T::of(k.iter().sum())),
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        // Without an exponent the highlight is uniform, also where cos α is negative.
        let flat = formula.n <= T::zero();
        let axis = if flat { V3::new(T::zero(), T::zero(), T::one()) } else { V3::new(-wo.x, -wo.y, wo.z) };
        diffuse_and(formula.weights[0], formula.weights[1], Lobe::Power { axis, n: formula.n })
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (d, s) = (formula.diffuse, formula.highlight);
        vec![d.x, d.y, d.z, formula.n, s.x, s.y, s.z]
    }
}

/// Diffuse and specular reflectance share the light that arrives.
///
/// # Errors
/// A sentence when k_d + k_s > 1 in any channel.
pub fn conserves(kd: [f64; 3], ks: [f64; 3]) -> Result<(), String> {
    match kd.iter().zip(&ks).map(|(d, s)| d + s).find(|sum| *sum > 1.0 + 1e-9) {
        Some(sum) => Err(format!("kd + ks is {sum}; it must be at most 1 in every channel, or more light leaves than arrives")),
        None => Ok(()),
    }
}
