//! The integrals behind the tables, by quasi-Monte Carlo over visible normals.

use super::*;
use crate::microfacet::{aniso_albedo_of, ggx_g1_aniso, ggx_g2_aniso, ggx_sample_vndf, stretched_length};
use crate::{SHEEN_MIN_ALPHA, fresnel_dielectric, reflect, refract, schlick_weight, sheen_d, sheen_visibility};
use glam::{Vec2, Vec3};
use kajo_sampling::sobol_2d;

/// The narrowest lobe that is integrated; narrower ones do not differ in albedo.
const ALPHA_FLOOR: f32 = 1e-4;

/// The direction at these spherical coordinates; exactly grazing ones are lifted to where an albedo exists.
pub fn direction(cos_theta: f32, azimuth: f32) -> Vec3 {
    let c = cos_theta.max(1e-4);
    let r = (1.0 - c * c).max(0.0).sqrt();
    Vec3::new(r * azimuth.cos(), r * azimuth.sin(), c)
}

/// Midpoints of the Sobol cells: no sample on an edge.
fn point(i: u32, n: u32) -> Vec2 {
    (sobol_2d(i) + Vec2::splat(0.5 / n as f32)).min(Vec2::splat(0.999_999))
}

/// Directional albedo of GGX single scattering, as factors of f0 and f90 of Schlick's Fresnel, with `n` samples.    \[Karis13]
///
/// ```text
/// E(wo) = ∫ f cos θi dωi = f0 ∫ (1 − w) G2/G1 + f90 ∫ w G2/G1,    w = (1 − wo·m)⁵, m over visible normals
/// ```
pub fn ggx_albedo(wo: Vec3, alpha: Vec2, n: u32) -> [f32; 2] {
    let alpha = alpha.max(Vec2::splat(ALPHA_FLOOR));
    let (mut a, mut b) = (0.0f64, 0.0f64);
    for i in 0..n {
        let m = ggx_sample_vndf(alpha, wo, point(i, n));
        let wi = reflect(wo, m);
        if wi.z > 0.0 {
            let g = f64::from(ggx_g2_aniso(alpha, wo, wi) / ggx_g1_aniso(alpha, wo));
            let w = f64::from(schlick_weight(wo.dot(m)));
            a += (1.0 - w) * g;
            b += w * g;
        }
    }
    [(a / f64::from(n)) as f32, (b / f64::from(n)) as f32]
}

/// Share of light that rough glass reflects or transmits in single scattering; `eta` = index beyond over index before.
pub fn glass_albedo(wo: Vec3, alpha: Vec2, eta: f32, n: u32) -> f32 {
    let alpha = alpha.max(Vec2::splat(ALPHA_FLOOR));
    let mut sum = 0.0f64;
    for i in 0..n {
        let m = ggx_sample_vndf(alpha, wo, point(i, n));
        let f = fresnel_dielectric(wo.dot(m), eta);
        let g = |wi: Vec3| f64::from(ggx_g2_aniso(alpha, wo, wi) / ggx_g1_aniso(alpha, wo));
        let wi = reflect(wo, m);
        if wi.z > 0.0 {
            sum += f64::from(f) * g(wi);
        }
        if let Some(wi) = refract(wo, m, eta).filter(|wi| wi.z < 0.0) {
            sum += f64::from(1.0 - f) * g(wi);
        }
    }
    (sum / f64::from(n)) as f32
}

/// Directional albedo of GGX whose Fresnel is the hat function of each of [`HAT_NODES`] nodes over wo·m.
pub fn ggx_hat_albedo(cos_theta: f32, alpha: f32, n: u32) -> [f32; HAT_NODES] {
    let alpha = Vec2::splat(alpha.max(ALPHA_FLOOR));
    let wo = direction(cos_theta, 0.0);
    let mut sums = [0.0f64; HAT_NODES];
    for i in 0..n {
        let m = ggx_sample_vndf(alpha, wo, point(i, n));
        let wi = reflect(wo, m);
        if wi.z > 0.0 {
            let g = ggx_g2_aniso(alpha, wo, wi) / ggx_g1_aniso(alpha, wo);
            let (k, t) = place(wo.dot(m), HAT_NODES);
            sums[k] += f64::from(g * (1.0 - t));
            sums[k + 1] += f64::from(g * t);
        }
    }
    sums.map(|s| (s / f64::from(n)) as f32)
}

