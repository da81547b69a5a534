use super::*;
use crate::models::testing::{assert_finite, asymmetry, chi_square_by, extreme_pair, fault, model, sampled_albedo};
use crate::models::{Hemisphere, V3, find};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

const WARD: (&str, &[(&str, &str)]) = ("ward", &[("kd", "0.3,0.2,0.1"), ("ks", "0.4,0.5,0.6"), ("m", "0.2")]);
const COOK_TORRANCE: (&str, &[(&str, &str)]) = ("cook-torrance", &[("kd", "0.2"), ("ks", "0.8"), ("m", "0.3")]);

fn analytic((id, pairs): (&str, &[(&str, &str)])) -> Arc<dyn Reflectance> {
    model(id, pairs, Form::Corrected)
}

fn table() -> &'static Table {
    static WARDS: LazyLock<Table> = LazyLock::new(|| Table::of_model(&*analytic(WARD)));
    &WARDS
}

fn measured() -> &'static Merl {
    static WARDS: LazyLock<Merl> = LazyLock::new(|| Merl::new(table().clone(), Interpolation::Linear));
    &WARDS
}

/// Bytes of a table in which every number is 0 but one.
fn one_bin(channel: usize, [h, d, p]: [usize; 3], number: f64) -> Vec<u8> {
    let count = 90 * 90 * 180;
    let mut bytes = vec![0; 12 + 3 * 8 * count];
    for (i, n) in [90_i32, 90, 180].into_iter().enumerate() {
        bytes[4 * i..4 * i + 4].copy_from_slice(&n.to_le_bytes());
    }
    let at = 12 + 8 * (channel * count + (h * 90 + d) * 180 + p);
    bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
    bytes
}

/// The layout and the scales, written out by hand: θ_h = 10.3° is in bin ⌊√(10.3 · 90)⌋ = 30, θ_d = 25.5° in 25, φ_d = 100.5° in 100.
#[test]
fn a_number_of_the_file_is_found_at_its_angles() {
    let angles = HalfDifference { theta_h: 10.3_f64.to_radians(), theta_d: 25.5_f64.to_radians(), phi_d: 100.5_f64.to_radians() };
    let (wi, wo) = angles.directions();
    for (channel, scale) in [1.0, 1.15, 1.66].into_iter().enumerate() {
        let table = Table::from_bytes(&one_bin(channel, [30, 25, 100], 750.0)).unwrap();
        let mut expected = [0.0; 3];
        expected[channel] = 0.5 * scale;
        let got = table.value(wi, wo, Interpolation::Nearest);
        assert!((got - DVec3::from_array(expected)).abs().max_element() < 1e-6, "{got}");
        for beside in [[29, 25, 100], [30, 26, 100], [30, 25, 101]] {
            let other = Table::from_bytes(&one_bin(channel, beside, 750.0)).unwrap();
            assert_eq!(other.value(wi, wo, Interpolation::Nearest), DVec3::ZERO, "{beside:?}");
        }
    }
}

#[test]
fn between_centres_values_are_linear_and_meet_at_half_a_turn() {
    let table = Table::from_bytes(&one_bin(0, [30, 40, 179], 1500.0)).unwrap();
    let value = |theta_h: f64, theta_d: f64, phi_d: f64| {
        let angles = HalfDifference {
            theta_h: (theta_h / 90.0).powi(2) * FRAC_PI_2,
            theta_d: theta_d.to_radians(),
            phi_d: phi_d.to_radians().rem_euclid(PI),
        };
        let (wi, wo) = angles.directions();
        table.value(wi, wo, Interpolation::Linear).x
    };
    for (at, expected) in [
        ([30.5, 40.5, 179.5], 1.0),
        ([30.75, 40.5, 179.5], 0.75),
        ([30.5, 40.0, 179.5], 0.5),
        ([30.5, 40.5, 180.25], 0.25),
        ([30.0, 40.0, 179.0], 0.125),
        ([30.5, 40.5, 0.6], 0.0),
    ] {
        let got = value(at[0], at[1], at[2]);
        assert!((got - expected).abs() < 1e-6, "{at:?}: {got} instead of {expected}");
    }
}

