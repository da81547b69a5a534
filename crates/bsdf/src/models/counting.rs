//! A number that counts what is done with it: the cost of an equation in operations, for any model written over [`Real`].

use super::Real;
use std::cell::Cell;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// How often each operation was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Operations {
    /// Additions and subtractions.
    pub add: u32,
    pub mul: u32,
    pub div: u32,
    pub sqrt: u32,
    /// exp, ln and the error function.
    pub exp: u32,
    pub pow: u32,
    /// Sines, cosines and their inverses.
    pub trig: u32,
    /// Comparisons, minima, maxima, choices, changes of sign.
    pub compare: u32,
}

impl AddAssign for Operations {
    fn add_assign(&mut self, other: Self) {
        self.add += other.add;
        self.mul += other.mul;
        self.div += other.div;
        self.sqrt += other.sqrt;
        self.exp += other.exp;
        self.pow += other.pow;
        self.trig += other.trig;
        self.compare += other.compare;
    }
}

impl Operations {
    const NONE: Self = Self { add: 0, mul: 0, div: 0, sqrt: 0, exp: 0, pow: 0, trig: 0, compare: 0 };

    /// Runs `f` and returns its result with the operations it did on [`Counted`] numbers in this thread.
    pub fn of<R>(f: impl FnOnce() -> R) -> (R, Self) {
        let before = COUNTS.replace(Self::NONE);
        let result = f();
        let during = COUNTS.get();
        let mut all = before;
        all += during;
        COUNTS.set(all);
        (result, during)
    }

    /// Is it only additions, multiplications and divisions (and what is free: comparisons, signs)?
    pub fn is_rational(&self) -> bool {
        self.sqrt + self.exp + self.pow + self.trig == 0
    }
}

thread_local! {
    static COUNTS: Cell<Operations> = const { Cell::new(Operations::NONE) };
}

fn count(operation: fn(&mut Operations)) {
    let mut counts = COUNTS.get();
    operation(&mut counts);
    COUNTS.set(counts);
}

/// An `f64` whose operations are counted; see [`Operations::of`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted(pub f64);

/// The answer of a comparison of [`Counted`] numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CountedMask(bool);

macro_rules! operator {
    ($trait:ident, $method:ident, $field:ident) => {
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                count(|c| c.$field += 1);
                Self($trait::$method(self.0, other.0))
            }
        }
    };
}
operator!(Add, add, add);
operator!(Sub, sub, add);
operator!(Mul, mul, mul);
operator!(Div, div, div);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        count(|c| c.compare += 1);
        Self(-self.0)
    }
}

impl BitAnd for CountedMask {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for CountedMask {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for CountedMask {
    type Output = Self;
    fn not(self) -> Self {
        Self(!self.0)
    }
}

macro_rules! functions {
    ($($name:ident $field:ident;)*) => {
        $(fn $name(self) -> Self {
            count(|c| c.$field += 1);
            Self(Real::$name(self.0))
        })*
    };
}

macro_rules! functions_of_two {
    ($($name:ident $field:ident;)*) => {
        $(fn $name(self, other: Self) -> Self {
            count(|c| c.$field += 1);
            Self(Real::$name(self.0, other.0))
        })*
    };
}

impl Real for Counted {
    type Mask = CountedMask;

    fn of(value: f64) -> Self {
        Self(value)
    }

    functions! {
        sqrt sqrt;
        exp exp;
        ln exp;
        erfc exp;
        sin trig;
        cos trig;
        acos trig;
        abs compare;
    }

    functions_of_two! {
        powf pow;
        atan2 trig;
        min compare;
        max compare;
    }

    /// The position, two entries' difference, and the line between them: a change of type costs nothing.
    fn interpolate(self, table: &[f32]) -> Self {
        count(|c| {
            c.add += 3;
            c.mul += 2;
        });
        Self(self.0.interpolate(table))
    }

    fn lt(self, other: Self) -> CountedMask {
        count(|c| c.compare += 1);
        CountedMask(self.0 < other.0)
    }

    fn le(self, other: Self) -> CountedMask {
        count(|c| c.compare += 1);
        CountedMask(self.0 <= other.0)
    }

    fn select(mask: CountedMask, yes: Self, no: Self) -> Self {
        count(|c| c.compare += 1);
        if mask.0 { yes } else { no }
    }

    fn any(mask: CountedMask) -> bool {
        mask.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::Form;
    use crate::models::blocks::{distribution, fresnel, highlight, masking};
    use crate::models::testing::{SETS, directions, model};

    fn rational(add: u32, mul: u32, div: u32) -> Operations {
        Operations { add, mul, div, ..Operations::NONE }
    }

    /// Row BR-35: (2.13), (3.4), (3.7) and (3.14) cost what their author says.
    #[test]
    fn schlicks_functions_cost_what_he_says() {
        let [x, a, b] = [0.7, 0.2, 0.8].map(Counted);
        assert_eq!(Operations::of(|| highlight::schlick(x, a)).1, rational(2, 1, 1), "(2.13)");
        assert_eq!(Operations::of(|| masking::schlick(x, a, b)).1, rational(1, 1, 1), "(3.4)");
        assert_eq!(Operations::of(|| distribution::schlick(x, a, b)).1, rational(1, 4, 1), "(3.7)");
        assert_eq!(Operations::of(|| fresnel::schlick(x, a, b)).1, rational(2, 4, 0), "(3.14)");
        assert_ne!(Operations::of(|| fresnel::schlick(x, a, b) * x).1, rational(2, 4, 0), "planted fault");
        assert!(!Operations::of(|| fresnel::conductor(x, a, b)).1.is_rational(), "roots");
    }

    /// Row BR-18: no exponential, power or angle, and no root after the half vector.
    #[test]
    fn schlick_cook_torrance_is_rational() {
        let (wi, wo) = directions(SETS[0].1);
        let cost = |id| model(id, &[], Form::Corrected).operations(wi, wo).unwrap();
        assert!(cost("schlick-cook-torrance").is_rational(), "{:?}", cost("schlick-cook-torrance"));
        assert!(!cost("cook-torrance").is_rational(), "{:?}", cost("cook-torrance"));
        assert!(!cost("torrance-sparrow").is_rational());
    }

    #[test]
    fn counting_does_not_change_values_and_nests() {
        let (sum, outer) = Operations::of(|| {
            let (inner, counted) = Operations::of(|| Counted(2.0) * Counted(3.0));
            assert_eq!(counted, rational(0, 1, 0));
            inner + Counted(1.0)
        });
        assert_eq!((sum, outer), (Counted(7.0), rational(1, 1, 0)));
        let (wi, wo) = directions(SETS[1].1);
        // One that is made of other code than equations over numbers, or of tables, cannot be counted.
        let counted = |id| model(id, &[], Form::Corrected).operations(wi, wo);
        for id in ["phong", "torrance-sparrow", "htsg", "ward", "ashikhmin-shirley"] {
            assert!(counted(id).unwrap().mul > 5, "{id}: {:?}", counted(id));
        }
        assert_eq!((counted("lambert"), counted("principled")), (Some(Operations::NONE), None));
    }
}
