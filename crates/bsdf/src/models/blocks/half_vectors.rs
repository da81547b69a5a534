//! Half vectors drawn from a table, for models of measurements: what an isotropic model reflects, tabulated over the half vector for each
//! inclination of the viewer.
//!
//! ```text
//! p_h(h | θ_o) ∝ f cos θ_i · 4 (h·o)          constant in cells of (θ_h, φ_h − φ_o), θ_h = (k/n)² π/2
//! p(ω_i) = (1 − c) p_h(h)/(4 (h·o)) + c cos θ_i/π                                                      [Walter07] eq. 14
//! ```
//!
//! Between two tabulated inclinations one of the two rows is chosen at random, so that the density is their mean with the same weights: exact, whatever
//! the table holds.

use crate::models::{Lobe, V3};
use glam::DVec3;
use std::array;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Inclinations of the viewer, from the normal to the horizon.
const VIEWS: usize = 31;
/// Cells from the normal to the horizon, the finer the nearer to the normal.
const INCLINATIONS: usize = 90;
/// Cells around the normal.
const AZIMUTHS: usize = 24;
/// Evaluations along each side of a cell.
const SUBDIVISION: usize = 2;
/// c: the share of samples by the cosine, which reaches every direction that the table has for black.
const COSINE_SHARE: f64 = 0.1;

/// Cumulative probabilities of one inclination of the viewer.
#[derive(Clone, Debug)]
struct Row {
    inclination: [f64; INCLINATIONS + 1],
    /// Given the inclination.
    azimuth: Vec<[f64; AZIMUTHS + 1]>,
}

/// Samples directions to the light by tabulated half vectors and by the cosine.
#[derive(Clone, Debug)]
pub struct HalfVectors {
    rows: Vec<Row>,
}

impl HalfVectors {
    /// Tabulates `f_cos`, which is given wi and wo, both above the surface, and does not change when both turn about the normal.
    pub fn new(f_cos: impl Fn(DVec3, DVec3) -> f64) -> Self {
        Self { rows: (0..VIEWS).map(|view| Row::new(view, &f_cos)).collect() }
    }

    /// A direction to the light for three random numbers in [0, 1); `None` below the horizon.
    pub fn sample(&self, wo: DVec3, [choice, u, v]: [f64; 3]) -> Option<DVec3> {
        if choice < COSINE_SHARE {
            return Lobe::Cosine.sample(V3::from(wo), [u, v]).map(DVec3::from).filter(|wi| wi.z > 0.0);
        }
        let (row, t) = place(wo);
        let farther = (choice - COSINE_SHARE) / (1.0 - COSINE_SHARE) < t;
        let row = &self.rows[row + usize::from(farther)];
        let (k, along) = draw(&row.inclination, u);
        let (j, around) = draw(&row.azimuth[k], v);
        let h = half_vector(k, along, j, around, to_azimuth(wo));
        let cos_beta = h.dot(wo);
        (cos_beta > 0.0).then(|| 2.0 * cos_beta * h - wo).filter(|wi| wi.z > 0.0)
    }

    /// The density of [`HalfVectors::sample`], 1/sr; 0 unless both directions are above the surface.
    pub fn pdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return 0.0;
        }
        let h = (wi + wo).normalize();
        let [cos_o, sin_o] = to_azimuth(wo);
        let theta = h.truncate().length().atan2(h.z);
        let phi = (h.y * cos_o - h.x * sin_o).atan2(h.x * cos_o + h.y * sin_o).rem_euclid(TAU);
        let k = (((theta / FRAC_PI_2).sqrt() * INCLINATIONS as f64) as usize).min(INCLINATIONS - 1);
        let j = ((phi / TAU * AZIMUTHS as f64) as usize).min(AZIMUTHS - 1);
        let (row, t) = place(wo);
        let mass = (1.0 - t) * self.rows[row].mass(k, j) + t * self.rows[row + 1].mass(k, j);
        (1.0 - COSINE_SHARE) * mass / (solid_angle(k) * 4.0 * h.dot(wo)) + COSINE_SHARE * Lobe::Cosine.pdf(V3::from(wi), V3::from(wo))
    }
}

impl Row {
    fn new(view: usize, f_cos: &impl Fn(DVec3, DVec3) -> f64) -> Self {
        // The last row is seen from just above the horizon, where there is still something to see.
        let theta = FRAC_PI_2 * (view as f64 / (VIEWS - 1) as f64).min(0.998);
        let wo = DVec3::new(theta.sin(), 0.0, theta.cos());
        let middle = |i: usize| (i as f64 + 0.5) / SUBDIVISION as f64;
        let weight = |k: usize, j: usize| -> f64 {
            let seen = |i: usize| {
                let h = half_vector(k, middle(i / SUBDIVISION), j, middle(i % SUBDIVISION), [1.0, 0.0]);
                let cos_beta = h.dot(wo);
                let wi = 2.0 * cos_beta * h - wo;
                if cos_beta > 0.0 && wi.z > 0.0 { f_cos(wi, wo) * cos_beta } else { 0.0 }
            };
            (0..SUBDIVISION * SUBDIVISION).map(seen).sum::<f64>() * solid_angle(k)
        };
        let weights: Vec<[f64; AZIMUTHS]> = (0..INCLINATIONS).map(|k| array::from_fn(|j| weight(k, j))).collect();
        let sums: [f64; INCLINATIONS] = array::from_fn(|k| weights[k].iter().sum());
        Self { inclination: cumulative(&sums), azimuth: weights.iter().map(cumulative).collect() }
    }

