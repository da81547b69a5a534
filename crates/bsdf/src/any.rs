//! The BSDF of a surface, whichever it is: glTF's layered material, or a model of the library.

use crate::models::Reflectance;
use crate::{Bsdf, BsdfSample, BsdfView, LambertView, Lobe, LobeValues};
use glam::{Vec2, Vec3};
use kajo_units::LinearRgb;
use std::sync::Arc;

/// A surface's BSDF. A model reflects on both sides alike and transmits nothing.
#[derive(Clone)]
#[allow(clippy::large_enum_variant, reason = "one is made a material or a hit, and never moved after")]
pub enum AnyBsdf {
    /// glTF's material.
    Layered(Bsdf),
    /// A model of the library.
    Model(Arc<dyn Reflectance>),
}

/// [`AnyBsdf`] seen from one direction.
#[allow(clippy::large_enum_variant, reason = "it lives on the stack of one bounce")]
pub enum AnyBsdfView<'a> {
    /// glTF's material where it is plain Lambert.
    Lambert(LambertView),
    /// glTF's material.
    Layered(BsdfView<'a>),
    /// A model of the library.
    Model(ModelView<'a>),
}

/// A model seen from one direction.
pub struct ModelView<'a> {
    model: &'a dyn Reflectance,
    /// On the side of the normal.
    wo: Vec3,
    /// −1 when the back is seen, else 1.
    side: f32,
    /// Reflectance of the mirror part, and the chance to sample it.
    mirror: Vec3,
    mirror_chance: f32,
}

impl AnyBsdf {
    /// [`Bsdf::view`].
    #[inline(always)]
    pub fn view(&self, wo: Vec3) -> AnyBsdfView<'_> {
        match self {
            Self::Layered(bsdf) => match bsdf.lambert_view(wo) {
                Some(view) => AnyBsdfView::Lambert(view),
                None => AnyBsdfView::Layered(bsdf.view(wo)),
            },
            Self::Model(model) => AnyBsdfView::Model(ModelView::new(&**model, wo)),
        }
    }

    /// [`Bsdf::is_delta`].
    #[inline(always)]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Layered(bsdf) => bsdf.is_delta(),
            Self::Model(_) => false,
        }
    }
}

impl AnyBsdfView<'_> {
    /// [`BsdfView::eval`].
    #[inline(always)]
    pub fn eval(&self, wi: Vec3) -> (LobeValues, f32) {
        match self {
            Self::Lambert(view) => view.eval(wi),
            Self::Layered(view) => view.eval(wi),
            Self::Model(view) => view.eval(wi),
        }
    }

    /// [`BsdfView::sample`].
    #[inline(always)]
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        match self {
            Self::Lambert(view) => view.sample(u),
            Self::Layered(view) => view.sample(u_lobe, u),
            Self::Model(view) => view.sample(u_lobe, u),
        }
    }
}

impl<'a> ModelView<'a> {
    fn new(model: &'a dyn Reflectance, wo: Vec3) -> Self {
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let wo = Vec3::new(wo.x, wo.y, wo.z * side);
        let mirror = model.mirror(wo.as_dvec3()).as_vec3();
        // The mirror part against the rest: by its reflectance, and never all.
        let mirror_chance = if mirror == Vec3::ZERO { 0.0 } else { (mirror.element_sum() / 3.0).clamp(0.05, 0.9) };
        Self { model, wo, side, mirror, mirror_chance }
    }

    /// Value and density without the mirror part.
    fn eval(&self, wi: Vec3) -> (LobeValues, f32) {
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        if wi.z <= 0.0 {
            return (LobeValues::ZERO, 0.0);
        }
        (self.split(self.model.rendered_f_cos(wi, self.wo)), (1.0 - self.mirror_chance) * self.model.pdf_f32(wi, self.wo))
    }

    fn sample(&self, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if u_lobe < self.mirror_chance {
            let wi = Vec3::new(-self.wo.x, -self.wo.y, self.wo.z * self.side);
            let weight = LobeValues { specular: LinearRgb(self.mirror / self.mirror_chance), ..LobeValues::ZERO };
            return Some(BsdfSample { wi, weight, pdf: self.mirror_chance, lobe: Lobe::SPECULAR | Lobe::DELTA | Lobe::REFLECT, eta2: 1.0 });
        }
        let rest = ((u_lobe - self.mirror_chance) / (1.0 - self.mirror_chance)).min(1.0 - f32::EPSILON / 2.0);
        let wi = self.model.sample_f32(self.wo, [rest, u.x, u.y])?;
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        let (value, pdf) = self.eval(wi);
        let kind = if self.model.is_diffuse() { Lobe::DIFFUSE } else { Lobe::SPECULAR };
        (pdf > 0.0 && pdf.is_finite()).then(|| BsdfSample { wi, weight: value * (1.0 / pdf), pdf, lobe: kind | Lobe::REFLECT, eta2: 1.0 })
    }

    /// A model is diffuse or specular as a whole: few say where one ends and the other begins.
    fn split(&self, value: Vec3) -> LobeValues {
        if self.model.is_diffuse() {
            LobeValues { diffuse: LinearRgb(value), ..LobeValues::ZERO }
        } else {
            LobeValues { specular: LinearRgb(value), ..LobeValues::ZERO }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::{Form, find};
    use kajo_sampling::{Rng, warp};

    /// The mean of f cos/pdf over the samples of a view is the albedo, on both sides, and equals the layered material for Lambert.
    #[test]
    fn a_model_is_sampled_as_the_layered_material_is() {
        let lambert = AnyBsdf::Model(find("lambert").unwrap().from_pairs(&[("kd", "0.2,0.4,0.8")], Form::Corrected).unwrap());
        let mut rng = Rng::new(4);
        for wo in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.6, 0.0, -0.8)] {
            let view = lambert.view(wo);
            let mut sum = Vec3::ZERO;
            for _ in 0..1000 {
                let sample = view.sample(rng.next_1d(), rng.next_2d()).unwrap();
                assert!(sample.wi.z * wo.z > 0.0 && sample.lobe.contains(Lobe::DIFFUSE));
                let (value, pdf) = view.eval(sample.wi);
                assert!((value.total().0 / pdf).abs_diff_eq(sample.weight.total().0, 1e-5));
                sum += sample.weight.total().0;
            }
            assert!((sum / 1000.0).abs_diff_eq(Vec3::new(0.2, 0.4, 0.8), 1e-4), "{sum}");
            let through = warp::uniform_sphere(rng.next_2d());
            let below = Vec3::new(through.x, through.y, -through.z.abs() * wo.z.signum());
            assert_eq!(view.eval(below), (LobeValues::ZERO, 0.0));
        }
    }
}
