use super::Material;
use crate::models::testing::*;
use crate::models::{Form, Lobe, V3};
use glam::DVec3;

const ISO: [(&str, &str); 3] = [("kd", "0.4"), ("ks", "0.4"), ("m", "0.15")];
const ANISO: [(&str, &str); 4] = [("kd", "0.4"), ("ks", "0.4"), ("mx", "0.1"), ("my", "0.4")];

/// Row BR-22.
#[test]
fn ward_equals_its_golden_values() {
    let iso = [1.363_364_848, 0.127_325_718_5, 0.127_323_954_5, 0.127_323_954_5, 4.263_661_047];
    assert_golden("ward", &ISO, Form::Corrected, iso, 1e-9);
    let elliptic = [0.581_764_714_5, 0.140_840_202_4, 0.132_493_150_3, 0.127_323_954_5, 2.454_013_569];
    assert_golden("ward", &ANISO, Form::Corrected, elliptic, 1e-9);
    let approximate = [0.583_753_251_3, 0.159_506_262_2, 0.157_690_151_4, 0.127_323_954_5, 2.454_013_569];
    assert_golden("ward", &[&ANISO[..], &[("exponent", "approximate")]].concat(), Form::Corrected, approximate, 1e-9);
}

/// (4.13) and (4.14) as they stand, by angles.
fn by_angles(wi: DVec3, wo: DVec3, mx: f64, my: f64) -> f64 {
    let h = (wi + wo).normalize();
    let (delta, phi) = (h.z.acos(), h.y.atan2(h.x));
    let spread = (phi.cos() / mx).powi(2) + (phi.sin() / my).powi(2);
    (-delta.tan().powi(2) * spread).exp() / (4.0 * std::f64::consts::PI * mx * my * (wi.z * wo.z).sqrt())
}

/// Row BR-22: the exponent without trigonometry is (4.14), and equal slopes are the isotropic model.
#[test]
fn the_exponent_without_angles_is_the_one_with_angles() {
    let specular = |mx: &str, my: &str| model("ward", &[("kd", "0"), ("ks", "1"), ("mx", mx), ("my", my)], Form::Corrected);
    let (iso, aniso) = (specular("0.2", "0.2"), specular("0.1", "0.4"));
    let deviation = |a: f64, b: f64| (a - b).abs() / a.abs().max(b.abs()).max(1e-6);
    for (i, set) in SETS.iter().cycle().take(200).enumerate() {
        let (wi, wo) = directions([set.1[0] * 0.9, set.1[1] + 7.0 * i as f64, set.1[2] * 0.8, set.1[3]]);
        assert!(deviation(aniso.value(wi, wo).x, by_angles(wi, wo, 0.1, 0.4)) < 1e-12, "set {i}");
        let tan2 = (wi + wo).normalize().z.powi(-2) - 1.0;
        let isotropic = (-tan2 / 0.04).exp() / (4.0 * std::f64::consts::PI * 0.04 * (wi.z * wo.z).sqrt());
        assert!(deviation(iso.value(wi, wo).x, isotropic) < 1e-12, "set {i}");
        assert!(deviation(iso.value(wi, wo).x, by_angles(wi, wo, 0.2, 0.201)) > 1e-6 || isotropic < 1e-6, "planted fault");
    }
}

/// Row BR-22.
#[test]
fn ward_reflects_what_the_furnace_table_says() {
    let angles = [0.0, 30.0, 60.0, 75.0, 85.0];
    for (m, table) in [
        ("0.05", [0.9926, 0.8598, 0.4972, 0.2591, 0.0944]),
        ("0.1", [0.9711, 0.8416, 0.4890, 0.2595, 0.1196]),
        ("0.2", [0.8949, 0.7773, 0.4589, 0.2692, 0.1816]),
        ("0.4", [0.6871, 0.5997, 0.3859, 0.2825, 0.2680]),
    ] {
        let ward = model("ward", &[("kd", "0"), ("ks", "1"), ("m", m)], Form::Corrected);
        for (theta, expected) in angles.into_iter().zip(table) {
            let quadrature = albedo(&*ward, theta, 0.0);
            assert!((quadrature - expected).abs() < 2e-4, "m = {m}, {theta}°: {quadrature}, table {expected}");
        }
    }
    let aniso = model("ward", &[("kd", "0"), ("ks", "1"), ("mx", "0.1"), ("my", "0.4")], Form::Corrected);
    assert!((albedo(&*aniso, 0.0, 0.0) - 0.8158).abs() < 2e-4);
}

/// Row BR-22.
#[test]
fn the_ten_measured_materials_keep_energy() {
    for material in Material::MEASURED {
        let [kd, ks, mx, my] = material.values().unwrap();
        let name = super::Params::SPEC[5].kind;
        let kajo_params::ParamKind::Choice { names } = name else { panic!("{name:?}") };
        let ward = model("ward", &[("material", names[material as usize])], Form::Corrected);
        let values = [kd, ks, mx, my].map(|v| v.to_string());
        let same = model("ward", &[("kd", &values[0]), ("ks", &values[1]), ("mx", &values[2]), ("my", &values[3])], Form::Corrected);
        let (wi, wo) = directions(SETS[0].1);
        assert_eq!(ward.value(wi, wo), same.value(wi, wo), "{material:?}");
        for (theta, phi) in [(0.0, 0.0), (60.0, 0.0), (60.0, 90.0), (85.0, 45.0)] {
            let (mean, error) = sampled_albedo(&*ward, theta, phi, 20_000);
            assert!(mean + 4.0 * error < 1.0 && mean > kd * 0.99, "{material:?}, {theta}°: {mean} ± {error}");
        }
    }
}

