//! Eight lanes: AVX2 and FMA.

use super::register::register;
use super::{Lanes, Values, functions};
use crate::models::{Evaluate, Real, V3};
use glam::Vec3;
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(in crate::models) struct Avx2(__m256);

/// All bits of a lane, or none.
#[derive(Clone, Copy, Debug)]
pub(in crate::models) struct Mask(__m256);

/// The values of all pairs.
pub(super) fn values(formula: &impl Evaluate<Avx2>, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
    #[target_feature(enable = "avx2,fma")]
    fn with_features(formula: &impl Evaluate<Avx2>, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        formula.in_brief(Values { wi, wo, out });
    }
    // SAFETY: a formula over `Avx2` exists only where the processor has the instructions; see `Lanes`.
    unsafe { with_features(formula, wi, wo, out) }
}

register!(Avx2, Mask, add _mm256_add_ps, sub _mm256_sub_ps, mul _mm256_mul_ps, div _mm256_div_ps, sqrt _mm256_sqrt_ps, min _mm256_min_ps,
    max _mm256_max_ps, fmadd _mm256_fmadd_ps, splat _mm256_set1_ps);

impl Avx2 {
    #[inline(always)]
    fn with_flipped_signs(self) -> Self {
        // SAFETY: the processor has the instructions; see `Lanes`.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_set1_ps(-0.0)) })
    }
}

impl Mask {
    #[inline(always)]
    fn less(a: Avx2, b: Avx2) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn less_or_equal(a: Avx2, b: Avx2) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn choose(self, yes: Avx2, no: Avx2) -> Avx2 {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Avx2(unsafe { _mm256_blendv_ps(no.0, yes.0, self.0) })
    }

    #[inline(always)]
    fn is_set_anywhere(self) -> bool {
        // SAFETY: the processor has the instruction; see `Lanes`.
        unsafe { _mm256_movemask_ps(self.0) != 0 }
    }
}

impl BitAnd for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm256_and_ps(self.0, other.0) })
    }
}

impl BitOr for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm256_or_ps(self.0, other.0) })
    }
}

impl Not for Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: the processor has the instructions; see `Lanes`.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1))) })
    }
}

impl Lanes for Avx2 {
    const WIDTH: usize = 8;

    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0) })
    }

    #[inline(always)]
    fn scaled(self, n: Self) -> Self {
        // Twice by half, so that neither factor leaves the range of exponents.
        let half = (n * Self::of(0.5)).round();
        let power = |n: Self| {
            // SAFETY: the processor has the instructions; see `Lanes`.
            Self(unsafe { _mm256_castsi256_ps(_mm256_slli_epi32::<23>(_mm256_add_epi32(_mm256_cvtps_epi32(n.0), _mm256_set1_epi32(127)))) })
        };
        self * power(half) * power(n - half)
    }

    #[inline(always)]
    fn split(self) -> [Self; 2] {
        // SAFETY: the processor has the instructions; see `Lanes`.
        unsafe {
            let bits = _mm256_castps_si256(self.0);
            // The bits of √½: from there on the exponent counts.
            let exponent = _mm256_srai_epi32::<23>(_mm256_sub_epi32(bits, _mm256_set1_epi32(0x3f35_04f3)));
            let mantissa = _mm256_sub_epi32(bits, _mm256_slli_epi32::<23>(exponent));
            [Self(_mm256_castsi256_ps(mantissa)), Self(_mm256_cvtepi32_ps(exponent))]
        }
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        // SAFETY: the processor has the instructions; see `Lanes`.
        unsafe {
            let bit = _mm256_set1_ps(-0.0);
            Self(_mm256_or_ps(_mm256_andnot_ps(bit, self.0), _mm256_and_ps(bit, sign.0)))
        }
    }

    #[inline(always)]
    fn of_table(self, table: &[f32]) -> Self {
        assert!(!table.is_empty() && table.len() < 1 << 24, "a table of {} entries", table.len());
        let index = self.max(Self::zero()).min(Self::of((table.len() - 1) as f64));
        // SAFETY: the processor has the instructions, see `Lanes`; the maximum and the minimum leave nothing outside the table, and of NaN make 0.
        Self(unsafe { _mm256_i32gather_ps::<4>(table.as_ptr(), _mm256_cvttps_epi32(index.0)) })
    }

    #[inline(always)]
    fn or_zero(self, mask: Mask) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm256_and_ps(self.0, mask.0) })
    }

    #[inline(always)]
    fn load(from: &[Vec3]) -> V3<Self> {
        assert!(from.len() >= 8, "{} vectors", from.len());
        let from = from.as_ptr().cast::<f32>();
        // SAFETY: the processor has the instructions, see `Lanes`; eight vectors are 24 numbers, and a `Vec3` is three.
        unsafe {
            let rows =
                |k: usize| _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(_mm_loadu_ps(from.add(k))), _mm_loadu_ps(from.add(k + 12)));
            // x0 y0 z0 x1 | y1 z1 x2 y2 | z2 x3 y3 z3, and the same for the upper four.
            let (a, b, c) = (rows(0), rows(4), rows(8));
            let xy = _mm256_shuffle_ps::<0b10_01_11_10>(b, c);
            let yz = _mm256_shuffle_ps::<0b01_00_10_01>(a, b);
            let x = _mm256_shuffle_ps::<0b10_00_11_00>(a, xy);
            let y = _mm256_shuffle_ps::<0b11_01_10_00>(yz, xy);
            let z = _mm256_shuffle_ps::<0b11_00_11_01>(yz, c);
            V3::new(Self(x), Self(y), Self(z))
        }
    }

    #[inline(always)]
    fn store(v: V3<Self>, to: &mut [Vec3]) {
        assert!(to.len() >= 8, "{} vectors", to.len());
        let to = to.as_mut_ptr().cast::<f32>();
        // SAFETY: the processor has the instructions, see `Lanes`; eight vectors are 24 numbers, and a `Vec3` is three.
        unsafe {
            let xy = _mm256_shuffle_ps::<0b10_00_10_00>(v.x.0, v.y.0);
            let yz = _mm256_shuffle_ps::<0b11_01_11_01>(v.y.0, v.z.0);
            let zx = _mm256_shuffle_ps::<0b11_01_10_00>(v.z.0, v.x.0);
            let a = _mm256_shuffle_ps::<0b10_00_10_00>(xy, zx);
            let b = _mm256_shuffle_ps::<0b11_01_10_00>(yz, xy);
            let c = _mm256_shuffle_ps::<0b11_01_11_01>(zx, yz);
            // Lower halves first, then upper ones.
            _mm256_storeu_ps(to, _mm256_permute2f128_ps::<0x20>(a, b));
            _mm256_storeu_ps(to.add(8), _mm256_permute2f128_ps::<0x30>(c, a));
            _mm256_storeu_ps(to.add(16), _mm256_permute2f128_ps::<0x31>(b, c));
        }
    }
}
