use super::avx2::Avx2;
use super::avx512::Avx512;
use super::*;
use crate::models::registry_tests::random_model;
use crate::models::testing::model;
use crate::models::{Reflectance, all};
use glam::DVec3;
use kajo_sampling::Rng;
use std::f64::consts::TAU;

/// Runs what follows for each register that the processor has.
macro_rules! for_each_register {
    ($function:ident($($argument:expr),*)) => {
        if Instructions::Avx2.are_supported() {
            $function::<Avx2>($($argument),*);
        }
        if Instructions::Avx512.are_supported() {
            $function::<Avx512>($($argument),*);
        }
        if !Instructions::Avx2.are_supported() {
            println!("skipped: this processor has no AVX2");
        }
    };
}

/// `f` of pairs, a register at a time.
fn apply<L: Lanes>(f: impl Fn(L, L) -> L, pairs: &[[f32; 2]]) -> Vec<f32> {
    let mut out = Vec::new();
    for chunk in pairs.chunks(L::WIDTH) {
        let mut block = [Vec3::ZERO; 16];
        for (v, [x, y]) in block.iter_mut().zip(chunk) {
            *v = Vec3::new(*x, *y, 0.0);
        }
        let v = L::load(&block);
        let value = f(v.x, v.y);
        L::store(V3::splat(value), &mut block);
        out.extend(block[..chunk.len()].iter().map(|v| v.x));
    }
    out
}

/// The largest error against double precision in units of the last place of `exact`, or of `floor` where that is larger, and where.
fn worst<L: Lanes>(f: impl Fn(L, L) -> L, exact: impl Fn(f64, f64) -> f64, pairs: &[[f32; 2]], floor: f64) -> (f64, [f32; 2]) {
    let errors = apply(f, pairs).into_iter().zip(pairs).map(|(found, &[x, y])| {
        let exact = exact(x.into(), y.into());
        if exact.abs() > f64::from(f32::MAX) || f64::from(found) == exact {
            return (
                if f64::from(found) == exact || f64::from(found) == exact.signum() * f64::INFINITY { 0.0 } else { f64::INFINITY },
                [x, y],
            );
        }
        if exact.abs() < f64::from(f32::MIN_POSITIVE) && found == 0.0 {
            return (0.0, [x, y]);
        }
        let ulp = exact.abs().max(floor).max(f64::from(f32::MIN_POSITIVE)).log2().floor().exp2() * 2_f64.powi(-23);
        ((f64::from(found) - exact).abs() / ulp, [x, y])
    });
    errors.fold((0.0, [0.0; 2]), |worst, error| if error.0 <= worst.0 { worst } else { error })
}

/// Numbers between, equally spaced or, from a positive `low` on, by decades.
fn numbers(low: f32, high: f32, count: u32) -> Vec<[f32; 2]> {
    let share = |k: u32| f64::from(k) / f64::from(count - 1);
    let at = |k: u32| f64::from(low) + (f64::from(high) - f64::from(low)) * share(k);
    let decades = |k: u32| f64::from(low) * (f64::from(high) / f64::from(low)).powf(share(k));
    (0..count).map(|k| [if low > 0.0 { decades(k) } else { at(k) } as f32, 0.0]).collect()
}

