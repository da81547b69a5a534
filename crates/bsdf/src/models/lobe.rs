//! The distributions that models are sampled from, each exact with its density, and mixtures of them.
//!
//! ```text
//! p(ω) = Σ_k w_k p_k(ω),    Σ_k w_k = 1                 one-sample mixture
//! p(ω) = p_h(h) / (4 (ω·h))                             half vector to direction    [Walter07] eq. 14
//! ```
//!
//! Directions that a lobe sends below the horizon count as samples of weight 0: no lobe is renormalised for them.

use super::{Real, Scalar, V3};
use std::f64::consts::{PI, TAU};

/// A distribution of directions, given the direction that stays fixed (the viewer).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe<T> {
    /// cos θ/π about the normal.    (5.1)
    Cosine,
    /// (n + 1)/(2π) cosⁿ about an axis, such as the mirror direction.    (5.2)
    Power {
        /// Unit vector.
        axis: V3<T>,
        /// Exponent ≥ 0.
        n: T,
    },
    /// Half vectors by exp(−tan²δ (cos²φ/m_x² + sin²φ/m_y²))/(π m_x m_y cos³δ).    \[Ward92], \[Walter05]
    Gauss {
        /// Slope along x, > 0.
        mx: T,
        /// Slope along y, > 0.
        my: T,
    },
    /// Half vectors by exp(−2 (1 − cos δ) k)/(π m_x m_y (1 − e^(−2k))), k = cos²φ/m_x² + sin²φ/m_y²: the Gaussian over the chord instead of the slope.
    GaussChord {
        /// Slope along x, > 0.
        mx: T,
        /// Slope along y, > 0.
        my: T,
    },
    /// Half vectors by √((n_x+1)(n_y+1))/(2π) cos δ^(n_x cos²φ + n_y sin²φ).    \[Ashikhmin00]
    HalfPower {
        /// Exponent along x, ≥ 0.
        nx: T,
        /// Exponent along y, ≥ 0.
        ny: T,
    },
    /// Half vectors by cos δ · r/(π (1 + r cos²δ − cos²δ)²) · √p/(cos²φ + p sin²φ): Schlick's zenith term, which is Trowbridge-Reitz with α² = r, and an
    /// azimuth that his A(φ) exceeds nowhere.    \[Schlick94]
    Rational {
        /// Roughness, > 0.
        r: T,
        /// Isotropy in (0, 1]; 1 is isotropic.
        p: T,
    },
    /// Half vectors as the viewer sees GGX facets, without most of those that reflect below the surface.    \[Heitz18], \[Eto23]
    VisibleGgx {
        /// Width of slopes along x, in (0, 1].
        alpha_x: T,
        /// Width of slopes along y, in (0, 1].
        alpha_y: T,
    },
    /// Half vectors by D cos δ/π, D of Trowbridge and Reitz: 1/(m_x m_y (cos²δ + sin²δ (cos²φ/m_x² + sin²φ/m_y²))²).    \[Walter07]
    LongTail {
        /// Slope along x, > 0.
        mx: T,
        /// Slope along y, > 0.
        my: T,
    },
    /// Half vectors by D cos δ/π, D of Schlick (3.7): m_φ²/(m_x m_y) cos²δ/(m cos⁴δ − r cos⁴δ + r)², r = 1/(2m), 1/m² = cos²φ/m_x² + sin²φ/m_y².
    SchlickSlopes {
        /// Slope along x, > 0.
        mx: T,
        /// Slope along y, > 0.
        my: T,
    },
    /// Directions whose projection on the surface is Gaussian about that of the mirror direction: exp(−|ω_xy + ω_o,xy|²/w²) cos θ/(π w²).
    Diffracted {
        /// Width w of the Gaussian, > 0.
        width: T,
    },
}

/// At most this many lobes make a mixture: a diffuse one, and as many as Lafortune's model has rows.
pub const MOST_LOBES: usize = 10;

/// Lobes with weights that sum to 1.
#[derive(Clone, Copy, Debug)]
pub struct Mixture<T> {
    lobes: [(T, Lobe<T>); MOST_LOBES],
    count: usize,
}

