//! What a reflectance model is: parameters as data, an equation over any number, the lobes it is sampled from; and the same without types,
//! for code that iterates over all models.

use super::lanes::Wide;
use super::{Counted, Geometry, Instructions, Lobe, Mixture, Operations, Real, Rgb, Scalar, V3};
use glam::{DVec3, Vec3};
use kajo_params::{ParamError, ParamSet, ParamSpec, ParamValues};
use std::f64::consts::FRAC_1_PI;
use std::fmt;
use std::sync::{Arc, OnceLock};

/// Which form of an equation whose print has a defect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Form {
    /// The form that keeps what the model claims.
    #[default]
    Corrected,
    /// As printed in the source.
    Printed,
}

/// What the value of a model means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// f, a BRDF in 1/sr.
    Brdf,
    /// S, a shading function that contains the cosine of the light, for lights of radiance L_k: Σ S L_k.    \[Schlick94survey]
    Bsf,
}

/// What the literature says of a model (Table 5.1 of \[Falski04]); `kajo bsdf table` puts measurements beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Claims {
    pub parameters: Parameters,
    /// Reciprocal and energy conserving.
    pub plausible: bool,
    pub anisotropic: bool,
    /// The lobe's peak leaves the mirror direction, or reflectance grows with the angle.
    pub off_specular: bool,
}

/// Where the values of parameters come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameters {
    /// Trial and eye.
    Empirical,
    /// Measurement.
    Physical,
}

/// A model, as data: what the registry lists.
pub struct ModelEntry {
    /// The name users write.
    pub id: &'static str,
    /// The name people say.
    pub title: &'static str,
    /// What its value means.
    pub kind: Kind,
    /// Equation, citation, limits, in Markdown.
    pub doc: &'static str,
    /// Keys of `docs/references.bib`.
    pub cites: &'static [&'static str],
    /// What its source claims, where it claims something.
    pub claims: Option<Claims>,
    /// Does the print of its source have a defect, so that [`Form::Printed`] differs?
    pub has_printed_form: bool,
    /// Its parameters.
    pub params: &'static [ParamSpec],
    /// Other names that users may write, and the parameters that each of them sets.
    pub aliases: &'static [(&'static str, &'static [&'static str])],
    /// The WESL module with its value on the GPU, `fn <name>_value(c: ModelConstants, g: ReflectionGeometry) -> vec3f`; `None` for models of files, which
    /// shaders read as tables ([`super::tabulated`]).
    pub wesl: Option<&'static str>,
    /// Makes it ready to evaluate.
    pub make: fn(&ParamValues, Form) -> Made,
}

impl ModelEntry {
    /// Makes the model from `name = value` pairs; what is not given keeps its default.
    ///
    /// # Errors
    /// [`ModelError::Param`] for unknown names and values out of range, [`ModelError::Constraint`] for values that do not go together,
    /// [`ModelError::File`] for a table that cannot be read.
    pub fn from_pairs(&self, pairs: &[(&str, &str)], form: Form) -> Made {
        (self.make)(&self.values(pairs)?, form)
    }

    /// The parameters that `name = value` pairs set, aliases resolved.
    ///
    /// # Errors
    /// Unknown or repeated names, values of the wrong type or out of range.
    pub fn values(&self, pairs: &[(&str, &str)]) -> Result<ParamValues, ParamError> {
        let mut resolved = Vec::with_capacity(pairs.len());
        for &(name, value) in pairs {
            match self.aliases.iter().find(|(alias, _)| *alias == name) {
                Some((_, targets)) => resolved.extend(targets.iter().map(|&target| (target, value))),
                None => resolved.push((name, value)),
            }
        }
        ParamValues::from_pairs(self.params, &resolved)
    }
}

impl fmt::Debug for ModelEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id)
    }
}

/// A model ready to evaluate, or why it cannot be.
pub type Made = Result<Arc<dyn Reflectance>, ModelError>;

/// A model that cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A wrong parameter.
    #[error(transparent)]
    Param(#[from] ParamError),
    /// Parameters that are each in range and do not go together.
    #[error("{0}")]
    Constraint(String),
    /// A file of measurements that cannot be used.
    #[error("`{file}`: {problem}")]
    #[allow(missing_docs, reason = "the names say it")]
    File { file: String, problem: String },
}

/// An equation with its constants prepared.
pub trait Evaluate<T: Real>: Copy + Send + Sync + 'static {
    /// The value for directions above the surface: f in 1/sr, or S; see [`Kind`].
    fn value(&self, g: &Geometry<T>) -> Rgb<T>;

    /// Runs a task that evaluates many pairs, with the shortest formula that has these values: what depends on parameters only is decided here, once, and
    /// what a material does not use takes no registers. Implementations are `#[inline(always)]`.
    #[inline(always)]
    fn in_brief(&self, task: impl Task<T>) {
        task.run(self);
    }
}

