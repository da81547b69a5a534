//! The Fresnel curve of an iridescent base, tabulated once per surface point.
//!
//! The film's reflectance is evaluated at [`HAT_NODES`] angles and linear between them; that curve *is* the model, so its albedo
//! is an exact sum over [`GGX_HAT_ALBEDO`] and the diffuse lobe below it can keep the energy.

use super::facets::Facets;
use super::unit;
use crate::microfacet::GgxAlbedo;
use crate::tables::{GGX_HAT_ALBEDO, HAT_AXIS_NODES, HAT_NODES, place};
use crate::{MaterialParams, fresnel_schlick, fresnel_thin_film};
use glam::Vec3;

/// Reflectance over wo·m of metal and dielectric under a film.
#[derive(Clone, Copy, Debug)]
pub(super) struct FilmFresnel {
    /// Metal and dielectric with their weights.
    sum: [Vec3; HAT_NODES],
    /// The dielectric, without weight.
    layer: [Vec3; HAT_NODES],
    metallic: f32,
    opaque: f32,
    metal_average: Vec3,
    dielectric_average: Vec3,
}

impl FilmFresnel {
    /// `None` when the film is absent.    KHR_materials_iridescence
    pub fn new(params: &MaterialParams, metal_f0: Vec3, f0: Vec3, f90: Vec3, metallic: f32, opaque: f32) -> Option<Self> {
        let strength = unit(params.iridescence);
        let present = params.iridescence_thickness > 0.0 && params.iridescence_thickness.is_finite() && params.iridescence_ior.is_finite();
        if strength == 0.0 || !present {
            return None;
        }
        let film_ior = params.iridescence_ior.clamp(1.0, 5.0);
        let at = |c: f32, base_f0: Vec3, plain: Vec3| {
            plain.lerp(fresnel_thin_film(c, film_ior, params.iridescence_thickness, base_f0), strength)
        };
        let mut film = Self {
            sum: [Vec3::ZERO; HAT_NODES],
            layer: [Vec3::ZERO; HAT_NODES],
            metallic,
            opaque,
            metal_average: Vec3::ZERO,
            dielectric_average: Vec3::ZERO,
        };
        for k in 0..HAT_NODES {
            let c = k as f32 / (HAT_NODES - 1) as f32;
            let metal = if metallic > 0.0 { at(c, metal_f0, fresnel_schlick(metal_f0, Vec3::ONE, c)) } else { Vec3::ZERO };
            // `specular` scales the film on the dielectric as it scales the reflection without it.
            let dielectric = if metallic < 1.0 {
                let specular = f90.x;
                fresnel_schlick(f0, f90, c).lerp(
                    specular * fresnel_thin_film(c, film_ior, params.iridescence_thickness, f0 / specular.max(f32::MIN_POSITIVE)),
                    strength,
                )
            } else {
                Vec3::ZERO
            };
            film.sum[k] = metallic * metal + opaque * dielectric;
            film.layer[k] = dielectric;
            film.metal_average += cosine_weight(k) * metal;
            film.dielectric_average += cosine_weight(k) * dielectric;
        }
        Some(film)
    }

    #[inline]
    pub fn at(&self, cos_m: f32) -> Vec3 {
        let (k, t) = place(cos_m, HAT_NODES);
        self.sum[k].lerp(self.sum[k + 1], t)
    }

    /// Albedo of the reflection seen from `v`, and of the layer above the diffuse lobe; `e` is that of white facets.
    pub fn albedos(&self, facets: Facets, v: Vec3, e: GgxAlbedo) -> (Vec3, Vec3) {
        if facets.is_delta {
            let (k, t) = place(v.z, HAT_NODES);
            return (self.at(v.z), self.layer[k].lerp(self.layer[k + 1], t));
        }
        let weights = hat_albedos(facets.isotropic_alpha(v), v.z);
        // The finer table knows the sum better.
        let scale = e.white() / weights.iter().sum::<f32>().max(1e-3);
        let (mut sum, mut layer) = (Vec3::ZERO, Vec3::ZERO);
        for (weight, (f, l)) in weights.iter().zip(self.sum.iter().zip(&self.layer)) {
            sum += weight * *f;
            layer += weight * *l;
        }
        (sum * scale, layer * scale)
    }

    /// Cosine-weighted mean over directions of the layer's albedo. Anisotropic facets share theirs out as those of equal area do.
    pub fn layer_average(&self, facets: Facets) -> Vec3 {
        // Midpoints in cos².
        const STEPS: usize = 48;
        let isotropic = facets.of_equal_area();
        let mean = (0..STEPS).fold(Vec3::ZERO, |sum, s| {
            let c = ((s as f32 + 0.5) / STEPS as f32).sqrt();
            let v = Vec3::new((1.0 - c * c).sqrt(), 0.0, c);
            sum + self.albedos(isotropic, v, isotropic.albedo(v)).1 * (1.0 / STEPS as f32)
        });
        mean * (facets.albedo_average().white() / isotropic.albedo_average().white())
    }

    /// Multiple-scattering colours of metal and dielectric together, and of the layer.
    pub fn multiple_scattering(&self, white_average: f32) -> (Vec3, Vec3) {
        let color = |f: Vec3| f * f * white_average / (Vec3::ONE - f * (1.0 - white_average));
        let sum = self.metallic * color(self.metal_average) + self.opaque * color(self.dielectric_average);
        (sum, color(self.dielectric_average))
    }
}

/// 2 ∫ hat_k(c) c dc: the weight of node k in a cosine-weighted mean.
fn cosine_weight(k: usize) -> f32 {
    let n = (HAT_NODES - 1) as f32;
    let c = k as f32 / n;
    match k {
        0 => 1.0 / (3.0 * n * n),
        k if k == HAT_NODES - 1 => (c - 1.0 / (3.0 * n)) / n,
        _ => 2.0 * c / n,
    }
}

/// Albedos of all hat functions at one direction.
fn hat_albedos(alpha: f32, cos_theta: f32) -> [f32; HAT_NODES] {
    let (c, tc) = place(cos_theta.max(0.0).sqrt(), HAT_AXIS_NODES);
    let (r, tr) = place(alpha.max(0.0).sqrt(), HAT_AXIS_NODES);
    let row = |r: usize, c: usize| &GGX_HAT_ALBEDO[(r * HAT_AXIS_NODES + c) * HAT_NODES..][..HAT_NODES];
    let corners = [row(r, c), row(r, c + 1), row(r + 1, c), row(r + 1, c + 1)];
    let weights = [(1.0 - tr) * (1.0 - tc), (1.0 - tr) * tc, tr * (1.0 - tc), tr * tc];
    std::array::from_fn(|k| (0..4).map(|i| weights[i] * corners[i][k]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn node_weights_integrate_linear_functions_exactly() {
        let one: f32 = (0..HAT_NODES).map(cosine_weight).sum();
        let c: f32 = (0..HAT_NODES).map(|k| cosine_weight(k) * k as f32 / (HAT_NODES - 1) as f32).sum();
        assert!((one - 1.0).abs() < 1e-5 && (c - 2.0 / 3.0).abs() < 1e-5, "{one} {c}");
    }

    #[test]
    fn hat_albedos_sum_to_the_white_albedo() {
        for (alpha, c) in [(0.01, 0.9), (0.25, 0.5), (0.64, 0.3), (1.0, 0.8)] {
            let sum: f32 = hat_albedos(alpha, c).iter().sum();
            let white = crate::ggx_albedo(alpha, c).white();
            assert!((sum - white).abs() < 6e-3, "alpha {alpha}, cos {c}: {sum} {white}");
        }
    }
}
