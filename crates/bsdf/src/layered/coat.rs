//! The layers above the base: clear coat and sheen. Both scale what lies below by one minus their albedo at `wo`.

use super::facets::{Facets, FacetsView};
use super::{unit, unit3};
use crate::{MaterialParams, SHEEN_MIN_ALPHA, f0_from_ior, schlick_weight, sheen_albedo, sheen_d, sheen_visibility};
use glam::{Vec2, Vec3};
use kajo_sampling::Frame;

/// Index of refraction of the clear coat.    KHR_materials_clearcoat
const COAT_IOR: f32 = 1.5;

#[derive(Clone, Copy, Debug)]
pub(super) struct Coat {
    weight: f32,
    facets: Facets,
    frame: Frame,
}

impl Coat {
    pub fn new(params: &MaterialParams) -> Option<Self> {
        let weight = unit(params.clearcoat);
        if weight == 0.0 {
            return None;
        }
        let n = params.clearcoat_normal.normalize_or_zero();
        let frame = if n == Vec3::ZERO || n == Vec3::Z || n.z <= 0.0 { Frame::IDENTITY } else { Frame::from_z(n) };
        Some(Self { weight, facets: Facets::isotropic(unit(params.clearcoat_roughness.0).powi(2)), frame })
    }

    pub fn is_delta(&self) -> bool {
        self.facets.is_delta
    }
}

/// The coat seen from one `wo`.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoatView {
    weight: f32,
    frame: Frame,
    /// In the frame of the coat.
    wo: Vec3,
    facets: FacetsView,
    is_delta: bool,
    /// Share of light that passes the coat.
    pub below: f32,
}

impl CoatView {
    pub fn new(coat: &Coat, wo: Vec3) -> Self {
        let mut wo = coat.frame.to_local(wo);
        // A coat normal that faces away from the viewer is seen at grazing angle.
        if wo.z < 1e-4 {
            wo = Vec3::new(wo.x, wo.y, 1e-4).normalize();
        }
        let e = coat.facets.albedo(wo);
        let below = 1.0 - coat.weight * (f0_from_ior(COAT_IOR) * e.f0 + e.f90);
        Self { weight: coat.weight, frame: coat.frame, wo, facets: FacetsView::new(&coat.facets, wo), is_delta: coat.is_delta(), below }
    }

    fn fresnel(cos_m: f32) -> f32 {
        let f0 = f0_from_ior(COAT_IOR);
        f0 + (1.0 - f0) * schlick_weight(cos_m)
    }

    /// f cos and density; the cosine is the one with the coat's normal.
    #[inline]
    pub fn eval(&self, wi: Vec3) -> (f32, f32) {
        let wi = self.frame.to_local(wi);
        match self.facets.pair(wi) {
            Some(f) if wi.z > 0.0 => (self.weight * Self::fresnel(f.cos_m) * f.value, f.pdf),
            _ => (0.0, 0.0),
        }
    }

    pub fn sample(&self, u: Vec2) -> Vec3 {
        self.frame.to_world(self.facets.reflect(u))
    }

    /// Mirror direction and reflectance of a smooth coat.
    pub fn delta(&self) -> Option<(Vec3, f32)> {
        let wi = Vec3::new(-self.wo.x, -self.wo.y, self.wo.z);
        self.is_delta.then(|| (self.frame.to_world(wi), self.weight * Self::fresnel(self.wo.z)))
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Sheen {
    color: Vec3,
    alpha: f32,
}

impl Sheen {
    pub fn new(params: &MaterialParams) -> Option<Self> {
        let color = unit3(params.sheen_color.0);
        let alpha = unit(params.sheen_roughness.0).powi(2).max(SHEEN_MIN_ALPHA);
        (color != Vec3::ZERO).then_some(Self { color, alpha })
    }
}

/// The sheen seen from one `wo`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SheenView {
    albedo: f32,
    /// Brings a lobe that would reflect more than everything down to everything.
    scale: f32,
    /// Share of light that passes the sheen.
    pub below: f32,
    pub chance: f32,
}

impl SheenView {
    pub fn new(sheen: &Sheen, wo: Vec3) -> Self {
        let e = sheen_albedo(sheen.alpha, wo.z);
        let albedo = e.min(1.0);
        Self { albedo, scale: 1.0 / e.max(1.0), below: 1.0 - sheen.color.max_element() * albedo, chance: super::mean(sheen.color) * albedo }
    }

    #[inline]
    pub fn eval(&self, sheen: &Sheen, wo: Vec3, wi: Vec3) -> Vec3 {
        let m = (wo + wi).normalize_or_zero();
        sheen.color * (self.scale * sheen_d(sheen.alpha, m.z) * sheen_visibility(sheen.alpha, wo.z, wi.z) * wi.z)
    }

    pub fn albedo(&self, sheen: &Sheen) -> Vec3 {
        sheen.color * self.albedo
    }
}