#[test]
fn bins_without_a_measurement_are_left_out() {
    let bin = |h: usize, d: usize, p: usize| (h * 90 + d) * 180 + p;
    let mut bins = vec![[1.0; 3]; 90 * 90 * 180];
    bins[bin(30, 40, 50)] = table::MISSING;
    let (wi, wo) = table::centre(bin(30, 40, 50)).directions();
    let table = Table::of_bins(bins);
    assert_eq!(table.value(wi, wo, Interpolation::Nearest), DVec3::ZERO);
    let beside = HalfDifference { theta_d: 40.7_f64.to_radians(), ..table::centre(bin(30, 40, 50)) }.directions();
    assert!((table.value(beside.0, beside.1, Interpolation::Linear).x - 1.0).abs() < 1e-6, "the others have the whole weight");
}

#[test]
fn a_file_that_is_written_and_read_is_the_same_table() {
    let again = Table::from_bytes(&table().to_bytes()).unwrap();
    let off = |other: &Table| {
        table().bins().iter().zip(other.bins()).flat_map(|(a, b)| (0..3).map(|c| (a[c] - b[c]).abs() / a[c].abs())).fold(0.0, f32::max)
    };
    assert!(off(&again) < 2e-7, "{}", off(&again));
    let mut fault = table().to_bytes();
    fault[12 + 8 * 500_000 + 6] ^= 1;
    assert!(off(&Table::from_bytes(&fault).unwrap()) > 1e-3, "planted fault");
}

/// The largest difference from a model over pseudo-random directions more than 5° above the surface, by the model's largest value among them.
fn worst(table: &Table, interpolation: Interpolation, model: &dyn Reflectance) -> f64 {
    let mut rng = kajo_sampling::Rng::new(8);
    let (mut off, mut largest) = (0.0_f64, 0.0_f64);
    for _ in 0..50_000 {
        let mut direction = || DVec3::from(V3::from_angles(rng.next_f64() * 85.0_f64.to_radians(), rng.next_f64() * 2.0 * PI));
        let (wi, wo) = (direction(), direction());
        let expected = model.value(wi, wo);
        off = off.max((table.value(wi, wo, interpolation) - expected).abs().max_element());
        largest = largest.max(expected.max_element());
    }
    off / largest
}

#[test]
fn a_measured_model_is_the_model() {
    for (analytic, tolerance, other) in [
        (WARD, 0.01, ("ward", &[("kd", "0.3,0.2,0.1"), ("ks", "0.4,0.5,0.6"), ("m", "0.21")][..])),
        (COOK_TORRANCE, 0.03, ("cook-torrance", &[("kd", "0.2"), ("ks", "0.8"), ("m", "0.35")][..])),
    ] {
        let model = self::analytic(analytic);
        let table = Table::of_model(&*model);
        let [linear, nearest] = [Interpolation::Linear, Interpolation::Nearest].map(|i| worst(&table, i, &*model));
        assert!(linear < tolerance, "{}: {linear}", analytic.0);
        assert!(nearest > linear && nearest < 0.2, "{}: {nearest}", analytic.0);
        assert!(worst(&table, Interpolation::Linear, &*self::analytic(other)) > tolerance, "{}: planted fault", analytic.0);
    }
}

#[test]
fn at_the_centre_of_a_bin_every_interpolation_is_the_measurement() {
    let model = analytic(WARD);
    for index in (0..90 * 90 * 180).step_by(997) {
        let (wi, wo) = table::centre(index).directions();
        if wi.z > 0.0 && wo.z > 0.0 {
            for interpolation in [Interpolation::Nearest, Interpolation::Linear] {
                let (got, expected) = (table().value(wi, wo, interpolation), model.value(wi, wo));
                assert!(
                    (got - expected).abs().max_element() < 2e-6 * expected.max_element(),
                    "{index} {interpolation:?}: {got} {expected}"
                );
            }
        }
    }
}

#[test]
fn tables_are_reciprocal() {
    let unequal = asymmetry(|a, b| measured().value(a, b).y, 20_000);
    assert!(unequal < 1e-5, "{unequal}");
}

