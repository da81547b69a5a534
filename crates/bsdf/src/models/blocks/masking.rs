//! Geometrical attenuation G: the share of facets that the viewer sees and the light reaches.
//!
//! ```text
//! v-groove  min(1, 2 cos δ cos θ_i/cos β, 2 cos δ cos θ_r/cos β)                               (3.1)    [Torrance67], [Blinn77]
//! smith     G(θ) = g/(g + 1),  g = √(hπ) e^h (2 − erfc √h),  h = cos²θ/(2 m² sin²θ)            (3.3)    [Smith67]
//! schlick   G(θ) = cos θ/(cos θ − k cos θ + k),  k = √(2m²/π)                                  (3.4)    [Schlick94survey]
//! ```
//!
//! Smith's and Schlick's are products G(θ_i) G(θ_r) (3.2). The printed Smith has no e^h, which makes G lower by up to 0.14. Where roughness is elliptic, a
//! direction of azimuth φ has m² = m_x² cos²φ + m_y² sin²φ.    \[Heitz14]

use crate::models::{Geometry, Real, V3};
use kajo_params::ParamChoice;
use std::f64::consts::{FRAC_2_PI, PI};

/// Which geometrical attenuation.
#[derive(ParamChoice, Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the module says it")]
pub enum Masking {
    VGroove,
    Smith,
    SmithPrinted,
    Schlick,
    None,
}

/// Attenuation (3.1), in [0, 1].
#[inline(always)]
pub fn v_groove<T: Real>(g: &Geometry<T>) -> T {
    let lower = g.cos_i().min(g.cos_r());
    (T::of(2.0) * g.cos_delta() * lower / g.cos_beta.max(T::of(1e-12))).min(T::one())
}

/// Smith's G(θ)/cos θ for a direction of inclination θ; `slope` = m sin θ. Finite at both ends: h = ∞ at the normal, 0 at the horizon.
#[inline(always)]
fn smith_over_cos<T: Real>(cos: T, slope: T, printed: bool) -> T {
    // √h = cos θ/(√2 m sin θ); beyond 100, e^{−h} is 0 in every precision.
    let root_h = (cos / (T::of(2.0_f64.sqrt()) * slope).max(T::of(1e-20))).min(T::of(100.0));
    let lost = T::of(FRAC_2_PI.sqrt()) * slope / (T::of(2.0) - root_h.erfc());
    let lost = if printed { lost } else { lost * (-root_h.squared()).exp() };
    T::one() / (cos + lost)
}

/// Smith's attenuation (3.3) of one direction, in [0, 1]; as printed, without e^h, or corrected.
#[inline(always)]
pub fn smith<T: Real>(cos: T, m: T, printed: bool) -> T {
    let sin = (T::one() - cos.squared()).max(T::zero()).sqrt();
    // At the horizon the limit is 0, at the normal 1.
    cos * smith_over_cos(cos, (m * sin).max(T::of(1e-20)), printed)
}

/// Schlick's attenuation (3.4) of one direction, in [0, 1]: 1 division, 1 multiplication, 1 addition with k and 1 − k prepared.
#[inline(always)]
pub fn schlick<T: Real>(cos: T, k: T, one_minus_k: T) -> T {
    cos / (cos * one_minus_k + k)
}

/// k = √(2m²/π) of (3.4).
pub fn schlick_k(m: f64) -> f64 {
    (2.0 / PI).sqrt() * m
}

/// G with its roughness.
#[derive(Clone, Copy, Debug)]
pub struct Attenuation<T> {
    kind: Masking,
    /// m_x², m_y².
    squares: [T; 2],
}

impl<T: Real> Attenuation<T> {
    /// m_x, m_y > 0.
    pub fn new(kind: Masking, mx: f64, my: f64) -> Self {
        Self { kind, squares: [mx, my].map(|m| T::of(m * m)) }
    }

    /// G/(cos θ_i cos θ_r), without division by a cosine that tends to 0 where G does, too.
    #[inline(always)]
    pub fn visibility(&self, g: &Geometry<T>) -> T {
        // At the floor f would overflow single precision; no pair of representable directions that are seen comes near.
        let floor = T::of(1e-20);
        let (ci, cr) = (g.cos_i(), g.cos_r());
        match self.kind {
            Masking::None => T::one() / (ci * cr).max(floor),
            Masking::VGroove => {
                let grooves = T::of(2.0) * g.cos_delta() / (g.cos_beta * ci.max(cr)).max(floor);
                (T::one() / (ci * cr).max(floor)).min(grooves)
            }
            Masking::Smith | Masking::SmithPrinted => {
                let printed = self.kind == Masking::SmithPrinted;
                smith_over_cos(ci, self.slope(g.wi), printed) * smith_over_cos(cr, self.slope(g.wo), printed)
            }
            Masking::Schlick => self.schlick_over_cos(g.wi) * self.schlick_over_cos(g.wo),
        }
    }

    /// Schlick's attenuation (3.4) of one direction over its cosine.
    #[inline(always)]
    fn schlick_over_cos(&self, w: V3<T>) -> T {
        let k = T::of(FRAC_2_PI.sqrt()) * self.roughness(w);
        T::one() / (w.z * (T::one() - k) + k)
    }

