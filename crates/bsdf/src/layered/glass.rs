//! Transmission: a thin sheet that does not bend light, or the rough boundary of a volume.    \[Walter07]
//!
//! Reflection uses the exact Fresnel equations. Rough glass is divided by its albedo, so that a lossless one keeps all light.
//! Dispersion gives each channel its own index ([`Glass::etas`]); transmitted samples pick one channel.

use super::facets::{FacetPair, Facets, FacetsView};
use super::{mean, unit, unit3};
use crate::microfacet::{ggx_d_aniso, ggx_g2_aniso, ggx_vndf_pdf};
use crate::{MaterialParams, f0_from_ior, fresnel_dielectric, reflect, refract};
use glam::{Vec2, Vec3};

/// An index this near to one bends light by less than rounding can resolve: light passes straight.
const STRAIGHT: f32 = 1e-3;

#[derive(Clone, Copy, Debug)]
pub(super) struct Glass {
    weight: f32,
    tint: Vec3,
    facets: Facets,
    /// Index of refraction of each channel.
    iors: Vec3,
    dispersive: bool,
    thin: bool,
    /// Reflectances at 0° and 90° that `specular` and `specular_color` ask for.
    f0: Vec3,
    f90: Vec3,
}

/// A delta sample.
pub(super) struct DeltaSample {
    pub wi: Vec3,
    pub value: Vec3,
    pub chance: f32,
    pub eta2: f32,
}

impl Glass {
    pub fn new(params: &MaterialParams, weight: f32, facets: Facets) -> Self {
        let iors = params.channel_iors();
        let dispersive = iors.x != iors.z;
        let f0 = unit3(Vec3::from_array(iors.to_array().map(f0_from_ior)) * params.specular_color.0) * unit(params.specular);
        let f90 = Vec3::splat(unit(params.specular));
        Self { weight: unit(weight), tint: unit3(params.base_color.0), facets, iors, dispersive, thin: params.thin, f0, f90 }
    }

    pub fn has_inside(&self) -> bool {
        !self.thin
    }

    pub fn is_delta(&self) -> bool {
        self.facets.is_delta || self.is_straight()
    }

    pub fn chance(&self) -> f32 {
        self.weight * mean(self.tint).max(0.25)
    }

    /// Nothing happens at the boundary but the tint.
    fn is_straight(&self) -> bool {
        !self.thin && !self.dispersive && (self.iors.y - 1.0).abs() < STRAIGHT
    }

    /// Index beyond over index before, per channel.
    fn etas(&self, inside: bool) -> Vec3 {
        // Index 0 (reflect everything) has no inside that light could leave.
        if inside { Vec3::ONE / self.iors.max(Vec3::splat(1e-3)) } else { self.iors }
    }

    /// Fresnel reflectance of each channel.
    #[inline]
    fn fresnel(&self, cos_m: f32, etas: Vec3) -> Vec3 {
        let exact = |eta: f32, f0: f32, f90: f32| {
            let f = fresnel_dielectric(cos_m, eta);
            let base = f0_from_ior(eta);
            // Total reflection stays total: there is no direction to transmit into.
            if f >= 1.0 || base >= 1.0 { 1.0 } else { f0 + (f90 - f0) * ((f - base) / (1.0 - base)).clamp(0.0, 1.0) }
        };
        let x = exact(etas.x, self.f0.x, self.f90.x);
        if !self.dispersive && self.f0.x == self.f0.y && self.f0.y == self.f0.z {
            return Vec3::splat(x);
        }
        Vec3::new(x, exact(etas.y, self.f0.y, self.f90.y), exact(etas.z, self.f0.z, self.f90.z))
    }
}

/// The glass seen from one `wo`.
#[derive(Clone, Copy, Debug)]
pub(super) struct GlassView {
    wo: Vec3,
    etas: Vec3,
    /// weight / albedo, per channel.
    scale: Vec3,
}

impl GlassView {
    pub fn new(glass: &Glass, wo: Vec3, inside: bool) -> Self {
        let etas = glass.etas(inside);
        let albedo = if glass.is_delta() {
            Vec3::ONE
        } else if glass.thin {
            Vec3::splat(glass.facets.albedo(wo).white())
        } else if glass.dispersive {
            Vec3::from_array(etas.to_array().map(|eta| glass.facets.glass_albedo(wo, eta)))
        } else {
            Vec3::splat(glass.facets.glass_albedo(wo, etas.y))
        };
        Self { wo, etas, scale: glass.weight / albedo.max(Vec3::splat(0.05)) }
    }

    /// f cos and density of a reflected direction.
    #[inline]
    pub fn reflect(&self, glass: &Glass, f: &FacetPair) -> (Vec3, f32) {
        if glass.is_delta() {
            return (Vec3::ZERO, 0.0);
        }
        let r = glass.fresnel(f.cos_m, self.etas);
        (self.scale * r * f.value, mean(r) * f.visible_pdf)
    }