    /// Probability of a cell.
    fn mass(&self, k: usize, j: usize) -> f64 {
        (self.inclination[k + 1] - self.inclination[k]) * (self.azimuth[k][j + 1] - self.azimuth[k][j])
    }
}

/// Cumulative sums that end at 1; of nothing but zeros, even steps.
fn cumulative<const N: usize, const M: usize>(weights: &[f64; N]) -> [f64; M] {
    let total: f64 = weights.iter().sum();
    let mut sum = 0.0;
    let mut out = [0.0; M];
    for (i, weight) in weights.iter().enumerate() {
        sum += if total > 0.0 { weight / total } else { 1.0 / N as f64 };
        out[i + 1] = sum;
    }
    // Rounding; empty cells at the end stay empty.
    out.map(|c| (c / sum).min(1.0))
}

/// The cell of a random number, and the rest of it in [0, 1).
fn draw(cumulative: &[f64], u: f64) -> (usize, f64) {
    let cell = cumulative.partition_point(|&c| c <= u).clamp(1, cumulative.len() - 1) - 1;
    let (low, high) = (cumulative[cell], cumulative[cell + 1]);
    (cell, if high > low { ((u - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 })
}

/// The row below the viewer's inclination, and how far it is to the next.
fn place(wo: DVec3) -> (usize, f64) {
    let at = wo.truncate().length().atan2(wo.z) / FRAC_PI_2 * (VIEWS - 1) as f64;
    let row = (at as usize).min(VIEWS - 2);
    (row, (at - row as f64).clamp(0.0, 1.0))
}

/// Cosine and sine of the azimuth.
fn to_azimuth(w: DVec3) -> [f64; 2] {
    let length = w.truncate().length();
    if length > 0.0 { [w.x / length, w.y / length] } else { [1.0, 0.0] }
}

/// sin²(θ/2) at the lower edge of an inclination's cell: half the solid angle up to there, over 2π.
fn edge(k: usize) -> f64 {
    let share = k as f64 / INCLINATIONS as f64;
    (0.5 * FRAC_PI_2 * share * share).sin().powi(2)
}

/// Of each of the cells at an inclination, sr.
fn solid_angle(k: usize) -> f64 {
    2.0 * (edge(k + 1) - edge(k)) * TAU / AZIMUTHS as f64
}

/// The half vector at a place within a cell, uniform over its solid angle, with the azimuth counted from that of `turn` (cosine, sine).
fn half_vector(k: usize, along: f64, j: usize, around: f64, [cos_o, sin_o]: [f64; 2]) -> DVec3 {
    let s = edge(k) + along * (edge(k + 1) - edge(k));
    let sin = 2.0 * (s * (1.0 - s)).sqrt();
    let (sin_phi, cos_phi) = ((j as f64 + around) / AZIMUTHS as f64 * TAU).sin_cos();
    DVec3::new(sin * (cos_phi * cos_o - sin_phi * sin_o), sin * (sin_phi * cos_o + cos_phi * sin_o), 1.0 - 2.0 * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{Hemisphere, testing::model};

    #[test]
    fn cells_fill_the_hemisphere() {
        let total: f64 = (0..INCLINATIONS).map(|k| AZIMUTHS as f64 * solid_angle(k)).sum();
        assert!((total - TAU).abs() < 1e-12, "{total}");
    }

    #[test]
    fn the_density_is_nearly_what_is_reflected() {
        let ward = model("ward", &[("kd", "0.2"), ("ks", "0.6"), ("m", "0.2")], Default::default());
        let table = HalfVectors::new(|wi, wo| ward.f_cos(wi, wo).x);
        let wo = DVec3::from(V3::from_angles(0.71, 2.0));
        let nodes = Hemisphere::new(200, 400);
        let albedo = nodes.integrate(|wi| ward.f_cos(wi, wo).x);
        let second = nodes.integrate(|wi| ward.f_cos(wi, wo).x.powi(2) / table.pdf(wi, wo));
        let deviation = (second - albedo * albedo).sqrt() / albedo;
        assert!(deviation < 0.35, "standard deviation of a sample's weight {deviation}");
        let cosine = nodes.integrate(|wi| ward.f_cos(wi, wo).x.powi(2) / Lobe::Cosine.pdf(V3::from(wi), V3::from(wo)));
        assert!((cosine - albedo * albedo).sqrt() / albedo > 1.0, "by the cosine alone the weights spread more");
    }

    #[test]
    fn nothing_but_black_is_sampled_all_the_same() {
        let table = HalfVectors::new(|_, _| 0.0);
        let wo = DVec3::new(0.6, 0.0, 0.8);
        assert!(table.pdf(DVec3::Z, wo) > 0.0 && table.sample(wo, [0.5, 0.01, 0.5]).is_some());
    }
}
