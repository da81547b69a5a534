//! Highlight functions H(t): how a highlight falls off with t, the cosine of the angle from its centre, from H(1) = 1. They stand in for Phong's tⁿ,
//! whose power was dear, and are exchangeable by name.
//!
//! ```text
//! phong               tⁿ                                                                  [Phong75]
//! trowbridge-reitz    [c²/(t² (c² − 1) + 1)]²                   0 < c ≤ 1                   [Blinn77] via [Falski04] (2.11), printed with c³
//! table               tⁿ from 1024 entries, linear between                                [Bishop86]
//! gaussian            exp(−(α c)²)                              α = acos t, rad            [Blinn77] via [Falski04] (2.12), printed without the minus
//! polynomial          1 + x (q₀ + … + q₉ x⁹), x = (α/α_c)²      0 beyond α_c               [Poulin90]: Chebyshev nodes
//! schlick             t/(n − n t + t)                                                     [Schlick94gems]
//! ```
//!
//! For t < 0 every function has its value at t = 0.

use crate::models::{Form, Lobe, Real, Scalar, V3, gauss_legendre};
use kajo_params::ParamChoice;
use std::f64::consts::{FRAC_PI_2, LN_2, SQRT_2, TAU};

/// The highlight functions by name.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
pub enum HighlightKind {
    /// A power of the cosine.
    Phong,
    /// The slope distribution of 1975, now called GGX.
    TrowbridgeReitz,
    /// The power, from a table.
    Table,
    /// A bell over the angle.
    Gaussian,
    /// A polynomial in the angle, fitted to the power.
    Polynomial,
    /// One division in place of the power.
    Schlick,
}

impl HighlightKind {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Phong, Self::TrowbridgeReitz, Self::Table, Self::Gaussian, Self::Polynomial, Self::Schlick];
}

/// Entries of the table; linear interpolation is within n (n − 1)/(8 · 1023²) of tⁿ: 1.2e-3 for n = 100.
pub const TABLE_ENTRIES: usize = 1024;

/// Coefficients of the polynomial.
const POLYNOMIAL_TERMS: usize = 10;

/// Below this value of tⁿ the polynomial stops.
const POLYNOMIAL_END: f64 = 1e-4;

/// A guard: beyond, the printed Gaussian, which grows with the angle, leaves the range of f32.
const LARGEST_EXPONENT: f64 = 80.0;

/// tⁿ in Schlick's form: 1 division, 1 multiplication, 1 subtraction, 1 addition. `t` in [0, 1], `n` > 0.    \[Schlick94gems]
#[inline(always)]
pub fn schlick<T: Real>(t: T, n: T) -> T {
    t / (n * (T::one() - t) + t)
}

/// A highlight function with its constants.
#[derive(Clone, Copy, Debug)]
pub struct Highlight<T> {
    shape: Shape<T>,
    /// Exponent of the power that it resembles near its centre.
    core: T,
    /// ∫ H(cos θ) dω over the hemisphere about its centre, sr.
    mass: T,
}

#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "the table lies with its material; a pointer would need an owner and could not be copied")]
enum Shape<T> {
    Phong { n: T },
    TrowbridgeReitz { numerator: T, c2: T },
    Table { n: T, entries: [f32; TABLE_ENTRIES] },
    Gaussian { factor: T },
    Polynomial { inverse_end2: T, q: [T; POLYNOMIAL_TERMS] },
    Schlick { n: T },
}