impl<T: Scalar> Mixture<T> {
    /// Of lobes with relative weights ≥ 0; where all are 0, a cosine lobe.
    ///
    /// # Panics
    /// For more than [`MOST_LOBES`].
    #[inline]
    pub fn new(weighted: &[(T, Lobe<T>)]) -> Self {
        let mut out = Self { lobes: [(T::one(), Lobe::Cosine); MOST_LOBES], count: 1 };
        let sum = weighted.iter().fold(T::zero(), |sum, (weight, _)| sum + *weight);
        if sum > T::zero() {
            out.count = weighted.len();
            for (slot, (weight, lobe)) in out.lobes.iter_mut().zip(weighted) {
                *slot = (*weight / sum, *lobe);
            }
        }
        out
    }

    /// A direction for random numbers in [0, 1); `None` below the horizon. `wo` is the fixed direction.
    #[inline]
    pub fn sample(&self, wo: V3<T>, choice: T, u: [T; 2]) -> Option<V3<T>> {
        let mut rest = choice;
        let mut chosen = self.lobes[self.count - 1].1;
        for (weight, lobe) in &self.lobes[..self.count] {
            if rest < *weight {
                chosen = *lobe;
                break;
            }
            rest = rest - *weight;
        }
        chosen.sample(wo, u).filter(|wi| wi.z > T::zero())
    }

    /// The density of [`Mixture::sample`] at `wi`, 1/sr.
    #[inline]
    pub fn pdf(&self, wi: V3<T>, wo: V3<T>) -> T {
        self.lobes[..self.count].iter().fold(T::zero(), |sum, (weight, lobe)| sum + *weight * lobe.pdf(wi, wo))
    }
}

impl<T: Scalar> Lobe<T> {
    /// A direction, perhaps below the horizon; `None` where the map leaves the half vector's side.
    pub fn sample(&self, wo: V3<T>, u: [T; 2]) -> Option<V3<T>> {
        let [u, v] = u;
        let two_pi = T::of(TAU);
        match *self {
            Self::Cosine => Some(from_cos_phi((T::one() - u).sqrt(), two_pi * v)),
            Self::Power { axis, n } => {
                let local = from_cos_phi((T::one() - u).powf(T::one() / (n + T::one())), two_pi * v);
                Some(to_frame(axis, local))
            }
            Self::Gauss { mx, my } => {
                let phi = quadrant_azimuth(v, my / mx);
                let (c2, s2) = (phi.cos().squared(), phi.sin().squared());
                let tan2 = -(T::one() - u).ln() / (c2 / mx.squared() + s2 / my.squared());
                mirror(wo, from_tan2_phi(tan2, phi))
            }
            Self::GaussChord { mx, my } => {
                let phi = quadrant_azimuth(v, my / mx);
                let two_k = T::of(2.0) * (phi.cos().squared() / mx.squared() + phi.sin().squared() / my.squared());
                let below = T::one() - (-two_k).exp();
                mirror(wo, from_cos_phi((T::one() + (T::one() - u * below).ln() / two_k).max(T::zero()), phi))
            }
            Self::HalfPower { nx, ny } => {
                let phi = quadrant_azimuth(v, ((nx + T::one()) / (ny + T::one())).sqrt());
                let exponent = nx * phi.cos().squared() + ny * phi.sin().squared();
                mirror(wo, from_cos_phi((T::one() - u).powf(T::one() / (exponent + T::one())), phi))
            }
            Self::Rational { r, p } => {
                // cos²δ = ξ/(r − ξ r + ξ), ξ = 1 − u.
                let xi = T::one() - u;
                mirror(wo, from_cos_phi((xi / (r - xi * r + xi)).sqrt(), quadrant_azimuth(v, T::one() / p.sqrt())))
            }
            Self::VisibleGgx { alpha_x, alpha_y } => {
                let stretched = V3::new(alpha_x * wo.x, alpha_y * wo.y, wo.z).normalized();
                // A uniform point of the spherical cap; the half vector with it is visible.
                let bound = visible_cap(alpha_x, alpha_y, wo) * stretched.z;
                let point = from_cos_phi((T::one() - u) * (T::one() + bound) - bound, two_pi * v);
                let h = point + stretched;
                mirror(wo, V3::new(alpha_x * h.x, alpha_y * h.y, h.z.max(T::of(1e-18))).normalized())
            }
            Self::LongTail { mx, my } => {
                let phi = quadrant_azimuth(v, my / mx);
                let (c2, s2) = (phi.cos().squared(), phi.sin().squared());
                mirror(wo, from_tan2_phi(u / (T::one() - u) / (c2 / mx.squared() + s2 / my.squared()), phi))
            }
            Self::SchlickSlopes { mx, my } => {
                // cos⁴δ = (1 − u)/(1 + u (2m² − 1)); tan²δ = (1 − cos⁴δ)/(cos²δ (1 + cos²δ)), in which nothing cancels.
                let phi = quadrant_azimuth(v, my / mx);
                let twice_m2 = T::of(2.0) / (phi.cos().squared() / mx.squared() + phi.sin().squared() / my.squared());
                let rest = T::one() / (T::one() + u * (twice_m2 - T::one()));
                let cos2 = ((T::one() - u) * rest).sqrt().max(T::of(1e-12));
                mirror(wo, from_tan2_phi(u * twice_m2 * rest / (cos2 * (T::one() + cos2)), phi))
            }
            Self::Diffracted { width } => {
                let (radius, phi) = (width * (-(T::one() - u).ln()).sqrt(), two_pi * v);
                let (x, y) = (radius * phi.cos() - wo.x, radius * phi.sin() - wo.y);
                let cos2 = T::one() - x.squared() - y.squared();
                (cos2 > T::zero()).then(|| V3::new(x, y, cos2.max(T::zero()).sqrt()))
            }
        }
    }

