//! The opaque base: metal and dielectric reflection from one set of GGX facets, and the diffuse lobe below the dielectric.

use super::film::FilmFresnel;
use super::{mean, unit, unit3};
use crate::microfacet::{
    GgxAlbedo, MIN_ALPHA, alpha_of_albedo, ggx_albedo, ggx_albedo_aniso, ggx_albedo_aniso_average, ggx_d_aniso,
    ggx_multiple_scattering_color, ggx_sample_vndf, ggx_visibility_aniso, ggx_vndf_pdf, glass_albedo,
};
use crate::tables::quadrature;
use crate::{MaterialParams, f0_from_ior, fresnel_schlick, reflect, schlick_weight};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Points of the quadratures that stand in for tables of anisotropic dielectrics, which would have five dimensions.
const ANISOTROPIC_POINTS: u32 = 64;

/// Width and orientation of the facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facets {
    pub alpha: Vec2,
    /// Cosine and sine of the rotation of α_x from the tangent; `None` for isotropic facets.
    rotation: Option<Vec2>,
    pub is_delta: bool,
}

/// Half vector, distribution, masking and density of one pair of directions on the same side.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetPair {
    /// wo · m.
    pub cos_m: f32,
    /// D V cos θi.
    pub value: f32,
    /// Density of wi.
    pub pdf: f32,
}

impl Facets {
    fn new(params: &MaterialParams) -> Self {
        let alpha = unit(params.roughness.0).powi(2);
        let strength = unit(params.anisotropy);
        // KHR_materials_anisotropy: α_t = mix(α, 1, strength²), α_b = α.
        let wide = alpha + (1.0 - alpha) * strength * strength;
        let is_delta = wide < MIN_ALPHA;
        let alpha = Vec2::new(wide, alpha).max(Vec2::splat(MIN_ALPHA));
        let rotation = (alpha.x > alpha.y).then(|| Vec2::from_angle(params.anisotropy_rotation.0));
        Self { alpha, rotation: rotation.filter(|r| r.is_finite()), is_delta }
    }

    /// From the shading frame to the frame of the facets.
    #[inline]
    pub fn to_facets(self, v: Vec3) -> Vec3 {
        self.rotation.map_or(v, |r| Vec3::new(r.x * v.x + r.y * v.y, r.x * v.y - r.y * v.x, v.z))
    }

    #[inline]
    fn to_shading(self, v: Vec3) -> Vec3 {
        self.rotation.map_or(v, |r| Vec3::new(r.x * v.x - r.y * v.y, r.x * v.y + r.y * v.x, v.z))
    }

    /// A facet visible from `wo`, shading frame.
    #[inline]
    pub fn sample(self, wo: Vec3, u: Vec2) -> Vec3 {
        self.to_shading(ggx_sample_vndf(self.alpha, self.to_facets(wo), u))
    }

    /// Albedo E of single scattering seen from `v`.
    #[inline]
    pub fn albedo(self, v: Vec3) -> GgxAlbedo {
        if self.is_delta {
            let w = schlick_weight(v.z);
            return GgxAlbedo { f0: 1.0 - w, f90: w };
        }
        match self.rotation {
            None => ggx_albedo(self.alpha.x, v.z),
            Some(_) => ggx_albedo_aniso(self.alpha, self.to_facets(v)),
        }
    }

    /// [`Facets::albedo`] whose split into f0 and f90 is right for anisotropic facets too, by a small quadrature.
    #[inline]
    pub fn dielectric_albedo(self, v: Vec3, e: GgxAlbedo) -> GgxAlbedo {
        if self.is_delta || self.rotation.is_none() {
            return e;
        }
        let [f0, f90] = quadrature::ggx_albedo(self.to_facets(v), self.alpha, ANISOTROPIC_POINTS);
        let scale = e.white() / (f0 + f90).max(1e-3);
        GgxAlbedo { f0: f0 * scale, f90: f90 * scale }
    }

    /// Mean over the cosine-weighted hemisphere of [`Facets::dielectric_albedo`].
    fn dielectric_albedo_average(self) -> GgxAlbedo {
        let average = self.albedo_average();
        if self.is_delta || self.rotation.is_none() {
            return average;
        }
        // Three Gauss points in cos² θ, which is uniform there, times two azimuths in the quadrant.
        let (mut f90, mut white) = (0.0, 0.0);
        for (x, weight) in [(0.112_702, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298, 5.0 / 18.0)] {
            for phi in [0.331_9, 1.238_9] {
                let v = quadrature::direction(f32::sqrt(x), phi);
                let [a, b] = quadrature::ggx_albedo(v, self.alpha, ANISOTROPIC_POINTS);
                white += 0.5 * weight * (a + b);
                f90 += 0.5 * weight * b;
            }
        }
        let f90 = f90 * average.white() / white.max(1e-3);
        GgxAlbedo { f0: average.white() - f90, f90 }
    }

    /// Share of light that glass with these facets reflects or transmits.
    pub fn glass_albedo(self, v: Vec3, eta: f32) -> f32 {
        match self.rotation {
            None => glass_albedo(self.alpha.x, v.z, eta),
            Some(_) => quadrature::glass_albedo(self.to_facets(v), self.alpha, eta, 2 * ANISOTROPIC_POINTS),
        }
    }

    /// Ē.
    fn albedo_average(self) -> GgxAlbedo {
        if self.is_delta { GgxAlbedo { f0: 20.0 / 21.0, f90: 1.0 / 21.0 } } else { ggx_albedo_aniso_average(self.alpha) }
    }

