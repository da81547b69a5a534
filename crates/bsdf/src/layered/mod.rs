//! The layered glTF material as one BSDF: `f_cos`, `pdf`, `sample` and `albedo` of the same model.
//!
//! From outside to inside: clear coat, sheen, base. The base is a mix of three, with the weights of glTF 2.0 appendix B:
//! metal (`metallic`), glass ((1 − metallic) · transmission) and opaque dielectric (the rest), all with the same GGX facets.
//!
//! Energy. Metal and dielectric reflection carry the reciprocal multiple-scattering lobe (\[Kulla17]); the diffuse lobe of the
//! dielectric is scaled by (1 − E(o))(1 − E(i))/(1 − Ē) with the albedo E of the reflection above it, so that a white one
//! reflects everything; glass is divided by its albedo; coat and sheen scale what lies below by one minus their albedo at `wo`.
//! Metal and opaque dielectric are reciprocal. Coat, sheen and the factor on rough glass depend on `wo` alone, as glTF's
//! layering does, and are not.
//!
//! Sides. Opaque lobes, coat and sheen look the same from both sides: `wo.z < 0` sees the mirror image of the front. Only
//! glass with a volume (`thin == false`) knows its inside (z < 0), where coat and sheen are absent. A caller that wants a
//! one-sided surface tests the side itself; flipping the frame of a two-sided one is allowed and changes nothing.

mod base;
mod coat;
mod facets;
mod film;
mod glass;
mod lambert;
#[cfg(test)]
mod mis_experiment;
#[cfg(test)]
mod tests;
mod types;

use crate::MaterialParams;
use base::{Base, BaseView};
use coat::{Coat, CoatView, Sheen, SheenView};
use facets::FacetsView;
use glam::{Vec2, Vec3};
use glass::{Glass, GlassView};
pub use lambert::LambertView;
pub use types::{BsdfSample, Lobe, LobeValues};

/// The material at one surface point, prepared for any directions.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    base: Base,
    glass: Option<Glass>,
    coat: Option<Coat>,
    sheen: Option<Sheen>,
    /// ρ/π and the chance of a bounce (0 or 1) of a surface with nothing but the diffuse lobe.
    lambert: Option<(Vec3, f32)>,
}

/// A [`Bsdf`] seen from one `wo`: what many `wi` share is computed once.
#[derive(Clone, Copy, Debug)]
pub struct BsdfView<'a> {
    bsdf: &'a Bsdf,
    /// +1, or −1 when `wo` lies below the surface and everything is mirrored.
    side: f32,
    /// `wo` above the surface.
    wo: Vec3,
    /// Facets of base and glass.
    facets: FacetsView,
    base: BaseView,
    glass: Option<GlassView>,
    coat: Option<CoatView>,
    sheen: Option<SheenView>,
    /// Share of light that passes coat and sheen.
    below: f32,
    /// Chances to pick diffuse, specular, glass, coat, sheen; their sum is 1, or 0 for a black material.
    chances: [f32; 5],
}

const DIFFUSE: usize = 0;
const SPECULAR: usize = 1;
const GLASS: usize = 2;
const COAT: usize = 3;
const SHEEN: usize = 4;

/// Mean of the channels.
#[inline]
fn mean(v: Vec3) -> f32 {
    (v.x + v.y + v.z) * (1.0 / 3.0)
}

impl Bsdf {
    /// Prepares the material. Parameters outside their ranges are clamped, so that every input gives a valid BSDF.
    pub fn new(params: &MaterialParams) -> Self {
        let glass_weight = (1.0 - unit(params.metallic)) * unit(params.transmission);
        let base = Base::new(params);
        let glass = (glass_weight > 0.0).then(|| Glass::new(params, glass_weight, base.facets()));
        let (coat, sheen) = (Coat::new(params), Sheen::new(params));
        let lambert = base.lambert().filter(|_| glass.is_none() && coat.is_none() && sheen.is_none());
        Self { base, glass, coat, sheen, lambert }
    }

