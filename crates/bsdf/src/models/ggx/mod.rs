//! GGX facets with height-correlated Smith masking, isotropic and anisotropic, with the light between facets if wanted.

use crate::models::blocks::fresnel::{Fresnel, FresnelForm, Schlicks, normal_reflectance};
use crate::models::blocks::metals::Metal;
use crate::models::{Evaluate, Form, Geometry, Kind, Lobe, Mixture, Model, ModelEntry, Real, Rgb, Scalar, Task, V3, diffuse_and, make};
use kajo_params::{ParamChoice, Params};
use std::f64::consts::FRAC_1_PI;

mod facets;
mod lost;
#[cfg(test)]
mod tests;

use facets::Facets;
use lost::Lost;

/// The registry's entry.
pub const MODEL: ModelEntry = ModelEntry {
    id: "ggx",
    title: "GGX (Trowbridge-Reitz)",
    kind: Kind::Brdf,
    doc: include_str!("doc.md"),
    cites: &["Walter07", "Heitz14", "Heitz18", "Kulla17", "Eto23"],
    claims: None,
    has_printed_form: false,
    params: Params::SPEC,
    aliases: &[
        ("alpha", &["alpha_x", "alpha_y"]),
        ("ax", &["alpha_x"]),
        ("ay", &["alpha_y"]),
        ("f", &["f0"]),
        ("ior", &["eta"]),
        ("k", &["kappa"]),
    ],
    wesl: Some(include_str!("ggx.wesl")),
    make: make::<Ggx>,
};

/// The model.
pub struct Ggx;

/// Fresnel's reflectance of a facet.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum FresnelChoice {
    /// Exact where eta or a metal is given, Schlick's approximation with f0 elsewhere.
    Auto,
    /// Schlick's approximation, with f0 from eta and kappa where they are given.
    Schlick,
    /// Fresnel's equations, with the index of a dielectric from f0 where eta is not given.
    Exact,
}

/// Its parameters.
#[derive(Params, Clone, Copy, Debug)]
pub struct Params {
    /// Width of the facets' slopes along x.
    #[param(default = 0.25, range = 1e-4..=1.0)]
    pub alpha_x: f64,
    /// Width of the facets' slopes along y.
    #[param(default = 0.25, range = 1e-4..=1.0)]
    pub alpha_y: f64,
    /// Reflectance at normal incidence.
    #[param(default = 0.04, range = 0.0..=1.0)]
    pub f0: [f64; 3],
    /// Index of refraction; takes the place of f0 where it is not 0.
    #[param(default = 0.0, range = 0.0..=100.0)]
    pub eta: [f64; 3],
    /// Extinction coefficient.
    #[param(default = 0.0, range = 0.0..=1e6)]
    pub kappa: [f64; 3],
    /// A measured metal, in place of eta, kappa and f0.
    #[param(default = Metal::None)]
    pub metal: Metal,
    /// Fresnel's reflectance of a facet.
    #[param(default = FresnelChoice::Auto)]
    pub fresnel: FresnelChoice,
    /// Gives back the light that leaves after several facets.
    #[param(default = false)]
    pub multiple_scattering: bool,
}

/// f = F D V + M (1 − E(θ_i))(1 − E(θ_r)).
#[derive(Clone, Copy, Debug)]
pub struct Formula<T> {
    facets: Facets<T>,
    fresnel: Fresnel<T>,
    alpha: [T; 2],
    isotropic: bool,
    gives_back: bool,
    /// F_ms/(π (1 − Ē)), or 0.
    multiple: Rgb<T>,
    /// Mean of F_ms, or 0.
    multiple_weight: T,
    lost: Lost<T>,
}

impl<T: Real> Evaluate<T> for Formula<T> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let (cos_beta, facets) = self.facets.at::<false>(g);
        let single = self.fresnel.at(cos_beta) * facets;
        if self.gives_back { self.multiple.mul_add(self.lost.at(g.wi) * self.lost.at(g.wo), single) } else { single }
    }

    #[inline(always)]
    fn in_brief(&self, task: impl Task<T>) {
        match self.fresnel.schlicks() {
            Some(fresnel) if !self.gives_back && self.isotropic => task.run(&Brief::<T, true> { facets: self.facets, fresnel }),
            Some(fresnel) if !self.gives_back => task.run(&Brief::<T, false> { facets: self.facets, fresnel }),
            _ => task.run(self),
        }
    }
}

