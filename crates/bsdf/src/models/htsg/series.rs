//! The sum over orders of diffraction, for surfaces of any roughness.
//!
//! ```text
//! Σ_{m≥1} g^m e^{−g}/(m! m) exp(−b/m)          (3.26)    [He91]
//! ```
//!
//! Smooth surfaces (g < [`ROUGH`]): the terms by recurrence, until the rest cannot count. Rough ones: the terms are a smooth bump about their saddle, so
//! equal steps of ¾ of its width, m! by Stirling's series, integrate it to 1e-9 with twenty terms for any g, where the plain sum needs g + 12√g + 40.

use crate::models::Real;
use std::f64::consts::TAU;

/// From here on the bump's lower end is clear of m = 1.
const ROUGH: f64 = 24.0;

/// Beyond g + 12 √g + 40 terms nothing is left.
const MOST_TERMS: u32 = 123;

/// Factors of a term that are smaller count for nothing in single precision; their products would underflow.
const LEAST_FACTOR: f64 = 1e-18;

/// Nodes below and above the saddle, in steps of ¾ of its width; the upper tail is the heavier one.
const NODES: (i32, i32) = (-8, 11);

/// The sum, `g` ≥ 0 and `b` ≥ 0.
#[inline(always)]
pub fn diffraction_sum<T: Real>(g: T, b: T) -> T {
    let rough = T::of(ROUGH).le(g);
    let few = if T::any(!rough) { by_terms(g.min(T::of(ROUGH)), b) } else { T::zero() };
    let many = if T::any(rough) { about_saddle(g.max(T::of(ROUGH)), b) } else { T::zero() };
    T::select(rough, many, few)
}

#[inline(always)]
fn by_terms<T: Real>(g: T, b: T) -> T {
    let (mut poisson, mut sum) = ((-g).exp(), T::zero());
    for order in 1..=MOST_TERMS {
        let inverse = T::of(1.0 / f64::from(order));
        poisson = (poisson * g * inverse).flushed(LEAST_FACTOR);
        sum = sum + poisson * inverse * (-b * inverse).exp().flushed(LEAST_FACTOR);
        // Past 2g, what follows is less than this term without its exponential.
        let left = (sum * T::of(1e-10)).lt(poisson * inverse);
        if !T::any(left | T::of(0.5 * f64::from(order)).lt(g)) {
            break;
        }
    }
    sum
}

#[inline(always)]
fn about_saddle<T: Real>(g: T, b: T) -> T {
    // Largest exponent: ln(m/g) = b/m². Newton's steps end near enough.
    let mut saddle = g + (b / g).min(b.sqrt());
    for _ in 0..4 {
        let slope = (saddle / g).ln() - b / saddle.squared();
        saddle = (saddle - slope / (T::one() / saddle + T::of(2.0) * b / (saddle.squared() * saddle))).max(g);
    }
    let width = (T::one() / (T::one() / saddle + T::of(2.0) * b / (saddle.squared() * saddle))).sqrt();
    let step = T::of(0.75) * width;
    let mut sum = T::zero();
    for k in NODES.0..=NODES.1 {
        let node = saddle + T::of(f64::from(k)) * step;
        let m = node.max(T::of(0.5));
        let inverse = T::one() / m;
        let stirling = inverse * (T::of(1.0 / 12.0) - inverse.squared() * T::of(1.0 / 360.0));
        let exponent = m * ln_1p_minus((g - m) * inverse) - b * inverse - stirling;
        let term = exponent.exp().flushed(LEAST_FACTOR) * inverse * (inverse * T::of(1.0 / TAU)).sqrt();
        sum = sum + T::select(node.lt(T::of(0.5)), T::zero(), term);
    }
    sum * step
}

/// ln(1 + r) − r for r > −1, with all digits for small r: from ln(1 + r) = 2 artanh s and r = 2s/(1 − s), s = r/(2 + r).
#[inline(always)]
fn ln_1p_minus<T: Real>(r: T) -> T {
    let s = r / (T::of(2.0) + r);
    let s2 = s.squared();
    let mut odd = T::zero();
    for n in [13.0, 11.0, 9.0, 7.0, 5.0, 3.0] {
        odd = odd.mul_add(s2, T::of(1.0 / n));
    }
    let near = T::of(2.0) * s2 * (s * odd - T::one() / (T::one() - s));
    let far = (T::one() + r).max(T::of(1e-30)).ln() - r;
    T::select(s.abs().lt(T::of(0.125)), near, far)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The plain sum of logarithms of terms.
    fn plain(g: f64, b: f64) -> f64 {
        let mut factorial = 0.0;
        (1..(g + 30.0 * g.sqrt() + 500.0) as u32)
            .map(|m| {
                let m = f64::from(m);
                factorial += m.ln();
                (m * g.ln() - g - factorial - m.ln() - b / m).exp()
            })
            .sum()
    }

    #[test]
    fn it_is_the_plain_sum_for_smooth_and_rough_surfaces() {
        for g in [1e-6, 0.1, 1.0, 5.0, 12.0, 23.9, 24.1, 26.0, 33.0, 60.0, 200.0, 5000.0, 2e5] {
            for b in [0.0, 0.3, 1.0, 3.0, 10.0].map(|x| x * f64::max(g, 1.0)) {
                let (sum, expected) = (diffraction_sum(g, b), plain(g, b));
                assert!((sum / expected - 1.0).abs() < 5e-9, "g {g}, b {b}: {sum} is not {expected}");
                let single = f64::from(diffraction_sum(g as f32, b as f32));
                assert!((single - expected).abs() < 1e-4 * expected + 1e-36, "f32, g {g}, b {b}: {single} is not {expected}");
            }
        }
        assert!((diffraction_sum(30.0_f64, 3.0) / plain(30.0, 3.01) - 1.0).abs() > 1e-5, "planted fault");
    }

    /// The limit of rough surfaces: (1/g) exp(−b/g).
    #[test]
    fn the_roughest_are_beckmanns() {
        for g in [1e6, 1e8] {
            for x in [0.0, 1.0, 3.0] {
                let ratio = diffraction_sum(g, x * g) * g / f64::exp(-x);
                assert!((ratio - 1.0).abs() < 10.0 / g, "g {g}, b/g {x}: {ratio}");
                let single = diffraction_sum(g as f32, (x * g) as f32) * g as f32 / f32::exp(-x as f32);
                assert!((single - 1.0).abs() < 1e-3, "f32, g {g}, b/g {x}: {single}");
            }
        }
    }

    #[test]
    fn both_ways_meet() {
        for b in [0.0, 10.0, 200.0] {
            let (below, above) = (by_terms(ROUGH, b), about_saddle(ROUGH, b));
            assert!((below / above - 1.0).abs() < 5e-9, "b {b}: {below} and {above}");
        }
        assert_eq!(diffraction_sum(0.0_f64, 1.0), 0.0, "a mirror diffracts nothing");
        assert!(diffraction_sum(f64::from(ROUGH as f32), 1e9) >= 0.0 && diffraction_sum(1.0_f32, 1e9) == 0.0);
    }
}
