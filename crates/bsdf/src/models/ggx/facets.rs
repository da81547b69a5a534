//! D V of GGX facets, without the half vector: with u = Θ_i + Θ_r, which is the half vector times |u|, one division is enough.
//!
//! ```text
//! D V = |u|⁴/(2π α_x α_y (u_x²/α_x² + u_y²/α_y² + u_z²)² (cos θ_i s(Θ_r) + cos θ_r s(Θ_i))),    cos β = |u|/2
//! s(v) = √(α_x² v_x² + α_y² v_y² + v_z²);  for α_x = α_y = α, √(α² + (1 − α²) v_z²)             [Walter07] eq. 33, [Heitz14] eq. 99
//! ```

use crate::models::{Geometry, Real, V3};
use std::f64::consts::PI;

/// Their widths, prepared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facets<T> {
    alpha2: [T; 2],
    inverse_alpha2: [T; 2],
    /// 1 − α_x².
    rest: T,
    /// 1/(2π α_x α_y).
    scale: T,
}

impl<T: Real> Facets<T> {
    /// Of these widths, in (0, 1].
    pub fn new(alpha_x: f64, alpha_y: f64) -> Self {
        Self {
            alpha2: [alpha_x, alpha_y].map(|a| T::of(a * a)),
            inverse_alpha2: [alpha_x, alpha_y].map(|a| T::of(1.0 / (a * a))),
            rest: T::of(1.0 - alpha_x * alpha_x),
            scale: T::of(0.5 / (PI * alpha_x * alpha_y)),
        }
    }

    /// cos β and D V in 1/sr; `ISOTROPIC` where α_x = α_y is known.
    #[inline(always)]
    pub fn at<const ISOTROPIC: bool>(&self, g: &Geometry<T>) -> (T, T) {
        let u = g.wi + g.wo;
        let (x2, y2, z2) = (u.x.squared(), u.y.squared(), u.z.squared());
        // Guard: where both directions are within 1e-6 of the surface, the squares would leave the range of f32.
        let least = T::of(1e-12);
        let (length2, spread) = if ISOTROPIC {
            let plane = x2 + y2;
            (plane + z2, plane.mul_add(self.inverse_alpha2[0], z2))
        } else {
            (x2 + y2 + z2, x2.mul_add(self.inverse_alpha2[0], y2.mul_add(self.inverse_alpha2[1], z2)))
        };
        let (length2, spread) = (length2.max(least), spread.max(least));
        let masking = g.cos_i().mul_add(self.stretched::<ISOTROPIC>(g.wo), g.cos_r() * self.stretched::<ISOTROPIC>(g.wi)).max(least);
        (T::of(0.5) * length2.sqrt(), length2.squared() * self.scale / (spread.squared() * masking))
    }

    /// s(v).
    #[inline(always)]
    fn stretched<const ISOTROPIC: bool>(&self, v: V3<T>) -> T {
        if ISOTROPIC {
            v.z.squared().mul_add(self.rest, self.alpha2[0]).sqrt()
        } else {
            v.x.squared().mul_add(self.alpha2[0], v.y.squared().mul_add(self.alpha2[1], v.z.squared())).sqrt()
        }
    }

    /// α_x², α_y² and 1/(π α_x α_y).
    pub fn constants(&self) -> [T; 3] {
        [self.alpha2[0], self.alpha2[1], T::of(2.0) * self.scale]
    }
}