impl<T: Real> Highlight<T> {
    /// The function called `kind` for exponent `n` ≥ 0. `c` is the width of `trowbridge-reitz` and the steepness of `gaussian`, 1/rad; 0 chooses the `c`
    /// with which the function is ½ at the angle where tⁿ is.    \[Blinn77]
    pub fn new(kind: HighlightKind, n: f64, c: f64, form: Form) -> Self {
        // tⁿ = ½ at this cosine.
        let half = 0.5_f64.powf(1.0 / n);
        let printed = form == Form::Printed;
        let (shape, core) = match kind {
            HighlightKind::Phong => (Shape::Phong { n: T::of(n) }, n),
            HighlightKind::TrowbridgeReitz => {
                let x = half * half;
                let c2 = if c > 0.0 { c * c } else { (1.0 - x) / (SQRT_2 - x) };
                // ½ where t² is this; broader ones are never ½.
                let x = (1.0 - SQRT_2 * c2) / (1.0 - c2);
                let core = if x > 0.0 { (-2.0 * LN_2 / x.ln()).max(0.0) } else { 0.0 };
                (Shape::TrowbridgeReitz { numerator: T::of(if printed { c2 * c2.sqrt() } else { c2 }), c2: T::of(c2) }, core)
            }
            HighlightKind::Table => {
                let entries = std::array::from_fn(|k| (k as f64 / (TABLE_ENTRIES - 1) as f64).powf(n) as f32);
                (Shape::Table { n: T::of(n), entries }, n)
            }
            HighlightKind::Gaussian => {
                let c2 = if c > 0.0 { c * c } else { LN_2 / half.acos().powi(2) };
                (Shape::Gaussian { factor: T::of(if printed { c2 } else { -c2 }) }, 2.0 * c2)
            }
            HighlightKind::Polynomial => {
                let (end, q) = fit(n);
                (Shape::Polynomial { inverse_end2: T::of(1.0 / (end * end)), q: q.map(T::of) }, n)
            }
            // Guard: at n = 0 and t = 0 the quotient is 0/0.
            HighlightKind::Schlick => (Shape::Schlick { n: T::of(n.max(1e-6)) }, n),
        };
        let mut out = Self { shape, core: T::of(core), mass: T::zero() };
        // t = 1 − u⁴ puts nodes into the narrowest highlights.
        let part = |(u, weight): (f64, f64)| out.value(T::of(1.0 - u.powi(4))) * T::of(TAU * weight * 4.0 * u.powi(3));
        out.mass = gauss_legendre(64).into_iter().map(part).fold(T::zero(), |sum, part| sum + part);
        out
    }

    /// H(t); `cosine` is clamped to [0, 1].
    #[inline(always)]
    pub fn value(&self, cosine: T) -> T {
        let t = cosine.clamp(0.0, 1.0);
        match &self.shape {
            Shape::Phong { n } => t.powf(*n),
            // t² (c² − 1) + 1, without the cancellation near t = 1.
            Shape::TrowbridgeReitz { numerator, c2 } => (*numerator / ((T::one() - t) * (T::one() + t) + *c2 * t.squared())).squared(),
            Shape::Table { entries, .. } => t.interpolate(entries),
            Shape::Gaussian { factor } => (*factor * t.acos().squared()).min(T::of(LARGEST_EXPONENT)).exp(),
            Shape::Polynomial { inverse_end2, q } => {
                let x = t.acos().squared() * *inverse_end2;
                let mut sum = T::zero();
                for q in q.iter().rev() {
                    sum = sum.mul_add(x, *q);
                }
                T::select(T::one().lt(x), T::zero(), (T::one() + x * sum).max(T::zero()))
            }
            Shape::Schlick { n } => schlick(t, *n),
        }
    }

    /// ∫ H(cos θ) dω over the hemisphere about its centre, sr.
    pub fn mass(&self) -> T {
        self.mass
    }
}

impl<T: Scalar> Highlight<T> {
    /// Powers of the cosine about the highlight's centre that the function is sampled from, (share, exponent); the shares sum to 1. The last is uniform,
    /// also where the cosine is negative. For the functions with long tails broader powers follow the core, so that weights stay bounded.
    pub fn powers(&self) -> [(T, T); 4] {
        let shares = match self.shape {
            Shape::Phong { n } | Shape::Table { n, .. } if n <= T::zero() => [0.0, 0.0, 0.0, 1.0],
            Shape::Phong { .. } => [1.0, 0.0, 0.0, 0.0],
            Shape::Table { .. } | Shape::Polynomial { .. } => [0.95, 0.0, 0.0, 0.05],
            Shape::Gaussian { .. } => [0.9, 0.0, 0.0, 0.1],
            Shape::TrowbridgeReitz { .. } => [0.5, 0.3, 0.12, 0.08],
            Shape::Schlick { .. } => [0.3, 0.3, 0.25, 0.15],
        };
        std::array::from_fn(|k| {
            let exponent = self.core * T::of([1.0, 1.0 / 8.0, 1.0 / 64.0, 0.0][k]);
            (T::of(shares[k]), exponent)
        })
    }

    /// Lobes for a highlight of cos α: powers about the mirror direction of `wo`. Their weights sum to `weight`.
    pub fn lobes_about_mirror(&self, wo: V3<T>, weight: T) -> [(T, Lobe<T>); 4] {
        let axis = V3::new(-wo.x, -wo.y, wo.z);
        self.lobes(weight, |n| Lobe::Power { axis, n })
    }

    /// Lobes for a highlight of cos δ: powers of half vectors about the normal. Their weights sum to `weight`.
    pub fn lobes_of_half_vectors(&self, weight: T) -> [(T, Lobe<T>); 4] {
        self.lobes(weight, |n| Lobe::HalfPower { nx: n, ny: n })
    }

