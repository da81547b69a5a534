//! The elementary functions on registers, in single precision.
//!
//! Each reduces its argument to a short interval and evaluates a polynomial there, fitted for the least largest relative error. Errors against double
//! precision, in units of the last place (tests beside this file hold them):
//!
//! ```text
//! exp 1 (0 for what is no normal number)    ln 1    powf 8    sin, cos 2 (|x| ≤ 7; to 10⁴ 1.5 in units of 1)    acos 2    atan2 2.5    erfc 7
//! ```

use super::Lanes;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, LN_2, LOG2_E, PI};

/// ln 2 in two parts: the first has 15 bits, so that its products with exponents are exact.
const LN_2_PARTS: [f64; 2] = [0.693_145_751_953_125, LN_2 - 0.693_145_751_953_125];

/// Below this e^x is 0: smaller numbers than the normal ones would cost the processor a hundred cycles each.
const LEAST_EXPONENT: f64 = -87.336_54;

/// Above, e^x is infinite in single precision.
const LARGEST_EXPONENT: f64 = 110.0;

/// The smallest normal number, 2⁻¹²⁶.
const SMALLEST: f64 = f32::MIN_POSITIVE as f64;

/// c[0] + c[1] x + …
#[inline(always)]
fn polynomial<L: Lanes, const N: usize>(x: L, c: [f64; N]) -> L {
    let mut sum = L::of(c[N - 1]);
    for k in (0..N - 1).rev() {
        sum = sum.mul_add(x, L::of(c[k]));
    }
    sum
}

#[inline(always)]
pub fn exp<L: Lanes>(x: L) -> L {
    exp_of_sum(x, L::zero())
}

/// e^(x + low), `low` small beside 1.
#[inline(always)]
fn exp_of_sum<L: Lanes>(x: L, low: L) -> L {
    // NaN stays: the minimum is its second number where they do not compare.
    let vanishes = (x + low).lt(L::of(LEAST_EXPONENT));
    let x = L::of(LARGEST_EXPONENT).min(L::select(vanishes, L::zero(), x));
    let n = (x * L::of(LOG2_E)).round();
    let r = n.mul_add(L::of(-LN_2_PARTS[1]), n.mul_add(L::of(-LN_2_PARTS[0]), x)) + low;
    let p = polynomial(r, [0.5, 0.166_666_66, 0.041_666_295, 0.008_333_497, 0.001_394_465, 0.000_197_903_57]);
    L::select(vanishes, L::zero(), (p.mul_add(r * r, r) + L::one()).scaled(n))
}

/// m − 1 and n of x = m·2ⁿ, and (ln m − (m − 1) + ½ (m − 1)²).
#[inline(always)]
fn ln_parts<L: Lanes>(x: L) -> [L; 3] {
    // Numbers below the normal ones have no exponent to read.
    let small = x.lt(L::of(SMALLEST));
    let [m, n] = L::select(small, x * L::of(f64::from(1 << 24)), x).split();
    let n = n - L::select(small, L::of(24.0), L::zero());
    let f = m - L::one();
    let p = polynomial(
        f,
        [0.333_333_13, -0.250_000_1, 0.200_021_19, -0.166_679_96, 0.142_195_51, -0.124_055_915, 0.118_881_75, -0.116_756_41, 0.067_466_01],
    );
    [f, n, f * f * f * p]
}

#[inline(always)]
pub fn ln<L: Lanes>(x: L) -> L {
    let [f, n, rest] = ln_parts(x);
    let low = (f * L::of(-0.5)).mul_add(f, n.mul_add(L::of(LN_2_PARTS[1]), rest));
    let ln = n.mul_add(L::of(LN_2_PARTS[0]), f + low);
    let ln = L::select(x.lt(L::of(f64::INFINITY)), ln, x);
    let outside = L::select(x.lt(L::zero()), L::of(f64::NAN), L::of(f64::NEG_INFINITY));
    L::select(x.le(L::zero()), outside, ln)
}

/// x^y for x ≥ 0. The logarithm is carried in two numbers, since its error is multiplied by y ln x.
#[inline(always)]
pub fn powf<L: Lanes>(x: L, y: L) -> L {
    let [f, n, rest] = ln_parts(x);
    // f − ½f² + rest + n ln 2 as sum + low: what each sum loses is kept.
    let half = f * L::of(0.5);
    let square = half * f;
    let square_low = half.mul_add(f, -square);
    let high = f - square;
    let near = high + rest;
    let whole = n * L::of(LN_2_PARTS[0]);
    let sum = whole + near;
    let lost = (((f - high) - square) - square_low) + ((high - near) + rest) + ((whole - sum) + near);
    let low = n.mul_add(L::of(LN_2_PARTS[1]), lost);
    let product = y * sum;
    // Where the product overflows this is not a number, and then of no account.
    let product_low = y.mul_add(low, y.mul_add(sum, -product)).max(-L::one()).min(L::one());
    let power = exp_of_sum(product, product_low);
    let power = L::select(x.lt(L::of(f64::INFINITY)), power, L::select(y.lt(L::zero()), L::zero(), x));
    let of_zero = L::select(L::zero().lt(y), L::zero(), L::select(y.lt(L::zero()), L::of(f64::INFINITY), L::one()));
    L::select(x.le(L::zero()), of_zero, power)
}