/// Directional albedo of a white sheen layer; `n` midpoints along each of cos θi and φ.
///
/// The fibres stand upright, so the lobe is largest near the horizon: cos θi = s² puts the points there.
pub fn sheen_albedo(cos_theta: f32, alpha: f32, n: u32) -> f32 {
    let alpha = alpha.max(SHEEN_MIN_ALPHA);
    let wo = direction(cos_theta, 0.0);
    let mut sum = 0.0f64;
    for i in 0..n * n {
        let s = ((i % n) as f32 + 0.5) / n as f32;
        // Even about φ = 0: half of the turn is enough.
        let phi = std::f32::consts::PI * ((i / n) as f32 + 0.5) / n as f32;
        let c = s * s;
        let r = (1.0 - c * c).sqrt();
        let wi = Vec3::new(r * phi.cos(), r * phi.sin(), c);
        let h = (wo + wi).normalize();
        sum += f64::from(sheen_d(alpha, h.z) * sheen_visibility(alpha, wo.z, wi.z) * c * 2.0 * s);
    }
    (sum * std::f64::consts::TAU / f64::from(n * n)) as f32
}

/// cos θ of node `i` of `nodes`.
pub fn cos_of_node(i: usize, nodes: usize) -> f32 {
    let x = i as f32 / (nodes - 1) as f32;
    x * x
}

/// α of node `i` of `nodes`.
pub fn alpha_of_node(i: usize, nodes: usize) -> f32 {
    cos_of_node(i, nodes)
}

/// η of node `i` of the glass table.
pub fn eta_of_node(i: usize) -> f32 {
    let z = GLASS_Z_MAX * (2.0 * i as f32 / (GLASS_ETA_NODES - 1) as f32 - 1.0);
    (1.0 + z) / (1.0 - z)
}

/// The table [`GGX_ALBEDO`].
pub fn make_ggx_albedo(n: u32) -> Vec<[f32; 2]> {
    let node = |k: usize| {
        let alpha = Vec2::splat(alpha_of_node(k / COS_NODES, ROUGHNESS_NODES));
        ggx_albedo(direction(cos_of_node(k % COS_NODES, COS_NODES), 0.0), alpha, n)
    };
    (0..COS_NODES * ROUGHNESS_NODES).map(node).collect()
}

/// The table [`GGX_ALBEDO_AVERAGE`]: 2 ∫ E cos θ d cos θ of the interpolated table, which is what furnace sums see.
pub fn make_ggx_albedo_average(table: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let steps = 4096;
    table
        .chunks_exact(COS_NODES)
        .map(|row| {
            let mut sum = [0.0f64; 2];
            for s in 0..steps {
                let c = (s as f32 + 0.5) / steps as f32;
                let (i, t) = place(c.sqrt(), COS_NODES);
                for k in 0..2 {
                    sum[k] += f64::from((row[i][k] + t * (row[i + 1][k] - row[i][k])) * 2.0 * c) / steps as f64;
                }
            }
            sum.map(|s| s as f32)
        })
        .collect()
}

/// The table [`GLASS_ALBEDO`].
pub fn make_glass_albedo(n: u32) -> Vec<f32> {
    let node = |k: usize| {
        let (c, r) = (k % GLASS_COS_NODES, k / GLASS_COS_NODES % GLASS_ROUGHNESS_NODES);
        let eta = eta_of_node(k / GLASS_COS_NODES / GLASS_ROUGHNESS_NODES);
        let alpha = Vec2::splat(alpha_of_node(r, GLASS_ROUGHNESS_NODES));
        glass_albedo(direction(cos_of_node(c, GLASS_COS_NODES), 0.0), alpha, eta, n)
    };
    (0..GLASS_COS_NODES * GLASS_ROUGHNESS_NODES * GLASS_ETA_NODES).map(node).collect()
}

/// The table [`SHEEN_ALBEDO`].
pub fn make_sheen_albedo(n: u32) -> Vec<f32> {
    let node = |k: usize| {
        let (c, r) = (k % SHEEN_COS_NODES, k / SHEEN_COS_NODES);
        sheen_albedo(cos_of_node(c, SHEEN_COS_NODES), alpha_of_node(r, SHEEN_ROUGHNESS_NODES), n) / SHEEN_TABLE_SCALE
    };
    (0..SHEEN_COS_NODES * SHEEN_ROUGHNESS_NODES).map(node).collect()
}

/// The table [`GGX_HAT_ALBEDO`].
pub fn make_ggx_hat_albedo(n: u32) -> Vec<f32> {
    let node = |k: usize| {
        let (c, r) = (k % HAT_AXIS_NODES, k / HAT_AXIS_NODES);
        ggx_hat_albedo(cos_of_node(c, HAT_AXIS_NODES), alpha_of_node(r, HAT_AXIS_NODES), n)
    };
    (0..HAT_AXIS_NODES * HAT_AXIS_NODES).flat_map(node).collect()
}

