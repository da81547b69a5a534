//! The number a formula is written over: `f32`, `f64`, several lanes of `f32` at once, or a type that counts operations.
//!
//! A model states its equation once, without branches on values ([`Real::select`] chooses), and is compiled for each of them.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// What a formula may do with a number.
#[allow(missing_docs, reason = "the names are those of the mathematical functions")]
pub trait Real:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The answer of a comparison.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// The nearest number to a constant.
    fn of(value: f64) -> Self;
    /// For numbers ≥ 0 of which those below `least` do not count: 0 in their place where a lane that underflows would hold up all others, 150 cycles each
    /// time.
    #[inline(always)]
    fn flushed(self, _least: f64) -> Self {
        self
    }
    /// self·factor + addend, rounded once where the hardware does that as fast.
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    fn sqrt(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    /// self^exponent for self ≥ 0; 0⁰ = 1.
    fn powf(self, exponent: Self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn acos(self) -> Self;
    fn atan2(self, x: Self) -> Self;
    /// Complementary error function.
    fn erfc(self) -> Self;
    /// The value at `self` in [0, 1] of a function tabulated at equal steps from 0 to 1, linear between; `table` has two entries or more.
    fn interpolate(self, table: &[f32]) -> Self;
    fn abs(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is set, else `no`; both are evaluated.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Is the mask set anywhere?
    fn any(mask: Self::Mask) -> bool;

    #[inline(always)]
    fn zero() -> Self {
        Self::of(0.0)
    }

    #[inline(always)]
    fn one() -> Self {
        Self::of(1.0)
    }

    #[inline(always)]
    fn clamp(self, low: f64, high: f64) -> Self {
        self.max(Self::of(low)).min(Self::of(high))
    }

    #[inline(always)]
    fn powi(self, exponent: u32) -> Self {
        let mut product = Self::one();
        for _ in 0..exponent {
            product = product * self;
        }
        product
    }

    /// self² — a multiplication.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
}

/// One number, as samplers need it: it can be compared and branched on.
pub trait Scalar: Real<Mask = bool> + PartialOrd + Into<f64> {}

macro_rules! real {
    ($t:ty, $erfc:path) => {
        impl Real for $t {
            type Mask = bool;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline(always)]
            fn exp(self) -> Self {
                self.exp()
            }
            #[inline(always)]
            fn ln(self) -> Self {
                self.ln()
            }
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                self.powf(exponent)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                self.sin()
            }
            #[inline(always)]
            fn cos(self) -> Self {
                self.cos()
            }
            #[inline(always)]
            fn acos(self) -> Self {
                self.acos()
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                self.atan2(x)
            }
            #[inline(always)]
            fn erfc(self) -> Self {
                $erfc(self)
            }
            #[inline(always)]
            fn interpolate(self, table: &[f32]) -> Self {
                let x = self * (table.len() - 1) as $t;
                let i = (x as usize).min(table.len() - 2);
                let [low, high] = [table[i], table[i + 1]].map(<$t>::from);
                low + (high - low) * (x - i as $t)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn any(mask: bool) -> bool {
                mask
            }
        }

        impl Scalar for $t {}
    };
}
real!(f32, libm::erfcf);
real!(f64, libm::erfc);