    /// m sin θ in the azimuth of `w`.
    #[inline(always)]
    fn slope(&self, w: V3<T>) -> T {
        (w.x.squared() * self.squares[0] + w.y.squared() * self.squares[1]).max(T::of(1e-36)).sqrt()
    }

    /// m in the azimuth of `w`; at the normal, where it does not matter, that along x.
    #[inline(always)]
    fn roughness(&self, w: V3<T>) -> T {
        let (x2, y2) = (w.x.squared(), w.y.squared());
        let flat = (x2 + y2).lt(T::of(1e-30));
        let weighted = (x2 * self.squares[0] + y2 * self.squares[1]) / T::select(flat, T::one(), x2 + y2);
        T::select(flat, self.squares[0], weighted).sqrt()
    }

    /// For the GPU's side: which kind, m_x², m_y².
    pub fn constants(&self) -> [T; 3] {
        [T::of(f64::from(self.kind as u32)), self.squares[0], self.squares[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::testing::{SETS, directions};

    fn geometry(angles: [f64; 4]) -> Geometry<f64> {
        let (wi, wo) = directions(angles);
        Geometry::new(wi.into(), wo.into())
    }

    /// Row BR-13: the table of section 3.6.
    #[test]
    fn smith_and_schlick_equal_the_table() {
        let table = [
            (30.0, [0.955_962_73, 1.0, 0.975_908_11, 0.878_374_05, 0.997_857_82, 0.931_046_77]),
            (60.0, [0.878_374_05, 0.997_857_82, 0.862_383_50, 0.667_429_29, 0.761_249_83, 0.676_255_64]),
            (80.0, [0.641_870_04, 0.725_543_84, 0.568_378_85, 0.311_986_14, 0.321_329_64, 0.305_048_27]),
            (89.0, [0.104_737_42, 0.105_095_07, 0.100_160_55, 0.035_965_57, 0.035_980_24, 0.035_775_73]),
        ];
        for (degrees, row) in table {
            let cos = f64::to_radians(degrees).cos();
            for (m, [printed, corrected, rational]) in [(0.2, [row[0], row[1], row[2]]), (0.6, [row[3], row[4], row[5]])] {
                let k = schlick_k(m);
                let values = [(smith(cos, m, true), printed), (smith(cos, m, false), corrected), (schlick(cos, k, 1.0 - k), rational)];
                for (value, expected) in values {
                    assert!((value - expected).abs() < 1e-7, "{degrees}°, m = {m}: {value} is not {expected}");
                }
            }
        }
        assert!((smith(0.5_f64, 0.2, true) - smith(0.5, 0.2, false)).abs() > 0.1, "planted fault: the two forms differ");
    }

    /// Row BR-13.
    #[test]
    fn v_grooves_equal_golden_values() {
        let golden = [1.0, 1.0, 0.512_993_281_1, 0.826_351_822_3, 1.0];
        for ((name, angles), expected) in SETS.iter().zip(golden) {
            let g = v_groove(&geometry(*angles));
            assert!((g - expected).abs() < 1e-10, "{name}: {g}");
        }
    }

    /// Row BR-13.
    #[test]
    fn attenuation_is_a_share_and_ends_at_one_and_zero() {
        for m in [0.001, 0.1, 0.2, 0.6, 2.0] {
            let k = schlick_k(m);
            for (one, at) in [
                (&(|cos| smith(cos, m, false)) as &dyn Fn(f64) -> f64, "smith"),
                (&|cos| smith(cos, m, true), "smith printed"),
                (&|cos| schlick(cos, k, 1.0 - k), "schlick"),
            ] {
                assert!((one(1.0) - 1.0).abs() < 1e-12 && one(0.0).abs() < 1e-12, "{at}");
                for i in 0..=1000 {
                    let g = one(f64::from(i) / 1000.0);
                    assert!((0.0..=1.0 + 1e-12).contains(&g), "{at} m = {m}: {g}");
                }
            }
        }
        for theta in 0..90 {
            for phi in [0.0, 60.0, 180.0] {
                let g = v_groove(&geometry([f64::from(theta), 0.0, 40.0, phi]));
                assert!((0.0..=1.0).contains(&g));
            }
        }
        assert!((v_groove(&geometry([0.0; 4])) - 1.0).abs() < 1e-12 && v_groove(&geometry([90.0, 0.0, 40.0, 0.0])) < 1e-12);
    }

    /// The form without division by small cosines is G/(cos θ_i cos θ_r).
    #[test]
    fn visibility_is_attenuation_over_the_cosines() {
        for (_, angles) in SETS {
            let g = geometry(angles);
            let (ci, cr, m) = (g.cos_i(), g.cos_r(), 0.3);
            let k = schlick_k(m);
            for (kind, expected) in [
                (Masking::VGroove, v_groove(&g)),
                (Masking::Smith, smith(ci, m, false) * smith(cr, m, false)),
                (Masking::SmithPrinted, smith(ci, m, true) * smith(cr, m, true)),
                (Masking::Schlick, schlick(ci, k, 1.0 - k) * schlick(cr, k, 1.0 - k)),
                (Masking::None, 1.0),
            ] {
                let value = Attenuation::new(kind, m, m).visibility(&g) * ci * cr;
                assert!((value - expected).abs() < 1e-12, "{kind:?}: {value} is not {expected}");
            }
        }
    }
}
