//! Fresnel's reflectance F(β) of a smooth facet, unpolarised light: exact, and the ways around it.
//!
//! ```text
//! exact         Fresnel's equations for η + iκ                                                (3.9), (3.10)    [Cook82]
//! schlick       f + (1 − f)(1 − cos β)⁵                                                       (3.14)           [Schlick94]
//! interpolated  f + (1 − f) max(F̄(β) − f̄, 0)/(1 − f̄),  F̄ exact for the mean η, κ;  f̄ = F̄(0)    (3.13)           [Cook82]
//! inverted      exact for η = (1 + √f)/(1 − √f), κ = 0                                        (3.12)           [Cook82]
//! none          1
//! ```
//!
//! η is the index below over the index above, κ the extinction coefficient, f the reflectance at normal incidence. Schlick's is off by up to 0.036 for
//! plastic, 0.075 for diamond, 0.016 for silver; inverted is far off for metals at grazing angles (0.33 too low for copper at 85°).

use super::metals::Metal;
use crate::models::{Real, Rgb};
use kajo_params::ParamChoice;

/// Which form of F.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the module says it")]
pub enum FresnelForm {
    Exact,
    Schlick,
    Interpolated,
    Inverted,
    None,
}

/// Reflectance of an interface with complex index η + iκ (3.9); 1 at β = 90° and for total reflection. `cos` in [0, 1].
///
/// ```text
/// F = ½ R_s (R_q + 1),   R_s = ((a − c)² + b²)/((a + c)² + b²),   R_q = ((c(a + c) − 1)² + c²b²)/((c(a − c) + 1)² + c²b²)
/// a² = ½(√(x² + 4η²κ²) + x),   b² = ½(√(x² + 4η²κ²) − x),   x = η² − κ² + c² − 1
/// ```
#[inline(always)]
pub fn conductor<T: Real>(cos: T, eta: T, kappa: T) -> T {
    let c = cos.min(T::one());
    let x = eta.squared() - kappa.squared() + c.squared() - T::one();
    let product = eta * kappa;
    // Of a² and b², the larger one is a sum, and a² b² = η²κ²: no digits cancel.
    let larger = T::of(0.5) * ((x.squared() + T::of(4.0) * product.squared()).sqrt() + x.abs());
    let smaller = product.squared() / larger.max(T::of(1e-36));
    let positive = T::zero().le(x);
    let (a2, b2) = (T::select(positive, larger, smaller), T::select(positive, smaller, larger));
    let a = a2.sqrt();
    let (minus, plus) = (a - c, a + c);
    // An index of 1 without extinction has 0/0 at grazing: no interface.
    let tiny = T::of(1e-36);
    let rs = (minus.squared() + b2) / (plus.squared() + b2).max(tiny);
    let c2b2 = c.squared() * b2;
    let rq = ((c * plus - T::one()).squared() + c2b2) / ((c * minus + T::one()).squared() + c2b2).max(tiny);
    T::of(0.5) * rs * (rq + T::one())
}

/// Reflectance of an interface without absorption (3.10); 1 where η < 1 reflects totally. `cos` in [0, 1].
#[inline(always)]
pub fn dielectric<T: Real>(cos: T, eta: T) -> T {
    let c = cos.min(T::one());
    let a2 = eta.squared() + c.squared() - T::one();
    let a = a2.max(T::zero()).sqrt();
    let rs = ((a - c) / (a + c).max(T::of(1e-36))).squared();
    let rq = ((c * (a + c) - T::one()) / (c * (a - c) + T::one())).squared();
    T::select(a2.lt(T::zero()), T::one(), T::of(0.5) * rs * (rq + T::one()))
}

/// Schlick's approximation (3.14): 4 multiplications, 2 additions with f and 1 − f prepared.
#[inline(always)]
pub fn schlick<T: Real>(cos: T, f: T, one_minus_f: T) -> T {
    let t = T::one() - cos;
    let t2 = t.squared();
    f + one_minus_f * (t2.squared() * t)
}

