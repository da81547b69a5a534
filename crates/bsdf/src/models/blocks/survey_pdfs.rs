//! The two densities with which \[Falski04] sampled all models alike, and how a Phong exponent follows from a roughness.
//!
//! ```text
//! p = cos θ/π                        diffuse        (5.1)
//! p = (n + 1)/(2π) cosⁿα             specular       (5.2), about the mirror direction
//! n = 2/m²                           (5.3)          [Ward95]
//! n = 1/(2m²)                        a quarter of it
//! ```
//!
//! (5.3) is for cosⁿδ, about the half vector, and (5.2) lives in α ≈ 2δ: cosⁿδ ≈ cos^(n/4) α. With (5.3) as it stands the lobe is half as wide as it should
//! be, and a quarter of the energy of a Ward lobe (m = 0.2, normal incidence) sits in samples whose weight exceeds 10; with the quarter next to none.

use crate::models::{Lobe, Mixture, Scalar, V3, diffuse_and};

/// Which exponent (5.2) takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExponentRule {
    /// 2/m², right for cosⁿδ.    (5.3)
    HalfVector,
    /// 1/(2m²), right for cosⁿα.
    Mirror,
}

impl ExponentRule {
    /// The exponent for the slope `m` > 0.
    pub fn exponent<T: Scalar>(self, m: T) -> T {
        let two = T::of(2.0);
        match self {
            Self::HalfVector => two / m.squared(),
            Self::Mirror => T::one() / (two * m.squared()),
        }
    }
}

/// (5.1) and (5.2) with weights `diffuse` and `glossy`, for a surface of slope `m` seen from `wo`. (5.2) has no support beyond 90° from the mirror direction:
/// only a mixture with `diffuse` > 0 leaves no direction out.
pub fn survey_mixture<T: Scalar>(diffuse: T, glossy: T, m: T, rule: ExponentRule, wo: V3<T>) -> Mixture<T> {
    diffuse_and(diffuse, glossy, Lobe::Power { axis: V3::new(-wo.x, -wo.y, wo.z), n: rule.exponent(m) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::Form;
    use crate::models::testing::{assert_samples_follow, masses, model};
    use glam::DVec3;

    /// Row BR-29: masses of (5.2) above the horizon, seen from 70°.
    #[test]
    fn the_surveys_densities_integrate_to_one_over_the_sphere() {
        let wo = V3::from_angles(70_f64.to_radians(), 0.4);
        let axis = V3::new(-wo.x, -wo.y, wo.z);
        for (n, expected) in [(200.0, 1.0), (50.0, 0.9939), (12.5, 0.8984), (3.125, 0.7502)] {
            let (whole, above) = masses(|wi| Lobe::Power { axis, n }.pdf(wi, wo));
            assert!((whole - 1.0).abs() < 1e-6, "n = {n}: {whole}");
            assert!((above - expected).abs() < 1e-3, "n = {n}: {above} above the horizon");
            assert!((above - expected - 0.01).abs() > 1e-3, "planted fault");
        }
        let (whole, above) = masses(|wi| Lobe::Cosine.pdf(wi, wo));
        assert!((whole - 1.0).abs() < 1e-6 && (above - 1.0).abs() < 1e-6, "{whole}, {above}");
    }

    /// Row BR-29: `lambert` and `phong` are sampled from (5.1) and (5.2).
    #[test]
    fn samples_of_the_surveys_densities_follow_them() {
        assert_samples_follow(&*model("lambert", &[], Form::Corrected), 30.0, 10.0);
        for n in ["3.125", "50"] {
            assert_samples_follow(&*model("phong", &[("kd", "0"), ("ks", "1"), ("n", n)], Form::Corrected), 70.0, 25.0);
        }
    }

    #[test]
    fn the_survey_mixture_is_its_two_densities() {
        let wo = V3::from_angles(0.7_f64, 0.2);
        let mixture = survey_mixture(1.0, 3.0, 0.2, ExponentRule::Mirror, wo);
        let wi = V3::from_angles(0.5, 3.0);
        let power = Lobe::Power { axis: V3::new(-wo.x, -wo.y, wo.z), n: 12.5 };
        let expected = 0.25 * Lobe::Cosine.pdf(wi, wo) + 0.75 * power.pdf(wi, wo);
        assert!((mixture.pdf(wi, wo) - expected).abs() < 1e-12);
    }

    /// Row BR-30: share of the energy of Ward's lobe that lies in samples of weight above 10.
    #[test]
    fn a_quarter_of_the_exponent_removes_the_heavy_weights() {
        for (m, rows, with_half_vector) in [("0.1", 4000, 0.28), ("0.2", 2000, 0.246), ("0.4", 2000, 0.15)] {
            let ward = model("ward", &[("kd", "0"), ("ks", "1"), ("m", m)], Form::Corrected);
            let heavy = |rule: ExponentRule| {
                let wo = DVec3::Z;
                let lobe = Lobe::Power { axis: V3::new(0.0, 0.0, 1.0), n: rule.exponent(m.parse::<f64>().unwrap()) };
                let (mut heavy, mut all) = (0.0, 0.0);
                for k in 0..rows {
                    let theta = (f64::from(k) + 0.5) / f64::from(rows) * std::f64::consts::FRAC_PI_2;
                    let wi = V3::from_angles(theta, 0.0);
                    let energy = ward.f_cos(wi.into(), wo).x;
                    all += energy * theta.sin();
                    heavy += if energy > 10.0 * lobe.pdf(wi, wo.into()) { energy * theta.sin() } else { 0.0 };
                }
                heavy / all
            };
            let (half, quarter) = (heavy(ExponentRule::HalfVector), heavy(ExponentRule::Mirror));
            assert!((half - with_half_vector).abs() < 0.02, "m = {m}: {half}");
            assert!(quarter < 0.001, "m = {m}: {quarter}");
        }
        let exponents = [0.05, 0.1, 0.15, 0.2, 0.25, 0.4, 0.6].map(|m: f64| ExponentRule::HalfVector.exponent(m));
        for (n, table) in exponents.into_iter().zip([800.0, 200.0, 88.9, 50.0, 32.0, 12.5, 5.56]) {
            assert!((n - table).abs() < 0.05, "{n} {table}");
        }
    }
}
