//! Lambert's diffuse reflection.

use crate::models::{Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, make};
use kajo_params::Params;
use std::f64::consts::FRAC_1_PI;

#[cfg(test)]
mod tests;

/// The BRDF's entry.
pub const BRDF: ModelEntry = ModelEntry {
    id: "lambert",
    title: "Lambert",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Lambert1760"],
    claims: Some(Claims { parameters: Parameters::Empirical, plausible: true, anisotropic: false, off_specular: false }),
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("rho", &["kd"]), ("rho_d", &["kd"]), ("rd", &["kd"])],
    wesl: Some(include_str!("lambert.wesl")),
    make: make::<Lambert>,
};

/// The shading function's entry.
pub const BSF: ModelEntry = ModelEntry {
    id: "lambert-bsf",
    title: "Lambert (shading function)",
    kind: Kind::Bsf,
    claims: None,
    wesl: Some(include_str!("lambert_bsf.wesl")),
    make: make::<LambertBsf>,
    ..BRDF
};

/// The BRDF.
pub struct Lambert;

/// The shading function.
pub struct LambertBsf;

/// Parameters of both.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse reflectance: the albedo, for every direction.
    #[param(default = 0.8, range = 0.0..=1.0)]
    pub kd: [f64; 3],
}

/// f = k_d/π.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    f: Rgb<T>,
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, _g: &Geometry<T>) -> Rgb<T> {
        self.f
    }
}

/// S = k_d cos θ_i.
#[derive(Clone, Copy, Debug)]
pub struct BsfFormula<T> {
    kd: Rgb<T>,
}

impl<T: Real> Evaluate<T> for BsfFormula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.kd * g.cos_i()
    }
}

impl Model for Lambert {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;
    const DIFFUSE: bool = true;

    fn formula<T: Real>(params: &Params, _form: Form) -> Formula<T> {
        Formula { f: Rgb::of(params.kd.map(|k| k * FRAC_1_PI)) }
    }

    fn lobes<T: Scalar>(_formula: &Formula<T>, _wo: V3<T>) -> Mixture<T> {
        Mixture::new(&[(T::one(), Lobe::Cosine)])
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        formula.f.to_array().to_vec()
    }
}

impl Model for LambertBsf {
    type Params = Params;
    type Formula<T: Real> = BsfFormula<T>;
    const KIND: Kind = Kind::Bsf;
    const DIFFUSE: bool = true;

    fn formula<T: Real>(params: &Params, _form: Form) -> BsfFormula<T> {
        BsfFormula { kd: Rgb::of(params.kd) }
    }

    fn lobes<T: Scalar>(_formula: &BsfFormula<T>, _wo: V3<T>) -> Mixture<T> {
        Mixture::new(&[(T::one(), Lobe::Cosine)])
    }

    fn constants(formula: &BsfFormula<f32>) -> Vec<f32> {
        formula.kd.to_array().to_vec()
    }
}
