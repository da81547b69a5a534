//! Distributions D(δ) of facet slopes, isotropic and elliptic, and sums of them.
//!
//! ```text
//! gaussian          c exp(−(δ/m)²)                                   (3.5)    [Torrance67], [Blinn77]
//! beckmann          exp(−(tan δ/m)²)/(m² cos⁴δ)                      (3.6)    [Beckmann63], [Cook82]
//! schlick           cos²δ/(m cos⁴δ − r cos⁴δ + r)²,  r = 1/(2m)      (3.7)    [Schlick94survey]
//! trowbridge-reitz  m²/(m² cos²δ + sin²δ)²                                    [Trowbridge75], [Walter07] α = m
//! blinn             (n + 2)/2 cosⁿδ,  n = 2/m²                       (5.3)    [Blinn77], [Ward95]
//! a sum             Σ w_k D(δ, m_k),  Σ w_k = 1                      (3.8)    [Cook82]
//! ```
//!
//! Unit: 1/sr times π, as the literature of these models has it: ∫ D cos δ dω = π. Printed c is arbitrary; here it is what gives that integral.
//! Elliptic: 1/m² becomes q(φ) = cos²φ/m_x² + sin²φ/m_y², and D(δ, m(φ)) is scaled by 1/(m_x m_y q), which keeps D continuous at the normal and the
//! integral π for every D. With e = sin²δ q all of them are short, and none loses digits near the normal in single precision.

use crate::models::{Geometry, Lobe, Real, Scalar};
use kajo_params::ParamChoice;
use std::f64::consts::{FRAC_PI_2, PI};

/// Which distribution of facets.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the module says it")]
pub enum Distribution {
    Gaussian,
    Beckmann,
    Schlick,
    TrowbridgeReitz,
    Blinn,
}

/// One scale of roughness, prepared.
#[derive(Clone, Copy, Debug)]
pub struct Scale<T> {
    /// 1/m_x², 1/m_y².
    inverse: [T; 2],
    /// Weight times D(0).
    peak: T,
}

/// A sum of at most two scales of one distribution.
#[derive(Clone, Copy, Debug)]
pub struct Facets<T> {
    kind: Distribution,
    scales: [Scale<T>; 2],
    count: usize,
    /// Weights and slopes m_x, m_y as given, for the sampler.
    given: [[T; 3]; 2],
}

impl<T: Real> Scale<T> {
    /// `weight` ≥ 0; m_x, m_y > 0.
    pub fn new(kind: Distribution, weight: f64, mx: f64, my: f64) -> Self {
        let height = match kind {
            Distribution::Gaussian => PI / gaussian_integral(mx, my),
            Distribution::Blinn => 0.5 * ((2.0 / (mx * mx) + 2.0) * (2.0 / (my * my) + 2.0)).sqrt(),
            _ => 1.0 / (mx * my),
        };
        Self { inverse: [mx, my].map(|m| T::of(1.0 / (m * m))), peak: T::of(weight * height) }
    }

    /// weight · D(δ, φ).
    #[inline(always)]
    pub fn d(&self, kind: Distribution, g: &Geometry<T>) -> T {
        let (x2, y2, c2) = (g.h.x.squared(), g.h.y.squared(), g.h.z.squared());
        let e = x2 * self.inverse[0] + y2 * self.inverse[1];
        match kind {
            Distribution::Beckmann => self.peak * (-e / c2).exp() / c2.squared(),
            Distribution::TrowbridgeReitz => self.peak / (c2 + e).squared(),
            Distribution::Schlick => self.peak * c2 / (c2.squared() + T::of(0.5) * e * (T::one() + c2)).squared(),
            Distribution::Blinn => {
                // cosⁿδ = exp(−(e/c²) ln(1 + t)/t), t = tan²δ; ln(u)/(u − 1) has all digits where u = 1 + t is rounded.
                let u = T::one() + (x2 + y2) / c2;
                let flat = u.le(T::one());
                let slope = T::select(flat, T::one(), u.ln() / T::select(flat, T::one(), u - T::one()));
                self.peak * (-e / c2 * slope).exp()
            }
            Distribution::Gaussian => {
                // δ²q = e δ²/sin²δ, and δ²/sin²δ → 1 at the normal.
                let s2 = x2 + y2;
                let flat = s2.lt(T::of(1e-20));
                let delta = s2.sqrt().atan2(g.h.z);
                let stretch = T::select(flat, T::one(), delta.squared() / T::select(flat, T::one(), s2));
                self.peak * (-e * stretch).exp()
            }
        }
    }
}

