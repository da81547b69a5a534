use super::tensor::{Array, Content, to_bytes};
use super::*;
use crate::models::testing::{assert_finite, chi_square_by, extreme_pair, fault, model, sampled_albedo};
use crate::models::{Hemisphere, find};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::LazyLock;

const GGX: &[(&str, &str)] = &[("alpha", "0.3"), ("f0", "0.9,0.5,0.2")];
const BRUSHED: &[(&str, &str)] = &[("alpha_x", "0.2"), ("alpha_y", "0.5"), ("f0", "0.9,0.5,0.2")];
const WARD: &[(&str, &str)] = &[("kd", "0.3,0.2,0.1"), ("ks", "0.4,0.5,0.6"), ("m", "0.2")];

fn analytic(id: &str, pairs: &[(&str, &str)]) -> Arc<dyn Reflectance> {
    model(id, pairs, Form::Corrected)
}

fn isotropic() -> &'static Rgl {
    static TABLE: LazyLock<Rgl> = LazyLock::new(|| Rgl::new(Table::of_model(&*analytic("ggx", GGX), Resolution::ISOTROPIC)));
    &TABLE
}

fn brushed() -> &'static Rgl {
    static TABLE: LazyLock<Rgl> = LazyLock::new(|| Rgl::new(Table::of_model(&*analytic("ggx", BRUSHED), Resolution::ANISOTROPIC)));
    &TABLE
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    V3::from_angles(theta, phi).into()
}