    /// Width by which tables that only know isotropic facets are read.
    pub fn isotropic_alpha(self, v: Vec3) -> f32 {
        if self.rotation.is_none() { self.alpha.x } else { alpha_of_albedo(self.albedo(v).white(), v.z) }
    }

    /// `None` for delta facets.
    #[inline]
    pub fn pair(self, wo: Vec3, wi: Vec3) -> Option<FacetPair> {
        if self.is_delta {
            return None;
        }
        let (wo, wi) = (self.to_facets(wo), self.to_facets(wi));
        let m = (wo + wi).normalize_or_zero();
        let cos_m = wo.dot(m);
        if cos_m <= 0.0 {
            return None;
        }
        let value = ggx_d_aniso(self.alpha, m) * ggx_visibility_aniso(self.alpha, wo, wi) * wi.z;
        Some(FacetPair { cos_m, value, pdf: ggx_vndf_pdf(self.alpha, wo, m) / (4.0 * cos_m) })
    }
}

/// Everything that does not depend on directions. Weights of metal and dielectric are multiplied into the colours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Base {
    facets: Facets,
    /// Fresnel of metal and dielectric together.
    f0: Vec3,
    f90: Vec3,
    /// Fresnel that takes light from the diffuse lobe: the largest channel, so that the rest keeps its colour.
    layer_f0: f32,
    layer_f90: f32,
    layer_ms: f32,
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
        let facets = Facets::new(params);
        let metallic = unit(params.metallic);
        let opaque = (1.0 - metallic) * (1.0 - unit(params.transmission));
        let color = unit3(params.base_color.0);
        let (dielectric_f0, dielectric_f90) = dielectric_reflectances(params);
        let average = if opaque > 0.0 { facets.dielectric_albedo_average() } else { facets.albedo_average() };
        let film = FilmFresnel::new(params, color, dielectric_f0, dielectric_f90, metallic, opaque);
        let white = average.white();
        let (f0, f90) = (metallic * color + opaque * dielectric_f0, Vec3::splat(metallic) + opaque * dielectric_f90);
        let (layer_f0, layer_f90) = (dielectric_f0.max_element(), dielectric_f90.max_element());
        let ms_of = |f0: Vec3, f90: Vec3| ggx_multiple_scattering_color(f0, f90, white);
        let (ms, layer_ms) = match &film {
            None => (
                metallic * ms_of(color, Vec3::ONE) + opaque * ms_of(dielectric_f0, dielectric_f90),
                ms_of(Vec3::splat(layer_f0), Vec3::splat(layer_f90)).x,
            ),
            Some(film) => film.multiple_scattering(white),
        };
        let layer_average = match &film {
            None => layer_f0 * average.f0 + layer_f90 * average.f90 + layer_ms * (1.0 - white),
            Some(film) => film.layer_average(facets) + layer_ms * (1.0 - white),
        };
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
            diffuse_scale: diffuse_albedo * FRAC_1_PI / (1.0 - layer_average).max(1e-4),
            ms: if white < 1.0 - 1e-5 { ms } else { Vec3::ZERO },
            ms_scale: FRAC_1_PI / (1.0 - white).max(1e-5),
            film,
            is_lambert: film.is_none() && f0 == Vec3::ZERO && f90 == Vec3::ZERO && opaque == 1.0,
        }
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
    fn albedos(&self, v: Vec3, e: GgxAlbedo) -> (Vec3, f32) {
        let ms = self.layer_ms * (1.0 - e.white());
        match &self.film {
            None => {
                let e = if self.diffuse_albedo == Vec3::ZERO { e } else { self.facets.dielectric_albedo(v, e) };
                (e.with(self.f0, self.f90), self.layer_f0 * e.f0 + self.layer_f90 * e.f90 + ms)
            }
            Some(film) => {
                let (specular, layer) = film.albedos(self.facets, v, e);
                (specular, layer + ms)
            }
        }
    }
}

/// f0 and f90 of the dielectric.    KHR_materials_specular, KHR_materials_ior
pub(super) fn dielectric_reflectances(params: &MaterialParams) -> (Vec3, Vec3) {
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
    below: f32,
    pub diffuse_chance: f32,
    pub specular_chance: f32,
}

impl BaseView {
    #[inline]
    pub fn new(base: &Base, wo: Vec3) -> Self {
        if base.is_lambert {
            let diffuse_chance = mean(base.diffuse_albedo);
            return Self { wo, specular_albedo: Vec3::ZERO, lost: 0.0, below: 1.0, diffuse_chance, specular_chance: 0.0 };
        }
        let e = base.facets.albedo(wo);
        let (specular_albedo, layer) = base.albedos(wo, e);
        let (lost, below) = ((1.0 - e.white()).max(0.0), (1.0 - layer).max(0.0));
        Self {
            wo,
            specular_albedo,
            lost,
            below,
            diffuse_chance: mean(base.diffuse_albedo) * below + mean(base.ms) * lost,
            specular_chance: mean(specular_albedo),
        }
    }

    #[inline]
    pub fn facets(&self, base: &Base, wi: Vec3) -> Option<FacetPair> {
        if base.is_lambert { None } else { base.facets.pair(self.wo, wi) }
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
            diffuse = base.diffuse_scale * (self.below * (1.0 - layer).max(0.0) * wi.z);
        }
        let mut specular = base.ms * (base.ms_scale * self.lost * (1.0 - e.white()).max(0.0) * wi.z);
        if let Some(f) = facets {
            specular += base.fresnel(f.cos_m) * f.value;
        }
        (diffuse, specular)
    }

    /// A mirrored direction; may lie below the surface.
    #[inline]
    pub fn sample(&self, base: &Base, u: Vec2) -> Vec3 {
        reflect(self.wo, base.facets.sample(self.wo, u))
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
