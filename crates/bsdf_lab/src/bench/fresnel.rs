//! What Fresnel's equations (3.9) cost beside Schlick's approximation (3.14), which is claimed to be 32 times as fast.
//!
//! Both are timed as models whose value is a sum over 16 cosines, beside a third one that only adds the cosines: its time is subtracted.

use super::{ModelCost, Nanoseconds};
use kajo_bsdf::models::blocks::fresnel::{conductor, normal_reflectance, schlick};
use kajo_bsdf::models::{Evaluate, Form, Geometry, Kind, Mixture, Model, Operations, Real, Reflectance, Rgb, Scalar, V3, make};
use kajo_params::{ParamValues, Params};
use std::sync::Arc;

/// (3.9) over (3.14), by \[Schlick94].
pub const CLAIMED_RATIO: f64 = 32.0;

/// Cosines a call.
const COSINES: u32 = 16;

/// Copper as the survey has it.
const COPPER: [f64; 2] = [1.0, 2.39];

/// (3.9) and (3.14), ns each, without the loop.
#[derive(Clone, Copy, Debug)]
pub struct FresnelCost {
    /// Fresnel's equations.
    pub exact: Nanoseconds,
    /// Schlick's approximation.
    pub schlick: Nanoseconds,
    /// The operations of both.
    pub operations: [Operations; 2],
}

impl FresnelCost {
    /// (3.9) over (3.14), one by one and many at once.
    pub fn ratios(&self) -> Nanoseconds {
        Nanoseconds { single: self.exact.single / self.schlick.single, many: self.exact.many / self.schlick.many }
    }

    /// From the costs of the three [`probes`].
    pub(super) fn of(costs: &[ModelCost]) -> Self {
        let [neither, exact, schlick] = [0, 1, 2].map(|k| &costs[k]);
        let one = |cost: &ModelCost| Nanoseconds {
            single: (cost.raw.single - neither.raw.single) / f64::from(COSINES),
            many: (cost.raw.many - neither.raw.many) / f64::from(COSINES),
        };
        Self { exact: one(exact), schlick: one(schlick), operations: operations() }
    }
}

/// Of (3.9) and (3.14), their constants prepared.
pub(super) fn operations() -> [Operations; 2] {
    use kajo_bsdf::models::Counted;
    let f = normal_reflectance(COPPER[0], COPPER[1]);
    let [cos, eta, kappa, f, rest] = [0.7, COPPER[0], COPPER[1], f, 1.0 - f].map(Counted);
    [Operations::of(|| conductor(cos, eta, kappa)).1, Operations::of(|| self::schlick(cos, f, rest)).1]
}

/// Nothing, (3.9), (3.14).
pub(super) fn probes() -> [(&'static str, Arc<dyn Reflectance>); 3] {
    let values = ParamValues::defaults(Index::SPEC);
    let made = [
        make::<Probe<NEITHER>>(&values, Form::Corrected),
        make::<Probe<EXACT>>(&values, Form::Corrected),
        make::<Probe<SCHLICK>>(&values, Form::Corrected),
    ];
    let [neither, exact, schlick] = made.map(|model| model.expect("the defaults are in range"));
    [("cosines", neither), ("fresnel", exact), ("schlick", schlick)]
}

const NEITHER: u8 = 0;
const EXACT: u8 = 1;
const SCHLICK: u8 = 2;

#[derive(Params, Clone, Copy, Debug)]
struct Index {
    /// Index of refraction.
    #[param(default = COPPER[0], range = 0.0..=100.0)]
    eta: f64,
    /// Extinction coefficient.
    #[param(default = COPPER[1], range = 0.0..=100.0)]
    kappa: f64,
}

struct Probe<const WHICH: u8>;

#[derive(Clone, Copy)]
struct Formula<T, const WHICH: u8> {
    eta: T,
    kappa: T,
    f: T,
    one_minus_f: T,
    /// Factors of the cosine, so that no evaluation is like another.
    factors: [T; COSINES as usize],
}

impl<T: Real, const WHICH: u8> Evaluate<T> for Formula<T, WHICH> {
    #[inline(always)]
    fn value(&self, g: &Geometry<T>) -> Rgb<T> {
        let mut sum = T::zero();
        for factor in self.factors {
            let cos = g.cos_beta * factor;
            sum = sum
                + match WHICH {
                    EXACT => conductor(cos, self.eta, self.kappa),
                    SCHLICK => schlick(cos, self.f, self.one_minus_f),
                    _ => cos,
                };
        }
        Rgb::splat(sum)
    }
}

impl<const WHICH: u8> Model for Probe<WHICH> {
    type Params = Index;
    type Formula<T: Real> = Formula<T, WHICH>;
    const KIND: Kind = Kind::Brdf;

    fn formula<T: Real>(&Index { eta, kappa }: &Index, _form: Form) -> Formula<T, WHICH> {
        let f = normal_reflectance(eta, kappa);
        let factors = std::array::from_fn(|k| T::of(1.0 - k as f64 / f64::from(2 * COSINES)));
        Formula { eta: T::of(eta), kappa: T::of(kappa), f: T::of(f), one_minus_f: T::of(1.0 - f), factors }
    }

    fn lobes<T: Scalar>(_formula: &Formula<T, WHICH>, _wo: V3<T>) -> Mixture<T> {
        Mixture::new(&[])
    }

    fn constants(_formula: &Formula<f32, WHICH>) -> Vec<f32> {
        Vec::new()
    }
}