/// What is done with a formula, whichever it is. Implementations are `#[inline(always)]`.
pub trait Task<T: Real> {
    /// Does it.
    fn run(self, formula: &impl Evaluate<T>);
}

/// A model in Rust's types. [`make`] makes the rest of it.
pub trait Model: Sized + 'static {
    /// Parameters with their ranges.
    type Params: ParamSet + Send + Sync;
    /// The equation, with what does not depend on directions worked out.
    type Formula<T: Real>: Evaluate<T>;
    /// What its value means.
    const KIND: Kind;
    /// It has no highlight: light-path roles count it as diffuse, every other model as specular.
    const DIFFUSE: bool = false;

    /// Parameters that do not go together, in one sentence.
    ///
    /// # Errors
    /// That sentence: what, got, limit, what to do.
    fn check(_params: &Self::Params) -> Result<(), String> {
        Ok(())
    }

    /// Prepares the equation.
    fn formula<T: Real>(params: &Self::Params, form: Form) -> Self::Formula<T>;

    /// What the model is sampled from when seen from `wo`. The mixture must reach every direction that the model reflects to.
    fn lobes<T: Scalar>(formula: &Self::Formula<T>, wo: V3<T>) -> Mixture<T>;

    /// The constants of the GPU's side, in the order in which its WESL reads them.
    fn constants(formula: &Self::Formula<f32>) -> Vec<f32>;

    /// Reflectance of the perfect mirror that is part of the model, seen from `wo`.
    fn mirror<T: Scalar>(_formula: &Self::Formula<T>, _wo: V3<T>) -> Rgb<T> {
        Rgb::splat(T::zero())
    }

    /// Radiance per ambient radiance, for the model that is no reflection.
    fn ambient(_params: &Self::Params) -> [f64; 3] {
        [0.0; 3]
    }
}

/// A model with its parameters, without types: evaluation, sampling and density in both precisions. `wi` points to the light, `wo` to the
/// viewer, both unit vectors in the local frame; everything is 0 unless both are above the surface.
pub trait Reflectance: Send + Sync {
    /// What [`Reflectance::value`] means.
    fn kind(&self) -> Kind;
    /// Light-path roles count it as diffuse.
    fn is_diffuse(&self) -> bool {
        false
    }
    /// f in 1/sr, or S.
    fn value(&self, wi: DVec3, wo: DVec3) -> DVec3;
    /// [`Reflectance::value`] in the precision of images.
    fn value_f32(&self, wi: Vec3, wo: Vec3) -> Vec3;
    /// [`Reflectance::value_f32`] of many pairs; all three slices have the same length. The fastest way there is.
    fn values_f32(&self, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        self.values_by(Instructions::detect(), wi, wo, out);
    }
    /// [`Reflectance::values_f32`] by instructions of one's choice, for who compares them. Models of other code than formulas go pair by pair.
    ///
    /// # Panics
    /// When the processor has not got them and the model uses them, or the slices differ in length.
    fn values_by(&self, _instructions: Instructions, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        assert!(wi.len() == wo.len() && wo.len() == out.len(), "one value a pair: {} {} {}", wi.len(), wo.len(), out.len());
        for ((wi, wo), out) in wi.iter().zip(wo).zip(out) {
            *out = self.value_f32(*wi, *wo);
        }
    }
    /// A direction to the light for three random numbers in [0, 1); `None` where the sample has weight 0.
    fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<DVec3>;
    /// [`Reflectance::sample`] in the precision of images.
    fn sample_f32(&self, wo: Vec3, u: [f32; 3]) -> Option<Vec3>;
    /// Density of [`Reflectance::sample`], 1/sr.
    fn pdf(&self, wi: DVec3, wo: DVec3) -> f64;
    /// [`Reflectance::pdf`] in the precision of images.
    fn pdf_f32(&self, wi: Vec3, wo: Vec3) -> f32;
    /// Reflectance of the perfect mirror that is part of the model.
    fn mirror(&self, wo: DVec3) -> DVec3;
    /// Radiance per ambient radiance.
    fn ambient(&self) -> DVec3;
    /// The constants of the GPU's side.
    fn constants(&self) -> Vec<f32>;

    /// What one evaluation costs, given the half vector; `None` for models of tables.
    fn operations(&self, _wi: DVec3, _wo: DVec3) -> Option<Operations> {
        None
    }

    /// f·cos θ_i in 1/sr, or S, which contains the cosine.
    fn f_cos(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        match self.kind() {
            Kind::Brdf => self.value(wi, wo) * wi.z.max(0.0),
            Kind::Bsf => self.value(wi, wo),
        }
    }

