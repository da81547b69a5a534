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

#[cfg(test)]
mod tests {
    use super::super::testing::{SETS, directions};
    use super::*;

    /// Appendix C: cos θ_i, cos θ_r, cos α, cos β, cos δ, cos²φ_h of the sets A to E (cos²φ_h of E is free).
    const TABLE: [[f64; 6]; 5] = [
        [0.866_025_403_784, 0.766_044_443_119, 0.984_807_753_012, 0.819_152_044_289, 0.996_194_698_092, 1.0],
        [0.5, std::f64::consts::FRAC_1_SQRT_2, 0.747_178_804_772, 0.692_794_333_267, 0.871_186_962_149, 0.087_676_287_874_5],
        [0.984_807_753_012, 0.258_819_045_103, 0.254_887_002_244, 0.792_113_313_309, 0.785_005_615_496, 0.031_306_833_246_2],
        [0.642_787_609_687, 0.642_787_609_687, -0.173_648_177_667, 1.0, 0.642_787_609_687, 1.0],
        [0.342_020_143_326, 0.342_020_143_326, 1.0, 0.342_020_143_326, 1.0, f64::NAN],
    ];

    fn worst(factor: f64) -> f64 {
        SETS.iter().zip(TABLE).fold(0.0, |worst, ((_, angles), expected)| {
            let (wi, wo) = directions(*angles);
            let g = Geometry::<f64>::new(wi.into(), (wo * factor).into());
            let found = [g.cos_i(), g.cos_r(), g.cos_alpha(), g.cos_beta, g.cos_delta(), g.cos2_phi_h()];
            found.iter().zip(expected).filter(|(_, e)| !e.is_nan()).fold(worst, |worst, (f, e)| f64::max(worst, (f - e).abs()))
        })
    }

    /// Row BR-3.
    #[test]
    fn the_geometry_of_the_sets_is_tabulated() {
        assert!(worst(1.0) < 1e-12, "{:e}", worst(1.0));
        assert!(worst(1.0 + 1e-9) > 1e-12, "a viewer's vector that is not a unit vector is noticed");
    }

    /// Row BR-3: the printed half vector (Θ_i + Θ_r)/2 of length cos β would make the right side 2 cos²β cos δ.
    #[test]
    fn the_cosines_of_both_angles_sum_to_twice_the_half_vectors() {
        let mut rng = kajo_sampling::Rng::new(3);
        let mut next = || V3::<f64>::from_angles(rng.next_f64().acos(), std::f64::consts::TAU * rng.next_f64());
        let mut printed: f64 = 0.0;
        for _ in 0..100_000 {
            let g = Geometry::new(next(), next());
            let product = 2.0 * g.cos_beta * g.cos_delta();
            let sum = g.cos_i() + g.cos_r();
            assert!((sum - product).abs() < 1e-14, "{g:?}");
            printed = printed.max((sum - product * g.cos_beta).abs());
        }
        assert!(printed > 0.4);
    }

    /// Row BR-41: where the half vector is the normal, and where both directions are the same.
    #[test]
    fn degenerate_pairs_are_finite() {
        let up = V3::new(0.0_f64, 0.0, 1.0);
        let g = Geometry::new(up, up);
        assert_eq!([g.cos2_phi_h(), g.tan2_delta(), g.cos_alpha(), g.cos_beta], [1.0, 0.0, 1.0, 1.0]);
        let low = V3::from_angles(89.999_f64.to_radians(), 1.0);
        let g = Geometry::new(low, low);
        assert!(g.tan2_delta().is_finite() && (g.cos_beta - 1.0).abs() < 1e-15);
    }
}
