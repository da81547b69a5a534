//! A BRDF at the nodes of a grid, and how far factors are from it.

use super::FactorError;
use glam::DVec3;
use kajo_bsdf::models::factored::Grid;
use kajo_bsdf::models::{Kind, Reflectance};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Directions farther from the normal do not count when the constant part is looked for: there measurements are poor and formulas fall to 0.
const STEEPEST_COS: f64 = 0.26;
/// The share of values that may be below the constant part.
const BELOW_DIFFUSE: f64 = 0.01;
/// Relative errors are of values not smaller than this share of the mean.
const FAINTEST: f64 = 0.01;

/// Q = (f − k_d/π) cos θ_i 4 (h·o) at the nodes of a grid; see `kajo_bsdf::models::factored`.
#[derive(Clone, Debug)]
pub struct Table {
    /// The nodes.
    pub grid: Grid,
    /// k_d of each channel.
    pub diffuse: Vec<f64>,
    /// Q by channel, viewer (θ_o, then φ_o), θ_h and φ_h, which is the fastest; 0 where the light would be below the surface.
    pub values: Vec<f32>,
}

/// What factors miss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// What the method makes small, relative to what it is without any terms.
    pub residual: f64,
    /// Root of ∫∫ (Δf cos θ_i)² dω_i cos θ_o dω_o, relative to the same of f.
    pub cos_rms: f64,
    /// Root of the mean of (Δf/f)² over cos θ_i dω_i cos θ_o dω_o, f not below 1 % of its mean.
    pub relative_rms: f64,
}

/// A pair of directions among the nodes.
struct Node {
    /// cos θ_i · 4 (h·o): Q of f = 1.
    cosines: f64,
    /// dω_h cos θ_o dω_o.
    measure: f64,
}

impl Table {
    /// Measures a model. Greys, and models that do not change when light and viewer turn about the normal together, get fewer nodes.
    ///
    /// # Errors
    /// A model that is black, infinite or in part a perfect mirror.
    pub fn of_model(model: &dyn Reflectance) -> Result<Self, FactorError> {
        let mut rng = kajo_sampling::Rng::new(6);
        let mut grid = Grid::ISOTROPIC;
        let mut grey = true;
        for _ in 0..64 {
            let [wi, wo] = std::array::from_fn(|_| crate::checks::random_direction(&mut rng));
            let share = model.mirror(wo).max_element();
            if share > 1e-3 {
                return Err(FactorError::Mirror { share });
            }
            let f = model.rendered_f_cos(wi.as_vec3(), wo.as_vec3()).as_dvec3();
            grey &= f.max_element() - f.min_element() <= 1e-6 * f.max_element();
            for turn in [0.7, 2.0, 4.4] {
                let turned = [wi, wo].map(|w| DVec3::from((w.truncate().rotate(glam::DVec2::from_angle(turn)), w.z)));
                let other = model.rendered_f_cos(turned[0].as_vec3(), turned[1].as_vec3()).as_dvec3();
                if (f - other).abs().max_element() > 0.01 * f.max_element().max(1e-6) {
                    grid = Grid::ANISOTROPIC;
                }
            }
        }
        Self::with_grid(model, Grid { channels: if grey { 1 } else { 3 }, ..grid })
    }

    /// Measures a model at the nodes of a grid.
    ///
    /// # Errors
    /// A model that is black or infinite.
    pub fn with_grid(model: &dyn Reflectance, grid: Grid) -> Result<Self, FactorError> {
        let rows: Vec<Vec<DVec3>> = (0..grid.viewers()).into_par_iter().map(|viewer| row(model, grid, viewer)).collect();
        for (viewer, row) in rows.iter().enumerate() {
            if let Some(bad) = row.iter().find(|v| !v.is_finite()) {
                let theta = grid.viewer(viewer).z.acos().to_degrees();
                return Err(FactorError::NotFinite { value: bad.element_sum(), theta });
            }
        }
        if rows.iter().flatten().all(|v| v.max_element() <= 0.0) {
            return Err(FactorError::Black);
        }
        let diffuse: Vec<f64> = (0..grid.channels).map(|channel| PI * constant_part(grid, &rows, channel)).collect();
        let mut values = Vec::with_capacity(grid.numbers());
        for (channel, diffuse) in diffuse.iter().enumerate() {
            for (viewer, row) in rows.iter().enumerate() {
                values.extend(nodes_of(grid, viewer).zip(row).map(|(node, q)| (q[channel] - diffuse * FRAC_1_PI * node.cosines) as f32));
            }
        }
        Ok(Self { grid, diffuse, values })
    }