/// sin(x + quarters·π/2).
#[inline(always)]
fn sin_of_sum<L: Lanes>(x: L, quarters: f64) -> L {
    let n = (x * L::of(FRAC_2_PI)).round();
    // π/2 in three numbers of single precision.
    let first = f64::from(FRAC_PI_2 as f32);
    let second = f64::from((FRAC_PI_2 - first) as f32);
    let r = n.mul_add(L::of(-first), x);
    let r = n.mul_add(L::of(-second), r);
    let r = n.mul_add(L::of(-(FRAC_PI_2 - first - second)), r);
    let r2 = r * r;
    let sin = polynomial(r2, [-0.166_666_67, 0.008_333_329, -0.000_198_393_13, 2.718_121_8e-6]).mul_add(r2 * r, r);
    let cos = polynomial(r2, [1.0, -0.5, 0.041_666_646, -0.001_388_731_6, 2.443_315_7e-5]);
    // The quarter turn, −2 to 2.
    let n = n + L::of(quarters);
    let k = (n * L::of(0.25)).round().mul_add(L::of(-4.0), n);
    let odd = L::of(0.5).lt(k.abs()) & k.abs().lt(L::of(1.5));
    let value = L::select(odd, cos, sin);
    L::select(k.lt(L::of(-0.5)) | L::of(1.5).lt(k), -value, value)
}

#[inline(always)]
pub fn sin<L: Lanes>(x: L) -> L {
    sin_of_sum(x, 0.0)
}

#[inline(always)]
pub fn cos<L: Lanes>(x: L) -> L {
    sin_of_sum(x, 1.0)
}

/// From ½ on by 2 asin √((1 − |x|)/2), which keeps the digits near 1.
#[inline(always)]
pub fn acos<L: Lanes>(x: L) -> L {
    let a = x.abs();
    let near_one = L::of(0.5).lt(a);
    let z = L::select(near_one, (L::one() - a) * L::of(0.5), a * a);
    let s = L::select(near_one, z.sqrt(), a);
    let p = polynomial(z, [0.166_666_6, 0.075_005_04, 0.044_516_96, 0.031_807_69, 0.014_438_697, 0.037_516_33]);
    let asin = p.mul_add(s * z, s);
    let small = L::of(FRAC_PI_2) - asin.with_sign_of(x);
    let twice = asin + asin;
    L::select(near_one, L::select(x.lt(L::zero()), L::of(PI) - twice, twice), small)
}

/// In (−π, π]; 0 for y = x = 0.
#[inline(always)]
pub fn atan2<L: Lanes>(y: L, x: L) -> L {
    let (a, b) = (y.abs(), x.abs());
    let t = a.min(b) / a.max(b).max(L::of(SMALLEST));
    let z = t * t;
    let p = polynomial(
        z,
        [
            -0.333_333_28,
            0.199_996_71,
            -0.142_798_33,
            0.110_582_23,
            -0.088_110_91,
            0.067_415_95,
            -0.044_689_916,
            0.022_539_843,
            -0.007_317_944,
            0.001_113_786_1,
        ],
    );
    let atan = p.mul_add(z * t, t);
    let first_quadrant = L::select(b.lt(a), L::of(FRAC_PI_2) - atan, atan);
    L::select(x.lt(L::zero()), L::of(PI) - first_quadrant, first_quadrant).with_sign_of(y)
}

/// e^(−x²) t P(t), t = 1/(1 + 0.35 |x|); for x < 0 from erfc x = 2 − erfc(−x).
#[inline(always)]
pub fn erfc<L: Lanes>(x: L) -> L {
    let a = x.abs();
    let t = L::one() / a.mul_add(L::of(0.35), L::one());
    let p = polynomial(
        t,
        [
            0.197_462_81,
            0.197_550_79,
            0.184_498_65,
            0.166_271_9,
            0.109_034_87,
            0.125_916_96,
            0.011_632_581,
            -0.012_772_263,
            0.137_534_93,
            -0.202_612_04,
            0.104_597_23,
            -0.019_116_418,
        ],
    );
    let square = a * a;
    let positive = t * p * exp_of_sum(-square, -a.mul_add(a, -square).min(L::one()));
    L::select(x.lt(L::zero()), L::of(2.0) - positive, positive)
}

#[inline(always)]
pub fn interpolate<L: Lanes>(x: L, table: &[f32]) -> L {
    let x = x * L::of((table.len() - 1) as f64);
    // The largest integer ≤ x, for x ≥ 0.
    let nearest = x.round();
    let below = L::select(x.lt(nearest), nearest - L::one(), nearest);
    let i = below.max(L::zero()).min(L::of((table.len() - 2) as f64));
    let (low, high) = (i.of_table(table), (i + L::one()).of_table(table));
    (high - low).mul_add(x - i, low)
}
