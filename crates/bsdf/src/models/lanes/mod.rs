//! Several numbers side by side in one register: every formula on 8 lanes (AVX2) or 16 (AVX-512), from the one statement of its equation.
//!
//! [`Reflectance::values_f32`](super::Reflectance::values_f32) goes through here. The processor is asked once which instructions it has; where it has neither, pairs are evaluated one by
//! one. Rust compiles a formula for each set of instructions by inlining it into a function that enables them.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod functions;
#[cfg(target_arch = "x86_64")]
mod register;
#[cfg(all(test, target_arch = "x86_64"))]
mod tests;

use super::{Evaluate, Form, Geometry, Model, Real, Rgb, Task, V3};
use glam::Vec3;

/// The instructions that [`Reflectance::values_f32`](super::Reflectance::values_f32) uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// One number at a time, as the compiler's target has it.
    Scalar,
    /// 8 lanes: AVX2 and FMA.
    Avx2,
    /// 16 lanes: AVX-512 F.
    Avx512,
}

impl Instructions {
    /// The most lanes that this processor has.
    pub fn detect() -> Self {
        [Self::Avx512, Self::Avx2].into_iter().find(|set| set.are_supported()).unwrap_or(Self::Scalar)
    }

    /// Has this processor got them?
    pub fn are_supported(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Self::Avx2.are_supported() && is_x86_feature_detected!("avx512f"),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Numbers in a register.
    pub fn lanes(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Avx2 => 8,
            Self::Avx512 => 16,
        }
    }

    /// What people call them.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        }
    }
}

/// A formula ready for whole registers; its constants fill every lane.
pub(super) enum Wide<M: Model> {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Avx2(Box<M::Formula<avx2::Avx2>>),
    #[cfg(target_arch = "x86_64")]
    Avx512(Box<M::Formula<avx512::Avx512>>),
}

impl<M: Model> Wide<M> {
    /// For instructions that the processor has.
    pub fn new(params: &M::Params, form: Form, instructions: Instructions) -> Self {
        assert!(instructions.are_supported(), "{} on a processor without", instructions.name());
        match instructions {
            Instructions::Scalar => Self::Scalar,
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => Self::Avx2(Box::new(M::formula(params, form))),
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 => Self::Avx512(Box::new(M::formula(params, form))),
            #[cfg(not(target_arch = "x86_64"))]
            Instructions::Avx2 | Instructions::Avx512 => Self::Scalar,
        }
    }

    /// Fills `out`; the slices have one length. `false` where nothing was done because there are no lanes.
    pub fn values(&self, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) -> bool {
        match self {
            Self::Scalar => return false,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(formula) => avx2::values(&**formula, wi, wo, out),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(formula) => avx512::values(&**formula, wi, wo, out),
        }
        true
    }
}

/// A register of numbers: what the elementary functions need of it beyond [`Real`]. Values exist only on processors that have the instructions: what makes
/// them ([`Wide`]) has asked.
#[cfg(target_arch = "x86_64")]
trait Lanes: Real {
    /// How many.
    const WIDTH: usize;

    /// The nearest integers.
    fn round(self) -> Self;
    /// `self`·2ⁿ for integers n in [−250, 250].
    fn scaled(self, n: Self) -> Self;
    /// m in [√½, √2) and the integer n of `self` = m·2ⁿ, for normal numbers > 0.
    fn split(self) -> [Self; 2];
    /// |`self`| with the sign of `sign`.
    fn with_sign_of(self, sign: Self) -> Self;
    /// `table[self]` for integers; others are moved to the nearest index there is.
    fn of_table(self, table: &[f32]) -> Self;
    /// `self` where the mask is set, else 0.
    fn or_zero(self, mask: Self::Mask) -> Self;
    /// The first [`Lanes::WIDTH`] vectors.
    fn load(from: &[Vec3]) -> V3<Self>;
    /// Writes the first [`Lanes::WIDTH`] vectors.
    fn store(v: V3<Self>, to: &mut [Vec3]);
}

/// The values of all pairs; 0 unless both directions are above the surface.
#[cfg(target_arch = "x86_64")]
struct Values<'a> {
    wi: &'a [Vec3],
    wo: &'a [Vec3],
    out: &'a mut [Vec3],
}

#[cfg(target_arch = "x86_64")]
impl<L: Lanes> Task<L> for Values<'_> {
    #[inline(always)]
    fn run(self, formula: &impl Evaluate<L>) {
        let Self { wi, wo, out } = self;
        let whole = wi.len() / L::WIDTH * L::WIDTH;
        let blocks = wi[..whole].chunks_exact(L::WIDTH).zip(wo[..whole].chunks_exact(L::WIDTH));
        for ((wi, wo), out) in blocks.zip(out[..whole].chunks_exact_mut(L::WIDTH)) {
            block(formula, wi, wo, out);
        }
        let left = wi.len() - whole;
        if left > 0 {
            let [mut last_wi, mut last_wo, mut last_out] = [[Vec3::ZERO; 16]; 3];
            last_wi[..left].copy_from_slice(&wi[whole..]);
            last_wo[..left].copy_from_slice(&wo[whole..]);
            block(formula, &last_wi, &last_wo, &mut last_out);
            out[whole..].copy_from_slice(&last_out[..left]);
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn block<L: Lanes>(formula: &impl Evaluate<L>, wi: &[Vec3], wo: &[Vec3], out: &mut [Vec3]) {
    let (wi, wo) = (L::load(wi), L::load(wo));
    let above = L::zero().lt(wi.z) & L::zero().lt(wo.z);
    let value: Rgb<L> = formula.value(&Geometry::new(wi, wo));
    L::store(V3::new(value.x.or_zero(above), value.y.or_zero(above), value.z.or_zero(above)), out);
}