/// Row BR-23: above-horizon mass 0.9996, 0.9993, 0.9853 at 0°, 45°, 70°.
#[test]
fn wards_density_integrates_to_one() {
    for lobe in [Lobe::Gauss { mx: 0.1, my: 0.4 }, Lobe::GaussChord { mx: 0.1, my: 0.4 }] {
        for (theta, expected) in [(0.0_f64, 0.9996), (45.0, 0.9993), (70.0, 0.9853)] {
            let wo = V3::from_angles(theta.to_radians(), 0.0);
            let (whole, above) = masses(|wi| lobe.pdf(wi, wo));
            assert!((whole - 1.0).abs() < 1e-4, "{lobe:?}, {theta}°: {whole}");
            if matches!(lobe, Lobe::Gauss { .. }) {
                assert!((above - expected).abs() < 1e-4, "{theta}°: {above} above the horizon");
            }
        }
    }
}

/// Row BR-23.
#[test]
fn wards_samples_give_its_albedo_and_follow_its_density() {
    for exponent in ["elliptic", "approximate"] {
        let ward = model("ward", &[("kd", "0.1"), ("ks", "0.9"), ("mx", "0.1"), ("my", "0.4"), ("exponent", exponent)], Form::Corrected);
        for theta in [0.0, 45.0, 70.0] {
            let quadrature = albedo(&*ward, theta, 0.0);
            let (mean, error) = sampled_albedo(&*ward, theta, 0.0, 1_000_000);
            assert!(
                (mean - quadrature).abs() < 3.0 * error + 1e-7,
                "{exponent}, {theta}°: sampled {mean} ± {error}, quadrature {quadrature}"
            );
        }
        assert_samples_follow(&*ward, 45.0, 30.0);
        assert_samples_follow(&*ward, 75.0, 0.0);
    }
}

#[test]
fn ward_is_reciprocal_and_turns_with_its_axes() {
    for exponent in ["elliptic", "approximate"] {
        let pairs = |mx, my| [("kd", "0.2"), ("ks", "0.6"), ("mx", mx), ("my", my), ("exponent", exponent)];
        let (ward, turned) = (model("ward", &pairs("0.1", "0.4"), Form::Corrected), model("ward", &pairs("0.4", "0.1"), Form::Corrected));
        assert!(asymmetry(|a, b| ward.value(a, b).x, 20_000) < 1e-12);
        let quarter = |v: DVec3| DVec3::new(-v.y, v.x, v.z);
        let (wi, wo) = directions(SETS[1].1);
        assert!((ward.value(wi, wo).x - turned.value(quarter(wi), quarter(wo)).x).abs() < 1e-12);
        assert!((ward.value(wi, wo).x - turned.value(wi, wo).x).abs() > 1e-3, "planted fault");
    }
}

/// The printed forms: (4.13) with tan²δ/m, (4.15) with the norm inside the exponent.
#[test]
fn printed_forms_have_another_width_and_scale() {
    let (wi, wo) = directions(SETS[0].1);
    let h = (wi + wo).normalize();
    let root = (wi.z * wo.z).sqrt();
    let specular = [("kd", "0"), ("ks", "1"), ("m", "0.15")];
    let printed = model("ward", &specular, Form::Printed).value(wi, wo).x;
    let norm = 4.0 * std::f64::consts::PI * 0.15 * 0.15;
    assert!((printed - (-(h.z.powi(-2) - 1.0) / 0.15).exp() / (norm * root)).abs() < 1e-12);
    let approximate = [&specular[..], &[("exponent", "approximate")]].concat();
    let printed = model("ward", &approximate, Form::Printed).value(wi, wo).x;
    let expected = (-2.0 * (1.0 - h.z * h.z) / (0.15 * 0.15) / ((1.0 + h.z) * norm)).exp() / root;
    assert!((printed - expected).abs() < 1e-12, "{printed} {expected}");
}

/// Row BR-23: the density is Walter's, p = exp(−tan²δ (cos²φ/m_x² + sin²φ/m_y²))/(4π m_x m_y (h·o) cos³δ), with the slopes of the model itself.
#[test]
fn the_models_own_density_is_the_published_one() {
    let (mx, my) = (0.1, 0.4);
    let ward = model("ward", &[("kd", "0"), ("ks", "1"), ("mx", "0.1"), ("my", "0.4")], Form::Corrected);
    for (_, angles) in SETS {
        let (wi, wo) = directions(angles);
        let h = (wi + wo).normalize();
        let exponent = ((h.x / mx).powi(2) + (h.y / my).powi(2)) / h.z.powi(2);
        let expected = (-exponent).exp() / (4.0 * std::f64::consts::PI * mx * my * h.dot(wo) * h.z.powi(3));
        let found = ward.pdf(wi, wo);
        assert!((found - expected).abs() <= 1e-9 * expected + 1e-300, "{angles:?}: {found} instead of {expected}");
    }
}