    /// The density of [`Lobe::sample`] at `wi`, 1/sr, over the whole sphere.
    pub fn pdf(&self, wi: V3<T>, wo: V3<T>) -> T {
        let inverse_pi = T::of(1.0 / PI);
        match *self {
            Self::Cosine => wi.z.max(T::zero()) * inverse_pi,
            Self::Power { axis, n } => {
                (n + T::one())
                    * T::of(0.5 / PI)
                    * axis.dot(wi).max(T::zero()).powf(n)
                    * T::select(axis.dot(wi) > T::zero(), T::one(), T::zero())
            }
            Self::Gauss { mx, my } => half_vector_pdf(wi, wo, |h| {
                // At the horizon the exponential is 0 and what it is divided by underflows.
                if h.z < T::of(1e-6) {
                    return T::zero();
                }
                let exponent = -((h.x / mx).squared() + (h.y / my).squared()) / h.z.squared();
                exponent.exp() * inverse_pi / (mx * my * h.z * h.z * h.z)
            }),
            Self::GaussChord { mx, my } => half_vector_pdf(wi, wo, |h| {
                let (x2, y2) = ((h.x / mx).squared(), (h.y / my).squared());
                let sin2 = h.x.squared() + h.y.squared();
                let exponent = -T::of(2.0) * (x2 + y2) / (T::one() + h.z);
                // Along the normal every azimuth is valid.
                let k = if sin2 > T::zero() { (x2 + y2) / sin2 } else { T::one() / mx.squared() };
                let below = T::one() - (-T::of(2.0) * k).exp();
                exponent.exp() * inverse_pi / (mx * my * below)
            }),
            Self::HalfPower { nx, ny } => half_vector_pdf(wi, wo, |h| {
                let sin2 = h.x.squared() + h.y.squared();
                let exponent = if sin2 > T::zero() { (nx * h.x.squared() + ny * h.y.squared()) / sin2 } else { T::zero() };
                ((nx + T::one()) * (ny + T::one())).sqrt() * T::of(0.5 / PI) * h.z.powf(exponent)
            }),
            Self::Rational { r, p } => half_vector_pdf(wi, wo, |h| {
                let (x2, y2) = (h.x.squared(), h.y.squared());
                let azimuth = T::select(x2 + y2 > T::zero(), p.sqrt() * (x2 + y2) / (x2 + p * y2).max(T::of(1e-37)), T::one());
                h.z * r * inverse_pi * azimuth / (x2 + y2 + r * h.z.squared()).squared()
            }),
            Self::VisibleGgx { alpha_x, alpha_y } => half_vector_pdf(wi, wo, |h| {
                let spread = (h.x / alpha_x).squared() + (h.y / alpha_y).squared() + h.z.squared();
                let stretched = ((alpha_x * wo.x).squared() + (alpha_y * wo.y).squared() + wo.z.squared()).sqrt();
                let bound = visible_cap(alpha_x, alpha_y, wo) * wo.z;
                // Facets beyond the cap, which all reflect below the surface.
                let over_cap = T::of(2.0) * wo.dot(h) * h.z / spread - wo.z + bound;
                let scale =
                    if wi.z <= T::zero() && over_cap < T::zero() { T::zero() } else { T::of(2.0) * wo.dot(h) / (bound + stretched) };
                scale * inverse_pi / (alpha_x * alpha_y * spread.squared())
            }),
            Self::LongTail { mx, my } => half_vector_pdf(wi, wo, |h| {
                let e = (h.x / mx).squared() + (h.y / my).squared();
                h.z * inverse_pi / (mx * my * (h.z.squared() + e).squared())
            }),
            Self::SchlickSlopes { mx, my } => half_vector_pdf(wi, wo, |h| {
                let (e, c2) = ((h.x / mx).squared() + (h.y / my).squared(), h.z.squared());
                h.z * c2 * inverse_pi / (mx * my * (c2.squared() + T::of(0.5) * e * (T::one() + c2)).squared())
            }),
            Self::Diffracted { width } => {
                let exponent = ((wi.x + wo.x).squared() + (wi.y + wo.y).squared()) / width.squared();
                (-exponent).exp() * wi.z.max(T::zero()) * inverse_pi / width.squared()
            }
        }
    }
}