/// Values at the nodes of `grid` whose interpolation is nearest to `value` in the mean square, from `per_node` points a node.
///
/// Linear interpolation between exact values is one-sided on curved functions; the fit halves its largest error and leaves no bias. A
/// tenth of the points lies on each face of the grid: the ends of the parameters are common, and nothing beyond them holds the fit.
fn fit<const D: usize>(grid: Grid<D>, per_node: usize, value: impl Fn([f32; D]) -> f32 + Sync) -> Vec<f32> {
    const SWEEPS: usize = 40;
    let mut table = in_parallel(grid.size(), |i| value(grid.position(i)));
    let points: Vec<[f32; D]> =
        (0..grid.size() * per_node).map(|i| additive_recurrence(i).map(|x| (1.25 * x - 0.125).clamp(0.0, 1.0))).collect();
    let wanted = in_parallel(points.len(), |i| value(points[i]));
    for _ in 0..SWEEPS {
        let (mut step, mut weights) = (vec![0.0f32; table.len()], vec![0.0f32; table.len()]);
        for (point, wanted) in points.iter().zip(&wanted) {
            let error = wanted - grid.interpolate(|i| table[i], *point);
            grid.corners(*point, |i, weight| {
                step[i] += weight * error;
                weights[i] += weight;
            });
        }
        for ((value, step), weight) in table.iter_mut().zip(step).zip(weights) {
            *value += step / weight.max(0.1);
        }
    }
    table
}

/// Point `i` of the additive recurrence with the powers of the generalised golden ratio x^(D+1) = x + 1.
fn additive_recurrence<const D: usize>(i: usize) -> [f32; D] {
    let ratio = (0..64).fold(1.5f64, |x, _| (1.0 + x).powf(1.0 / (D + 1) as f64));
    std::array::from_fn(|axis| (0.5 + i as f64 * ratio.powi(-(axis as i32 + 1))).fract() as f32)
}

/// `f` of 0 … n − 1 on all cores.
fn in_parallel(n: usize, f: impl Fn(usize) -> f32 + Sync) -> Vec<f32> {
    let mut out = vec![0.0; n];
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let chunk = n.div_ceil(threads);
    std::thread::scope(|scope| {
        for (t, out) in out.chunks_mut(chunk).enumerate() {
            let f = &f;
            scope.spawn(move || out.iter_mut().enumerate().for_each(|(i, out)| *out = f(t * chunk + i)));
        }
    });
    out
}

/// The table [`ANISO_WHITE`].
pub fn make_aniso_white(n: u32) -> Vec<f32> {
    fit(ANISO_WHITE_GRID, 8, |[polar, azimuth, strength, roughness]| {
        let alpha = aniso_alpha([strength, roughness]);
        let [f0, f90] = ggx_albedo(aniso_from_stretched(alpha, [polar, azimuth]), alpha, n);
        f0 + f90
    })
}

/// The table [`ANISO_MEAN_COS`].
pub fn make_aniso_mean_cos(n: u32) -> Vec<f32> {
    let table = fit(ANISO_COS_GRID, 8, |[polar, azimuth, strength, roughness]| {
        let alpha = aniso_alpha([strength, roughness]);
        let v = aniso_from_half_stretched(alpha, [polar, azimuth]);
        let [f0, f90] = ggx_albedo(v, alpha, n);
        (1.0 - (f90 / (f0 + f90)).powf(0.2)) / stretched_length(alpha, v)
    });
    table.into_iter().map(|rho| rho / ANISO_COS_SCALE).collect()
}

/// The table [`ANISO_AVERAGE`] of the albedo as it is interpolated from the tables, by `n`² midpoints.
pub fn make_aniso_average(white: &[f32], mean_cos: &[f32], n: u32) -> Vec<f32> {
    let node = |k: usize| {
        let alpha = aniso_alpha(ANISO_AVERAGE_GRID.position(k));
        let mut sum = [0.0f64; 2];
        for i in 0..n * n {
            // Uniform in cos² θ: the cosine-weighted hemisphere.
            let c = (((i % n) as f32 + 0.5) / n as f32).sqrt();
            let phi = std::f32::consts::FRAC_PI_2 * ((i / n) as f32 + 0.5) / n as f32;
            let e = aniso_albedo_of(|i| white[i], |i| mean_cos[i], alpha, direction(c, phi));
            sum[0] += f64::from(e.f0);
            sum[1] += f64::from(e.f90);
        }
        sum.map(|s| (s / f64::from(n * n)) as f32)
    };
    (0..ANISO_AVERAGE_GRID.size()).flat_map(node).collect()
}

/// The table [`ANISO_GLASS`].
pub fn make_aniso_glass(n: u32) -> Vec<f32> {
    fit(ANISO_GLASS_GRID, 4, |[polar, azimuth, strength, roughness, index]| {
        let alpha = aniso_alpha([strength, roughness]);
        glass_albedo(aniso_from_half_stretched(alpha, [polar, azimuth]), alpha, aniso_eta(index), n)
    })
}
