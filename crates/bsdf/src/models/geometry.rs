//! The angles that reflectance models are written in.

use super::{Real, V3};

/// A pair of directions and what follows from it. The surface is seen and lit from above: callers answer 0 for the rest.
#[derive(Clone, Copy, Debug)]
pub struct Geometry<T> {
    /// To the light, Θ_i.
    pub wi: V3<T>,
    /// To the viewer, Θ_r.
    pub wo: V3<T>,
    /// Half vector Θ_h = (Θ_i + Θ_r)/|Θ_i + Θ_r|.
    pub h: V3<T>,
    /// cos β: between the half vector and either direction.
    pub cos_beta: T,
}

impl<T: Real> Geometry<T> {
    /// Of two unit vectors in the local frame, both away from the surface.
    #[inline(always)]
    pub fn new(wi: V3<T>, wo: V3<T>) -> Self {
        let h = (wi + wo).normalized();
        Self { wi, wo, h, cos_beta: h.dot(wo) }
    }

    /// cos θ_i.
    #[inline(always)]
    pub fn cos_i(&self) -> T {
        self.wi.z
    }

    /// cos θ_r.
    #[inline(always)]
    pub fn cos_r(&self) -> T {
        self.wo.z
    }

    /// cos δ: between the half vector and the normal.
    #[inline(always)]
    pub fn cos_delta(&self) -> T {
        self.h.z
    }

    /// cos α: between the viewer and the mirror direction of the light, in [−1, 1].
    #[inline(always)]
    pub fn cos_alpha(&self) -> T {
        T::of(2.0) * self.wi.z * self.wo.z - self.wi.dot(self.wo)
    }

    /// cos²φ_h, φ_h the azimuth of the half vector from the tangent x. Where the half vector is the normal, to
    /// 1e-7 rad, which is what f32 resolves, every azimuth is valid: 1.
    #[inline(always)]
    pub fn cos2_phi_h(&self) -> T {
        let (x2, y2) = (self.h.x.squared(), self.h.y.squared());
        let sum = x2 + y2;
        let degenerate = sum.le(T::of(1e-14));
        T::select(degenerate, T::one(), x2 / T::select(degenerate, T::one(), sum))
    }

    /// tan²δ, infinite at the horizon only.
    #[inline(always)]
    pub fn tan2_delta(&self) -> T {
        (self.h.x.squared() + self.h.y.squared()) / self.h.z.squared()
    }
}
