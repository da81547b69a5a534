//! Repeatable numbers for placing things.

/// A hash of two numbers, well mixed in every bit.    \[Jarzynski20], function pcg2d, one output
pub(super) fn hash(a: u32, b: u32) -> u32 {
    let step = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let (mut x, mut y) = (step(a), step(b));
    x = x.wrapping_add(y.wrapping_mul(1_664_525));
    y = y.wrapping_add(x.wrapping_mul(1_664_525));
    x ^= x >> 16;
    y ^= y >> 16;
    x = x.wrapping_add(y.wrapping_mul(1_664_525));
    y = y.wrapping_add(x.wrapping_mul(1_664_525));
    x ^ (x >> 16) ^ (y >> 16)
}

/// A number in [0, 1) for each pair.
pub(super) fn unit(a: u32, b: u32) -> f32 {
    (hash(a, b) >> 8) as f32 / (1 << 24) as f32
}

/// Value noise: random values at integer points, blended with continuous slope; in [0, 1).
fn value(x: f32, y: f32) -> f32 {
    let (column, row) = (x.floor(), y.floor());
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let (s, t) = (smooth(x - column), smooth(y - row));
    let corner = |i: i32, j: i32| unit((column as i32 + i) as u32, (row as i32 + j) as u32);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(mix(corner(0, 0), corner(1, 0), s), mix(corner(0, 1), corner(1, 1), s), t)
}

/// A fractal sum of `octaves` of value noise, each twice as fine and half as high, turned against the last; in [0, 1).
pub(super) fn fractal(mut x: f32, mut y: f32, octaves: u32) -> f32 {
    let (mut sum, mut amplitude) = (0.0, 0.5);
    for _ in 0..octaves {
        sum += amplitude * value(x, y);
        amplitude *= 0.5;
        // A turn by atan(4/3) and a doubling, so that the lattices of octaves do not line up.
        (x, y) = (1.2 * x - 1.6 * y + 17.3, 1.6 * x + 1.2 * y + 5.9);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_numbers_are_even() {
        let n = 20_000;
        let mean = (0..n).map(|i| f64::from(unit(i, 3))).sum::<f64>() / f64::from(n);
        assert!((mean - 0.5).abs() < 4.0 / (12.0 * f64::from(n)).sqrt(), "{mean}");
        assert!((0..n).all(|i| (0.0..1.0).contains(&unit(i, i ^ 5))));
    }

    #[test]
    fn noise_is_bounded_and_continuous() {
        for i in 0..1000 {
            let (x, y) = (unit(i, 1) * 50.0 - 25.0, unit(i, 2) * 50.0 - 25.0);
            let a = fractal(x, y, 6);
            assert!((0.0..1.0).contains(&a));
            assert!((fractal(x + 1e-4, y, 6) - a).abs() < 1e-2);
        }
    }
}