    /// How far `found`, laid out as [`Table::values`], is from them.
    pub fn errors(&self, found: &[f32], residual: f64) -> Errors {
        let measured = self.values.par_chunks(self.grid.half_vectors()).zip(found.par_chunks(self.grid.half_vectors())).enumerate();
        let mean = |part: &dyn Fn(f64, &Node) -> f64| {
            let mut sums = [0.0; 2];
            for (i, row) in self.values.chunks(self.grid.half_vectors()).enumerate() {
                let constant = self.diffuse[i / self.grid.viewers()] * FRAC_1_PI;
                for (node, q) in nodes_of(self.grid, i % self.grid.viewers()).zip(row).filter(|(node, _)| node.cosines > 0.0) {
                    sums[0] += part(f64::from(*q) / node.cosines + constant, &node);
                    sums[1] += node.cosines * node.measure;
                }
            }
            sums[0] / sums[1]
        };
        let faintest = FAINTEST * mean(&|f, node| f * node.cosines * node.measure);
        let sums: Vec<[f64; 4]> = measured
            .map(|(i, (values, found))| {
                let constant = self.diffuse[i / self.grid.viewers()] * FRAC_1_PI;
                let mut sums = [0.0; 4];
                for ((node, q), found) in nodes_of(self.grid, i % self.grid.viewers()).zip(values).zip(found) {
                    if node.cosines <= 0.0 {
                        continue;
                    }
                    let f = f64::from(*q) / node.cosines + constant;
                    let off = (f64::from(*found) / node.cosines + constant).max(0.0) - f;
                    // (f cos θ_i)² dω_i = (f · cosines)²/(4 (h·o))² · 4 (h·o) dω_h, and cosines/(4 (h·o)) is cos θ_i.
                    let energy = node.cosines * node.measure * node.cosines;
                    sums[0] += off * off * energy;
                    sums[1] += f * f * energy;
                    sums[2] += (off / f.max(faintest)).powi(2) * node.cosines * node.measure;
                    sums[3] += node.cosines * node.measure;
                }
                sums
            })
            .collect();
        let total = |k: usize| sums.iter().map(|s| s[k]).sum::<f64>();
        Errors { residual, cos_rms: (total(0) / total(1)).sqrt(), relative_rms: (total(2) / total(3)).sqrt() }
    }
}

/// f cos θ_i 4 (h·o) of a viewer.
fn row(model: &dyn Reflectance, grid: Grid, viewer: usize) -> Vec<DVec3> {
    let wo = grid.viewer(viewer);
    let scale = match model.kind() {
        Kind::Brdf => 1.0,
        Kind::Bsf => FRAC_1_PI,
    };
    lights(grid, viewer)
        .map(|(wi, cos_beta)| if cos_beta > 0.0 && wi.z > 0.0 { model.f_cos(wi, wo) * (scale * 4.0 * cos_beta) } else { DVec3::ZERO })
        .collect()
}

/// Directions to the light at the nodes of the half vector, and h·o.
fn lights(grid: Grid, viewer: usize) -> impl Iterator<Item = (DVec3, f64)> {
    let wo = grid.viewer(viewer);
    let zero = grid.place(wo).zero;
    grid.sigma().into_iter().flat_map(move |sigma| {
        (0..grid.phi_h).map(move |j| {
            let h = Grid::half_vector(sigma, j as f64 / grid.phi_h as f64 * TAU, zero);
            let cos_beta = h.dot(wo);
            (2.0 * cos_beta * h - wo, cos_beta)
        })
    })
}

/// The nodes of the half vector for a viewer.
fn nodes_of(grid: Grid, viewer: usize) -> impl Iterator<Item = Node> {
    let sigma = grid.sigma();
    let wo = grid.viewer(viewer);
    // cos θ_o dω_o: nodes of θ_o are equidistant.
    let seen = wo.z * (1.0 - wo.z * wo.z).sqrt();
    lights(grid, viewer).enumerate().map(move |(i, (wi, cos_beta))| {
        let k = i / grid.phi_h;
        let width = 0.5 * (sigma[(k + 1).min(grid.theta_h - 1)] - sigma[k.saturating_sub(1)]);
        let above = cos_beta > 0.0 && wi.z > 0.0;
        Node { cosines: if above { wi.z * 4.0 * cos_beta } else { 0.0 }, measure: width * seen }
    })
}

/// The f that nearly all values of a channel are not below.
fn constant_part(grid: Grid, rows: &[Vec<DVec3>], channel: usize) -> f64 {
    let mut values: Vec<f64> = Vec::new();
    for (viewer, row) in rows.iter().enumerate().filter(|(viewer, _)| grid.viewer(*viewer).z > STEEPEST_COS) {
        let lit = lights(grid, viewer).zip(row).filter(|((wi, _), _)| wi.z > STEEPEST_COS);
        values.extend(lit.map(|((wi, cos_beta), q)| q[channel] / (wi.z * 4.0 * cos_beta)));
    }
    values.sort_by(f64::total_cmp);
    values[(values.len() as f64 * BELOW_DIFFUSE) as usize]
}
