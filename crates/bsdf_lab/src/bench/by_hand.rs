//! Lambert and GGX written by hand in the processor's own instructions: the bar for what formulas over registers cost.
//!
//! They take and give the same slices as [`kajo_bsdf::models::Reflectance::values_f32`], and know what a formula in general does not: GGX here is isotropic,
//! reflects by Schlick's approximation and has nothing to give back. Its parameters are numbers at run time, as a material's are.

use glam::Vec3;
use kajo_bsdf::models::Instructions;
use std::f32::consts::{FRAC_1_PI, PI};

/// The defaults of `lambert` and `ggx`.
#[derive(Clone, Copy, Debug)]
pub struct Materials {
    /// Lambert's diffuse reflectance.
    pub kd: [f32; 3],
    /// The width of the slopes of GGX facets.
    pub alpha: f32,
    /// Their reflectance at normal incidence.
    pub f0: [f32; 3],
}

/// The defaults of the models.
pub const DEFAULTS: Materials = Materials { kd: [0.8; 3], alpha: 0.25, f0: [0.04; 3] };

/// A loop written by hand. All slices have one length, a multiple of 16.
pub type Loop = fn(&Materials, &[Vec3], &[Vec3], &mut [Vec3]);

/// The loop for this model by these instructions, where there is one.
pub fn by_hand(instructions: Instructions, id: &str) -> Option<Loop> {
    match (instructions, id) {
        #[cfg(target_arch = "x86_64")]
        (Instructions::Avx512, "lambert") if instructions.are_supported() && is_x86_feature_detected!("bmi2") => Some(avx512::lambert),
        #[cfg(target_arch = "x86_64")]
        (Instructions::Avx512, "ggx") if instructions.are_supported() => Some(avx512::ggx),
        #[cfg(target_arch = "x86_64")]
        (Instructions::Avx2, "lambert") if instructions.are_supported() => Some(avx2::lambert),
        #[cfg(target_arch = "x86_64")]
        (Instructions::Avx2, "ggx") if instructions.are_supported() => Some(avx2::ggx),
        _ => None,
    }
}

#[cfg(target_arch = "x86_64")]
mod avx512 {
    use super::{FRAC_1_PI, Materials, PI};
    use glam::Vec3;
    use std::arch::x86_64::*;

    pub fn lambert(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        assert!(wi.len() == wo.len() && wo.len() == out.len() && out.len().is_multiple_of(16), "whole registers");
        // SAFETY: `by_hand` asked for the instructions.
        unsafe { lambert_512(m, wi, wo, out) }
    }

    pub fn ggx(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        assert!(wi.len() == wo.len() && wo.len() == out.len() && out.len().is_multiple_of(16), "whole registers");
        // SAFETY: `by_hand` asked for the instructions.
        unsafe { ggx_512(m, wi, wo, out) }
    }