fn functions_are_accurate<L: Lanes>() {
    let check = |name: &str, limit: f64, (error, at): (f64, [f32; 2])| {
        println!("{name}, {} lanes: {error:.2} units of the last place at {at:?}", L::WIDTH);
        assert!(error <= limit, "{name}, {} lanes: {error} units of the last place at {at:?}", L::WIDTH);
    };
    let n = 200_000;
    check("exp", 1.5, worst(|x: L, _| x.exp(), |x, _| x.exp(), &numbers(-110.0, 90.0, n), 0.0));
    check("ln", 1.5, worst(|x: L, _| x.ln(), |x, _| x.ln(), &numbers(1e-44, 3e38, n), 0.0));
    check("ln near 1", 1.5, worst(|x: L, _| x.ln(), |x, _| x.ln(), &numbers(0.5, 2.0, n), 0.0));
    check("sin", 1.5, worst(|x: L, _| x.sin(), |x, _| x.sin(), &numbers(-1e4, 1e4, n), 0.5));
    check("cos", 1.5, worst(|x: L, _| x.cos(), |x, _| x.cos(), &numbers(-1e4, 1e4, n), 0.5));
    check("sin, one turn", 2.0, worst(|x: L, _| x.sin(), |x, _| x.sin(), &numbers(-7.0, 7.0, n), 1e-6));
    check("cos, one turn", 2.0, worst(|x: L, _| x.cos(), |x, _| x.cos(), &numbers(-7.0, 7.0, n), 1e-6));
    check("acos", 2.0, worst(|x: L, _| x.acos(), |x, _| x.acos(), &numbers(-1.0, 1.0, n), 0.0));
    check("acos near 1", 2.0, worst(|x: L, _| x.acos(), |x, _| x.acos(), &numbers(0.999, 1.0, n), 0.0));
    check("erfc", 7.0, worst(|x: L, _| x.erfc(), |x, _| libm::erfc(x), &numbers(-5.0, 11.0, n), 0.0));
    let mut rng = Rng::new(8);
    let mut between = |low: f64, high: f64| low + (high - low) * f64::from(rng.next_1d());
    let pairs: Vec<_> = (0..n).map(|_| [between(-2.0, 2.0) as f32, between(-2.0, 2.0) as f32]).collect();
    check("atan2", 2.5, worst(|y: L, x| y.atan2(x), f64::atan2, &pairs, 0.0));
    let powers: Vec<_> = (0..n).map(|_| [between(0.0, 1.0) as f32, between(-6.0, 11.5).exp() as f32]).collect();
    check("powf", 8.0, worst(|x: L, y| x.powf(y), f64::powf, &powers, 0.0));
    let powers: Vec<_> = (0..n).map(|_| [between(-1e-3, 1e-3).exp() as f32, between(0.0, 1e5) as f32]).collect();
    check("powf near 1", 8.0, worst(|x: L, y| x.powf(y), f64::powf, &powers, 0.0));
    let powers: Vec<_> = (0..n).map(|_| [between(-40.0, 40.0).exp() as f32, between(-5.0, 5.0) as f32]).collect();
    check("powf of any", 8.0, worst(|x: L, y| x.powf(y), f64::powf, &powers, 0.0));
    let fault = worst(|x: L, _| x.exp() * L::of(1.000_001), |x, _| x.exp(), &numbers(-10.0, 10.0, 1000), 0.0);
    assert!(fault.0 > 4.0, "planted fault");
}

#[test]
fn functions_of_registers_are_accurate_to_the_last_places() {
    for_each_register!(functions_are_accurate());
}

fn special_values_are_right<L: Lanes>() {
    let of = |f: fn(L, L) -> L, x: f32, y: f32| apply(f, &[[x, y]])[0];
    let inf = f32::INFINITY;
    assert_eq!([of(|x, _| x.exp(), -inf, 0.0), of(|x, _| x.exp(), inf, 0.0), of(|x, _| x.exp(), 0.0, 0.0)], [0.0, inf, 1.0]);
    assert_eq!([of(|x, _| x.ln(), 0.0, 0.0), of(|x, _| x.ln(), inf, 0.0), of(|x, _| x.ln(), 1.0, 0.0)], [-inf, inf, 0.0]);
    assert!(
        of(|x, _| x.ln(), -1.0, 0.0).is_nan() && of(|x, _| x.exp(), f32::NAN, 0.0).is_nan() && of(|x, _| x.ln(), f32::NAN, 0.0).is_nan()
    );
    let pow = |x, y| of(|x, y| x.powf(y), x, y);
    for (x, y) in [
        (0.0, 0.0),
        (0.0, 2.0),
        (0.0, -1.0),
        (1.0, 1e30),
        (0.5, 1e30),
        (2.0, 1e30),
        (0.3, 0.0),
        (inf, 2.0),
        (inf, -2.0),
        (1e-40, 0.5),
        (4.0, 0.5),
    ] {
        let (found, expected) = (pow(x, y), x.powf(y));
        assert!((found - expected).abs() <= 4e-7 * expected || found == expected, "{x}^{y} = {found}, not {expected}");
    }
    assert_eq!(of(|y, x| y.atan2(x), 0.0, 0.0), 0.0);
    assert_eq!([of(|x, _| x.erfc(), inf, 0.0), of(|x, _| x.erfc(), -inf, 0.0), of(|x, _| x.acos(), 1.0, 0.0)], [0.0, 2.0, 0.0]);
    // The second number where they do not compare, as one number does.
    assert_eq!([of(|x, y| x.min(y), f32::NAN, 1.0), of(|x, y| x.max(y), f32::NAN, 1.0)], [1.0, 1.0]);
    assert_eq!([of(|x, _| -x.abs(), -2.0, 0.0), of(|x, y| x.with_sign_of(y), 2.0, -1.0)], [-2.0, -2.0]);
}

#[test]
fn functions_of_registers_are_right_at_the_ends() {
    for_each_register!(special_values_are_right());
}

fn tables_are_read_within<L: Lanes>() {
    let table: Vec<f32> = (0..1024).map(|k| (k as f32 / 1023.0).powi(3)).collect();
    let inputs: Vec<[f32; 2]> = (0..=10_000).map(|k| [k as f32 / 10_000.0, 0.0]).collect();
    for (found, [x, _]) in apply(|x: L, _| x.interpolate(&table), &inputs).into_iter().zip(&inputs) {
        let expected = x.interpolate(&table);
        assert!((found - expected).abs() < 1e-6, "{x}: {found} is not {expected}");
    }
    // Lanes below the surface bring anything.
    for x in [f32::NAN, f32::INFINITY, -f32::INFINITY, -5.0, 5.0, 1e30] {
        apply(|x: L, _| x.interpolate(&table[..2]), &[[x, 0.0]]);
    }
}