    /// What a renderer multiplies irradiance per solid angle by: f·cos θ_i, 1/sr. A shading function is made for lights of radiance L_k where a BRDF
    /// has irradiance π L_k, so S/π stands here, and Lambert is Lambert in both forms.
    fn rendered_f_cos(&self, wi: Vec3, wo: Vec3) -> Vec3 {
        match self.kind() {
            Kind::Brdf => self.value_f32(wi, wo) * wi.z.max(0.0),
            Kind::Bsf => self.value_f32(wi, wo) * FRAC_1_PI as f32,
        }
    }
}

/// For [`ModelEntry::make`]: checks the parameters and prepares the equation in each precision.
///
/// # Errors
/// [`ModelError::Constraint`].
pub fn make<M: Model>(values: &ParamValues, form: Form) -> Made {
    let params = M::Params::from_values(values);
    M::check(&params).map_err(ModelError::Constraint)?;
    Ok(Arc::new(Prepared::<M> {
        double: M::formula(&params, form),
        single: M::formula(&params, form),
        counted: M::formula(&params, form),
        ambient: DVec3::from_array(M::ambient(&params)),
        wide: Default::default(),
        params,
        form,
    }))
}

struct Prepared<M: Model> {
    double: M::Formula<f64>,
    single: M::Formula<f32>,
    counted: M::Formula<Counted>,
    ambient: DVec3,
    /// By [`Instructions`]; made when many values are first asked for.
    wide: [OnceLock<Wide<M>>; 3],
    params: M::Params,
    form: Form,
}

/// The value, or 0 where a direction is not above the surface.
#[inline(always)]
fn above<T: Scalar>(formula: &impl Evaluate<T>, wi: V3<T>, wo: V3<T>) -> Rgb<T> {
    if wi.z > T::zero() && wo.z > T::zero() { formula.value(&Geometry::new(wi, wo)) } else { Rgb::splat(T::zero()) }
}

fn pdf_above<M: Model, T: Scalar>(formula: &M::Formula<T>, wi: V3<T>, wo: V3<T>) -> T {
    if wi.z > T::zero() && wo.z > T::zero() { M::lobes(formula, wo).pdf(wi, wo) } else { T::zero() }
}

fn sample_above<M: Model, T: Scalar>(formula: &M::Formula<T>, wo: V3<T>, [choice, u, v]: [T; 3]) -> Option<V3<T>> {
    if wo.z > T::zero() { M::lobes(formula, wo).sample(wo, choice, [u, v]) } else { None }
}

impl<M: Model> Reflectance for Prepared<M> {
    fn kind(&self) -> Kind {
        M::KIND
    }

    fn is_diffuse(&self) -> bool {
        M::DIFFUSE
    }

    fn value(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        above(&self.double, wi.into(), wo.into()).into()
    }

    fn value_f32(&self, wi: Vec3, wo: Vec3) -> Vec3 {
        above(&self.single, wi.into(), wo.into()).into()
    }

    fn values_by(&self, instructions: Instructions, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        assert!(wi.len() == wo.len() && wo.len() == out.len(), "one value a pair: {} {} {}", wi.len(), wo.len(), out.len());
        let wide = self.wide[instructions as usize].get_or_init(|| Wide::new(&self.params, self.form, instructions));
        if !wide.values(wi, wo, out) {
            for ((wi, wo), out) in wi.iter().zip(wo).zip(out) {
                *out = self.value_f32(*wi, *wo);
            }
        }
    }

    fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<DVec3> {
        sample_above::<M, f64>(&self.double, wo.into(), u).map(Into::into)
    }

    fn sample_f32(&self, wo: Vec3, u: [f32; 3]) -> Option<Vec3> {
        sample_above::<M, f32>(&self.single, wo.into(), u).map(Into::into)
    }

    fn pdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        pdf_above::<M, f64>(&self.double, wi.into(), wo.into())
    }

    fn pdf_f32(&self, wi: Vec3, wo: Vec3) -> f32 {
        pdf_above::<M, f32>(&self.single, wi.into(), wo.into())
    }

    fn mirror(&self, wo: DVec3) -> DVec3 {
        M::mirror::<f64>(&self.double, wo.into()).into()
    }

    fn ambient(&self) -> DVec3 {
        self.ambient
    }

    fn constants(&self) -> Vec<f32> {
        M::constants(&self.single)
    }

    fn operations(&self, wi: DVec3, wo: DVec3) -> Option<Operations> {
        let geometry = Geometry::new(V3::of(wi.to_array()), V3::of(wo.to_array()));
        Some(Operations::of(|| self.counted.value(&geometry)).1)
    }
}

/// Lobes of a model that is a diffuse part and one glossy part: weights by their albedos at `wo`.
#[inline]
pub fn diffuse_and<T: Scalar>(diffuse: T, glossy: T, lobe: Lobe<T>) -> Mixture<T> {
    Mixture::new(&[(diffuse, Lobe::Cosine), (glossy, lobe)])
}
