//! The opaque base: metal and dielectric reflection from one set of GGX facets, and the diffuse lobe below the dielectric.

use super::facets::{FacetPair, Facets};
use super::film::FilmFresnel;
use super::{mean, unit, unit3};
use crate::microfacet::{GgxAlbedo, ggx_multiple_scattering_color};
use crate::{MaterialParams, f0_from_ior, fresnel_schlick};
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Everything that does not depend on directions. Weights of metal and dielectric are multiplied into the colours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Base {
    facets: Facets,
    /// Fresnel of metal and dielectric together.
    f0: Vec3,
    f90: Vec3,
    /// Fresnel that takes light from the diffuse lobe: the largest channel, so that the rest keeps its colour. A film takes each channel
    /// for itself (deviation from KHR_materials_iridescence, which takes the largest): what it does not reflect, it lets through.
    layer_f0: f32,
    layer_f90: f32,
    layer_ms: Vec3,
    /// Share of the opaque dielectric × base colour.
    diffuse_albedo: Vec3,
    /// `diffuse_albedo` / (π (1 − Ē_layer)).
    diffuse_scale: Vec3,
    /// Colour of multiple scattering.
    ms: Vec3,
    /// 1 / (π (1 − Ē)).
    ms_scale: f32,
    film: Option<FilmFresnel>,
    /// Nothing but the diffuse lobe: facets need not be looked at.
    is_lambert: bool,
}

impl Base {
    pub fn new(params: &MaterialParams) -> Self {
        let facets = Facets::of_base(params);
        let metallic = unit(params.metallic);
        let opaque = (1.0 - metallic) * (1.0 - unit(params.transmission));
        let color = unit3(params.base_color.0);
        let (dielectric_f0, dielectric_f90) = dielectric_reflectances(params);
        let average = facets.albedo_average();
        let film = FilmFresnel::new(params, color, dielectric_f0, dielectric_f90, metallic, opaque);
        let white = average.white();
        let (f0, f90) = (metallic * color + opaque * dielectric_f0, Vec3::splat(metallic) + opaque * dielectric_f90);
        let (layer_f0, layer_f90) = (dielectric_f0.max_element(), dielectric_f90.max_element());
        let ms_of = |f0: Vec3, f90: Vec3| ggx_multiple_scattering_color(f0, f90, white);
        let (ms, layer_ms) = match &film {
            None => (
                metallic * ms_of(color, Vec3::ONE) + opaque * ms_of(dielectric_f0, dielectric_f90),
                ms_of(Vec3::splat(layer_f0), Vec3::splat(layer_f90)),
            ),
            Some(film) => film.multiple_scattering(white),
        };
        let layer_average = match &film {
            None => Vec3::splat(layer_f0 * average.f0 + layer_f90 * average.f90),
            Some(film) => film.layer_average(facets),
        } + layer_ms * (1.0 - white);
        let diffuse_albedo = opaque * color;
        Self {
            facets,
            f0,
            f90,
            layer_f0,
            layer_f90,
            layer_ms,
            diffuse_albedo,
            // A layer that reflects everything leaves nothing; the guard keeps 0 · ∞ away.
            diffuse_scale: diffuse_albedo * FRAC_1_PI / (Vec3::ONE - layer_average).max(Vec3::splat(1e-4)),
            ms: if white < 1.0 - 1e-5 { ms } else { Vec3::ZERO },
            ms_scale: FRAC_1_PI / (1.0 - white).max(1e-5),
            film,
            is_lambert: film.is_none() && f0 == Vec3::ZERO && f90 == Vec3::ZERO && opaque == 1.0,
        }
    }

    /// True for a pure Lambert surface.
    #[inline]
    pub fn is_lambert(&self) -> bool {
        self.is_lambert
    }

    /// ρ/π of a pure Lambert surface, and the chance that it reflects at all: 0 if it is black, else 1.
    pub fn lambert(&self) -> Option<(Vec3, f32)> {
        self.is_lambert.then(|| (self.diffuse_scale, f32::from(u8::from(mean(self.diffuse_albedo) > 0.0))))
    }