#[test]
fn tables_are_interpolated_and_never_read_outside() {
    for_each_register!(tables_are_read_within());
}

/// Directions, a fifth of them below the surface, and pairs of equal and of mirrored ones among them.
fn pairs(count: usize) -> [Vec<Vec3>; 2] {
    let mut rng = Rng::new(512);
    let mut direction = |below: bool| {
        let v = V3::<f64>::from_angles(rng.next_f64().acos(), TAU * rng.next_f64());
        let v = Vec3::new(v.x as f32, v.y as f32, v.z as f32);
        if below { -v } else { v }
    };
    let wi: Vec<_> = (0..count).map(|k| direction(k % 10 == 3)).collect();
    let wo = wi.iter().enumerate().map(|(k, wi)| match k % 16 {
        5 => *wi,
        6 => Vec3::new(-wi.x, -wi.y, wi.z),
        _ => direction(k % 10 == 7),
    });
    let wo = wo.collect();
    [wi, wo]
}

/// How far many values are from single ones, and both from double precision: the largest of all pairs and channels, relative to the value or a millionth.
struct Differences {
    many_from_single: f64,
    many: f64,
    single: f64,
}

/// Of `model`, with many values wrong by a factor of 1 + `fault`.
fn differences(model: &dyn Reflectance, instructions: Instructions, [wi, wo]: &[Vec<Vec3>; 2], fault: f32) -> Differences {
    let mut out = vec![Vec3::NAN; wi.len()];
    model.values_by(instructions, wi, wo, &mut out);
    let mut worst = Differences { many_from_single: 0.0, many: 0.0, single: 0.0 };
    for (k, (&wi, &wo)) in wi.iter().zip(wo).enumerate() {
        let [many, single] = [out[k] * (1.0 + fault), model.value_f32(wi, wo)].map(|v| v.as_dvec3());
        let exact = model.value(wi.as_dvec3(), wo.as_dvec3());
        assert!(many.is_finite(), "{wi} {wo}: {many} where one gives {single}");
        assert!(wi.z > 0.0 && wo.z > 0.0 || many == DVec3::ZERO, "below the surface {many}");
        let relative = |error: DVec3| (error / exact.abs().max(DVec3::splat(1e-6))).abs().max_element();
        worst.many_from_single = worst.many_from_single.max(relative(many - single));
        worst.many = worst.many.max(relative(many - exact));
        worst.single = worst.single.max(relative(single - exact));
    }
    worst
}

/// Single ones round products where many fuse them: as many digits, others.
const TOLERANCE: f64 = 2e-5;

/// Every model by its defaults within the tolerance; with parameters anywhere in their ranges, where single precision may lose digits, as near to double
/// precision as single values are (the worst of four times). Three instruction sets, lengths that are no multiple of a register's.
#[test]
fn many_values_at_once_are_the_single_values_for_every_model() {
    let pairs = pairs(403);
    for instructions in [Instructions::Scalar, Instructions::Avx2, Instructions::Avx512] {
        if !instructions.are_supported() {
            println!("skipped: this processor has no {}", instructions.name());
            continue;
        }
        for entry in all().filter(|entry| entry.wesl.is_some()) {
            let name = format!("{}, {}", entry.id, instructions.name());
            let default = model(entry.id, &[], Form::Corrected);
            let difference = differences(&*default, instructions, &pairs, 0.0).many_from_single;
            assert!(difference < TOLERANCE, "{name}: off by {difference:e}");
            let fault = differences(&*default, instructions, &pairs, 3e-5).many_from_single;
            assert!(fault > TOLERANCE || entry.id == "ambient", "{name}: planted fault");
            let mut rng = Rng::new(16);
            let (mut materials, mut noticed) = (0, 0);
            while materials < 20 {
                let Some(model) = random_model(entry, &mut rng) else { continue };
                materials += 1;
                let allowed = |d: &Differences| 4.0 * d.single + TOLERANCE;
                let d = differences(&*model, instructions, &pairs, 0.0);
                assert!(d.many < allowed(&d), "{name}, material {materials}: {:e} where one is off by {:e}", d.many, d.single);
                let d = differences(&*model, instructions, &pairs, 0.01);
                noticed += u32::from(d.many > allowed(&d));
            }
            assert!(noticed > 0 || entry.id == "ambient", "{name}: {noticed} planted faults noticed");
        }
    }
}

#[test]
fn any_number_of_pairs_is_evaluated() {
    let ggx = model("ggx", &[], Form::Corrected);
    for count in 0..40 {
        let pairs = pairs(count);
        assert!(differences(&*ggx, Instructions::detect(), &pairs, 0.0).many_from_single < TOLERANCE, "{count} pairs");
    }
}