    /// Seen from `wo` (unit length, local frame, either side).
    #[inline]
    pub fn view(&self, wo: Vec3) -> BsdfView<'_> {
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let mut wo = Vec3::new(wo.x, wo.y, wo.z * side);
        // A direction exactly in the surface has no well-defined albedo; the nearest one above it has.
        wo.z = wo.z.max(1e-6);
        let inside = side < 0.0 && self.glass.as_ref().is_some_and(Glass::has_inside);
        let base = BaseView::new(&self.base, wo);
        let facets = if self.base.is_lambert() { FacetsView::ABSENT } else { FacetsView::new(&self.base.facets(), wo) };
        let glass = self.glass.as_ref().map(|g| GlassView::new(g, wo, inside));
        let coat = if inside { None } else { self.coat.as_ref().map(|c| CoatView::new(c, wo)) };
        let sheen = if inside { None } else { self.sheen.as_ref().map(|s| SheenView::new(s, wo)) };
        let below_coat = coat.as_ref().map_or(1.0, |c| c.below);
        let below = below_coat * sheen.as_ref().map_or(1.0, |s| s.below);
        let mut chances = [
            below * base.diffuse_chance,
            below * base.specular_chance,
            below * self.glass.as_ref().map_or(0.0, Glass::chance),
            1.0 - below_coat,
            below_coat * sheen.as_ref().map_or(0.0, |s| s.chance),
        ];
        let sum: f32 = chances.iter().sum();
        if sum > 0.0 {
            chances.iter_mut().for_each(|c| *c /= sum);
        }
        BsdfView { bsdf: self, side, wo, facets, base, glass, coat, sheen, below, chances }
    }

    /// f(wo, wi) |cos θi| without delta lobes, 1/sr.
    pub fn f_cos(&self, wo: Vec3, wi: Vec3) -> LobeValues {
        self.view(wo).eval(wi).0
    }

    /// Density with which [`Bsdf::sample`] returns `wi` from a lobe that is no delta, 1/sr.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.view(wo).eval(wi).1
    }

    /// Samples a direction: `u_lobe` picks the lobe, `u` the direction in it. `None`: the light is absorbed.
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        self.view(wo).sample(u_lobe, u)
    }

    /// Directional albedo, the share of light from all sides that leaves along `wo`; transmission without its 1/η² scale.
    pub fn albedo(&self, wo: Vec3) -> LobeValues {
        self.view(wo).albedo()
    }

    /// True when every lobe is a delta: light sampling cannot contribute.
    pub fn is_delta(&self) -> bool {
        self.base.is_delta()
            && self.glass.as_ref().is_none_or(Glass::is_delta)
            && self.coat.as_ref().is_none_or(Coat::is_delta)
            && self.sheen.is_none()
    }
}

