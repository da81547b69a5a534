//! Measures a model as the database's gonioreflectometer measures a material: facets from what returns to the light, then samples where they are seen.
//!
//! ```text
//! D(ω) ∝ σ(ω) f(ω, ω) cos θ,    σ(ω) = ∫ D(m) ⟨m·ω⟩ dω_m         by power iteration                  [Dupuy18] eqs. 8-13
//! s(x, y | ω_o) = f cos θ_i · 4 σ(ω_o)/D(h)
//! ```

use super::table::{Data, Symmetry, Table, normal, solid_angle, to_u, to_v};
use super::warp::{Blend, Patches, Warp};
use crate::models::{Kind, Reflectance};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Inclination beyond which nothing is measured, of π/2.
const LAST_INCLINATION: f64 = 0.99;
/// Of the largest D: facets where nothing returns to the light reflect elsewhere all the same.
const LEAST_NDF: f64 = 1e-4;
/// The iteration gains a digit or two a step.
const ITERATIONS: usize = 5;

/// How finely a model is tabulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Azimuths of the viewer over the part of a turn that [`Resolution::symmetry`] leaves; 1 for isotropic models.
    pub phi_i: usize,
    /// Inclinations of the viewer, at least 2.
    pub theta_i: usize,
    /// Nodes of D and of visible normals along the inclination and along the azimuth, at least 2 each.
    pub normals: [usize; 2],
    /// Samples along each side of the square, at least 2.
    pub samples: usize,
    /// What the model is known to have; half turns start at azimuth −π, as do quarters.
    pub symmetry: Symmetry,
}

impl Resolution {
    /// For isotropic models: more inclinations than in the files of the database (8), as nothing has to be measured.
    pub const ISOTROPIC: Self = Self { phi_i: 1, theta_i: 32, normals: [128, 64], samples: 48, symmetry: Symmetry::None };
    /// For anisotropic ones.
    pub const ANISOTROPIC: Self = Self { phi_i: 25, theta_i: 16, normals: [64, 64], samples: 32, symmetry: Symmetry::None };
}

impl Table {
    /// Measures a model; with one azimuth the viewer stands along the tangent x.
    ///
    /// # Panics
    /// For fewer nodes than [`Resolution`] asks for, or two azimuths.
    pub fn of_model(model: &dyn Reflectance, resolution: Resolution) -> Self {
        let Resolution { phi_i, theta_i, normals, samples, symmetry } = resolution;
        assert!(phi_i != 2 && phi_i > 0 && theta_i >= 2 && samples >= 2 && normals.iter().all(|n| *n >= 2), "{resolution:?}");
        let isotropic = phi_i == 1;
        let steps = |count: usize| (0..count).map(move |i| i as f64 / (count - 1).max(1) as f64);
        let part = TAU / symmetry.parts() as f64;
        let phi: Vec<f64> = steps(phi_i).map(|t| if isotropic { 0.0 } else { t * part - PI }).collect();
        let theta: Vec<f64> = steps(theta_i).map(|t| t * LAST_INCLINATION * FRAC_PI_2).collect();
        let (ndf, sigma) = facets(model, normals, isotropic);
        let viewers: Vec<[f64; 2]> = phi.iter().flat_map(|p| theta.iter().map(|t| [*p, *t])).collect();
        let vndf: Vec<f32> = viewers.iter().flat_map(|viewer| visible(&ndf, *viewer, normals, isotropic)).collect();
        let even = vec![0.0; viewers.len() * samples * samples];
        let mut table = Self::new(Data {
            phi_i: phi,
            theta_i: theta,
            ndf,
            sigma,
            vndf: Warp::new(normals, &vndf),
            luminance: Warp::new([samples; 2], &even),
            color: Patches::new([samples; 2], vec![[0.0; 3]; even.len()]),
            jacobian: true,
        })
        .expect("a known part of a turn");
        let mut colors = Vec::with_capacity(even.len());
        for (slice, [phi, theta]) in viewers.into_iter().enumerate() {
            let at = [to_u(theta), to_v(phi)];
            let wo = direction(theta, phi);
            for y in steps(samples) {
                for x in steps(samples) {
                    let half = table.data().vndf.sample(&Blend::one(slice), [x, y]);
                    let h = normal(half, if isotropic { phi } else { 0.0 });
                    let wi = 2.0 * h.dot(wo) * h - wo;
                    let scale = table.scale(at, half);
                    let lit = wi.z > 0.0 && scale > 0.0;
                    colors.push(if lit { (f_cos(model, wi, wo) / scale).as_vec3().to_array() } else { [0.0; 3] });
                }
            }
        }
        let light: Vec<f32> = colors.iter().map(|[r, g, b]| 0.2126 * r + 0.7152 * g + 0.0722 * b).collect();
        let data = Data { luminance: Warp::new([samples; 2], &light), color: Patches::new([samples; 2], colors), ..table.data().clone() };
        table = Self::new(data).expect("as before");
        table
    }
}