/// Factor by which the cap of visible normals shrinks when only reflections above the surface count: (1 − a²)s²/(s² + a²z²), a the smaller width,
/// s = 1 + √(1 − z²), z = wo.z.    \[Eto23]
#[inline]
fn visible_cap<T: Scalar>(alpha_x: T, alpha_y: T, wo: V3<T>) -> T {
    let a2 = alpha_x.min(alpha_y).squared();
    let s2 = (T::one() + (wo.x.squared() + wo.y.squared()).sqrt()).squared();
    (T::one() - a2) * s2 / (s2 + a2 * wo.z.squared())
}

/// The density of a direction whose half vector has density `pdf_h` on the upper hemisphere.
#[inline]
fn half_vector_pdf<T: Scalar>(wi: V3<T>, wo: V3<T>, pdf_h: impl Fn(V3<T>) -> T) -> T {
    let sum = wi + wo;
    let length2 = sum.dot(sum);
    if length2 <= T::zero() {
        return T::zero();
    }
    let h = sum * (T::one() / length2.sqrt());
    let cos_beta = h.dot(wo);
    // A half vector on the other side of the viewer is not sampled.
    if h.z <= T::zero() || cos_beta <= T::zero() {
        return T::zero();
    }
    pdf_h(h) / (T::of(4.0) * cos_beta)
}

/// The mirror direction of `wo` about `h`; `None` if `h` faces away.
#[inline]
fn mirror<T: Scalar>(wo: V3<T>, h: V3<T>) -> Option<V3<T>> {
    let cos_beta = wo.dot(h);
    (cos_beta > T::zero()).then(|| h * (T::of(2.0) * cos_beta) - wo)
}

#[inline]
fn from_cos_phi<T: Real>(cos: T, phi: T) -> V3<T> {
    let sin = (T::one() - cos * cos).max(T::zero()).sqrt();
    V3::new(phi.cos() * sin, phi.sin() * sin, cos)
}

/// As [`from_cos_phi`], without cancellation for small angles.
#[inline]
fn from_tan2_phi<T: Real>(tan2: T, phi: T) -> V3<T> {
    let cos = T::one() / (T::one() + tan2).sqrt();
    let sin = tan2.sqrt() * cos;
    V3::new(phi.cos() * sin, phi.sin() * sin, cos)
}

/// atan(ratio · tan 2πv), kept in the quadrant of 2πv.
#[inline]
fn quadrant_azimuth<T: Scalar>(v: T, ratio: T) -> T {
    let turn = T::of(TAU) * v;
    (ratio * turn.sin()).atan2(turn.cos())
}