impl<T: Real> Facets<T> {
    /// Of one or two scales (weight, m_x, m_y); weights sum to 1.
    pub fn new(kind: Distribution, scales: &[[f64; 3]]) -> Self {
        let at = |k: usize| scales[k.min(scales.len() - 1)];
        let scale = |k| Scale::new(kind, at(k)[0], at(k)[1], at(k)[2]);
        Self { kind, scales: [scale(0), scale(1)], count: scales.len().min(2), given: [0, 1].map(|k| at(k).map(T::of)) }
    }

    /// Σ w_k D(δ, φ; m_k); 0 for a half vector in the surface.
    #[inline(always)]
    pub fn d(&self, g: &Geometry<T>) -> T {
        let mut sum = self.scales[0].d(self.kind, g);
        if self.count > 1 {
            sum = sum + self.scales[1].d(self.kind, g);
        }
        // Below, cos⁴δ underflows in single precision; D of every kind is at its end there.
        T::select(g.h.z.lt(T::of(1e-9)), T::zero(), sum)
    }

    /// For the GPU's side: which kind, and (1/m_x², 1/m_y², peak) of both scales, the second 0 where there is one.
    pub fn constants(&self) -> (T, [[T; 3]; 2]) {
        let scale = |k: usize| {
            let Scale { inverse: [x, y], peak } = self.scales[k];
            [x, y, if k < self.count { peak } else { T::zero() }]
        };
        (T::of(f64::from(self.kind as u32)), [scale(0), scale(1)])
    }
}

impl<T: Scalar> Facets<T> {
    /// The lobe of each scale with its weight: half vectors by D cos δ/π; for the Gaussian, by the long-tailed distribution of its width, which is at
    /// least 0.6 times as dense everywhere.
    pub fn lobes(&self) -> impl Iterator<Item = (T, Lobe<T>)> {
        let kind = self.kind;
        self.given.into_iter().take(self.count).map(move |[weight, mx, my]| {
            let exponent = |m: T| T::of(2.0) / m.squared() + T::one();
            let lobe = match kind {
                Distribution::Beckmann => Lobe::Gauss { mx, my },
                Distribution::Schlick => Lobe::SchlickSlopes { mx, my },
                Distribution::Blinn => Lobe::HalfPower { nx: exponent(mx), ny: exponent(my) },
                Distribution::TrowbridgeReitz | Distribution::Gaussian => Lobe::LongTail { mx, my },
            };
            (weight, lobe)
        })
    }
}

/// Schlick's distribution (3.7) in the form that he counts: 1 division, 4 multiplications, 1 addition, with m − r and r prepared, r = 1/(2m). In single
/// precision it loses digits for m < 0.01; [`Scale::d`] does not.
#[inline(always)]
pub fn schlick<T: Real>(cos_delta: T, m_minus_r: T, r: T) -> T {
    let t2 = cos_delta.squared();
    t2 / (m_minus_r * t2.squared() + r).squared()
}