impl BsdfView<'_> {
    /// [`Bsdf::f_cos`] and [`Bsdf::pdf`] at once.
    #[inline]
    pub fn eval(&self, wi: Vec3) -> (LobeValues, f32) {
        self.eval_mirrored(Vec3::new(wi.x, wi.y, wi.z * self.side))
    }

    /// [`Bsdf::f_cos`].
    pub fn f_cos(&self, wi: Vec3) -> LobeValues {
        self.eval(wi).0
    }

    /// [`Bsdf::pdf`].
    pub fn pdf(&self, wi: Vec3) -> f32 {
        self.eval(wi).1
    }

    #[inline]
    fn eval_mirrored(&self, wi: Vec3) -> (LobeValues, f32) {
        let (mut diffuse, mut specular, mut pdf) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        if wi.z > 0.0 {
            let facets = self.facets.pair(wi);
            let (d, s) = self.base.eval(&self.bsdf.base, wi, facets.as_ref());
            diffuse += d;
            specular += s;
            pdf += self.chances[DIFFUSE] * wi.z * std::f32::consts::FRAC_1_PI;
            if let Some(f) = &facets {
                pdf += self.chances[SPECULAR] * f.pdf;
                if let (Some(glass), Some(view)) = (&self.bsdf.glass, &self.glass) {
                    let (f_glass, pdf_glass) = view.reflect(glass, f);
                    specular += f_glass;
                    pdf += self.chances[GLASS] * pdf_glass;
                }
            }
            diffuse *= self.below;
            specular *= self.below;
            if let Some(view) = &self.coat {
                let (f_coat, pdf_coat) = view.eval(wi);
                specular += Vec3::splat(f_coat);
                pdf += self.chances[COAT] * pdf_coat;
            }
            if let (Some(sheen), Some(view)) = (&self.bsdf.sheen, &self.sheen) {
                specular += view.eval(sheen, self.wo, wi) * self.coat.as_ref().map_or(1.0, |c| c.below);
                pdf += self.chances[SHEEN] * 0.5 * std::f32::consts::FRAC_1_PI;
            }
        } else if wi.z < 0.0
            && let (Some(glass), Some(view)) = (&self.bsdf.glass, &self.glass)
        {
            let (f_glass, pdf_glass) = view.transmit(glass, &self.facets, wi);
            specular += f_glass * self.below;
            pdf += self.chances[GLASS] * pdf_glass;
        }
        (LobeValues::new(diffuse, specular), pdf)
    }

    /// [`Bsdf::sample`].
    #[inline]
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let (lobe, rest) = self.pick(u_lobe)?;
        let chance = self.chances[lobe];
        let (wi, kind, eta2) = match lobe {
            DIFFUSE => (kajo_sampling::warp::cosine_hemisphere(u), Lobe::DIFFUSE | Lobe::REFLECT, 1.0),
            SHEEN => (kajo_sampling::warp::uniform_hemisphere(u), Lobe::SPECULAR | Lobe::REFLECT, 1.0),
            SPECULAR => {
                if let Some(f) = self.base.delta(&self.bsdf.base) {
                    return Some(self.delta(Vec3::new(-self.wo.x, -self.wo.y, self.wo.z), f * self.below / chance, chance, 1.0));
                }
                (self.facets.reflect(u), Lobe::SPECULAR | Lobe::REFLECT, 1.0)
            }
            COAT => {
                let view = self.coat.as_ref()?;
                if let Some((wi, f)) = view.delta() {
                    return Some(self.delta(wi, Vec3::splat(f / chance), chance, 1.0)).filter(|s| s.wi.z * self.side > 0.0);
                }
                (view.sample(u), Lobe::SPECULAR | Lobe::REFLECT, 1.0)
            }
            _ => {
                let (glass, view) = (self.bsdf.glass.as_ref()?, self.glass.as_ref()?);
                if let Some(d) = view.sample_delta(glass, rest) {
                    let scale = self.below / (chance * d.chance);
                    return Some(self.delta(d.wi, d.value * scale, chance * d.chance, d.eta2));
                }
                let (wi, eta2) = view.sample(glass, &self.facets, rest, u)?;
                let direction = if wi.z > 0.0 { Lobe::REFLECT } else { Lobe::TRANSMIT };
                (wi, Lobe::SPECULAR | direction, eta2)
            }
        };
        // Samples that a lobe sends to its wrong side are absorbed.
        if kind.contains(Lobe::REFLECT) && wi.z <= 0.0 {
            return None;
        }
        let (values, pdf) = self.eval_mirrored(wi);
        if !(pdf > 0.0 && pdf.is_finite()) {
            return None;
        }
        Some(BsdfSample { wi: Vec3::new(wi.x, wi.y, wi.z * self.side), weight: values * (1.0 / pdf), pdf, lobe: kind, eta2 })
    }

    /// [`Bsdf::albedo`].
    pub fn albedo(&self) -> LobeValues {
        let (diffuse, mut specular) = self.base.albedo(&self.bsdf.base);
        if let (Some(glass), Some(view)) = (&self.bsdf.glass, &self.glass) {
            specular += view.albedo(glass);
        }
        let below_coat = self.coat.as_ref().map_or(1.0, |c| c.below);
        let outer = Vec3::splat(1.0 - below_coat)
            + self.bsdf.sheen.as_ref().zip(self.sheen.as_ref()).map_or(Vec3::ZERO, |(s, v)| v.albedo(s) * below_coat);
        LobeValues::new(diffuse * self.below, specular * self.below + outer)
    }

    /// The lobe that `u` falls into and a fresh uniform number made from the rest of `u`.
    #[inline]
    fn pick(&self, u: f32) -> Option<(usize, f32)> {
        let (mut low, mut last) = (0.0, None);
        for (lobe, &chance) in self.chances.iter().enumerate() {
            if chance > 0.0 {
                let rest = ((u - low) / chance).clamp(0.0, 1.0 - f32::EPSILON / 2.0);
                last = Some((lobe, rest));
                if u < low + chance {
                    return last;
                }
                low += chance;
            }
        }
        // Rounding left the sum of the chances below u.
        last
    }

    fn delta(&self, wi: Vec3, weight: Vec3, chance: f32, eta2: f32) -> BsdfSample {
        let direction = if wi.z > 0.0 { Lobe::REFLECT } else { Lobe::TRANSMIT };
        BsdfSample {
            wi: Vec3::new(wi.x, wi.y, wi.z * self.side),
            weight: LobeValues::new(Vec3::ZERO, weight),
            pdf: chance,
            lobe: Lobe::SPECULAR | Lobe::DELTA | direction,
            eta2,
        }
    }
}

/// Clamps to [0, 1]; NaN becomes 0.
#[inline]
fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// [`unit`] on each channel.
#[inline]
fn unit3(v: Vec3) -> Vec3 {
    Vec3::new(unit(v.x), unit(v.y), unit(v.z))
}