/// What most materials are: Schlick's reflectance, and nothing is given back.
#[derive(Clone, Copy, Debug)]
struct Brief<T, const ISOTROPIC: bool> {
    facets: Facets<T>,
    fresnel: Schlicks<T>,
}

impl<T: Real, const ISOTROPIC: bool> Evaluate<T> for Brief<T, ISOTROPIC> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let (cos_beta, facets) = self.facets.at::<ISOTROPIC>(g);
        self.fresnel.at(cos_beta) * facets
    }
}

/// Fresnel's reflectance as the parameters ask for it.
fn fresnel<T: Real>(params: &Params) -> Fresnel<T> {
    let &Params { f0, eta, kappa, metal, fresnel, .. } = params;
    let by_index = metal != Metal::None || eta != [0.0; 3];
    // A channel without index has none of its own: the vacuum's.
    let eta = eta.map(|eta| if eta > 0.0 { eta } else { 1.0 });
    let f0 = if by_index { std::array::from_fn(|k| normal_reflectance(eta[k], kappa[k])) } else { f0 };
    let form = match (fresnel, by_index) {
        (FresnelChoice::Schlick, _) | (FresnelChoice::Auto, false) => FresnelForm::Schlick,
        (FresnelChoice::Exact, false) => FresnelForm::Inverted,
        (_, true) => FresnelForm::Exact,
    };
    Fresnel::new(form, metal, eta, kappa, f0)
}

/// 2 ∫ F(β) cos β d cos β: the mean over a cosine-weighted hemisphere.
fn fresnel_average(fresnel: &Fresnel<f64>) -> [f64; 3] {
    let steps = 512;
    let mut sum = [0.0; 3];
    for k in 0..steps {
        let cos = ((f64::from(k) + 0.5) / f64::from(steps)).sqrt();
        for (sum, f) in sum.iter_mut().zip(fresnel.at(cos).to_array()) {
            *sum += f / f64::from(steps);
        }
    }
    sum
}

impl Model for Ggx {
    type Params = Params;
    type Formula<T: Real> = Formula<T>;
    const KIND: Kind = Kind::Brdf;

    fn check(params: &Params) -> Result<(), String> {
        if params.kappa != [0.0; 3] && params.eta == [0.0; 3] && params.metal == Metal::None {
            return Err("kappa is given without eta; give both, or f0 alone".to_owned());
        }
        Ok(())
    }

    fn formula<T: Real>(params: &Params, _form: Form) -> Formula<T> {
        let &Params { alpha_x, alpha_y, multiple_scattering, .. } = params;
        let lost = Lost::<f64>::new(alpha_x, alpha_y).mean();
        // F_ms = F̄² Ē/(1 − F̄ (1 − Ē)).    [Kulla17] slide 17
        let color =
            fresnel_average(&fresnel(params)).map(|f| if multiple_scattering { f * f * (1.0 - lost) / (1.0 - f * lost) } else { 0.0 });
        Formula {
            facets: Facets::new(alpha_x, alpha_y),
            fresnel: fresnel(params),
            alpha: [alpha_x, alpha_y].map(T::of),
            isotropic: alpha_x == alpha_y,
            gives_back: multiple_scattering,
            // Facets that lose nothing give nothing back.
            multiple: Rgb::of(color.map(|f| f * FRAC_1_PI / lost.max(1e-6))),
            multiple_weight: T::of(color.iter().sum::<f64>() / 3.0),
            lost: Lost::new(alpha_x, alpha_y),
        }
    }

    fn lobes<T: Scalar>(formula: &Formula<T>, wo: V3<T>) -> Mixture<T> {
        let lost = formula.lost.at(wo);
        let [alpha_x, alpha_y] = formula.alpha;
        let single = formula.fresnel.at(wo.z).mean() * (T::one() - lost);
        let multiple = formula.multiple_weight * lost;
        diffuse_and(multiple, single, Lobe::VisibleGgx { alpha_x, alpha_y })
    }

    fn constants(formula: &Formula<f32>) -> Vec<f32> {
        let (m, [alpha_x2, alpha_y2, d_scale]) = (formula.multiple, formula.facets.constants());
        let mut out = vec![alpha_x2, alpha_y2, d_scale, 0.0, m.x, m.y, m.z, 0.0];
        out.extend(formula.fresnel.constants().into_iter().flatten());
        out.extend(formula.lost.fits.as_flattened());
        out
    }
}
