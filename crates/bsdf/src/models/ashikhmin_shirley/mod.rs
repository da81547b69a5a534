//! Ashikhmin and Shirley's anisotropic Phong model, with Fresnel's growth and a diffuse part below it.

use crate::models::{
    Claims, Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, diffuse_and, make,
};
use kajo_params::Params;
use std::f64::consts::PI;

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "ashikhmin-shirley",
    title: "Ashikhmin-Shirley",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Ashikhmin00", "Falski04"],
    claims: Some(Claims { parameters: Parameters::Empirical, plausible: true, anisotropic: true, off_specular: true }),
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[
        ("ks", &["rs"]),
        ("r_s", &["rs"]),
        ("kd", &["rd"]),
        ("r_d", &["rd"]),
        ("n", &["nx", "ny"]),
        ("n_x", &["nx"]),
        ("nu", &["nx"]),
        ("n_y", &["ny"]),
        ("nv", &["ny"]),
    ],
    wesl: Some(include_str!("ashikhmin_shirley.wesl")),
    make: make::<AshikhminShirley>,
};

/// The model.
pub struct AshikhminShirley;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Specular reflectance at normal incidence, R_s.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub rs: [f64; 3],
    /// Diffuse reflectance of the substrate below the specular layer, R_d; 0 for metals.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub rd: [f64; 3],
    /// Exponent along x.
    #[param(default = 10.0, range = 0.0..=1e6)]
    pub nx: f64,
    /// Exponent along y.
    #[param(default = 100.0, range = 0.0..=1e6)]
    pub ny: f64,
}

/// f = d (1 − (1 − cos θ_i/2)⁵)(1 − (1 − cos θ_r/2)⁵) + s F cosᵉδ/(cos β max(cos θ_i, cos θ_r)).
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    diffuse: Rgb<T>,
    rs: Rgb<T>,
    nx: T,
    ny: T,
    scale: T,
    /// Weights of the diffuse lobe.
    diffuse_weight: T,
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        // n_x cos²φ_h + n_y sin²φ_h
        let exponent = self.ny + (self.nx - self.ny) * g.cos2_phi_h();
        // Below, mirrored grazing directions would overflow f32.
        let cosines = (g.cos_beta * g.cos_i().max(g.cos_r())).max(T::of(1e-20));
        let highlight = self.scale * g.cos_delta().max(T::zero()).powf(exponent) / cosines;
        self.diffuse * (leaving(g.cos_i()) * leaving(g.cos_r())) + fresnel(self.rs, g.cos_beta) * highlight
    }
}

/// 1 − (1 − cos θ/2)⁵: what the specular layer leaves to the diffuse one.
#[inline(always)]
fn leaving<T: Real>(cos: T) -> T {
    T::one() - (T::one() - T::of(0.5) * cos).powi(5)
}

/// Schlick's approximation R_s + (1 − R_s)(1 − cos β)⁵.    (3.14)
#[inline(always)]
fn fresnel<T: Real>(rs: Rgb<T>, cos_beta: T) -> Rgb<T> {
    let w = (T::one() - cos_beta).max(T::zero()).powi(5);
    rs.map(|r| r + (T::one() - r) * w)
}

impl Model for AshikhminShirley {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn formula<T: Real>(params: &Params, _form: Form) -> Formula<T> {
        let below = std::array::from_fn(|k| params.rd[k] * (1.0 - params.rs[k]));
        Formula {
            diffuse: Rgb::of(below.map(|d: f64| 28.0 * d / (23.0 * PI))),
            rs: Rgb::of(params.rs),
            nx: T::of(params.nx),
            ny: T::of(params.ny),
            scale: T::of(((params.nx + 1.0) * (params.ny + 1.0)).sqrt() / (8.0 * PI)),
            diffuse_weight: T::of(below.iter().sum::<f64>() / 3.0),
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        let glossy = Lobe::HalfPower { nx: formula.nx, ny: formula.ny };
        diffuse_and(formula.diffuse_weight * leaving(wo.z), fresnel(formula.rs, wo.z).mean(), glossy)
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (d, s) = (formula.diffuse, formula.rs);
        vec![d.x, d.y, d.z, formula.nx, s.x, s.y, s.z, formula.ny, formula.scale]
    }
}