/// A small file of even facets and half vectors spread evenly over the square, black but for what `change` does: one azimuth, inclinations 0 and 1.5.
fn fields(change: impl FnOnce(&mut Vec<(&'static str, Content)>)) -> Vec<u8> {
    let mut fields = vec![
        ("description", Content::Bytes(b"test".to_vec())),
        numbers("phi_i", &[1], |_| 0.0),
        numbers("theta_i", &[2], |i| 1.5 * i as f32),
        numbers("sigma", &[2, 3], |_| 0.5),
        numbers("ndf", &[3, 2], |_| 4.0),
        numbers("vndf", &[1, 2, 3, 4], |_| 7.0),
        numbers("luminance", &[1, 2, 5, 5], |_| 1.0),
        numbers("rgb", &[1, 2, 3, 5, 5], |_| 0.0),
        ("jacobian", Content::Bytes(vec![1])),
    ];
    change(&mut fields);
    to_bytes(&fields)
}

fn numbers(name: &'static str, shape: &[usize], value: impl Fn(usize) -> f32) -> (&'static str, Content) {
    (name, Content::Numbers(Array { shape: shape.to_vec(), data: (0..shape.iter().product()).map(value).collect() }))
}

fn replace(fields: &mut Vec<(&'static str, Content)>, field: (&'static str, Content)) {
    fields.retain(|(name, _)| *name != field.0);
    fields.push(field);
}

/// The layout written out by hand, byte for byte.
#[test]
fn a_file_is_laid_out_as_the_database_does_it() {
    let mut by_hand = b"tensor_file\0\x01\0\x02\0\0\0".to_vec();
    by_hand.extend(b"\x01\0a\x02\0\x0a\x48\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0\x02\0\0\0\0\0\0\0");
    by_hand.extend(b"\x03\0bcd\x01\0\x01\x50\0\0\0\0\0\0\0\x03\0\0\0\0\0\0\0");
    by_hand.extend(1.5_f32.to_le_bytes());
    by_hand.extend((-2.0_f32).to_le_bytes());
    by_hand.extend(b"xyz");
    let written = to_bytes(&[numbers("a", &[1, 2], |i| [1.5, -2.0][i]), ("bcd", Content::Bytes(b"xyz".to_vec()))]);
    assert_eq!(written, by_hand);
    let read = tensor::Tensors::parse(&by_hand).unwrap();
    assert_eq!(read.numbers("a", 2).unwrap(), Array { shape: vec![1, 2], data: vec![1.5, -2.0] });
    assert_eq!(read.bytes("bcd").unwrap(), b"xyz");
}

/// θ_h = 22.5° is at u = √¼, half a turn less a quarter on from the viewer at v = ¾: node (2, 3) of 5 × 5. Halfway between the two inclinations half
/// of each counts; D/(4σ) = 4/(4 · ½) = 2.
#[test]
fn a_number_of_the_file_is_found_at_its_half_vector() {
    let wo = direction(0.75, 0.4);
    let at = |theta_h: f64, phi_h: f64| {
        let h = direction(theta_h, 0.4 + phi_h);
        2.0 * h.dot(wo) * h - wo
    };
    let wi = at(FRAC_PI_2 / 4.0, FRAC_PI_2);
    for (slice, jacobian, expected) in [(0, 1, 6.0), (1, 1, 6.0), (1, 0, 3.0)] {
        for channel in 0..3 {
            let lit = ((slice * 3 + channel) * 5 + 3) * 5 + 2;
            let bytes = fields(|fields| {
                replace(fields, numbers("rgb", &[1, 2, 3, 5, 5], |i| if i == lit { 6.0 } else { 0.0 }));
                replace(fields, ("jacobian", Content::Bytes(vec![jacobian])));
            });
            let table = Table::from_bytes(&bytes).unwrap();
            let mut f_cos = [0.0; 3];
            f_cos[channel] = expected;
            let got = table.value(wi, wo) * wi.z;
            assert!((got - DVec3::from_array(f_cos)).abs().max_element() < 1e-6, "{slice} {channel}: {got}");
            for beside in [at(0.0, 0.0), at(FRAC_PI_2 * 0.75 * 0.75, FRAC_PI_2), at(FRAC_PI_2 / 4.0, 0.0), at(FRAC_PI_2 / 4.0, PI)] {
                assert!(table.value(beside, wo).max_element() < 1e-6, "{beside}");
            }
        }
    }
}

#[test]
fn colors_outside_the_gamut_are_black_and_nothing_else() {
    let bytes = fields(|fields| replace(fields, numbers("rgb", &[1, 2, 3, 5, 5], |i| [1.0, -0.1, 0.5][i / 25 % 3])));
    let value = Table::from_bytes(&bytes).unwrap().value(direction(0.3, 1.0), direction(0.7, 0.0));
    assert!(value.x > 0.0 && value.y == 0.0 && (value.z / value.x - 0.5).abs() < 1e-6, "{value}");
}

/// The largest difference of f cos θ_i from a model within `degrees` of the normal by its largest value there, and the root of the mean square by that of
/// the model's.
fn off(table: &Rgl, model: &dyn Reflectance, degrees: f64) -> [f64; 2] {
    let mut rng = kajo_sampling::Rng::new(8);
    let (mut worst, mut largest, mut squares, mut whole) = (0.0_f64, 0.0_f64, 0.0, 0.0);
    for _ in 0..50_000 {
        let mut direction = || direction(rng.next_f64() * degrees.to_radians(), rng.next_f64() * TAU);
        let (wi, wo) = (direction(), direction());
        let (expected, got) = (model.f_cos(wi, wo), table.f_cos(wi, wo));
        worst = worst.max((got - expected).abs().max_element());
        largest = largest.max(expected.max_element());
        squares += (got - expected).length_squared();
        whole += expected.length_squared();
    }
    [worst / largest, (squares / whole).sqrt()]
}

#[test]
fn a_measured_model_is_the_model() {
    let quarter = Resolution { phi_i: 9, symmetry: Symmetry::Mirrors, ..Resolution::ANISOTROPIC };
    let mirrored = Rgl::new(Table::of_model(&*analytic("ggx", BRUSHED), quarter));
    let ward = Rgl::new(Table::of_model(&*analytic("ward", WARD), Resolution::ISOTROPIC));
    for (name, table, model, other, [worst, mean]) in [
        ("ggx", isotropic(), analytic("ggx", GGX), analytic("ggx", &[("alpha", "0.32"), GGX[1]]), [0.02, 0.002]),
        (
            "brushed",
            brushed(),
            analytic("ggx", BRUSHED),
            analytic("ggx", &[("alpha_x", "0.2"), ("alpha_y", "0.55"), GGX[1]]),
            [0.02, 0.002],
        ),
        (
            "mirrored",
            &mirrored,
            analytic("ggx", BRUSHED),
            analytic("ggx", &[("alpha_x", "0.5"), ("alpha_y", "0.2"), GGX[1]]),
            [0.02, 0.002],
        ),
        ("ward", &ward, analytic("ward", WARD), analytic("ward", &[WARD[0], WARD[1], ("m", "0.21")]), [0.02, 0.002]),
    ] {
        for (degrees, factor) in [(60.0, 1.0), (80.0, 3.0)] {
            let got = off(table, &*model, degrees);
            assert!(got[0] < factor * worst && got[1] < factor * mean, "{name} within {degrees}°: {got:?}");
        }
        assert!(off(table, &*other, 60.0)[1] > mean, "{name}: planted fault");
    }
}

/// A file of half or a quarter of a turn is what the whole one is where it was measured, and elsewhere that of the pair turned or mirrored into that part.
#[test]
fn a_part_of_the_azimuths_is_enough_for_symmetric_materials() {
    let full = Resolution { phi_i: 9, theta_i: 4, normals: [16, 17], samples: 8, symmetry: Symmetry::None };
    let model = analytic("ggx", BRUSHED);
    let whole = Table::of_model(&*model, full);
    let mut rng = kajo_sampling::Rng::new(6);
    for (symmetry, phi_i) in [(Symmetry::HalfTurn, 5), (Symmetry::Mirrors, 3)] {
        let part = Table::of_model(&*model, Resolution { phi_i, symmetry, ..full });
        let part = Table::from_bytes(&part.to_bytes()).unwrap();
        assert_eq!((part.symmetry(), part.is_isotropic()), (symmetry, false));
        let mut faults = 0;
        for _ in 0..2000 {
            let wo = direction(rng.next_f64() * 1.5, rng.next_f64() * TAU);
            let wi = direction(rng.next_f64() * 1.5, rng.next_f64() * TAU);
            let signs = match symmetry {
                Symmetry::Mirrors => DVec3::new(-wo.x.signum(), -wo.y.signum(), 1.0),
                _ => DVec3::new(-wo.y.signum(), -wo.y.signum(), 1.0),
            };
            let close = |a: DVec3, b: DVec3| (a - b).abs().max_element() < 1e-5 * (a.max_element() + 0.1);
            let (got, expected) = (part.value(wi, wo), whole.value(wi * signs, wo * signs));
            assert!(close(got, expected), "{symmetry:?}: {got} {expected}");
            assert!((part.pdf(wi, wo) / whole.pdf(wi * signs, wo * signs) - 1.0).abs() < 1e-4);
            faults += u32::from(!close(got, whole.value(wi, wo * signs)));
        }
        assert!(faults > 500, "planted fault: only the viewer turned");
    }
}

#[test]
fn an_isotropic_material_turns() {
    let mut rng = kajo_sampling::Rng::new(12);
    let mut moved = 0;
    for _ in 0..2000 {
        let [a, b, c, d, e] = std::array::from_fn(|_| rng.next_f64());
        let pair = |turn: f64| (direction(1.5 * a, TAU * b + turn), direction(1.5 * c, TAU * d + turn));
        let value = |model: &Rgl, (wi, wo): (DVec3, DVec3)| model.value(wi, wo).x;
        let (still, turned) = (pair(0.0), pair(TAU * e));
        let expected = value(isotropic(), still);
        assert!((value(isotropic(), turned) - expected).abs() < 1e-9 * (1.0 + expected), "{still:?} {turned:?}");
        moved += u32::from((value(brushed(), turned) - value(brushed(), still)).abs() > 1e-3);
    }
    assert!(moved > 500, "a brushed one changes");
}

#[test]
fn a_file_that_is_written_and_read_is_the_same_table() {
    let again = |change: fn(&mut Vec<u8>)| {
        let mut bytes = isotropic().table.to_bytes();
        change(&mut bytes);
        Rgl::new(Table::from_bytes(&bytes).unwrap())
    };
    let off = |other: &Rgl| {
        let mut rng = kajo_sampling::Rng::new(31);
        (0..20_000).fold(0.0_f64, |worst, _| {
            let (wi, wo) = (direction(1.5 * rng.next_f64(), TAU * rng.next_f64()), direction(1.5 * rng.next_f64(), TAU * rng.next_f64()));
            let (a, b) = (isotropic().value(wi, wo), other.value(wi, wo));
            let (p, q) = (isotropic().pdf(wi, wo), other.pdf(wi, wo));
            worst.max((a - b).abs().max_element() / (1e-3 + a.max_element())).max((p - q).abs() / p)
        })
    };
    let same = off(&again(|_| ()));
    assert!(same < 1e-5, "{same}");
    let changed = off(&again(|bytes| {
        let middle = bytes.len() / 2;
        bytes[middle / 4 * 4 + 2] ^= 64;
    }));
    assert!(changed > 1e-3, "planted fault: {changed}");
}

/// A flat spectrum is grey whatever its wavelengths, a red one red, and weights of the conversion are those of the block.
#[test]
fn spectra_become_colors() {
    let spectral = |wavelengths: &[f32], spectrum: fn(f32) -> f32| {
        let count = wavelengths.len();
        Table::from_bytes(&fields(|fields| {
            fields.retain(|(name, _)| *name != "rgb");
            fields.push(numbers("wavelengths", &[count], |i| wavelengths[i]));
            fields.push(numbers("spectra", &[1, 2, count, 5, 5], |i| spectrum(wavelengths[i / 25 % count]) * (1.0 + (i % 25) as f32)));
        }))
    };
    let grey = Table::from_bytes(&fields(|fields| replace(fields, numbers("rgb", &[1, 2, 3, 5, 5], |i| 1.0 + (i % 25) as f32)))).unwrap();
    let (wi, wo) = (direction(0.4, 2.0), direction(0.9, 0.5));
    let expected = grey.value(wi, wo);
    for wavelengths in [&[360.0, 500.0, 520.0, 990.0][..], &[550.0]] {
        let got = spectral(wavelengths, |_| 1.0).unwrap().value(wi, wo);
        assert!((got - expected).abs().max_element() < 1e-5 * expected.x, "{got} {expected}");
    }
    let red = spectral(&[400.0, 590.0, 600.0, 700.0], |nm| f32::from(nm > 595.0)).unwrap().value(wi, wo);
    assert!(red.x > 0.8 * expected.x && red.y < 0.2 * expected.x && red.z < 0.05 * expected.x, "{red} {expected}");
    assert!(spectral(&[900.0, 1000.0], |_| 1.0).unwrap_err().contains("none from 380 to 780 nm"));
    assert!(spectral(&[500.0, 450.0], |_| 1.0).unwrap_err().contains("`wavelengths` does not rise: 450 follows 500"));
}

#[test]
fn numbers_stay_finite_and_every_reflection_is_sampled() {
    let dark = Rgl::new(
        Table::from_bytes(&fields(|fields| {
            replace(fields, numbers("luminance", &[1, 2, 5, 5], |_| -1.0));
            replace(fields, numbers("vndf", &[1, 2, 3, 4], |i| if i < 14 { 0.0 } else { 1.0 }));
            replace(fields, numbers("sigma", &[2, 3], |i| i as f32 % 2.0));
            replace(fields, numbers("rgb", &[1, 2, 3, 5, 5], |i| i as f32 - 40.0));
        }))
        .unwrap(),
    );
    let absurd = fields(|fields| {
        replace(fields, numbers("rgb", &[1, 2, 3, 5, 5], |_| 1e38));
        replace(fields, numbers("ndf", &[3, 2], |_| 1e38));
        replace(fields, numbers("sigma", &[2, 3], |_| 1e-38));
        replace(fields, numbers("vndf", &[1, 2, 3, 4], |i| if i % 12 == 5 { 1e38 } else { 0.0 }));
    });
    let absurd = Rgl::new(Table::from_bytes(&absurd).unwrap());
    for model in [isotropic(), brushed(), &dark, &absurd] {
        if let Some(fault) = fault(model, 40_000) {
            panic!("{fault}");
        }
        let mut rng = kajo_sampling::Rng::new(4);
        for k in 0..10_000 {
            let (wi, wo) = extreme_pair(&mut rng, k);
            assert_finite(model, wi, wo);
        }
    }
}

#[test]
fn samples_follow_density_and_value() {
    let quarter = Resolution { phi_i: 5, theta_i: 8, symmetry: Symmetry::Mirrors, ..Resolution::ANISOTROPIC };
    let mirrored = Rgl::new(Table::of_model(&*analytic("ggx", BRUSHED), quarter));
    for (name, model, theta, phi) in [
        ("isotropic", isotropic(), 0.0, 0.0),
        ("isotropic", isotropic(), 40.0, 20.0),
        ("isotropic", isotropic(), 75.0, 200.0),
        ("brushed", brushed(), 50.0, 110.0),
        ("mirrored", &mirrored, 50.0, 20.0),
        ("mirrored", &mirrored, 50.0, 290.0),
    ] {
        let p = chi_square_by(24, model, |wi, wo| model.pdf(wi, wo), theta, phi);
        assert!(p > 1e-3, "{name} {theta}°: p = {p}");
        let fault = chi_square_by(24, model, |wi, wo| model.pdf(wi, wo) * if wi.y > 0.0 { 1.05 } else { 0.95 }, theta, phi);
        assert!(fault < 1e-3, "planted fault: p = {fault}");
        let wo = direction(f64::to_radians(theta), f64::to_radians(phi));
        let quadrature = Hemisphere::new(300, 480).integrate(|wi| model.f_cos(wi, wo).x);
        let (mean, error) = sampled_albedo(model, theta, phi, 20_000);
        assert!((mean - quadrature).abs() < 4.0 * error + 1e-3 * quadrature, "{name} {theta}°: {mean} ± {error}, quadrature {quadrature}");
        assert!(error < 0.003 * quadrature, "{name} {theta}°: the weights spread, {mean} ± {error}");
    }
}

#[test]
fn files_that_are_no_tables_are_told_apart() {
    let entry = find("rgl").unwrap();
    let problem =
        |file: &str| entry.from_pairs(&[("file", file)], Form::Corrected).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(problem("").contains("`file` is not given"), "{}", problem(""));
    let missing = problem("/nowhere/gold_rgb.bsdf");
    assert!(missing.starts_with("`/nowhere/gold_rgb.bsdf`: cannot be read"), "{missing}");
    let good = fields(|_| ());
    assert!(Table::from_bytes(&good).is_ok());
    let said = |bytes: &[u8], words: &str| {
        let complaint = Table::from_bytes(bytes).unwrap_err();
        assert!(complaint.contains(words), "{complaint} instead of {words}");
    };
    said(b"", "does not begin with `tensor_file`");
    said(b"PF\n512 512\n", "is it another format?");
    for length in [12, 17, 40] {
        said(&good[..length], &format!("is cut off: has {length} bytes, too few for its header"));
    }
    said(&good[..good.len() - 1], "`jacobian` of shape 1 at byte");
    let changed = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    said(&changed(12, 2), "has version 2.0 of the format");
    said(&changed(17, 255), "says 4278190089 fields, more than the 64");
    // The name of the first field has 11 letters: rank at 31, type at 33, offset at 34, shape at 42.
    said(&changed(31, 200), "`description` has 200 indices");
    said(&changed(33, 99), "`description` is of type 99");
    said(&changed(41, 255), "does not lie within");
    said(&changed(49, 127), "does not lie within");
}

#[test]
fn fields_that_do_not_fit_are_told_apart() {
    let said = |field: (&'static str, Content), words: &str| {
        let complaint = Table::from_bytes(&fields(|fields| replace(fields, field))).unwrap_err();
        assert!(complaint.contains(words), "{complaint} instead of {words}");
    };
    for name in ["phi_i", "theta_i", "sigma", "ndf", "vndf", "luminance", "rgb", "jacobian"] {
        let complaint = Table::from_bytes(&fields(|fields| fields.retain(|field| field.0 != name))).unwrap_err();
        assert!(complaint.starts_with(&format!("has no field `{name}`")), "{complaint}");
        if name != "jacobian" {
            said((name, Content::Bytes(vec![1])), &format!("`{name}` is of type u8, not f32"));
            said(numbers(name, &[1; 7], |_| 0.0), &format!("`{name}` has the shape 1 × 1 × 1 × 1 × 1 × 1 × 1"));
        }
    }
    said(numbers("phi_i", &[0], |_| 0.0), "`phi_i` is empty");
    said(numbers("phi_i", &[3], |i| [0.0, 0.5, 0.5][i]), "`phi_i` does not rise: 0.5 follows 0.5");
    said(numbers("phi_i", &[1], |_| 7.0), "`phi_i` holds the angle 7");
    said(numbers("theta_i", &[2], |i| [0.5, 0.0][i]), "`theta_i` does not rise: 0 follows 0.5");
    said(numbers("theta_i", &[2], |i| [0.5, 90.0][i]), "`theta_i` holds the angle 90");
    said(numbers("theta_i", &[2], |_| f32::NAN), "`theta_i` holds NaN at index 0");
    said(numbers("theta_i", &[3], |i| i as f32 / 2.0), "`vndf` has the shape 1 × 2 × 3 × 4, not 1 × 3 × …");
    said(numbers("ndf", &[1, 8], |_| 1.0), "`ndf` has the shape 1 × 8, too few nodes");
    said(numbers("sigma", &[2, 3], |i| [1.0, -0.5][i / 5]), "`sigma` holds -0.5 at index 5");
    said(numbers("vndf", &[1, 2, 3, 4], |i| if i == 9 { f32::INFINITY } else { 1.0 }), "`vndf` holds inf at index 9");
    said(numbers("luminance", &[1, 1, 5, 5], |_| 1.0), "`luminance` has the shape 1 × 1 × 5 × 5, not 1 × 2");
    said(numbers("rgb", &[1, 2, 4, 5, 5], |_| 1.0), "`rgb` has the shape 1 × 2 × 4 × 5 × 5, not … × 3 × 5 × 5");
    said(numbers("rgb", &[1, 2, 3, 6, 5], |_| 1.0), "not … × 3 × 5 × 5");
    said(numbers("rgb", &[1, 2, 3, 5, 5], |_| f32::NAN), "`rgb` holds NaN");
    said(("jacobian", Content::Bytes(vec![1, 1])), "`jacobian` has 2 bytes");
    // Three azimuths, this much apart.
    let azimuths = |first: f32, step: f32| {
        let file = fields(|fields| {
            replace(fields, numbers("phi_i", &[3], |i| first + step * i as f32));
            replace(fields, numbers("vndf", &[3, 2, 3, 4], |_| 1.0));
            replace(fields, numbers("luminance", &[3, 2, 5, 5], |_| 1.0));
            replace(fields, numbers("rgb", &[3, 2, 3, 5, 5], |_| 1.0));
        });
        Table::from_bytes(&file).map_err(|error| error.to_string())
    };
    let eighth = std::f32::consts::FRAC_PI_4;
    assert!(azimuths(0.0, 1.0).unwrap_err().contains("`phi_i` spans 114.6°"));
    assert!(azimuths(eighth, eighth).unwrap_err().contains("`phi_i` spans a quarter from 45.0° on"));
    assert!(azimuths(2.0 * eighth, eighth).is_ok() && azimuths(-4.0 * eighth, eighth).is_ok());
}

#[test]
fn a_model_is_made_from_a_file() {
    let path = std::env::temp_dir().join(format!("kajo-rgl-{}.bsdf", std::process::id()));
    let file = path.to_str().unwrap();
    isotropic().table.write(file).unwrap();
    let made = find("rgl").unwrap().from_pairs(&[("path", file)], Form::Corrected);
    let missing = Table::read("/nowhere/at/all").is_err() && isotropic().table.write("/nowhere/at/all").is_err();
    std::fs::remove_file(&path).unwrap();
    let (wi, wo) = (direction(0.5, 0.2), direction(0.6, 3.0));
    let (got, expected) = (made.unwrap().value(wi, wo), isotropic().value(wi, wo));
    assert!((got - expected).abs().max_element() < 1e-5 * expected.max_element(), "{got} {expected}");
    assert!(missing);
}
