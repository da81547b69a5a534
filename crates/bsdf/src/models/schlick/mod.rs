//! Schlick's model by rational functions: one layer (`schlick-single`), or a translucent one over an opaque one (`schlick-double`).

use crate::models::{Claims, Evaluate, Form, Geometry, Kind, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, make};
use kajo_params::{ParamChoice, Params};

mod layer;
#[cfg(test)]
mod tests;

use layer::Layer;

/// The entry of one layer.
pub const SINGLE: ModelEntry = ModelEntry {
    id: "schlick-single",
    title: "Schlick, one layer",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Schlick94", "Falski04"],
    claims: Some(Claims { parameters: Parameters::Physical, plausible: true, anisotropic: true, off_specular: true }),
    has_printed_form: true,
    params: SingleParams::SPEC,
    aliases: &[("c1", &["c"]), ("r1", &["r"]), ("p1", &["p"])],
    wesl: Some(include_str!("schlick_single.wesl")),
    make: make::<Single>,
};

/// The entry of two layers.
pub const DOUBLE: ModelEntry = ModelEntry {
    id: "schlick-double",
    title: "Schlick, two layers",
    params: DoubleParams::SPEC,
    aliases: &[
        ("c1", &["c"]),
        ("r1", &["r"]),
        ("p1", &["p"]),
        ("c_prime", &["c2"]),
        ("r_prime", &["r2"]),
        ("p_prime", &["p2"]),
        ("c'", &["c2"]),
        ("r'", &["r2"]),
        ("p'", &["p2"]),
    ],
    wesl: Some(include_str!("schlick_double.wesl")),
    make: make::<Double>,
    ..SINGLE
};

/// One layer: metal, glass, paper, cotton.
pub struct Single;

/// A translucent layer over an opaque one: plastic, skin, varnished wood.
pub struct Double;

/// The spectral factor S.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spectral {
    /// S = C.    (4.17)
    Constant,
    /// S = C + (1 − C)(1 − cos β)⁵.    (4.18)
    Fresnel,
}

/// The directional factor D.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Directional {
    /// D = Z A/(4π cos θ_i cos θ_r).    (4.19)
    Simple,
    /// With self-blocking, and the blocked light leaving diffusely.    (4.22)
    Blocked,
}

/// Parameters of one layer.
#[derive(Params, Clone, Copy, Debug)]
pub struct SingleParams {
    /// Reflectance at normal incidence.
    #[param(default = 0.6, range = 0.0..=1.0)]
    pub c: [f64; 3],
    /// Roughness: 0 mirror, 1 diffuse. Below 1e-6 it is 1e-6.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub r: f64,
    /// Isotropy: 0 fully anisotropic, 1 isotropic. Below 1e-4 it is 1e-4.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub p: f64,
    /// The spectral factor.
    #[param(default = Spectral::Fresnel)]
    pub spectral: Spectral,
    /// The directional factor.
    #[param(default = Directional::Blocked)]
    pub directional: Directional,
}

/// Parameters of two layers.
#[derive(Params, Clone, Copy, Debug)]
pub struct DoubleParams {
    /// Reflectance of the upper layer at normal incidence.
    #[param(default = 0.04, range = 0.0..=1.0)]
    pub c: [f64; 3],
    /// Roughness of the upper layer: 0 mirror, 1 diffuse. Below 1e-6 it is 1e-6.
    #[param(default = 0.1, range = 0.0..=1.0)]
    pub r: f64,
    /// Isotropy of the upper layer: 0 fully anisotropic, 1 isotropic. Below 1e-4 it is 1e-4.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub p: f64,
    /// Reflectance of the lower layer at normal incidence.
    #[param(default = 0.6, range = 0.0..=1.0)]
    pub c2: [f64; 3],
    /// Roughness of the lower layer.
    #[param(default = 0.8, range = 0.0..=1.0)]
    pub r2: f64,
    /// Isotropy of the lower layer.
    #[param(default = 1.0, range = 0.0..=1.0)]
    pub p2: f64,
    /// The spectral factor of both.
    #[param(default = Spectral::Fresnel)]
    pub spectral: Spectral,
    /// The directional factor of both.
    #[param(default = Directional::Blocked)]
    pub directional: Directional,
}

/// f = S(β) D.
#[derive(Clone, Copy, Debug)]
pub struct SingleFormula<T> {
    layer: Layer<T>,
}

/// f = S(β) D + (1 − S(β)) S'(β) D'.
#[derive(Clone, Copy, Debug)]
pub struct DoubleFormula<T> {
    upper: Layer<T>,
    lower: Layer<T>,
    form: Form,
}

impl<T: Real> Evaluate<T> for SingleFormula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.layer.spectral(g.cos_beta) * self.layer.directional(g)
    }
}

impl<T: Real> Evaluate<T> for DoubleFormula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let upper = self.upper.spectral(g.cos_beta);
        // Printed: S'(θ_i), which is not reciprocal.
        let lower = self.lower.spectral(if self.form == Form::Printed { g.cos_i() } else { g.cos_beta });
        let below = (Rgb::splat(T::one()) - upper).times(lower);
        upper * self.upper.directional(g) + below * self.lower.directional(g)
    }
}

impl Model for Single {
    type Params = SingleParams;
    type Formula<T: Real> = SingleFormula<T>;
    const KIND: Kind = Kind::Brdf;

    fn formula<T: Real>(params: &SingleParams, form: Form) -> SingleFormula<T> {
        let &SingleParams { c, r, p, spectral, directional } = params;
        SingleFormula { layer: Layer::new(c, r, p, spectral, directional, form) }
    }

    fn lobes<T: Scalar>(formula: &SingleFormula<T>, wo: V3<T>) -> Mixture<T> {
        Mixture::new(&formula.layer.lobes(wo, formula.layer.spectral(wo.z).mean()))
    }

    fn constants(formula: &SingleFormula<f32>) -> Vec<f32> {
        formula.layer.constants().to_vec()
    }
}

impl Model for Double {
    type Params = DoubleParams;
    type Formula<T: Real> = DoubleFormula<T>;
    const KIND: Kind = Kind::Brdf;

    fn formula<T: Real>(params: &DoubleParams, form: Form) -> DoubleFormula<T> {
        let &DoubleParams { c, r, p, c2, r2, p2, spectral, directional } = params;
        DoubleFormula {
            upper: Layer::new(c, r, p, spectral, directional, form),
            lower: Layer::new(c2, r2, p2, spectral, directional, form),
            form,
        }
    }

    fn lobes<T: Scalar>(formula: &DoubleFormula<T>, wo: V3<T>) -> Mixture<T> {
        let upper = formula.upper.spectral(wo.z);
        let below = (Rgb::splat(T::one()) - upper).times(formula.lower.spectral(wo.z));
        let [a, b] = formula.upper.lobes(wo, upper.mean());
        let [c, d] = formula.lower.lobes(wo, below.mean());
        Mixture::new(&[a, b, c, d])
    }

    fn constants(formula: &DoubleFormula<f32>) -> Vec<f32> {
        [formula.upper.constants(), formula.lower.constants()].concat()
    }
}
