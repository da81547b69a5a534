//! [`Real`](crate::models::Real) for a register, from its instructions: once for both widths.

/// Implements the operators and [`Real`](crate::models::Real) for `$lanes`, a wrapper of a register, by the named instructions.
macro_rules! register {
    ($lanes:ident, $mask:ident, add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident, sqrt $sqrt:ident, min $min:ident, max $max:ident,
     fmadd $fmadd:ident, splat $splat:ident) => {
        register!(operator $lanes Add add $add);
        register!(operator $lanes Sub sub $sub);
        register!(operator $lanes Mul mul $mul);
        register!(operator $lanes Div div $div);

        impl Neg for $lanes {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                self.with_flipped_signs()
            }
        }

        impl Real for $lanes {
            type Mask = $mask;

            #[inline(always)]
            fn of(value: f64) -> Self {
                // SAFETY: the processor has the instruction; see `Lanes`.
                Self(unsafe { $splat(value as f32) })
            }
            #[inline(always)]
            fn flushed(self, least: f64) -> Self {
                self.or_zero(Self::of(least).le(self))
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                // SAFETY: the processor has the instruction; see `Lanes`.
                Self(unsafe { $fmadd(self.0, factor.0, addend.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: the processor has the instruction; see `Lanes`.
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn exp(self) -> Self {
                functions::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                functions::ln(self)
            }
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                functions::powf(self, exponent)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                functions::sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                functions::cos(self)
            }
            #[inline(always)]
            fn acos(self) -> Self {
                functions::acos(self)
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                functions::atan2(self, x)
            }
            #[inline(always)]
            fn erfc(self) -> Self {
                functions::erfc(self)
            }
            #[inline(always)]
            fn interpolate(self, table: &[f32]) -> Self {
                functions::interpolate(self, table)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.with_sign_of(Self::zero())
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // The second number where they do not compare, as in one number's `min`.
                // SAFETY: the processor has the instruction; see `Lanes`.
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // SAFETY: the processor has the instruction; see `Lanes`.
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask {
                $mask::less(self, other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask {
                $mask::less_or_equal(self, other)
            }
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                mask.choose(yes, no)
            }
            #[inline(always)]
            fn any(mask: $mask) -> bool {
                mask.is_set_anywhere()
            }
        }
    };
    (operator $lanes:ident $trait:ident $method:ident $instruction:ident) => {
        impl $trait for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the processor has the instruction; see `Lanes`.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}
pub(super) use register;
