//! Value, samples and density of a sum of separable terms.
//!
//! ```text
//! p(ω_i) = (Σ_c k_d,c cos θ_i/π + Σ_l |w_l|₁ û_l(θ_h) v̂_l(φ_h)/(4 (h·o))) / (Σ_c k_d,c + Σ_l |w_l|₁ U_l V_l)
//! ```
//!
//! |w|₁ sums absolute values over colours, û and v̂ bound |u| and |v| ([`Profile`]), U and V are their integrals. The density is the exact one of what is
//! drawn; terms may be negative and then only make it larger than f cos θ_i, so weights f cos θ_i/p never exceed the denominator.

use super::grid::{Grid, Viewer};
use super::profile::{Profile, locate};
use crate::models::{Kind, Lobe, Reflectance, V3};
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_1_PI, TAU};

/// Cosines are not taken smaller where Q is divided by them: a table knows f cos θ_i at grazing angles to its own error only, and f = error/cos θ_i
/// would grow without limit there.
pub const LEAST_COSINE: f64 = 0.02;

/// f is not larger: products of absurd numbers of a file stay finite in f32.
const MOST: f64 = 1e30;

/// How the terms weigh for a viewer.
pub trait ViewWeights: Send + Sync + 'static {
    /// w_l(ω_o) in each colour, of any sign.
    fn weight(&self, term: usize, viewer: &Viewer) -> DVec3;
}

/// A factored BRDF, ready to evaluate and to sample.
#[derive(Clone, Debug)]
pub struct Factored<W> {
    grid: Grid,
    /// k_d.
    diffuse: DVec3,
    weights: W,
    /// Which u and v make a term.
    terms: Vec<(usize, usize)>,
    inclinations: Vec<Profile>,
    azimuths: Vec<Profile>,
    sigma: Vec<f64>,
}

impl<W: ViewWeights> Factored<W> {
    /// Of the terms' functions at the nodes of `grid`, those of φ_h without the repeated first value.
    pub fn new(grid: Grid, diffuse: DVec3, weights: W, terms: Vec<(usize, usize)>, inclinations: &[f32], azimuths: &[f32]) -> Self {
        let sigma = grid.sigma();
        let phi: Vec<f64> = (0..=grid.phi_h).map(|j| j as f64 / grid.phi_h as f64 * TAU).collect();
        let along = |u: &[f32]| Profile::new(u.iter().map(|&v| f64::from(v)).collect(), &sigma);
        let around = |v: &[f32]| Profile::new(v.iter().chain(&v[..1]).map(|&v| f64::from(v)).collect(), &phi);
        let inclinations = inclinations.chunks_exact(grid.theta_h).map(along).collect();
        let azimuths = azimuths.chunks_exact(grid.phi_h).map(around).collect();
        Self { grid, diffuse, weights, terms, inclinations, azimuths, sigma }
    }

    /// The places of a half vector among the nodes of θ_h and φ_h.
    fn place(&self, h: DVec3, viewer: &Viewer) -> [(usize, f64); 2] {
        let (sigma, phi) = Grid::coordinates(h, viewer.zero);
        let at = phi / TAU * self.grid.phi_h as f64;
        let j = (at as usize).min(self.grid.phi_h - 1);
        [locate(&self.sigma, sigma), (j, (at - j as f64).clamp(0.0, 1.0))]
    }

    /// Σ |w|₁ û v̂ at a place, and its integral over all half vectors.
    fn density(&self, [(k, t), (j, s)]: [(usize, f64); 2], viewer: &Viewer) -> (f64, f64) {
        self.terms.iter().enumerate().fold((0.0, 0.0), |(here, all), (term, &(u, v))| {
            let weight = strength(self.weights.weight(term, viewer));
            let (u, v) = (&self.inclinations[u], &self.azimuths[v]);
            (here + weight * u.bound(k, t) * v.bound(j, s), all + weight * u.total() * v.total())
        })
    }