    /// Only the z are taken out; their signs are spread to three bits a vector, which choose among f's numbers.
    #[target_feature(enable = "avx512f,bmi2")]
    fn lambert_512(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        let f = m.kd.map(|k| k * FRAC_1_PI);
        let rows: [__m512; 3] = [0, 1, 2].map(|r| {
            let row: [f32; 16] = std::array::from_fn(|k| f[(16 * r + k) % 3]);
            // SAFETY: 16 numbers.
            unsafe { _mm512_loadu_ps(row.as_ptr()) }
        });
        let zero = _mm512_setzero_ps();
        for block in 0..out.len() / 16 {
            let [.., iz] = load(wi[16 * block..].as_ptr().cast());
            let [.., oz] = load(wo[16 * block..].as_ptr().cast());
            let to = out[16 * block..].as_mut_ptr().cast::<f32>();
            let above = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(iz, zero), oz, zero);
            let all = 7 * _pdep_u64(u64::from(above), 0x2492_4924_9249);
            for (k, row) in rows.iter().enumerate() {
                // SAFETY: a block is 16 vectors of three numbers.
                unsafe { _mm512_storeu_ps(to.add(16 * k), _mm512_maskz_mov_ps((all >> (16 * k)) as u16, *row)) };
            }
        }
    }

    /// Lane `l` of component `k` is number 3 l + k of 48.
    #[target_feature(enable = "avx512f")]
    fn load(from: *const f32) -> [__m512; 3] {
        // SAFETY: the caller has 48 numbers.
        let [a, b, c] = [0, 16, 32].map(|k| unsafe { _mm512_loadu_ps(from.add(k)) });
        [
            _mm512_permutex2var_ps(
                _mm512_permutex2var_ps(a, _mm512_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 0, 0, 0, 0, 0), b),
                _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 17, 20, 23, 26, 29),
                c,
            ),
            _mm512_permutex2var_ps(
                _mm512_permutex2var_ps(a, _mm512_setr_epi32(1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 31, 0, 0, 0, 0, 0), b),
                _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 18, 21, 24, 27, 30),
                c,
            ),
            _mm512_permutex2var_ps(
                _mm512_permutex2var_ps(a, _mm512_setr_epi32(2, 5, 8, 11, 14, 17, 20, 23, 26, 29, 0, 0, 0, 0, 0, 0), b),
                _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 19, 22, 25, 28, 31),
                c,
            ),
        ]
    }

    #[target_feature(enable = "avx512f")]
    fn store([x, y, z]: [__m512; 3], to: *mut f32) {
        let rows = [
            _mm512_permutex2var_ps(
                _mm512_permutex2var_ps(x, _mm512_setr_epi32(0, 16, 0, 1, 17, 0, 2, 18, 0, 3, 19, 0, 4, 20, 0, 5), y),
                _mm512_setr_epi32(0, 1, 16, 3, 4, 17, 6, 7, 18, 9, 10, 19, 12, 13, 20, 15),
                z,
            ),
            _mm512_permutex2var_ps(
                _mm512_permutex2var_ps(x, _mm512_setr_epi32(21, 0, 6, 22, 0, 7, 23, 0, 8, 24, 0, 9, 25, 0, 10, 26), y),
                _mm512_setr_epi32(0, 21, 2, 3, 22, 5, 6, 23, 8, 9, 24, 11, 12, 25, 14, 15),
                z,
            ),
            _mm512_permutex2var_ps(
                _mm512_permutex2var_ps(x, _mm512_setr_epi32(0, 11, 27, 0, 12, 28, 0, 13, 29, 0, 14, 30, 0, 15, 31, 0), y),
                _mm512_setr_epi32(26, 1, 2, 27, 4, 5, 28, 7, 8, 29, 10, 11, 30, 13, 14, 31),
                z,
            ),
        ];
        for (k, row) in rows.into_iter().enumerate() {
            // SAFETY: the caller has 48 numbers.
            unsafe { _mm512_storeu_ps(to.add(16 * k), row) };
        }
    }

    /// √x by an estimate of 1/√x and one step of Newton.
    #[target_feature(enable = "avx512f")]
    fn root(x: __m512) -> __m512 {
        let y = _mm512_rsqrt14_ps(x);
        let root = _mm512_mul_ps(x, y);
        let half = _mm512_mul_ps(root, _mm512_set1_ps(0.5));
        _mm512_fmadd_ps(_mm512_fnmadd_ps(half, y, _mm512_set1_ps(0.5)), root, root)
    }

    #[target_feature(enable = "avx512f")]
    fn ggx_512(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        let splat = |v: f32| _mm512_set1_ps(v);
        let zero = _mm512_setzero_ps();
        let (a2, one_minus_a2) = (splat(m.alpha * m.alpha), splat(1.0 - m.alpha * m.alpha));
        let inverse_a2 = splat(1.0 / (m.alpha * m.alpha));
        let scale = splat(0.5 / (PI * m.alpha * m.alpha));
        let f0 = m.f0.map(splat);
        let rest = m.f0.map(|f| splat(1.0 - f));
        for block in 0..out.len() / 16 {
            let [ix, iy, iz] = load(wi[16 * block..].as_ptr().cast());
            let [ox, oy, oz] = load(wo[16 * block..].as_ptr().cast());
            let above = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(iz, zero), oz, zero);
            let (x, y, z) = (_mm512_add_ps(ix, ox), _mm512_add_ps(iy, oy), _mm512_add_ps(iz, oz));
            let (plane, z2) = (_mm512_fmadd_ps(x, x, _mm512_mul_ps(y, y)), _mm512_mul_ps(z, z));
            let length2 = _mm512_add_ps(plane, z2);
            let spread = _mm512_fmadd_ps(plane, inverse_a2, z2);
            let stretched = |cos| root(_mm512_fmadd_ps(_mm512_mul_ps(cos, cos), one_minus_a2, a2));
            let masking = _mm512_fmadd_ps(iz, stretched(oz), _mm512_mul_ps(oz, stretched(iz)));
            let top = _mm512_mul_ps(_mm512_mul_ps(length2, length2), scale);
            let dv = _mm512_div_ps(top, _mm512_mul_ps(_mm512_mul_ps(spread, spread), masking));
            let t = _mm512_fnmadd_ps(root(length2), splat(0.5), splat(1.0));
            let t2 = _mm512_mul_ps(t, t);
            let t5 = _mm512_mul_ps(_mm512_mul_ps(t2, t2), t);
            let f = [0, 1, 2].map(|k| _mm512_maskz_mul_ps(above, _mm512_fmadd_ps(rest[k], t5, f0[k]), dv));
            store(f, out[16 * block..].as_mut_ptr().cast());
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{FRAC_1_PI, Materials, PI};
    use glam::Vec3;
    use std::arch::x86_64::*;

    pub fn lambert(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        assert!(wi.len() == wo.len() && wo.len() == out.len() && out.len().is_multiple_of(8), "whole registers");
        // SAFETY: `by_hand` asked for the instructions.
        unsafe { lambert_256(m, wi, wo, out) }
    }

    pub fn ggx(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        assert!(wi.len() == wo.len() && wo.len() == out.len() && out.len().is_multiple_of(8), "whole registers");
        // SAFETY: `by_hand` asked for the instructions.
        unsafe { ggx_256(m, wi, wo, out) }
    }

    /// x, y and z of eight vectors.
    #[target_feature(enable = "avx2,fma")]
    fn load(from: *const f32) -> [__m256; 3] {
        // SAFETY: the caller has 24 numbers.
        let [a, b, c] = [0, 4, 8].map(|k| unsafe { _mm256_loadu2_m128(from.add(k + 12), from.add(k)) });
        let xy = _mm256_shuffle_ps::<0b10_01_11_10>(b, c);
        let yz = _mm256_shuffle_ps::<0b01_00_10_01>(a, b);
        [_mm256_shuffle_ps::<0b10_00_11_00>(a, xy), _mm256_shuffle_ps::<0b11_01_10_00>(yz, xy), _mm256_shuffle_ps::<0b11_00_11_01>(yz, c)]
    }

    #[target_feature(enable = "avx2,fma")]
    fn store([x, y, z]: [__m256; 3], to: *mut f32) {
        let xy = _mm256_shuffle_ps::<0b10_00_10_00>(x, y);
        let yz = _mm256_shuffle_ps::<0b11_01_11_01>(y, z);
        let zx = _mm256_shuffle_ps::<0b11_01_10_00>(z, x);
        let a = _mm256_shuffle_ps::<0b10_00_10_00>(xy, zx);
        let b = _mm256_shuffle_ps::<0b11_01_10_00>(yz, xy);
        let c = _mm256_shuffle_ps::<0b11_01_11_01>(zx, yz);
        let rows = [_mm256_permute2f128_ps::<0x20>(a, b), _mm256_permute2f128_ps::<0x30>(c, a), _mm256_permute2f128_ps::<0x31>(b, c)];
        for (k, row) in rows.into_iter().enumerate() {
            // SAFETY: the caller has 24 numbers.
            unsafe { _mm256_storeu_ps(to.add(8 * k), row) };
        }
    }

    /// The z of both directions, then three masks of them.
    #[target_feature(enable = "avx2,fma")]
    fn lambert_256(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        let zero = _mm256_setzero_ps();
        let f = m.kd.map(|k| _mm256_set1_ps(k * FRAC_1_PI));
        for block in 0..out.len() / 8 {
            let [.., iz] = load(wi[8 * block..].as_ptr().cast());
            let [.., oz] = load(wo[8 * block..].as_ptr().cast());
            let above = _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(iz, zero), _mm256_cmp_ps::<_CMP_GT_OQ>(oz, zero));
            store(f.map(|f| _mm256_and_ps(above, f)), out[8 * block..].as_mut_ptr().cast());
        }
    }

    #[target_feature(enable = "avx2,fma")]
    fn ggx_256(m: &Materials, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
        let splat = |v: f32| _mm256_set1_ps(v);
        let zero = _mm256_setzero_ps();
        let (a2, one_minus_a2) = (splat(m.alpha * m.alpha), splat(1.0 - m.alpha * m.alpha));
        let inverse_a2 = splat(1.0 / (m.alpha * m.alpha));
        let scale = splat(0.5 / (PI * m.alpha * m.alpha));
        let f0 = m.f0.map(splat);
        let rest = m.f0.map(|f| splat(1.0 - f));
        for block in 0..out.len() / 8 {
            let [ix, iy, iz] = load(wi[8 * block..].as_ptr().cast());
            let [ox, oy, oz] = load(wo[8 * block..].as_ptr().cast());
            let above = _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(iz, zero), _mm256_cmp_ps::<_CMP_GT_OQ>(oz, zero));
            let (x, y, z) = (_mm256_add_ps(ix, ox), _mm256_add_ps(iy, oy), _mm256_add_ps(iz, oz));
            let (plane, z2) = (_mm256_fmadd_ps(x, x, _mm256_mul_ps(y, y)), _mm256_mul_ps(z, z));
            let length2 = _mm256_add_ps(plane, z2);
            let spread = _mm256_fmadd_ps(plane, inverse_a2, z2);
            let stretched = |cos| _mm256_sqrt_ps(_mm256_fmadd_ps(_mm256_mul_ps(cos, cos), one_minus_a2, a2));
            let masking = _mm256_fmadd_ps(iz, stretched(oz), _mm256_mul_ps(oz, stretched(iz)));
            let top = _mm256_mul_ps(_mm256_mul_ps(length2, length2), scale);
            let dv = _mm256_and_ps(above, _mm256_div_ps(top, _mm256_mul_ps(_mm256_mul_ps(spread, spread), masking)));
            let t = _mm256_fnmadd_ps(_mm256_sqrt_ps(length2), splat(0.5), splat(1.0));
            let t2 = _mm256_mul_ps(t, t);
            let t5 = _mm256_mul_ps(_mm256_mul_ps(t2, t2), t);
            let f = [0, 1, 2].map(|k| _mm256_mul_ps(_mm256_fmadd_ps(rest[k], t5, f0[k]), dv));
            store(f, out[8 * block..].as_mut_ptr().cast());
        }
    }
}