/// ∫ exp(−δ² q(φ)) cos δ dω by Simpson's rule in δ and equal steps in φ, both far finer than the tolerance of anything here.
fn gaussian_integral(mx: f64, my: f64) -> f64 {
    let over_delta = |m: f64| {
        let (end, steps) = (FRAC_PI_2.min(7.0 * m), 2048_u32);
        let step = end / f64::from(steps);
        let f = |k: u32| {
            let delta = f64::from(k) * step;
            (-(delta / m).powi(2)).exp() * 0.5 * (2.0 * delta).sin()
        };
        let inner: f64 = (1..steps).map(|k| f(k) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
        (f(0) + inner + f(steps)) * step / 3.0
    };
    if mx == my {
        return 2.0 * PI * over_delta(mx);
    }
    let turns = 64_u32;
    let at = |k: u32| {
        let (sin, cos) = ((f64::from(k) + 0.5) / f64::from(turns) * FRAC_PI_2).sin_cos();
        over_delta(1.0 / ((cos / mx).powi(2) + (sin / my).powi(2)).sqrt())
    };
    2.0 * PI * (0..turns).map(at).sum::<f64>() / f64::from(turns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::testing::{SETS, directions};
    use crate::models::{V3, testing};

    const KINDS: [Distribution; 5] =
        [Distribution::Gaussian, Distribution::Beckmann, Distribution::Schlick, Distribution::TrowbridgeReitz, Distribution::Blinn];

    fn at(theta: f64, phi: f64) -> Geometry<f64> {
        let h = V3::from_angles(theta, phi);
        Geometry { wi: h, wo: h, h, cos_beta: 1.0 }
    }

    /// ∫ D cos δ dω with tan δ = m x: Simpson's rule in x after x = u/(1 − u), equal steps in φ.
    fn integral(facets: &Facets<f64>, width: f64) -> f64 {
        let (steps, turns) = (4000_u32, 96_u32);
        let mut sum = 0.0;
        for k in 1..steps {
            let u = f64::from(k) / f64::from(steps);
            let tan = width * (u / (1.0 - u)).powi(2);
            let jacobian = width * 2.0 * u / (1.0 - u).powi(3);
            let delta = tan.atan();
            let weight = if k % 2 == 1 { 4.0 } else { 2.0 };
            let ring: f64 = (0..turns).map(|j| facets.d(&at(delta, (f64::from(j) + 0.5) * 2.0 * PI / f64::from(turns)))).sum();
            sum += weight * ring * delta.cos() * delta.sin() * delta.cos().powi(2) * jacobian;
        }
        sum / 3.0 / f64::from(steps) * 2.0 * PI / f64::from(turns)
    }

    /// Row BR-14.
    #[test]
    fn every_distribution_integrates_to_pi() {
        for kind in KINDS {
            for m in [0.05, 0.2, 0.6, 1.0] {
                let one = integral(&Facets::new(kind, &[[1.0, m, m]]), m);
                assert!((one / PI - 1.0).abs() < 1e-9 / PI, "{kind:?} m = {m}: {one}");
            }
            let sum = integral(&Facets::new(kind, &[[0.3, 0.2, 0.2], [0.7, 0.6, 0.6]]), 0.3);
            assert!((sum / PI - 1.0).abs() < 1e-9 / PI, "{kind:?} of two scales: {sum}");
        }
        let wrong = integral(&Facets::new(Distribution::Beckmann, &[[0.3, 0.2, 0.2], [0.71, 0.6, 0.6]]), 0.3);
        assert!((wrong - PI).abs() > 1e-3, "planted fault");
    }

    /// Row BR-19.
    #[test]
    fn elliptic_distributions_integrate_to_pi() {
        for kind in KINDS {
            let integral = integral(&Facets::new(kind, &[[1.0, 0.15, 0.4]]), 0.2);
            assert!((integral - PI).abs() < 1e-8, "{kind:?}: {integral}");
        }
    }

    /// Row BR-14. The Gaussian's c and Blinn's lobe have their own heights.
    #[test]
    fn at_the_normal_they_are_one_over_m_squared() {
        for m in [0.001, 0.2, 0.6] {
            let peak = |kind| Facets::new(kind, &[[1.0, m, m]]).d(&at(0.0, 0.0)) * m * m;
            for kind in [Distribution::Beckmann, Distribution::Schlick, Distribution::TrowbridgeReitz] {
                assert!((peak(kind) - 1.0).abs() < 1e-12, "{kind:?}");
            }
            assert!((peak(Distribution::Blinn) - 1.0 - m * m).abs() < 1e-12);
        }
    }

    /// Row BR-14: appendix C and the angles of section 3.7.
    #[test]
    fn they_equal_golden_values() {
        let beckmann = Facets::new(Distribution::Beckmann, &[[1.0, 0.2, 0.2]]);
        let rational = Facets::new(Distribution::Schlick, &[[1.0, 0.2, 0.2]]);
        let golden = [
            (20.963_218_68, 17.999_369_35),
            (0.015_466_945_61, 0.549_605_405_8),
            (1.140_015_889e-5, 0.232_911_061_5),
            (5.561_763_163e-14, 0.093_037_654_17),
            (25.0, 25.0),
        ];
        for ((name, angles), (b, s)) in SETS.iter().zip(golden) {
            let (wi, wo) = directions(*angles);
            let g = Geometry::new(wi.into(), wo.into());
            for (value, expected) in [(beckmann.d(&g), b), (rational.d(&g), s), (schlick(g.cos_delta(), 0.2 - 2.5, 2.5), s)] {
                assert!((value / expected - 1.0).abs() < 2e-9, "{name}: {value} is not {expected}");
            }
        }
        for (m, [half, tenth, hundredth]) in [(0.05, [2.39, 4.35, 6.14]), (0.2, [9.84, 17.52, 24.03]), (0.6, [37.24, 50.62, 58.07])] {
            let facets = Facets::new(Distribution::Beckmann, &[[1.0, m, m]]);
            for (degrees, share) in [(half, 0.5), (tenth, 0.1), (hundredth, 0.01)] {
                let [below, above] = [-0.02_f64, 0.02].map(|d| facets.d(&at((degrees + d).to_radians(), 0.0)) * m * m - share);
                assert!(below > 0.0 && above < 0.0, "Beckmann m = {m} falls to {share} at {degrees}°");
            }
        }
        for (m, [half, tenth, hundredth]) in [(0.05, [1.85, 4.22, 8.64]), (0.2, [7.63, 17.63, 37.47]), (0.6, [32.53, 64.23, 82.02])] {
            let facets = Facets::new(Distribution::Schlick, &[[1.0, m, m]]);
            for (degrees, share) in [(half, 0.5), (tenth, 0.1), (hundredth, 0.01)] {
                let [below, above] = [-0.02_f64, 0.02].map(|d| facets.d(&at((degrees + d).to_radians(), 0.0)) * m * m - share);
                assert!(below > 0.0 && above < 0.0, "Schlick m = {m} falls to {share} at {degrees}°");
            }
        }
    }

    #[test]
    fn single_precision_keeps_its_digits_on_smooth_surfaces() {
        for kind in KINDS {
            let double = Facets::<f64>::new(kind, &[[1.0, 0.001, 0.002]]);
            let single = Facets::<f32>::new(kind, &[[1.0, 0.001, 0.002]]);
            for delta in [0.0, 0.0005, 0.002, 0.01, 0.5] {
                let h = V3::from_angles(delta, 0.7);
                let g = Geometry { wi: h, wo: h, h, cos_beta: 1.0 };
                let h32 = V3::new(h.x as f32, h.y as f32, h.z as f32);
                let g32 = Geometry { wi: h32, wo: h32, h: h32, cos_beta: 1.0 };
                let (exact, rounded) = (double.d(&g), f64::from(single.d(&g32)));
                assert!((exact - rounded).abs() <= 1e-4 * exact + 1e-30, "{kind:?} at {delta}: {rounded} is not {exact}");
            }
        }
    }

    /// The sampler's density over f's D cos δ stays bounded.
    #[test]
    fn lobes_cover_their_distribution() {
        for kind in KINDS {
            let facets = Facets::new(kind, &[[0.4, 0.1, 0.3], [0.6, 0.5, 0.5]]);
            let mut rng = kajo_sampling::Rng::new(3);
            for _ in 0..2000 {
                let mut next = || testing::directions([f64::from(rng.next_1d()) * 88.0, f64::from(rng.next_1d()) * 360.0, 0.0, 0.0]).0;
                let (wi, wo) = (V3::from(next()), V3::from(next()));
                let g = Geometry::new(wi, wo);
                let density: f64 = facets.lobes().map(|(weight, lobe)| weight * lobe.pdf(wi, wo)).sum();
                let wanted = facets.d(&g) * g.cos_delta() / (4.0 * PI * g.cos_beta);
                assert!(wanted <= 1.7 * density + 1e-12, "{kind:?}: {wanted} by a density of {density}");
            }
        }
    }
}