    fn draw(&self, wo: DVec3, [choice, x, y]: [f64; 3]) -> Option<DVec3> {
        let viewer = self.grid.place(wo);
        let area = |term: usize, (u, v): (usize, usize)| {
            strength(self.weights.weight(term, &viewer)) * self.inclinations[u].total() * self.azimuths[v].total()
        };
        let diffuse = self.diffuse.element_sum();
        let all = self.terms.iter().enumerate().fold(diffuse, |sum, (term, &pair)| sum + area(term, pair));
        let mut rest = choice * all - diffuse;
        if rest < 0.0 || all <= 0.0 {
            return Lobe::Cosine.sample(V3::from(wo), [x, y]).map(DVec3::from).filter(|wi| wi.z > 0.0);
        }
        let mut chosen = None;
        for (term, &pair) in self.terms.iter().enumerate() {
            let area = area(term, pair);
            // Rounding may leave a little after the last term that is not empty.
            chosen = if area > 0.0 { Some(pair) } else { chosen };
            rest -= area;
            if rest < 0.0 {
                break;
            }
        }
        let (u, v) = chosen?;
        let ((k, t), (j, s)) = (self.inclinations[u].sample(x), self.azimuths[v].sample(y));
        let sigma = self.sigma[k] + t * (self.sigma[k + 1] - self.sigma[k]);
        let h = Grid::half_vector(sigma, (j as f64 + s) / self.grid.phi_h as f64 * TAU, viewer.zero);
        let cos_beta = h.dot(wo);
        (cos_beta > 0.0).then(|| (2.0 * cos_beta * h - wo).normalize()).filter(|wi| wi.z > 0.0)
    }
}

fn strength(weight: DVec3) -> f64 {
    weight.abs().element_sum()
}

impl<W: ViewWeights> Reflectance for Factored<W> {
    fn kind(&self) -> Kind {
        Kind::Brdf
    }

    fn value(&self, wi: DVec3, wo: DVec3) -> DVec3 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return DVec3::ZERO;
        }
        let h = (wi + wo).normalize();
        let viewer = self.grid.place(wo);
        let [(k, t), (j, s)] = self.place(h, &viewer);
        let q = self.terms.iter().enumerate().fold(DVec3::ZERO, |sum, (term, &(u, v))| {
            sum + self.weights.weight(term, &viewer) * (self.inclinations[u].value(k, t) * self.azimuths[v].value(j, s))
        });
        let cosines = 4.0 * h.dot(wo).max(LEAST_COSINE) * wi.z.max(LEAST_COSINE);
        (self.diffuse * FRAC_1_PI + q / cosines).clamp(DVec3::ZERO, DVec3::splat(MOST))
    }

    fn value_f32(&self, wi: Vec3, wo: Vec3) -> Vec3 {
        self.value(wi.as_dvec3(), wo.as_dvec3()).as_vec3()
    }

    fn sample(&self, wo: DVec3, u: [f64; 3]) -> Option<DVec3> {
        if wo.z > 0.0 { self.draw(wo, u) } else { None }
    }

    fn sample_f32(&self, wo: Vec3, u: [f32; 3]) -> Option<Vec3> {
        self.sample(wo.as_dvec3(), u.map(f64::from)).map(|wi| wi.as_vec3())
    }

    fn pdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return 0.0;
        }
        let h = (wi + wo).normalize();
        let viewer = self.grid.place(wo);
        let (here, all) = self.density(self.place(h, &viewer), &viewer);
        let cosine = Lobe::Cosine.pdf(V3::from(wi), V3::from(wo));
        let diffuse = self.diffuse.element_sum();
        if diffuse + all <= 0.0 {
            return cosine;
        }
        (diffuse * cosine + here / (4.0 * h.dot(wo))) / (diffuse + all)
    }

    fn pdf_f32(&self, wi: Vec3, wo: Vec3) -> f32 {
        self.pdf(wi.as_dvec3(), wo.as_dvec3()) as f32
    }

    fn mirror(&self, _wo: DVec3) -> DVec3 {
        DVec3::ZERO
    }

    fn ambient(&self) -> DVec3 {
        DVec3::ZERO
    }

    fn constants(&self) -> Vec<f32> {
        Vec::new()
    }
}