    fn lobes(&self, weight: T, lobe: impl Fn(T) -> Lobe<T>) -> [(T, Lobe<T>); 4] {
        let up = V3::new(T::zero(), T::zero(), T::one());
        let [core, broad, broader, (rest, _)] = self.powers();
        let [core, broad, broader] = [core, broad, broader].map(|(share, n)| (weight * share, lobe(n)));
        [core, broad, broader, (weight * rest, Lobe::Power { axis: up, n: T::zero() })]
    }
}

impl Highlight<f32> {
    /// Constants of the GPU's twin: the rank of the kind, and what its formula needs.
    pub fn constants(&self) -> [f32; 13] {
        let mut out = [0.0; 13];
        let numbers: &[f32] = match &self.shape {
            Shape::Phong { n } | Shape::Table { n, .. } | Shape::Schlick { n } => &[*n],
            Shape::TrowbridgeReitz { numerator, c2 } => &[*numerator, *c2],
            Shape::Gaussian { factor } => &[*factor],
            Shape::Polynomial { inverse_end2, q } => {
                out[2..12].copy_from_slice(q);
                &[*inverse_end2]
            }
        };
        out[1..=numbers.len()].copy_from_slice(numbers);
        let kind = match self.shape {
            Shape::Phong { .. } => HighlightKind::Phong,
            Shape::TrowbridgeReitz { .. } => HighlightKind::TrowbridgeReitz,
            Shape::Table { .. } => HighlightKind::Table,
            Shape::Gaussian { .. } => HighlightKind::Gaussian,
            Shape::Polynomial { .. } => HighlightKind::Polynomial,
            Shape::Schlick { .. } => HighlightKind::Schlick,
        };
        out[0] = kind as u32 as f32;
        out
    }
}

/// The largest difference between a highlight function and tⁿ over t in [0, 1], looked for at steps of 1/20000 and as fine near t = 1.
pub fn largest_difference(highlight: &Highlight<f64>, n: f64) -> f64 {
    let steps = 20_000;
    let at = |k: i32| f64::from(k) / f64::from(steps);
    let difference = |t: f64| (highlight.value(t) - t.powf(n)).abs();
    (0..=steps).map(|k| difference(at(k)).max(difference(1.0 - at(k).powi(4)))).fold(0.0, f64::max)
}