/// F(0) = ((η − 1)² + κ²)/((η + 1)² + κ²); (3.11) with its square, for κ = 0 ((η − 1)/(η + 1))².
pub fn normal_reflectance(eta: f64, kappa: f64) -> f64 {
    ((eta - 1.0).powi(2) + kappa * kappa) / ((eta + 1.0).powi(2) + kappa * kappa)
}

/// (3.11) as printed, without the square: 0.197 instead of 0.039 for η = 1.49.
pub fn normal_reflectance_printed(eta: f64) -> f64 {
    (eta - 1.0) / (eta + 1.0)
}

/// η of the dielectric that reflects `f` at normal incidence (3.12), `f` in [0, 1).
pub fn index_of(f: f64) -> f64 {
    (1.0 + f.sqrt()) / (1.0 - f.sqrt())
}

/// Cook and Torrance's colours (3.13): `f` interpolated to 1 as `mean` = F̄(β) goes from `mean_at_normal` to 1.
#[inline(always)]
pub fn interpolated<T: Real>(f: T, mean: T, mean_at_normal: T, inverse_rest: T) -> T {
    // Where f̄ is nearly 1, rounding could lead beyond it.
    f + (T::one() - f) * ((mean - mean_at_normal).max(T::zero()) * inverse_rest).min(T::one())
}

/// F with its constants, per channel.
#[derive(Clone, Copy, Debug)]
pub struct Fresnel<T> {
    form: FresnelForm,
    /// Complex index; for [`FresnelForm::Interpolated`] its mean, in every channel.
    eta: Rgb<T>,
    kappa: Rgb<T>,
    /// Reflectance at normal incidence.
    f: Rgb<T>,
    one_minus_f: Rgb<T>,
    /// f̄ and 1/(1 − f̄).
    mean: [T; 2],
    /// All channels have one index.
    grey: bool,
}

impl<T: Real> Fresnel<T> {
    /// From the parameters of a model: a metal replaces `eta`, `kappa` and `f`.
    pub fn new(form: FresnelForm, metal: Metal, eta: [f64; 3], kappa: [f64; 3], f: [f64; 3]) -> Self {
        let (mut eta, mut kappa, f) = metal.rgb().map_or((eta, kappa, f), |optics| (optics.eta, optics.kappa, optics.f));
        match form {
            FresnelForm::Interpolated => {
                eta = [eta.iter().sum::<f64>() / 3.0; 3];
                kappa = [kappa.iter().sum::<f64>() / 3.0; 3];
            }
            // At 1 the index is infinite; F is 1 to six digits before.
            FresnelForm::Inverted => (eta, kappa) = (f.map(|f| index_of(f.min(1.0 - 1e-6))), [0.0; 3]),
            FresnelForm::Exact | FresnelForm::Schlick | FresnelForm::None => {}
        }
        let mean = normal_reflectance(eta[0], kappa[0]);
        Self {
            form,
            eta: Rgb::of(eta),
            kappa: Rgb::of(kappa),
            f: Rgb::of(f),
            one_minus_f: Rgb::of(f.map(|f| 1.0 - f)),
            mean: [mean, 1.0 / (1.0 - mean).max(1e-9)].map(T::of),
            grey: eta == [eta[0]; 3] && kappa == [kappa[0]; 3],
        }
    }

    /// F(β), `cos` = cos β.
    #[inline(always)]
    pub fn at(&self, cos: T) -> Rgb<T> {
        match self.form {
            FresnelForm::None => Rgb::splat(T::one()),
            FresnelForm::Schlick => Schlicks { f: self.f, one_minus_f: self.one_minus_f }.at(cos),
            FresnelForm::Interpolated => {
                let mean = conductor(cos, self.eta.x, self.kappa.x);
                let [normal, inverse_rest] = self.mean;
                Rgb::new(
                    interpolated(self.f.x, mean, normal, inverse_rest),
                    interpolated(self.f.y, mean, normal, inverse_rest),
                    interpolated(self.f.z, mean, normal, inverse_rest),
                )
            }
            FresnelForm::Exact | FresnelForm::Inverted if self.grey => Rgb::splat(conductor(cos, self.eta.x, self.kappa.x)),
            FresnelForm::Exact | FresnelForm::Inverted => Rgb::new(
                conductor(cos, self.eta.x, self.kappa.x),
                conductor(cos, self.eta.y, self.kappa.y),
                conductor(cos, self.eta.z, self.kappa.z),
            ),
        }
    }

