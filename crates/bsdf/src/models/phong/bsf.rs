//! Phong's shading function of 1975 with exchangeable highlights, and the one with Schlick's quotient in place of the power.

use super::BRDF;
use crate::models::blocks::highlight::{Highlight, HighlightKind, schlick};
use crate::models::blocks::highlight_shading::{self, HighlightShading};
use crate::models::{Claims, Evaluate, Form, Geometry, Kind, Mixture, Model, ModelEntry, Parameters, Real, Rgb, Scalar, V3, make};
use kajo_params::Params;

/// The shading function's entry.
pub const BSF: ModelEntry = ModelEntry {
    id: "phong-bsf",
    title: "Phong (shading function)",
    kind: Kind::Bsf,
    cites: &["Phong75", "Blinn77", "Bishop86", "Poulin90", "Schlick94gems", "Lewis94", "Falski04"],
    claims: Some(Claims { parameters: Parameters::Empirical, plausible: false, anisotropic: false, off_specular: false }),
    has_printed_form: true,
    params: highlight_shading::Params::SPEC,
    wesl: Some(include_str!("phong_bsf.wesl")),
    make: make::<PhongBsf>,
    ..BRDF
};

/// The entry of the one with Schlick's highlight.
pub const SCHLICK_BSF: ModelEntry = ModelEntry {
    id: "schlick-phong-bsf",
    title: "Schlick-Phong (shading function)",
    kind: Kind::Bsf,
    cites: &["Phong75", "Schlick94gems"],
    claims: None,
    params: Params::SPEC,
    wesl: Some(include_str!("schlick_phong_bsf.wesl")),
    make: make::<SchlickPhongBsf>,
    ..BRDF
};

/// S = k_d cos θ_i + k_s H(cos α).
pub struct PhongBsf;

/// S = k_d cos θ_i + k_s cos α/(n − n cos α + cos α).
pub struct SchlickPhongBsf;

/// Parameters of `schlick-phong-bsf`.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Diffuse part.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub kd: [f64; 3],
    /// Height of the highlight.
    #[param(default = 0.4, range = 0.0..=1.0)]
    pub ks: [f64; 3],
    /// Exponent of the power that the highlight resembles.
    #[param(default = 50.0, range = 1.0..=1e6)]
    pub n: f64,
}

/// The equation of `phong-bsf`.
#[derive(Clone, Copy, Debug)]
pub struct Formula<T>(HighlightShading<T>);

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.0.value(g.cos_i(), g.cos_alpha())
    }
}

impl Model for PhongBsf {
    type Params = highlight_shading::Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Bsf;

    fn check(params: &Self::Params) -> Result<(), String> {
        params.check()
    }

    fn formula<T: Real>(params: &Self::Params, form: Form) -> Formula<T> {
        Formula(HighlightShading::new(params, form, 1.0))
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        formula.0.mixture(|highlight, weight| highlight.lobes_about_mirror(wo, weight))
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        formula.0.constants()
    }
}

/// The equation of `schlick-phong-bsf`.
#[derive(Clone, Copy, Debug)]
pub struct SchlickFormula<T> {
    diffuse: Rgb<T>,
    specular: Rgb<T>,
    n: T,
    shading: HighlightShading<T>,
}

impl<T: Real> Evaluate<T> for SchlickFormula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        self.diffuse * g.cos_i() + self.specular * schlick(g.cos_alpha().clamp(0.0, 1.0), self.n)
    }
}

impl Model for SchlickPhongBsf {
    type Params = Params;
    type Formula<T: Real> = SchlickFormula<T>;
    const KIND: Kind = Kind::Bsf;

    fn formula<T: Real>(params: &Params, form: Form) -> SchlickFormula<T> {
        let Params { kd, ks, n } = *params;
        let same = highlight_shading::Params { kd, ks, n, highlight: HighlightKind::Schlick, c: 0.0 };
        SchlickFormula { diffuse: Rgb::of(kd), specular: Rgb::of(ks), n: T::of(n), shading: HighlightShading::new(&same, form, 1.0) }
    }

    fn lobes<T: Scalar>(formula: &SchlickFormula<T>, wo: V3<T>) -> Mixture<T> {
        formula.shading.mixture(|highlight: &Highlight<T>, weight| highlight.lobes_about_mirror(wo, weight))
    }

    fn constants(formula: &SchlickFormula<f32>) -> Vec<f32> {
        let (d, s) = (formula.diffuse, formula.specular);
        vec![d.x, d.y, d.z, formula.n, s.x, s.y, s.z]
    }
}