    /// f cos and density of a transmitted direction, wi.z < 0.
    #[inline]
    pub fn transmit(&self, glass: &Glass, facets: &FacetsView, wi: Vec3) -> (Vec3, f32) {
        if glass.is_delta() {
            return (Vec3::ZERO, 0.0);
        }
        if glass.thin {
            let Some(f) = facets.pair(Vec3::new(wi.x, wi.y, -wi.z)) else { return (Vec3::ZERO, 0.0) };
            let r = glass.fresnel(f.cos_m, self.etas);
            return (self.scale * glass.tint * (Vec3::ONE - r) * f.value, (1.0 - mean(r)) * f.visible_pdf);
        }
        let (wo, wi) = (glass.facets.to_facets(self.wo), glass.facets.to_facets(wi));
        if !glass.dispersive {
            let Some((cos_m, value, pdf)) = refracted_pair(glass.facets.alpha, wo, wi, self.etas.y) else { return (Vec3::ZERO, 0.0) };
            let r = glass.fresnel(cos_m, self.etas);
            return (self.scale * glass.tint * (Vec3::ONE - r) * value, (1.0 - mean(r)) * pdf);
        }
        let (mut f_cos, mut density) = (Vec3::ZERO, 0.0);
        for channel in 0..3 {
            if let Some((cos_m, value, pdf)) = refracted_pair(glass.facets.alpha, wo, wi, self.etas[channel]) {
                let r = glass.fresnel(cos_m, self.etas);
                f_cos[channel] = self.scale[channel] * glass.tint[channel] * (1.0 - r[channel]) * value;
                density += (1.0 - mean(r)) * pdf * (1.0 / 3.0);
            }
        }
        (f_cos, density)
    }

    /// A direction and (n_i/n_o)²; `u_choice` picks reflection or transmission.
    pub fn sample(&self, glass: &Glass, facets: &FacetsView, u_choice: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let m = facets.visible_normal(u);
        let mirrored = reflect(self.wo, m);
        let r = mean(glass.fresnel(self.wo.dot(m), self.etas));
        if u_choice < r {
            return Some((mirrored, 1.0)).filter(|s| s.0.z > 0.0);
        }
        if glass.thin {
            return Some((Vec3::new(mirrored.x, mirrored.y, -mirrored.z), 1.0)).filter(|s| s.0.z < 0.0);
        }
        let eta = self.etas[self.channel(glass, (u_choice - r) / (1.0 - r))];
        refract(self.wo, m, eta).map(|wi| (wi.normalize(), eta * eta)).filter(|s| s.0.z < 0.0)
    }

    /// A sample of smooth glass; `None` if the glass is rough.
    pub fn sample_delta(&self, glass: &Glass, u_choice: f32) -> Option<DeltaSample> {
        if !glass.is_delta() {
            return None;
        }
        let tint = glass.weight * glass.tint;
        if glass.is_straight() {
            return Some(DeltaSample { wi: -self.wo, value: tint, chance: 1.0, eta2: 1.0 });
        }
        let f = glass.fresnel(self.wo.z, self.etas);
        let r = mean(f);
        if u_choice < r {
            let wi = Vec3::new(-self.wo.x, -self.wo.y, self.wo.z);
            return Some(DeltaSample { wi, value: glass.weight * f, chance: r, eta2: 1.0 });
        }
        let chance = 1.0 - r;
        if glass.thin {
            return Some(DeltaSample { wi: -self.wo, value: tint * (Vec3::ONE - f), chance, eta2: 1.0 });
        }
        let channel = self.channel(glass, (u_choice - r) / chance);
        let eta = self.etas[channel];
        // Another channel may be totally reflected where the mean is not: that choice carries nothing.
        let wi = refract(self.wo, Vec3::Z, eta).unwrap_or(-self.wo);
        let value = tint * (Vec3::ONE - f) / (eta * eta);
        if !glass.dispersive {
            return Some(DeltaSample { wi, value, chance, eta2: eta * eta });
        }
        let mut one = Vec3::ZERO;
        one[channel] = value[channel];
        Some(DeltaSample { wi, value: one, chance: chance * (1.0 / 3.0), eta2: eta * eta })
    }

    /// Share of light that is reflected or transmitted; the split is that of the mean facet.
    pub fn albedo(&self, glass: &Glass) -> Vec3 {
        let r = if glass.is_straight() { Vec3::ZERO } else { glass.fresnel(self.wo.z, self.etas) };
        glass.weight * (r + (Vec3::ONE - r) * glass.tint)
    }

    fn channel(&self, glass: &Glass, u: f32) -> usize {
        if glass.dispersive { ((u * 3.0) as usize).min(2) } else { 1 }
    }
}

/// wo·m, D G2 Jacobian cos and density of a refracted direction without Fresnel factors, in the frame of the facets.
///
/// ```text
/// f cos = |wo·m||wi·m| / cos θo · D G2 / (wo·m + η wi·m)²,    p = D_vis η² |wi·m| / (wo·m + η wi·m)²     [Walter07] eqs. 17, 21
/// ```
///
/// f is for radiance: light that enters a denser medium from `wo`'s side carries 1/η².
fn refracted_pair(alpha: Vec2, wo: Vec3, wi: Vec3, eta: f32) -> Option<(f32, f32, f32)> {
    let mut m = (wo + eta * wi).normalize_or_zero();
    if m.z < 0.0 {
        m = -m;
    }
    let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
    // Facets seen from their back on either side do not exist.
    if cos_o <= 0.0 || cos_i >= 0.0 {
        return None;
    }
    let s = cos_o + eta * cos_i;
    let jacobian = -cos_i / (s * s);
    if !jacobian.is_finite() {
        return None;
    }
    let value = cos_o * jacobian * ggx_d_aniso(alpha, m) * ggx_g2_aniso(alpha, wo, wi) / wo.z;
    Some((cos_o, value, ggx_vndf_pdf(alpha, wo, m) * eta * eta * jacobian))
}
