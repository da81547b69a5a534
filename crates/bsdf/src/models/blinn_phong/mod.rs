//! Blinn's version of Phong's highlight, by the half vector: the normalised BRDF and the shading function.

use crate::models::blocks::highlight_shading::{self, HighlightShading};
use crate::models::phong::conserves;
use crate::models::{Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Real, Rgb, Scalar, V3, diffuse_and, make};
use kajo_params::Params;
use std::f64::consts::{FRAC_1_PI, PI};

#[cfg(test)]
mod tests;

/// The BRDF's entry.
pub const BRDF: ModelEntry = ModelEntry {
    id: "blinn-phong",
    title: "Blinn-Phong (normalised BRDF)",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Blinn77", "Falski04"],
    claims: None,
    has_printed_form: true,
    params: Params::SPEC,
    aliases: &[("rho_d", &["kd"]), ("rd", &["kd"]), ("rho_s", &["ks"]), ("rs", &["ks"])],
    wesl: Some(include_str!("blinn_phong.wesl")),
    make: make::<BlinnPhong>,
};

/// The shading function's entry.
pub const BSF: ModelEntry = ModelEntry {
    id: "blinn-phong-bsf",
    title: "Blinn-Phong (shading function)",
    kind: Kind::Bsf,
    params: highlight_shading::Params::SPEC,
    wesl: Some(include_str!("blinn_phong_bsf.wesl")),
    make: make::<BlinnPhongBsf>,
    ..BRDF
};

/// The BRDF.
pub struct BlinnPhong;

/// The shading function.
pub struct BlinnPhongBsf;

/// Parameters of the BRDF.
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

/// f = d + s cosⁿδ.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    diffuse: Rgb<T>,
    highlight: Rgb<T>,
    n: T,
    /// Weights of the lobes.
    weights: [T; 2],
}

/// The equation of the shading function.
#[derive(Clone, Copy, Debug)]
pub struct BsfFormula<T>(HighlightShading<T>);

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.diffuse + self.highlight * g.cos_delta().powf(self.n)
    }
}

impl<T: Real> Evaluate<T> for BsfFormula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.0.value(g.cos_i(), g.cos_delta())
    }
}

/// Factor of cosⁿδ. Corrected: the inverse of ∫ cosⁿδ cos θ_i dω_i seen along the normal, where δ = θ_i/2.
fn norm(n: f64, form: Form) -> f64 {
    match form {
        Form::Corrected => (n + 2.0) * (n + 4.0) / (8.0 * PI * (n + (-0.5 * n).exp2())),
        Form::Printed => (n + 2.0) / (2.0 * PI),
    }
}

impl Model for BlinnPhong {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        conserves(params.kd, params.ks)
    }

    fn formula<T: Real>(params: &Params, form: Form) -> Formula<T> {
        let factor = norm(params.n, form);
        let excess = factor / norm(params.n, Form::Corrected);
        let sum = |k: [f64; 3]| k.iter().sum::<f64>();
        Formula {
            diffuse: Rgb::of(params.kd.map(|k| k * FRAC_1_PI)),
            highlight: Rgb::of(params.ks.map(|k| k * factor)),
            n: T::of(params.n),
            weights: [T::of(sum(params.kd)), T::of(sum(params.ks) * excess)],
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, _wo: V3<T>) -> Mixture<T> {
        diffuse_and(formula.weights[0], formula.weights[1], Lobe::HalfPower { nx: formula.n, ny: formula.n })
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (d, s) = (formula.diffuse, formula.highlight);
        vec![d.x, d.y, d.z, formula.n, s.x, s.y, s.z]
    }
}

impl Model for BlinnPhongBsf {
    type Params = highlight_shading::Params;
    type Formula<T: Real> = BsfFormula<T>;
    const KIND: Kind = Kind::Bsf;

    fn check(params: &Self::Params) -> Result<(), String> {
        params.check()
    }

    fn formula<T: Real>(params: &Self::Params, form: Form) -> BsfFormula<T> {
        BsfFormula(HighlightShading::new(params, form, 4.0))
    }

    fn lobes<T: Scalar>(formula: &BsfFormula<T>, _wo: V3<T>) -> Mixture<T> {
        formula.0.mixture(|highlight, weight| highlight.lobes_of_half_vectors(weight))
    }

    fn constants(formula: &BsfFormula<f32>) -> Vec<f32> {
        formula.0.constants()
    }
}