    pub fn facets(&self) -> Facets {
        self.facets
    }

    /// True when there is no diffuse lobe and the facets are a mirror.
    pub fn is_delta(&self) -> bool {
        self.facets.is_delta && self.diffuse_albedo == Vec3::ZERO
    }

    #[inline]
    fn fresnel(&self, cos_m: f32) -> Vec3 {
        match &self.film {
            None => fresnel_schlick(self.f0, self.f90, cos_m),
            Some(film) => film.at(cos_m),
        }
    }

    /// Albedo of single-scattering reflection, and of the whole layer above the diffuse lobe.
    #[inline]
    fn albedos(&self, v: Vec3, e: GgxAlbedo) -> (Vec3, Vec3) {
        let ms = self.layer_ms * (1.0 - e.white());
        match &self.film {
            None => (e.with(self.f0, self.f90), ms + self.layer_f0 * e.f0 + self.layer_f90 * e.f90),
            Some(film) => {
                let (specular, layer) = film.albedos(self.facets, v, e);
                (specular, layer + ms)
            }
        }
    }
}

/// f0 and f90 of the dielectric.    KHR_materials_specular, KHR_materials_ior
fn dielectric_reflectances(params: &MaterialParams) -> (Vec3, Vec3) {
    let specular = unit(params.specular);
    let ior = if params.ior.is_finite() { params.ior.max(0.0) } else { 1.5 };
    let f0 = unit3(f0_from_ior(ior) * params.specular_color.0) * specular;
    (f0, Vec3::splat(specular))
}

/// The base seen from one `wo`.
#[derive(Clone, Copy, Debug)]
pub(super) struct BaseView {
    wo: Vec3,
    specular_albedo: Vec3,
    /// 1 − E(o).
    lost: f32,
    /// 1 − E_layer(o).
    below: Vec3,
    pub diffuse_chance: f32,
    pub specular_chance: f32,
}

impl BaseView {
    #[inline]
    pub fn new(base: &Base, wo: Vec3) -> Self {
        if base.is_lambert {
            let diffuse_chance = mean(base.diffuse_albedo);
            return Self { wo, specular_albedo: Vec3::ZERO, lost: 0.0, below: Vec3::ONE, diffuse_chance, specular_chance: 0.0 };
        }
        let e = base.facets.albedo(wo);
        let (specular_albedo, layer) = base.albedos(wo, e);
        let (lost, below) = ((1.0 - e.white()).max(0.0), (Vec3::ONE - layer).max(Vec3::ZERO));
        Self {
            wo,
            specular_albedo,
            lost,
            below,
            diffuse_chance: mean(base.diffuse_albedo * below) + mean(base.ms) * lost,
            specular_chance: mean(specular_albedo),
        }
    }

    /// Diffuse and specular f cos θi of a direction above the surface.
    #[inline]
    pub fn eval(&self, base: &Base, wi: Vec3, facets: Option<&FacetPair>) -> (Vec3, Vec3) {
        if base.is_lambert {
            return (base.diffuse_scale * wi.z, Vec3::ZERO);
        }
        let e = base.facets.albedo(wi);
        let mut diffuse = Vec3::ZERO;
        if base.diffuse_albedo != Vec3::ZERO {
            let layer = base.albedos(wi, e).1;
            diffuse = base.diffuse_scale * self.below * (Vec3::ONE - layer).max(Vec3::ZERO) * wi.z;
        }
        let mut specular = base.ms * (base.ms_scale * self.lost * (1.0 - e.white()).max(0.0) * wi.z);
        if let Some(f) = facets {
            specular += base.fresnel(f.cos_m) * f.value;
        }
        (diffuse, specular)
    }

    /// Reflectance of the mirror, if the facets are one.
    #[inline]
    pub fn delta(&self, base: &Base) -> Option<Vec3> {
        base.facets.is_delta.then(|| base.fresnel(self.wo.z))
    }

    /// Diffuse and specular albedo.
    pub fn albedo(&self, base: &Base) -> (Vec3, Vec3) {
        (base.diffuse_albedo * self.below, self.specular_albedo + base.ms * self.lost)
    }
}