/// f cos θ_i, of shading functions as a renderer takes them.
fn f_cos(model: &dyn Reflectance, wi: DVec3, wo: DVec3) -> DVec3 {
    match model.kind() {
        Kind::Brdf => model.f_cos(wi, wo),
        Kind::Bsf => model.f_cos(wi, wo) / PI,
    }
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// D and σ over the square of normals. Of isotropic models one row stands for every azimuth.
fn facets(model: &dyn Reflectance, [columns, rows]: [usize; 2], isotropic: bool) -> (Patches<1>, Patches<1>) {
    let place = |column: usize, row: usize| [column as f64 / (columns - 1) as f64, row as f64 / (rows - 1) as f64];
    // The last row is the first again.
    let around = if isotropic { 1 } else { rows - 1 };
    let viewer = |i: usize| normal(place(i % columns, i / columns), 0.0);
    let returned: Vec<f64> = (0..columns * around)
        .map(|i| {
            let [u, v] = place(i % columns, i / columns);
            let w = normal([u.min(LAST_INCLINATION.sqrt()), v], 0.0);
            f_cos(model, w, w).dot(DVec3::new(0.2126, 0.7152, 0.0722)).max(0.0)
        })
        .collect();
    let weight = |column: usize| {
        let u = place(column, 0)[0];
        let end = if column == columns - 1 { 0.5 } else { 1.0 };
        end * solid_angle(u, (u * u * FRAC_PI_2).sin()) / ((columns - 1) * (rows - 1)) as f64
    };
    let nodes: Vec<(DVec3, f64)> = (0..columns * (rows - 1)).map(|i| (viewer(i), weight(i % columns))).collect();
    let mut ndf = vec![1.0; columns * around];
    let mut sigma = vec![1.0; columns * around];
    for _ in 0..ITERATIONS {
        for (i, sigma) in sigma.iter_mut().enumerate() {
            let w = viewer(i);
            *sigma = nodes.iter().enumerate().map(|(m, (normal, weight))| ndf[m % ndf.len()] * weight * normal.dot(w).max(0.0)).sum();
        }
        let head_on = sigma[0];
        sigma.iter_mut().for_each(|s| *s /= head_on);
        let next: Vec<f64> = sigma.iter().zip(&returned).map(|(s, r)| s * r).collect();
        let largest = next.iter().copied().fold(0.0, f64::max);
        ndf = next.into_iter().map(|d| if largest > 0.0 { d.max(LEAST_NDF * largest) / largest } else { 1.0 }).collect();
    }
    // σ = 1 seen head on: ∫ D cos θ dω = 1.
    let area: f64 = nodes.iter().enumerate().map(|(m, (normal, weight))| ndf[m % ndf.len()] * weight * normal.z).sum();
    let grid = |values: &[f64], scale: f64| {
        let out_rows = if isotropic { 2 } else { rows };
        let node = |i: usize| [(values[i % values.len()] * scale) as f32];
        Patches::new([columns, out_rows], (0..columns * out_rows).map(node).collect())
    };
    (grid(&ndf, 1.0 / area), grid(&sigma, 1.0))
}

/// Relative density of visible normals over the square.
fn visible(ndf: &Patches<1>, [phi, theta]: [f64; 2], [columns, rows]: [usize; 2], isotropic: bool) -> Vec<f32> {
    let wo = direction(theta, phi);
    let node = |i: usize| {
        let at = [(i % columns) as f64 / (columns - 1) as f64, (i / columns) as f64 / (rows - 1) as f64];
        let m = normal(at, if isotropic { phi } else { 0.0 });
        let [d] = ndf.value(&Blend::one(0), at);
        (d * m.dot(wo).max(0.0) * solid_angle(at[0], m.truncate().length())) as f32
    };
    (0..columns * rows).map(node).collect()
}