#[test]
fn numbers_stay_finite_and_every_reflection_is_sampled() {
    if let Some(fault) = fault(measured(), 200_000) {
        panic!("{fault}");
    }
    let mut rng = kajo_sampling::Rng::new(4);
    for k in 0..20_000 {
        let (wi, wo) = extreme_pair(&mut rng, k);
        assert_finite(measured(), wi, wo);
    }
}

#[test]
fn samples_follow_density_and_value() {
    let stepped = Merl::new(table().clone(), Interpolation::Nearest);
    for (model, theta, phi) in [(measured(), 0.0, 0.0), (measured(), 40.0, 20.0), (measured(), 75.0, 200.0), (&stepped, 40.0, 20.0)] {
        let name = format!("{:?} {theta}°", model.interpolation);
        let p = chi_square_by(96, model, |wi, wo| model.pdf(wi, wo), theta, phi);
        assert!(p > 1e-3, "{name}: p = {p}");
        let fault = chi_square_by(24, model, |wi, wo| model.pdf(wi, wo) * if wi.y > 0.0 { 1.05 } else { 0.95 }, theta, phi);
        assert!(fault < 1e-3, "planted fault: p = {fault}");
        let wo = DVec3::from(V3::from_angles(f64::to_radians(theta), f64::to_radians(phi)));
        let quadrature = Hemisphere::new(300, 480).integrate(|wi| model.f_cos(wi, wo).x);
        let (mean, error) = sampled_albedo(model, theta, phi, 20_000);
        assert!((mean - quadrature).abs() < 4.0 * error + 1e-3 * quadrature, "{name}: {mean} ± {error}, quadrature {quadrature}");
        assert!(error < 0.005 * quadrature, "{name}: the weights spread, {mean} ± {error}");
    }
}

#[test]
fn files_that_are_no_tables_are_told_apart() {
    let entry = find("merl").unwrap();
    let problem =
        |file: &str| entry.from_pairs(&[("file", file)], Form::Corrected).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(problem("").contains("`file` is not given"), "{}", problem(""));
    let missing = problem("/nowhere/gold.binary");
    assert!(missing.starts_with("`/nowhere/gold.binary`: cannot be read"), "{missing}");
    let good = one_bin(0, [1, 2, 3], 4.0);
    let complaint = |bytes: &[u8]| Table::from_bytes(bytes).unwrap_err();
    assert!(complaint(&good[..7]).contains("has 7 bytes, too few for the header"));
    assert!(complaint(&good[..good.len() - 1]).starts_with("is cut off: has 34992011"), "{}", complaint(&good[..good.len() - 1]));
    assert!(complaint(&[&good[..], &[0]].concat()).starts_with("goes on after the last bin"));
    let mut wrong = good.clone();
    wrong[0] = 45;
    assert!(complaint(&wrong).contains("45 × 90 × 180 bins, not"), "{}", complaint(&wrong));
    let nan = complaint(&one_bin(1, [0, 0, 7], f64::NAN));
    assert!(nan.contains("green value of bin 7 is NaN"), "{nan}");
    assert!(complaint(&one_bin(2, [0, 0, 7], 1e300)).contains("blue value of bin 7 is inf"));
}

#[test]
fn a_model_is_made_from_a_file() {
    let path = std::env::temp_dir().join(format!("kajo-merl-{}.binary", std::process::id()));
    let file = path.to_str().unwrap();
    table().write(file).unwrap();
    let made = find("merl").unwrap().from_pairs(&[("file", file), ("interpolation", "nearest")], Form::Corrected);
    let missing = Table::read("/nowhere/at/all").is_err() && table().write("/nowhere/at/all").is_err();
    std::fs::remove_file(&path).unwrap();
    let (wi, wo) = table::centre(500_000).directions();
    let (got, expected) = (made.unwrap().value(wi, wo), analytic(WARD).value(wi, wo));
    assert!((got - expected).abs().max_element() < 2e-6 * expected.max_element(), "{got} {expected}");
    assert!(missing);
}
