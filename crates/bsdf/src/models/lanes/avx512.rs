//! Sixteen lanes: AVX-512 F.

use super::register::register;
use super::{Lanes, Values, functions};
use crate::models::{Evaluate, Real, V3};
use glam::Vec3;
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Sixteen numbers.
#[derive(Clone, Copy, Debug)]
pub(in crate::models) struct Avx512(__m512);

/// A bit for each lane.
#[derive(Clone, Copy, Debug)]
pub(in crate::models) struct Mask(__mmask16);

/// The values of all pairs.
pub(super) fn values(formula: &impl Evaluate<Avx512>, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
    #[target_feature(enable = "avx512f,avx2,fma")]
    fn with_features(formula: &impl Evaluate<Avx512>, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        formula.in_brief(Values { wi, wo, out });
    }
    // SAFETY: a formula over `Avx512` exists only where the processor has the instructions; see `Lanes`.
    unsafe { with_features(formula, wi, wo, out) }
}

register!(Avx512, Mask, add _mm512_add_ps, sub _mm512_sub_ps, mul _mm512_mul_ps, div _mm512_div_ps, sqrt _mm512_sqrt_ps, min _mm512_min_ps,
    max _mm512_max_ps, fmadd _mm512_fmadd_ps, splat _mm512_set1_ps);

impl Avx512 {
    #[inline(always)]
    fn with_flipped_signs(self) -> Self {
        // SAFETY: the processor has the instructions; see `Lanes`.
        Self(unsafe { _mm512_castsi512_ps(_mm512_xor_epi32(_mm512_castps_si512(self.0), _mm512_set1_epi32(i32::MIN))) })
    }
}

impl Mask {
    #[inline(always)]
    fn less(a: Avx512, b: Avx512) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn less_or_equal(a: Avx512, b: Avx512) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a.0, b.0) })
    }

    #[inline(always)]
    fn choose(self, yes: Avx512, no: Avx512) -> Avx512 {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Avx512(unsafe { _mm512_mask_blend_ps(self.0, no.0, yes.0) })
    }

    #[inline(always)]
    fn is_set_anywhere(self) -> bool {
        self.0 != 0
    }
}

impl BitAnd for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

/// For each of 16 lanes which of 32 numbers it takes, two registers side by side.
type Choice = [i32; 16];

/// Component `k` of 16 vectors from 48 numbers: first from the first two registers, then, where the vector lies beyond, from the third.
const fn of_vectors(k: usize) -> [Choice; 2] {
    let mut choices = [[0; 16]; 2];
    let mut lane = 0;
    while lane < 16 {
        let at = 3 * lane + k;
        if at < 32 {
            choices[0][lane] = at as i32;
            choices[1][lane] = lane as i32;
        } else {
            choices[1][lane] = (at - 32 + 16) as i32;
        }
        lane += 1;
    }
    choices
}

/// Register `r` of 48 numbers from the components of 16 vectors: x and y first, then z.
const fn of_components(r: usize) -> [Choice; 2] {
    let mut choices = [[0; 16]; 2];
    let mut lane = 0;
    while lane < 16 {
        let (vector, component) = ((16 * r + lane) / 3, (16 * r + lane) % 3);
        if component < 2 {
            choices[0][lane] = (vector + 16 * component) as i32;
            choices[1][lane] = lane as i32;
        } else {
            choices[1][lane] = (vector + 16) as i32;
        }
        lane += 1;
    }
    choices
}

const OF_VECTORS: [[Choice; 2]; 3] = [of_vectors(0), of_vectors(1), of_vectors(2)];
const OF_COMPONENTS: [[Choice; 2]; 3] = [of_components(0), of_components(1), of_components(2)];

impl Avx512 {
    /// From a and b, then from that and c.
    #[inline(always)]
    fn chosen([first, second]: &[Choice; 2], [a, b, c]: [Self; 3]) -> Self {
        // SAFETY: the processor has the instructions, see `Lanes`; a choice is 16 integers.
        unsafe {
            let early = _mm512_permutex2var_ps(a.0, _mm512_loadu_epi32(first.as_ptr()), b.0);
            Self(_mm512_permutex2var_ps(early, _mm512_loadu_epi32(second.as_ptr()), c.0))
        }
    }
}

impl Lanes for Avx512 {
    const WIDTH: usize = 16;

    #[inline(always)]
    fn round(self) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0) })
    }

    #[inline(always)]
    fn scaled(self, n: Self) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm512_scalef_ps(self.0, n.0) })
    }

    #[inline(always)]
    fn split(self) -> [Self; 2] {
        // SAFETY: the processor has the instructions; see `Lanes`.
        unsafe {
            let bits = _mm512_castps_si512(self.0);
            // The bits of √½: from there on the exponent counts.
            let exponent = _mm512_srai_epi32::<23>(_mm512_sub_epi32(bits, _mm512_set1_epi32(0x3f35_04f3)));
            let mantissa = _mm512_sub_epi32(bits, _mm512_slli_epi32::<23>(exponent));
            [Self(_mm512_castsi512_ps(mantissa)), Self(_mm512_cvtepi32_ps(exponent))]
        }
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        // SAFETY: the processor has the instructions; see `Lanes`.
        unsafe {
            let bit = _mm512_set1_epi32(i32::MIN);
            // Bit by bit: the sign's where `bit` is set, else the number's.
            let both = _mm512_ternarylogic_epi32::<0xca>(bit, _mm512_castps_si512(sign.0), _mm512_castps_si512(self.0));
            Self(_mm512_castsi512_ps(both))
        }
    }

    #[inline(always)]
    fn of_table(self, table: &[f32]) -> Self {
        assert!(!table.is_empty() && table.len() < 1 << 24, "a table of {} entries", table.len());
        let index = self.max(Self::zero()).min(Self::of((table.len() - 1) as f64));
        // SAFETY: the processor has the instructions, see `Lanes`; the maximum and the minimum leave nothing outside the table, and of NaN make 0.
        Self(unsafe { _mm512_i32gather_ps::<4>(_mm512_cvttps_epi32(index.0), table.as_ptr()) })
    }

    #[inline(always)]
    fn or_zero(self, mask: Mask) -> Self {
        // SAFETY: the processor has the instruction; see `Lanes`.
        Self(unsafe { _mm512_maskz_mov_ps(mask.0, self.0) })
    }

    #[inline(always)]
    fn load(from: &[Vec3]) -> V3<Self> {
        assert!(from.len() >= 16, "{} vectors", from.len());
        let from = from.as_ptr().cast::<f32>();
        // SAFETY: the processor has the instructions, see `Lanes`; 16 vectors are 48 numbers, and a `Vec3` is three.
        let rows = [0, 16, 32].map(|k| Self(unsafe { _mm512_loadu_ps(from.add(k)) }));
        let [x, y, z] = OF_VECTORS;
        V3::new(Self::chosen(&x, rows), Self::chosen(&y, rows), Self::chosen(&z, rows))
    }

    #[inline(always)]
    fn store(v: V3<Self>, to: &mut [Vec3]) {
        assert!(to.len() >= 16, "{} vectors", to.len());
        let to = to.as_mut_ptr().cast::<f32>();
        for (r, choice) in OF_COMPONENTS.iter().enumerate() {
            // SAFETY: the processor has the instructions, see `Lanes`; 16 vectors are 48 numbers, and a `Vec3` is three.
            unsafe { _mm512_storeu_ps(to.add(16 * r), Self::chosen(choice, v.to_array()).0) };
        }
    }
}