/// The angle where the polynomial for cosⁿα ends, and its coefficients: 1 + x q(x) meets cosⁿα at the Chebyshev nodes of x = (α/end)² in (0, 1).
///
/// cosⁿα is even in α, so a polynomial in α² of degree 10 does what one in α of degree 20 would.
fn fit(n: f64) -> (f64, [f64; POLYNOMIAL_TERMS]) {
    let end = POLYNOMIAL_END.powf(1.0 / n).acos().min(FRAC_PI_2);
    let node = |k: usize| 0.5 - 0.5 * ((k as f64 + 0.5) * std::f64::consts::PI / POLYNOMIAL_TERMS as f64).cos();
    let x: [f64; POLYNOMIAL_TERMS] = std::array::from_fn(node);
    // Divided differences of (cosⁿα − 1)/x, then Newton's form multiplied out.
    let mut difference = x.map(|x| ((x.sqrt() * end).cos().powf(n) - 1.0) / x);
    for order in 1..POLYNOMIAL_TERMS {
        for k in (order..POLYNOMIAL_TERMS).rev() {
            difference[k] = (difference[k] - difference[k - 1]) / (x[k] - x[k - order]);
        }
    }
    let mut q = [0.0; POLYNOMIAL_TERMS];
    for k in (0..POLYNOMIAL_TERMS).rev() {
        // q := q · (x − x_k) + difference_k
        for j in (0..POLYNOMIAL_TERMS).rev() {
            q[j] = if j > 0 { q[j - 1] } else { 0.0 } - x[k] * q[j];
        }
        q[0] += difference[k];
    }
    (end, q)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn highlight(kind: HighlightKind, n: f64, c: f64) -> Highlight<f64> {
        Highlight::new(kind, n, c, Form::Corrected)
    }

    /// Row BR-12.
    #[test]
    fn every_highlight_is_one_at_its_centre_and_falls() {
        for kind in HighlightKind::ALL {
            for n in [1.0, 5.0, 50.0, 1000.0] {
                let (h, single) = (highlight(kind, n, 0.0), Highlight::<f32>::new(kind, n, 0.0, Form::Corrected));
                assert!((h.value(1.0) - 1.0).abs() < 1e-12, "{kind:?} {n}");
                assert!((single.value(1.0) - 1.0).abs() < 1e-5, "{kind:?} {n}");
                let mut last = 1.0;
                for k in 1..=1000 {
                    let value = h.value(1.0 - f64::from(k) / 1000.0);
                    assert!(value >= 0.0 && value <= last + 1e-3, "{kind:?} {n}, step {k}: {value} after {last}");
                    last = value;
                }
                assert!((h.value(-0.5) - h.value(0.0)).abs() < 1e-15, "{kind:?}: beyond 90°");
            }
        }
        assert!(Highlight::<f64>::new(HighlightKind::TrowbridgeReitz, 50.0, 0.35, Form::Printed).value(1.0) < 0.2, "as printed it is c²");
    }

    /// Row BR-12: Trowbridge-Reitz c = 0.35, Gaussian c = 2, Schlick n = 50.
    #[test]
    fn highlights_equal_their_golden_values() {
        let close = |found: f64, expected: f64, digits: f64| assert!((found - expected).abs() < digits, "{found} for {expected}");
        let h = highlight(HighlightKind::TrowbridgeReitz, 50.0, 0.35);
        for (t, expected) in [(1.0, 1.0), (0.95, 0.34667), (0.9, 0.17939), (0.5, 0.024_626)] {
            close(h.value(t), expected, 6e-6);
        }
        let h = highlight(HighlightKind::Gaussian, 50.0, 2.0);
        for (alpha, expected) in [(0.0_f64, 1.0), (10.0, 0.88528), (30.0, 0.33400)] {
            close(h.value(alpha.to_radians().cos()), expected, 6e-6);
        }
        let h = highlight(HighlightKind::Schlick, 50.0, 0.0);
        close(h.value(0.9), 0.152_542, 6e-7);
        close(0.9_f64.powi(50), 0.005_15, 6e-6);
        let printed = Highlight::<f64>::new(HighlightKind::Gaussian, 50.0, 2.0, Form::Printed);
        assert!(printed.value(0.5) > 1.0, "as printed the Gaussian grows with the angle");
    }

    /// Row BR-12: the widths that `c` = 0 chooses.
    #[test]
    fn highlights_are_half_where_the_power_is() {
        for kind in HighlightKind::ALL.into_iter().filter(|kind| *kind != HighlightKind::Schlick) {
            for n in [1.0, 10.0, 100.0] {
                let value = highlight(kind, n, 0.0).value(0.5_f64.powf(1.0 / n));
                assert!((value - 0.5).abs() < 2e-3, "{kind:?} {n}: {value}");
            }
        }
    }

    /// Row BR-12.
    #[test]
    fn a_table_of_1024_entries_is_within_two_thousandths_of_the_power() {
        for n in [1.0, 3.0, 10.0, 50.0, 100.0] {
            let found = largest_difference(&highlight(HighlightKind::Table, n, 0.0), n);
            assert!(found < 2e-3 && found < n * n / (8.0 * 1023.0 * 1023.0) + 1e-7, "{n}: {found}");
        }
        assert!(largest_difference(&highlight(HighlightKind::Table, 300.0, 0.0), 300.0) > 2e-3, "finer powers need a larger table");
    }

    /// Row BR-12: the error of the fit, as doc.md of `phong` reports it.
    #[test]
    fn the_polynomial_stays_near_the_power() {
        for n in [1.0, 5.0, 50.0, 200.0, 1e4] {
            let found = largest_difference(&highlight(HighlightKind::Polynomial, n, 0.0), n);
            println!("polynomial n = {n}: {found:e}");
            assert!(found < 2e-4, "{n}: {found}");
        }
        assert!(largest_difference(&highlight(HighlightKind::Polynomial, 50.0, 0.0), 55.0) > 0.01, "planted fault");
    }

    /// Row BR-12: largest gap between Schlick's quotient and tⁿ; same slope n at t = 1.
    #[test]
    fn schlicks_quotient_is_near_the_power_with_a_longer_tail() {
        for (n, gap) in [(1.0, 0.0), (5.0, 0.155), (10.0, 0.179), (50.0, 0.199), (100.0, 0.201)] {
            let h = highlight(HighlightKind::Schlick, n, 0.0);
            let found = largest_difference(&h, n);
            assert!((found - gap).abs() < 6e-4, "{n}: {found}");
            let slope = (h.value(1.0) - h.value(1.0 - 1e-7)) / 1e-7;
            assert!((slope / n - 1.0).abs() < 1e-3, "{n}: slope {slope}");
        }
    }

    #[test]
    fn the_mass_of_a_power_is_known() {
        for n in [1.0, 50.0, 1e4] {
            let mass = highlight(HighlightKind::Phong, n, 0.0).mass();
            assert!((mass * (n + 1.0) / TAU - 1.0).abs() < 1e-6, "{n}: {mass}");
        }
    }
}