    /// The constants of (3.14), where that is the form.
    #[inline(always)]
    pub fn schlicks(&self) -> Option<Schlicks<T>> {
        (self.form == FresnelForm::Schlick).then_some(Schlicks { f: self.f, one_minus_f: self.one_minus_f })
    }

    /// For the GPU's side: [η, form], [κ, f̄], [f, 1/(1 − f̄)].
    pub fn constants(&self) -> [[T; 4]; 3] {
        let form = T::of(f64::from(self.form as u32));
        let row = |v: Rgb<T>, w| [v.x, v.y, v.z, w];
        [row(self.eta, form), row(self.kappa, self.mean[0]), row(self.f, self.mean[1])]
    }
}

/// Schlick's approximation (3.14) alone, per channel.
#[derive(Clone, Copy, Debug)]
pub struct Schlicks<T> {
    f: Rgb<T>,
    one_minus_f: Rgb<T>,
}

impl<T: Real> Schlicks<T> {
    /// F(β), `cos` = cos β.
    #[inline(always)]
    pub fn at(&self, cos: T) -> Rgb<T> {
        let t = (T::one() - cos).max(T::zero());
        let t2 = t.squared();
        self.one_minus_f.mul_add(t2.squared() * t, self.f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fresnel's equations in complex numbers, as (re, im) pairs.
    fn complex_reference(cos: f64, eta: f64, kappa: f64) -> f64 {
        let mul = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let norm = |a: (f64, f64)| a.0 * a.0 + a.1 * a.1;
        let n2 = mul((eta, kappa), (eta, kappa));
        let under = (n2.0 - (1.0 - cos * cos), n2.1);
        let length = norm(under).sqrt();
        // The root in the first quadrant, by whichever half keeps its digits.
        let larger = (0.5 * (length + under.0.abs())).sqrt();
        let other = if larger > 0.0 { 0.5 * under.1 / larger } else { 0.0 };
        let root = if under.0 >= 0.0 { (larger, other) } else { (other, larger) };
        let rs = norm((cos - root.0, -root.1)) / norm((cos + root.0, root.1));
        let n2c = (n2.0 * cos, n2.1 * cos);
        let rp = norm((n2c.0 - root.0, n2c.1 - root.1)) / norm((n2c.0 + root.0, n2c.1 + root.1));
        0.5 * (rs + rp)
    }

    const MATERIALS: [(f64, f64, f64, [f64; 6], f64); 4] = [
        (1.49, 0.0, 0.038_725, [0.048_845, 0.087_521, 0.251_156, 0.385_989, 0.611_656, 0.903_906], 0.0364),
        (2.417, 0.0, 0.171_969, [0.181_116, 0.211_261, 0.330_500, 0.433_315, 0.621_709, 0.899_746], 0.0754),
        (0.135, 3.985, 0.968_547, [0.967_234, 0.964_309, 0.961_497, 0.965_224, 0.977_407, 0.994_934], 0.0155),
        (1.0, 2.39, 0.588_143, [0.588_721, 0.597_268, 0.659_778, 0.721_746, 0.828_951, 0.960_141], 0.0252),
    ];

    /// Row BR-15.
    #[test]
    fn the_table_of_materials_is_reproduced() {
        for (eta, kappa, normal, row, _) in MATERIALS {
            assert!((conductor(1.0, eta, kappa) - normal).abs() < 1e-6);
            assert!((normal_reflectance(eta, kappa) - normal).abs() < 1e-6);
            for (degrees, expected) in [45.0_f64, 60.0, 75.0, 80.0, 85.0, 89.0].into_iter().zip(row) {
                let f = conductor(degrees.to_radians().cos(), eta, kappa);
                assert!((f - expected).abs() < 1e-6, "η {eta}, κ {kappa} at {degrees}°: {f}");
            }
        }
        assert!((conductor(0.5_f64, 1.0, 2.4) - 0.597_268).abs() > 1e-6, "planted fault");
    }

    /// Row BR-15.
    #[test]
    fn it_equals_fresnels_equations_in_complex_numbers() {
        let mut rng = kajo_sampling::Rng::new(15);
        for _ in 0..10_000 {
            let [cos, eta, kappa] = [1.0, 5.0, 8.0].map(|scale| f64::from(rng.next_1d()) * scale);
            let eta = eta + 0.02;
            let (f, expected) = (conductor(cos, eta, kappa), complex_reference(cos, eta, kappa));
            assert!((f - expected).abs() < 1e-12, "cos {cos}, η {eta}, κ {kappa}: {f} is not {expected}");
            // Of the same cosine, without absorption.
            let (f, expected) = (conductor(cos, eta, 0.0), dielectric(cos, eta));
            assert!((f - expected).abs() < 1e-14, "cos {cos}, η {eta}: {f} is not {expected}");
            assert!((conductor(0.0, eta, kappa) - 1.0).abs() < 1e-14 && (dielectric(0.0, eta) - 1.0).abs() < 1e-14);
        }
        assert_eq!(dielectric(0.3, 0.7), 1.0, "total reflection");
        assert_eq!(conductor(0.3, 0.7, 0.0), 1.0, "total reflection");
        assert!(conductor(0.0_f64, 1.0, 0.0).is_finite() && conductor(1.0_f64, 1e-3, 0.0).is_finite());
    }

    /// Row BR-16.
    #[test]
    fn index_and_normal_reflectance_are_inverse() {
        for i in 1..1000 {
            let eta = 1.0 + f64::from(i) * 0.01;
            assert!((index_of(normal_reflectance(eta, 0.0)) / eta - 1.0).abs() < 1e-12);
        }
        assert!((index_of(normal_reflectance(1.0, 2.39)) - 7.580_176_958).abs() < 1e-8);
        assert!((index_of(0.588_142_626) - 7.580_176_958).abs() < 1e-7);
        assert!((normal_reflectance_printed(1.49) - 0.197).abs() < 1e-3, "the print has no square");
        // Poor for metals: section 3.8.
        let inverted = Fresnel::<f64>::new(FresnelForm::Inverted, Metal::None, [1.0; 3], [0.0; 3], [normal_reflectance(1.0, 2.39); 3]);
        for (degrees, expected) in [(0.0_f64, 0.588_143), (75.0, 0.4896), (85.0, 0.4974)] {
            assert!((inverted.at(degrees.to_radians().cos()).x - expected).abs() < 1e-4);
        }
    }

    /// Row BR-16.
    #[test]
    fn colours_are_interpolated_as_by_cook_and_torrance() {
        let f = Fresnel::<f64>::new(FresnelForm::Interpolated, Metal::None, [1.0; 3], [2.39; 3], [0.95; 3]);
        assert!((f.at(0.5).x - 0.951_107_855).abs() < 1e-9);
        assert!((f.at(80_f64.to_radians().cos()).x - 0.966_219_590).abs() < 1e-9);
        assert!((f.at(1.0).x - 0.95).abs() < 1e-12 && (f.at(0.0).x - 1.0).abs() < 1e-12);
    }

    /// Row BR-16: the largest error of (3.14), and not "less than 1 %".
    #[test]
    fn schlicks_largest_error_is_as_tabled() {
        for (eta, kappa, _, _, largest) in MATERIALS {
            let f = normal_reflectance(eta, kappa);
            let error = (0..=90_000).fold(0.0, |worst: f64, k| {
                let cos = (f64::from(k) / 1000.0).to_radians().cos();
                worst.max((schlick(cos, f, 1.0 - f) - conductor(cos, eta, kappa)).abs())
            });
            assert!((error - largest).abs() < 1e-4, "η {eta}, κ {kappa}: {error}");
        }
    }

    #[test]
    fn single_precision_keeps_its_digits_on_metals() {
        for (eta, kappa, ..) in MATERIALS {
            for k in 0..=100 {
                let cos = f64::from(k) / 100.0;
                let (double, single) = (conductor(cos, eta, kappa), f64::from(conductor(cos as f32, eta as f32, kappa as f32)));
                assert!((double - single).abs() < 2e-6, "η {eta}, κ {kappa}, cos {cos}: {single} is not {double}");
            }
        }
    }
}
