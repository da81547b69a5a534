//! One set of GGX facets, as metal, dielectric, glass and clear coat share them.

use super::unit;
use crate::microfacet::{
    GgxAlbedo, MIN_ALPHA, ggx_albedo, ggx_albedo_aniso, ggx_albedo_aniso_average, ggx_albedo_average, ggx_cap_bound, ggx_sample_reflection,
    ggx_sample_vndf, glass_albedo, glass_albedo_aniso, stretched_length,
};
use crate::{MaterialParams, reflect, schlick_weight};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Width and orientation of the facets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facets {
    pub alpha: Vec2,
    /// (1/α_x², 1/α_y²).
    inv_alpha2: Vec2,
    /// 1 / (π α_x α_y).
    d_scale: f32,
    /// Cosine and sine of the rotation of α_x from the tangent; `None` for isotropic facets.
    rotation: Option<Vec2>,
    pub is_delta: bool,
}

/// Distribution and masking of one pair of directions on the same side, without Fresnel factor.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetPair {
    /// wo · m.
    pub cos_m: f32,
    /// D V cos θi.
    pub value: f32,
    /// Density of wi from [`FacetsView::reflect`].
    pub pdf: f32,
    /// Density of wi mirrored at [`FacetsView::visible_normal`].
    pub visible_pdf: f32,
}

/// The facets seen from one `wo`.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacetsView {
    facets: Facets,
    /// In the frame of the facets.
    wo: Vec3,
    /// |(α_x wo.x, α_y wo.y, wo.z)|.
    stretched: f32,
    /// What D is multiplied by in `pdf` and `visible_pdf`.
    pdf_scale: f32,
    visible_pdf_scale: f32,
}

impl Facets {
    /// The facets of the base layer.
    pub fn of_base(params: &MaterialParams) -> Self {
        let alpha = unit(params.roughness.0).powi(2);
        let strength = unit(params.anisotropy);
        if strength == 0.0 {
            return Self::isotropic(alpha);
        }
        // KHR_materials_anisotropy: α_t = mix(α, 1, strength²), α_b = α.
        let wide = alpha + (1.0 - alpha) * strength * strength;
        let rotation = Vec2::from_angle(params.anisotropy_rotation.0);
        let mut facets = Self::new(Vec2::new(wide, alpha));
        facets.rotation = (facets.alpha.x > facets.alpha.y && rotation.is_finite()).then_some(rotation);
        facets
    }

    /// Facets of one width.
    #[inline]
    pub fn isotropic(alpha: f32) -> Self {
        Self::new(Vec2::splat(alpha))
    }

    fn new(alpha: Vec2) -> Self {
        let is_delta = alpha.max_element() < MIN_ALPHA;
        let alpha = alpha.max(Vec2::splat(MIN_ALPHA));
        Self { alpha, inv_alpha2: Vec2::ONE / (alpha * alpha), d_scale: FRAC_1_PI / (alpha.x * alpha.y), rotation: None, is_delta }
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

    /// Share of light that glass with these facets reflects or transmits.
    pub fn glass_albedo(self, v: Vec3, eta: f32) -> f32 {
        match self.rotation {
            None => glass_albedo(self.alpha.x, v.z, eta),
            Some(_) => glass_albedo_aniso(self.alpha, self.to_facets(v), eta),
        }
    }

    /// Ē.
    pub fn albedo_average(self) -> GgxAlbedo {
        if self.is_delta {
            return GgxAlbedo { f0: 20.0 / 21.0, f90: 1.0 / 21.0 };
        }
        if self.rotation.is_none() { ggx_albedo_average(self.alpha.x) } else { ggx_albedo_aniso_average(self.alpha) }
    }

    /// Isotropic facets with the same product of widths.
    pub fn of_equal_area(self) -> Self {
        if self.rotation.is_none() { self } else { Self::isotropic((self.alpha.x * self.alpha.y).sqrt()) }
    }

    /// Width by which tables that only know isotropic facets are read: the one along `v` near the horizon, that of equal area from above.
    pub fn isotropic_alpha(self, v: Vec3) -> f32 {
        if self.rotation.is_none() {
            return self.alpha.x;
        }
        let v = self.to_facets(v);
        (Vec2::new(self.alpha.x * v.x, self.alpha.y * v.y).length_squared() + v.z * v.z * self.alpha.x * self.alpha.y).sqrt()
    }
}

impl FacetsView {
    /// For a surface without facets: there is no pair.
    pub const ABSENT: Self = Self {
        facets: Facets { alpha: Vec2::ONE, inv_alpha2: Vec2::ONE, d_scale: 0.0, rotation: None, is_delta: true },
        wo: Vec3::Z,
        stretched: 1.0,
        pdf_scale: 0.0,
        visible_pdf_scale: 0.0,
    };

    #[inline]
    pub fn new(facets: &Facets, wo: Vec3) -> Self {
        let wo = facets.to_facets(wo);
        let stretched = stretched_length(facets.alpha, wo);
        let bounded = ggx_cap_bound(facets.alpha, wo) * wo.z + stretched;
        Self { facets: *facets, wo, stretched, pdf_scale: 0.5 / bounded, visible_pdf_scale: 0.5 / (wo.z + stretched) }
    }

    /// `None` for delta facets, and for directions without a half vector.
    ///
    /// The half vector is not normalised: with h = wo + wi, wo·m = |h|/2 and D(m) = |h|⁴ / (π α_x α_y (h_x²/α_x² + h_y²/α_y² + h_z²)²).
    #[inline]
    pub fn pair(&self, wi: Vec3) -> Option<FacetPair> {
        if self.facets.is_delta {
            return None;
        }
        let wi = self.facets.to_facets(wi);
        let h = self.wo + wi;
        let length2 = h.length_squared();
        if h.z <= 0.0 || length2 < 1e-12 {
            return None;
        }
        let spread = h.x * h.x * self.facets.inv_alpha2.x + h.y * h.y * self.facets.inv_alpha2.y + h.z * h.z;
        let ratio = length2 / spread;
        let d = self.facets.d_scale * ratio * ratio;
        let sum = wi.z * self.stretched + self.wo.z * stretched_length(self.facets.alpha, wi);
        Some(FacetPair {
            cos_m: 0.5 * length2.sqrt(),
            value: 0.5 * d * wi.z / sum.max(1e-30),
            pdf: d * self.pdf_scale,
            visible_pdf: d * self.visible_pdf_scale,
        })
    }

    /// A mirrored direction, shading frame; may lie below the surface.
    #[inline]
    pub fn reflect(&self, u: Vec2) -> Vec3 {
        self.facets.to_shading(reflect(self.wo, ggx_sample_reflection(self.facets.alpha, self.wo, u)))
    }

    /// A facet visible from `wo`, shading frame.
    #[inline]
    pub fn visible_normal(&self, u: Vec2) -> Vec3 {
        self.facets.to_shading(ggx_sample_vndf(self.facets.alpha, self.wo, u))
    }
}
