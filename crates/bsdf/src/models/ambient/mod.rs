//! Ambient light: a constant in place of light that was reflected before.

use crate::models::{Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Real, Rgb, Scalar, V3, make};
use kajo_params::Params;
use std::marker::PhantomData;

#[cfg(test)]
mod tests;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "ambient",
    title: "Ambient",
    kind: Kind::Bsf,
    doc: include_str!("doc.md"),
    cites: &["Falski04"],
    claims: None,
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[],
    wesl: Some(include_str!("ambient.wesl")),
    make: make::<Ambient>,
};

/// The model.
pub struct Ambient;

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Share of the ambient radiance that is seen.
    #[param(default = 0.2, range = 0.0..=1.0)]
    pub ka: [f64; 3],
}

/// S = 0: nothing depends on a light.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T>(PhantomData<T>);

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, _g: &Geometry<T>) -> Rgb<T> {
        Rgb::splat(T::zero())
    }
}

impl Model for Ambient {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Bsf;
    const DIFFUSE: bool = true;

    fn formula<T: Real>(_params: &Params, _form: Form) -> Formula<T> {
        Formula(PhantomData)
    }

    fn lobes<T: Scalar>(_formula: &Formula<T>, _wo: V3<T>) -> Mixture<T> {
        Mixture::new(&[(T::one(), Lobe::Cosine)])
    }

    fn constants(_formula: &Formula<f32>) -> Vec<f32> {
        Vec::new()
    }

    fn ambient(params: &Params) -> [f64; 3] {
        params.ka
    }
}