/// `local` about +z, turned so that +z becomes `axis`.    \[Duff17] listing 3
#[inline]
pub(super) fn to_frame<T: Scalar>(axis: V3<T>, local: V3<T>) -> V3<T> {
    let sign = if axis.z < T::zero() { -T::one() } else { T::one() };
    let a = -T::one() / (sign + axis.z);
    let b = axis.x * axis.y * a;
    let x = V3::new(T::one() + sign * axis.x.squared() * a, sign * b, -sign * axis.x);
    let y = V3::new(b, sign + axis.y.squared() * a, -axis.y);
    x * local.x + y * local.y + axis * local.z
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOBES: [Lobe<f64>; 18] = [
        Lobe::Cosine,
        Lobe::Power { axis: V3 { x: 0.6, y: 0.0, z: 0.8 }, n: 0.0 },
        Lobe::Power { axis: V3 { x: 0.6, y: 0.0, z: 0.8 }, n: 30.0 },
        Lobe::Gauss { mx: 0.1, my: 0.4 },
        Lobe::Gauss { mx: 0.5, my: 0.5 },
        Lobe::HalfPower { nx: 10.0, ny: 100.0 },
        Lobe::GaussChord { mx: 0.1, my: 0.4 },
        Lobe::GaussChord { mx: 1.5, my: 0.8 },
        Lobe::Rational { r: 0.4, p: 1.0 },
        Lobe::Rational { r: 0.05, p: 1.0 },
        Lobe::Rational { r: 0.1, p: 0.3 },
        Lobe::VisibleGgx { alpha_x: 0.1, alpha_y: 0.5 },
        Lobe::VisibleGgx { alpha_x: 1.0, alpha_y: 1.0 },
        Lobe::LongTail { mx: 0.1, my: 0.3 },
        Lobe::SchlickSlopes { mx: 0.2, my: 0.2 },
        Lobe::SchlickSlopes { mx: 0.15, my: 0.5 },
        Lobe::Diffracted { width: 0.1 },
        Lobe::Diffracted { width: 0.6 },
    ];

    /// Sorts samples and the integral of the density into the same cells and returns the worst deviation in standard deviations.
    fn worst_cell(lobe: Lobe<f64>, density: impl Fn(V3<f64>, V3<f64>) -> f64) -> f64 {
        let wo = V3::from_angles(0.6, 0.3);
        let (rows, columns, side) = (16, 24, 512);
        let mut counts = vec![0.0; rows * columns];
        let samples = side * side;
        for i in 0..samples {
            let u = [(f64::from(i % side) + 0.5) / f64::from(side), (f64::from(i / side) + 0.5) / f64::from(side)];
            if let Some(wi) = lobe.sample(wo, u) {
                let row = ((1.0 - wi.z) / 2.0 * rows as f64).min(rows as f64 - 1.0) as usize;
                let column = ((wi.y.atan2(wi.x) / TAU).rem_euclid(1.0) * columns as f64).min(columns as f64 - 1.0) as usize;
                counts[row * columns + column] += 1.0;
            }
        }
        let fine = 40_usize;
        let cell = 4.0 * PI / (rows * columns * fine * fine) as f64;
        let mut worst: f64 = 0.0;
        for row in 0..rows {
            for column in 0..columns {
                let mut mass = 0.0;
                for k in 0..fine * fine {
                    let z = 1.0 - 2.0 * (row as f64 + ((k / fine) as f64 + 0.5) / fine as f64) / rows as f64;
                    let phi = TAU * (column as f64 + ((k % fine) as f64 + 0.5) / fine as f64) / columns as f64;
                    mass += density(from_cos_phi(z, phi), wo) * cell;
                }
                let expected = mass * f64::from(samples);
                worst = worst.max((counts[row * columns + column] - expected).abs() / (expected.sqrt() + 12.0));
            }
        }
        worst
    }

    #[test]
    fn samples_follow_their_density() {
        for lobe in LOBES {
            let worst = worst_cell(lobe, |wi, wo| lobe.pdf(wi, wo));
            assert!(worst < 4.0, "{lobe:?}: {worst} deviations");
        }
    }

    #[test]
    fn a_wrong_density_is_noticed() {
        let narrow = Lobe::Gauss { mx: 0.1, my: 0.4 };
        let wide = Lobe::Gauss { mx: 0.11, my: 0.4 };
        assert!(worst_cell(narrow, |wi, wo| wide.pdf(wi, wo)) > 4.0);
        let cosine = Lobe::Rational { r: 0.4, p: 1.0 };
        assert!(worst_cell(cosine, |wi, wo| 1.2 * cosine.pdf(wi, wo)) > 4.0);
    }
}
