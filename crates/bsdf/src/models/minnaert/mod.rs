//! Minnaert's diffuse reflection with a dark or bright limb.

use crate::models::{Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Real, Rgb, Scalar, V3, make};
use kajo_params::Params;
use std::f64::consts::TAU;

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "minnaert",
    title: "Minnaert",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Minnaert41", "Lafortune97", "Falski04"],
    claims: None,
    has_printed_form: true,
    params: Params::SPEC,
    aliases: &[("rho", &["kd"]), ("rho_d", &["kd"]), ("rd", &["kd"])],
    wesl: Some(include_str!("minnaert.wesl")),
    make: make::<Minnaert>,
};

/// The model.
pub struct Minnaert;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Reflectance at normal incidence.
    #[param(default = 0.5, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Exponent: 0 is Lambert, larger darkens the limb.
    #[param(default = 0.7, range = 0.0..=10000.0)]
    pub n: f64,
}

/// f = s (cos θ_i cos θ_r)ⁿ.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    scale: Rgb<T>,
    n: T,
    /// 1 for the printed product of x components, else 0.
    printed: T,
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let printed = T::zero().lt(self.printed);
        let product = T::select(printed, (g.wi.x * g.wo.x).max(T::zero()), g.cos_i() * g.cos_r());
        self.scale * product.powf(self.n)
    }
}

impl Model for Minnaert {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;
    const DIFFUSE: bool = true;

    fn formula<T: Real>(params: &Params, form: Form) -> Formula<T> {
        Formula {
            scale: Rgb::of(params.kd.map(|k| k * (params.n + 2.0) / TAU)),
            n: T::of(params.n),
            printed: T::of(if form == Form::Printed { 1.0 } else { 0.0 }),
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        // f cos θ_i is cosⁿ⁺¹ about the normal; the printed one is about the tangent, and the cosine lobe covers the rest of it.
        let axis = if formula.printed > T::zero() {
            V3::new(if wo.x < T::zero() { -T::one() } else { T::one() }, T::zero(), T::zero())
        } else {
            V3::new(T::zero(), T::zero(), T::one())
        };
        Mixture::new(&[
            (T::one() - formula.printed * T::of(0.5), Lobe::Power { axis, n: formula.n + T::one() - formula.printed }),
            (formula.printed, Lobe::Cosine),
        ])
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let s = formula.scale;
        vec![s.x, s.y, s.z, formula.n, formula.printed]
    }
}
