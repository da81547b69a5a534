//! Oren and Nayar's rough diffuse reflection.

use crate::models::{Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Real, Rgb, Scalar, V3, make};
use kajo_params::{ParamChoice, Params};
use std::f64::consts::{FRAC_1_PI, PI};

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "oren-nayar",
    title: "Oren-Nayar",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Oren94"],
    claims: None,
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[("rho", &["kd"]), ("rho_d", &["kd"]), ("rd", &["kd"])],
    wesl: Some(include_str!("oren_nayar.wesl")),
    make: make::<OrenNayar>,
};

/// The model.
pub struct OrenNayar;

/// How much of the model.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terms {
    /// The short form, without light between facets.
    Qualitative,
    /// All terms, with one reflection between facets.
    Full,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Reflectance of the facets.
    #[param(default = 0.8, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Standard deviation of the facets' slope angle; 0 is Lambert.
    #[param(default = 20.0, range = 0.0..=90.0, unit = "°")]
    pub sigma: f64,
    /// How much of the model.
    #[param(default = Terms::Qualitative)]
    pub terms: Terms,
}

/// The equation with its coefficients; see doc.md.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    rho: Rgb<T>,
    a: T,
    b: T,
    c3: T,
    between: T,
    terms: Terms,
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let sine = |cos: T| (T::one() - cos.squared()).max(T::zero()).sqrt();
        let (sin_i, sin_r) = (sine(g.cos_i()), sine(g.cos_r()));
        // cos Δφ sin θ_i sin θ_r is the dot product of the tangential parts. Below, one direction is the normal and Δφ does not matter.
        let across = sin_i * sin_r;
        let degenerate = across.le(T::of(1e-12));
        let cosine = (g.wi.x * g.wo.x + g.wi.y * g.wo.y) / T::select(degenerate, T::one(), across);
        let cos_phi = T::select(degenerate, T::zero(), cosine.clamp(-1.0, 1.0));
        let sin_alpha = sin_i.max(sin_r);
        let tan_beta = sin_i.min(sin_r) / g.cos_i().max(g.cos_r());
        match self.terms {
            Terms::Qualitative => self.rho * ((self.a + self.b * cos_phi.max(T::zero()) * sin_alpha * tan_beta) * T::of(FRAC_1_PI)),
            Terms::Full => {
                let alpha = g.cos_i().min(g.cos_r()).clamp(0.0, 1.0).acos();
                let beta = g.cos_i().max(g.cos_r()).clamp(0.0, 1.0).acos();
                let share = beta * T::of(2.0 / PI);
                let c2 = self.b * (sin_alpha - T::select(cos_phi.lt(T::zero()), share.powi(3), T::zero()));
                let c3 = self.c3 * (alpha * beta * T::of(4.0 / (PI * PI))).squared();
                let half = (alpha + beta) * T::of(0.5);
                let direct = self.a + cos_phi * c2 * tan_beta + (T::one() - cos_phi.abs()) * c3 * (half.sin() / half.cos());
                let between = self.between * (T::one() - cos_phi * share.squared());
                // Deviation: at grazing angles the fitted C₂ tan β outweighs the rest and f would be negative.
                self.rho.times(Rgb::splat(direct) + self.rho * between).map(|f| f.max(T::zero())) * T::of(FRAC_1_PI)
            }
        }
    }
}

impl Model for OrenNayar {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;
    const DIFFUSE: bool = true;

    fn formula<T: Real>(params: &Params, _form: Form) -> Formula<T> {
        let s2 = params.sigma.to_radians().powi(2);
        Formula {
            rho: Rgb::of(params.kd),
            a: T::of(1.0 - 0.5 * s2 / (s2 + 0.33)),
            b: T::of(0.45 * s2 / (s2 + 0.09)),
            c3: T::of(0.125 * s2 / (s2 + 0.09)),
            between: T::of(0.17 * s2 / (s2 + 0.13)),
            terms: params.terms,
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, _wo: V3<T>) -> Mixture<T> {
        // The rest grows like tan β, against which f cos θ stays bounded: uniform over the hemisphere.
        let up = V3::new(T::zero(), T::zero(), T::one());
        Mixture::new(&[(formula.a, Lobe::Cosine), (formula.b * T::of(0.5), Lobe::Power { axis: up, n: T::zero() })])
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let Formula { rho, a, b, c3, between, terms } = *formula;
        vec![rho.x, rho.y, rho.z, a, b, c3, between, if terms == Terms::Full { 1.0 } else { 0.0 }]
    }
}
