//! Ward's elliptical Gaussian of slopes, with the parameters that he measured.

use crate::models::phong::conserves;
use crate::models::{
    Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, diffuse_and, make,
};
use kajo_params::{ParamChoice, Params};
use std::f64::consts::{FRAC_1_PI, PI};

mod measured;
#[cfg(test)]
mod tests;

pub use measured::Material;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "ward",
    title: "Ward",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Ward92", "Walter05", "Falski04"],
    claims: Some(Claims { parameters: Parameters::Physical, plausible: true, anisotropic: true, off_specular: false }),
    has_printed_form: true,
    params: Params::SPEC,
    aliases: &[
        ("rho_d", &["kd"]),
        ("rd", &["kd"]),
        ("rho_s", &["ks"]),
        ("rs", &["ks"]),
        ("m", &["mx", "my"]),
        ("alpha", &["mx", "my"]),
        ("m_x", &["mx"]),
        ("alpha_x", &["mx"]),
        ("m_y", &["my"]),
        ("alpha_y", &["my"]),
    ],
    wesl: Some(include_str!("ward.wesl")),
    make: make::<Ward>,
};

/// The model.
pub struct Ward;

/// The exponent of the Gaussian.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exponent {
    /// tan²δ: the Gaussian of slopes.    (4.14)
    Elliptic,
    /// 2 sin²δ/(1 + cos δ): cheaper, wider tails.    (4.15)
    Approximate,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse reflectance, ρ_d.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Specular reflectance, ρ_s.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Roughness along x: the root-mean-square slope.
    #[param(default = 0.15, range = 1e-4..=2.0)]
    pub mx: f64,
    /// Roughness along y: the root-mean-square slope.
    #[param(default = 0.15, range = 1e-4..=2.0)]
    pub my: f64,
    /// The exponent of the Gaussian.
    #[param(default = Exponent::Elliptic)]
    pub exponent: Exponent,
    /// A measured material, whose values replace kd, ks, mx and my.
    #[param(default = Material::None)]
    pub material: Material,
}

/// f = d + s (cos θ_i cos θ_r)^(−½) exp(−E(h)).
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    diffuse: Rgb<T>,
    highlight: Rgb<T>,
    /// 1/m_x² and 1/m_y², or the printed form's widths.
    x: T,
    y: T,
    exponent: Exponent,
    /// The slopes, for sampling.
    slopes: [T; 2],
    /// Weights of the lobes.
    weights: [T; 2],
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let ellipse = g.h.x.squared() * self.x + g.h.y.squared() * self.y;
        // tan²δ = (h_x² + h_y²)/h_z², 2 sin²δ/(1 + cos δ): no angle is formed.
        let exponent = match self.exponent {
            Exponent::Elliptic => ellipse / g.h.z.squared(),
            Exponent::Approximate => T::of(2.0) * ellipse / (T::one() + g.h.z),
        };
        // Below, mirrored grazing directions would overflow f32.
        let cosines = (g.cos_i() * g.cos_r()).max(T::of(1e-20));
        self.diffuse + self.highlight * ((-exponent).exp() / cosines.sqrt())
    }
}

impl Model for Ward {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        let params = params.measured();
        conserves(params.kd, params.ks)
    }

    fn formula<T: Real>(params: &Params, form: Form) -> Formula<T> {
        let Params { kd, ks, mx, my, exponent, .. } = params.measured();
        let norm = 4.0 * PI * mx * my;
        // Printed: (4.13), which is the isotropic case, has tan²δ/m, and (4.15) has 4π m_x m_y inside the exponent.
        let (x, y, norm) = match (form, exponent) {
            (Form::Printed, Exponent::Approximate) => (1.0 / (mx * mx * norm), 1.0 / (my * my * norm), 1.0),
            (Form::Printed, Exponent::Elliptic) if mx == my => (1.0 / mx, 1.0 / mx, norm),
            _ => (1.0 / (mx * mx), 1.0 / (my * my), norm),
        };
        Formula {
            diffuse: Rgb::of(kd.map(|k| k * FRAC_1_PI)),
            highlight: Rgb::of(ks.map(|k| k / norm)),
            x: T::of(x),
            y: T::of(y),
            exponent,
            slopes: [1.0 / x.sqrt(), 1.0 / y.sqrt()].map(T::of),
            weights: [kd, ks].map(|k| T::of(k.iter().sum())),
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, _wo: V3<T>) -> Mixture<T> {
        let [mx, my] = formula.slopes;
        let lobe = match formula.exponent {
            Exponent::Elliptic => Lobe::Gauss { mx, my },
            Exponent::Approximate => Lobe::GaussChord { mx, my },
        };
        diffuse_and(formula.weights[0], formula.weights[1], lobe)
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (d, s) = (formula.diffuse, formula.highlight);
        let approximate = if formula.exponent == Exponent::Approximate { 1.0 } else { 0.0 };
        vec![d.x, d.y, d.z, formula.x, s.x, s.y, s.z, formula.y, approximate]
    }
}
