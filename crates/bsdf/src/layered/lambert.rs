//! A plain Lambert surface seen from one direction: what [`BsdfView`](super::BsdfView) comes to, bit for bit, when nothing else is there.

use super::{Bsdf, BsdfSample, Lobe, LobeValues};
use glam::{Vec2, Vec3};
use kajo_sampling::warp::cosine_hemisphere;
use std::f32::consts::FRAC_1_PI;

/// Reflects ρ/π on both sides.
#[derive(Clone, Copy, Debug)]
pub struct LambertView {
    /// ρ/π.
    scale: Vec3,
    /// −1 when the back is seen, else 1.
    side: f32,
    /// 0 for a black surface, else 1.
    chance: f32,
}

impl Bsdf {
    /// Seen from `wo` like [`Bsdf::view`]; `None` unless the diffuse lobe is all there is.
    #[inline(always)]
    pub fn lambert_view(&self, wo: Vec3) -> Option<LambertView> {
        let (scale, chance) = self.lambert?;
        Some(LambertView { scale, side: if wo.z < 0.0 { -1.0 } else { 1.0 }, chance })
    }
}

impl LambertView {
    /// [`BsdfView::eval`](super::BsdfView::eval).
    #[inline(always)]
    pub fn eval(&self, wi: Vec3) -> (LobeValues, f32) {
        self.eval_mirrored(wi.z * self.side)
    }

    #[inline(always)]
    fn eval_mirrored(&self, cos: f32) -> (LobeValues, f32) {
        if cos > 0.0 { (LobeValues::new(self.scale * cos, Vec3::ZERO), self.chance * cos * FRAC_1_PI) } else { (LobeValues::ZERO, 0.0) }
    }

    /// [`BsdfView::sample`](super::BsdfView::sample): there is one lobe, so nothing to choose.
    #[inline(always)]
    pub fn sample(&self, u: Vec2) -> Option<BsdfSample> {
        if self.chance == 0.0 {
            return None;
        }
        let wi = cosine_hemisphere(u);
        let (values, pdf) = self.eval_mirrored(wi.z);
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: values * (1.0 / pdf), pdf, lobe: Lobe::DIFFUSE | Lobe::REFLECT, eta2: 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MaterialParams;
    use kajo_sampling::{Rng, warp::uniform_sphere};
    use kajo_units::LinearRgb;

    fn matte(color: Vec3) -> MaterialParams {
        MaterialParams { base_color: LinearRgb(color), metallic: 0.0, specular: 0.0, ..MaterialParams::default() }
    }

    #[test]
    fn equals_the_layered_view_bit_for_bit() {
        let mut rng = Rng::new(3);
        for color in [Vec3::ZERO, Vec3::ONE, Vec3::new(0.8, 0.3, 0.0), Vec3::new(1e-30, 0.0, 0.0)] {
            let bsdf = Bsdf::new(&matte(color));
            for _ in 0..1000 {
                let (wo, wi) = (uniform_sphere(rng.next_2d()), uniform_sphere(rng.next_2d()));
                let (view, lambert) = (bsdf.view(wo), bsdf.lambert_view(wo).expect("nothing but diffuse"));
                assert_eq!(lambert.eval(wi), view.eval(wi));
                let (lobe, u) = (rng.next_1d(), rng.next_2d());
                assert_eq!(lambert.sample(u), view.sample(lobe, u));
            }
        }
    }

    #[test]
    fn is_refused_by_every_material_with_another_lobe() {
        let base = matte(Vec3::splat(0.5));
        let others = [
            MaterialParams { specular: 0.1, ..base },
            MaterialParams { metallic: 0.1, ..base },
            MaterialParams { transmission: 0.1, ..base },
            MaterialParams { clearcoat: 0.1, ..base },
            MaterialParams { sheen_color: LinearRgb::splat(0.1), ..base },
        ];
        for params in others {
            assert!(Bsdf::new(&params).lambert_view(Vec3::Z).is_none(), "{params:?}");
        }
    }
}
