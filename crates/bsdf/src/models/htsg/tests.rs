use super::*;
use crate::models::testing::*;
use crate::models::{Form, Reflectance};
use glam::DVec3;

const ROUGH: [(&str, &str); 4] = [("sigma0", "0.28"), ("tau", "1.77"), ("lambda", "0.5"), ("fresnel", "none")];
const SMOOTH: [(&str, &str); 4] = [("sigma0", "0.05"), ("tau", "1"), ("lambda", "0.5"), ("fresnel", "none")];

/// Row BR-20.
#[test]
fn htsg_equals_its_golden_values() {
    let rough = [1.157_730_959, 0.161_027_968_6, 0.016_837_511_15, 5.722_985_719e-5, 7.557_945_415];
    assert_golden("htsg", &ROUGH, Form::Corrected, rough, 1e-7);
    let smooth = [3.208_449_639, 6.058_680_878e-4, 6.649_341_858e-6, 3.519_170_566e-10, 2.022_690_18];
    assert_golden("htsg", &SMOOTH, Form::Corrected, smooth, 1e-7);
}

fn formula(sigma0: f64, tau: f64, lambda: f64, form: Form) -> Formula<f64> {
    let params = Params { sigma0, tau, lambda: [lambda; 3], fresnel: FresnelForm::None, ..Params::default() };
    Htsg::formula(&params, form)
}

fn geometry(angles: [f64; 4]) -> Geometry<f64> {
    let (wi, wo) = directions(angles);
    Geometry::new(wi.into(), wo.into())
}

/// Row BR-20: the intermediates of appendix C.
#[test]
fn its_parts_equal_golden_values() {
    let surface = formula(0.28, 1.77, 0.5, Form::Corrected);
    let golden = [
        (0, 0.999_999_948, 0.28, 32.977_161_6, 2.704_584_65, 0.892_157_565),
        (2, 0.844_731_266, 0.276_060_936, 18.612_717_4, 4.072_762_54, 0.003_918_932_65),
    ];
    for (set, s, sigma, phase, factor, d) in golden {
        let g = geometry(SETS[set].1);
        let parts = surface.parts(&g);
        let wave = surface.wave[0];
        let found = [
            parts.visibility * g.cos_i() * g.cos_r(),
            parts.sigma,
            surface.phase(wave, parts.sigma, g.cos_i() + g.cos_r()),
            parts.geometry,
            surface.distribution(&g, wave, parts.sigma),
        ];
        for (value, expected) in found.into_iter().zip([s, sigma, phase, factor, d]) {
            assert!((value / expected - 1.0).abs() < 1e-8, "set {set}: {value} is not {expected}");
        }
    }
}

/// Row BR-20: z0 of set C, and its equation everywhere.
#[test]
fn the_mean_level_solves_its_equation() {
    for k in -60..=60 {
        let f = 10_f64.powf(f64::from(k) / 10.0);
        let x = mean_level(f);
        let residual = x - f * (-0.5 * x * x).exp();
        assert!(residual.abs() < 1e-12, "f {f}: x {x}, residual {residual:e}");
        let single = f64::from(mean_level(f as f32));
        assert!((single - x).abs() < 1e-5 * x + 1e-6, "f {f}: f32 gives {single}, f64 {x}");
    }
    let surface = formula(0.28, 1.77, 0.5, Form::Corrected);
    let sigma = surface.parts(&geometry(SETS[2].1)).sigma;
    let z0 = 0.28 * ((0.28 / sigma).powi(2) - 1.0).sqrt();
    assert!((z0 - 0.047_469_075_8).abs() < 1e-9, "{z0}");
}

/// (3.24) with polarisation vectors and the cross product.
fn geometrical_factor_by_vectors(wi: DVec3, wo: DVec3) -> f64 {
    let (ki, kr) = (-wi, wo);
    let v = kr - ki;
    let (si, sr) = (ki.cross(DVec3::Z).normalize(), kr.cross(DVec3::Z).normalize());
    let (pi, pr) = (si.cross(ki), sr.cross(kr));
    let factor = (sr.dot(ki).powi(2) + pr.dot(ki).powi(2)) * (si.dot(kr).powi(2) + pi.dot(kr).powi(2));
    (v.dot(v) / v.z).powi(2) * kr.cross(ki).length().powi(-4) * factor
}

/// Row BR-20: polarisation cancels.
#[test]
fn the_geometrical_factor_is_its_short_form() {
    let surface = formula(0.28, 1.77, 0.5, Form::Corrected);
    let mut rng = kajo_sampling::Rng::new(20);
    let mut compared = 0;
    while compared < 10_000 {
        let angles = [89.0, 360.0, 89.0, 360.0].map(|scale| f64::from(rng.next_1d()) * scale);
        let (wi, wo) = directions(angles);
        // Where a direction is the normal, or light returns to where it came from, the long form is 0/0.
        if wi.cross(wo).length() < 0.02 || wi.z > 0.999 || wo.z > 0.999 {
            continue;
        }
        let (short, long) = (surface.parts(&geometry(angles)).geometry, geometrical_factor_by_vectors(wi, wo));
        assert!((short / long - 1.0).abs() < 1e-10, "{angles:?}: {short} is not {long}");
        compared += 1;
    }
}

/// ∫ f_dd cos θ dω for light from `theta_i` degrees: midpoints in √θ and in half of the azimuths.
fn scattered(model: &dyn Reflectance, theta_i: f64) -> f64 {
    let (rows, columns) = (240, 160);
    let wo: DVec3 = V3::from_angles(theta_i.to_radians(), 0.0).into();
    let mut sum = 0.0;
    for row in 0..rows {
        let t = (f64::from(row) + 0.5) / f64::from(rows);
        let theta = 0.5 * PI * t * t;
        for column in 0..columns {
            let phi = (f64::from(column) + 0.5) / f64::from(columns) * PI;
            let wi: DVec3 = V3::from_angles(theta, phi).into();
            sum += model.value(wi, wo).x * theta.cos() * theta.sin() * t;
        }
    }
    2.0 * sum * PI * PI / f64::from(rows * columns)
}

fn surface(sigma0: &str, tau: &str, lambda: &str, form: Form) -> std::sync::Arc<dyn Reflectance> {
    model("htsg", &[("sigma0", sigma0), ("tau", tau), ("lambda", lambda), ("fresnel", "none")], form)
}

fn mirrored(model: &dyn Reflectance, theta: f64) -> f64 {
    model.mirror(V3::from_angles(theta.to_radians(), 0.0).into()).x
}

/// Rows BR-6, BR-20: what is scattered and mirrored is what arrives.
#[test]
fn mirror_and_lobe_share_the_energy() {
    let rows = [
        ("0.05", "3", [1.000_002, 1.000_003, 1.000_029]),
        ("0.1", "3", [1.000_006, 1.000_012, 0.999_438]),
        ("0.02", "3", [1.0, 1.0, 1.000_012]),
        ("0.05", "1", [1.000_138, 1.000_161, 0.984_178]),
    ];
    for (sigma0, tau, expected) in rows {
        let model = surface(sigma0, tau, "0.5", Form::Corrected);
        for (theta, expected) in [0.0, 30.0, 60.0].into_iter().zip(expected) {
            let sum = scattered(&*model, theta) + mirrored(&*model, theta);
            assert!((sum - expected).abs() < 1e-3 && sum < 1.0 + 2e-4, "σ0 {sigma0}, τ {tau}, {theta}°: {sum}");
        }
    }
    let model = surface("0.05", "3", "0.5", Form::Corrected);
    for (theta, expected) in [(0.0, 0.206_153), (30.0, 0.305_944), (60.0, 0.673_825)] {
        assert!((mirrored(&*model, theta) - expected).abs() < 1e-6, "{theta}°: {}", mirrored(&*model, theta));
    }
}

/// Row BR-20: the directional-diffuse albedo of both forms.
#[test]
fn the_printed_shadowing_loses_light() {
    let corrected = surface("0.28", "1.77", "0.5", Form::Corrected);
    let printed = surface("0.28", "1.77", "0.5", Form::Printed);
    for (theta, full, less) in [(0.0, 0.9959, 0.9423), (30.0, 0.9716, 0.8608), (60.0, 0.8824, 0.6945), (75.0, 0.7464, 0.5727)] {
        for (model, expected) in [(&corrected, full), (&printed, less)] {
            let albedo = scattered(&**model, theta);
            assert!((albedo - expected).abs() < 1e-3, "{theta}°: {albedo} is not {expected}");
        }
    }
}

/// Row BR-20: the limit of rough surfaces is Cook and Torrance's prefactor 1/(4π).
#[test]
fn rough_surfaces_are_cook_torrance_with_one_over_four_pi() {
    let surface = formula(11.2, 70.8, 0.5, Form::Corrected);
    for (name, expected) in [('A', 1.000_016), ('B', 0.999_989), ('C', 1.000_291), ('E', 1.000_109)] {
        let g = geometry(SETS.iter().find(|(set, _)| *set == name).unwrap().1);
        let parts = surface.parts(&g);
        let m = 2.0 * parts.sigma / 70.8;
        let tan2 = g.tan2_delta();
        let beckmann = (-tan2 / (m * m)).exp() / (m * m * g.cos_delta().powi(4));
        let ratio = surface.value(&g).x / (beckmann * parts.visibility / (4.0 * PI));
        assert!((ratio - 1.0).abs() < 5e-4 && (ratio - expected).abs() < 2e-6, "{name}: {ratio}");
    }
}

/// Row BR-20: smoother for longer waves, larger angles and lower heights.
#[test]
fn the_mirror_grows_with_wavelength_and_angle_and_fades_with_roughness() {
    let share = |sigma0: f64, lambda: f64, theta: f64| {
        let wo = V3::from_angles(theta.to_radians(), 0.0);
        Htsg::mirror::<f64>(&formula(sigma0, 3.0, lambda, Form::Corrected), wo).x
    };
    for step in 0..40 {
        let t = f64::from(step);
        assert!(share(0.05, 0.41 + 0.01 * t, 30.0) > share(0.05, 0.40 + 0.01 * t, 30.0), "wavelength {t}");
        assert!(share(0.05, 0.5, 2.0 * t + 2.0) > share(0.05, 0.5, 2.0 * t), "angle {t}");
        assert!(share(0.02 + 0.005 * (t + 1.0), 0.5, 30.0) < share(0.02 + 0.005 * t, 0.5, 30.0), "height {t}");
    }
}

/// Row BR-5.
#[test]
fn htsg_is_reciprocal() {
    for form in [Form::Corrected, Form::Printed] {
        let model = model("htsg", &[], form);
        assert!(asymmetry(|a, b| model.value(a, b).x, 20_000) < 1e-6);
    }
}

#[test]
fn sampled_albedo_is_the_integral_for_smooth_and_rough_surfaces() {
    for (sigma0, tau) in [("0.05", "3"), ("0.1", "1.5"), ("0.15", "1.77"), ("0.28", "1.77"), ("3", "12")] {
        let model = surface(sigma0, tau, "0.5", Form::Corrected);
        for theta in [0.0, 60.0, 80.0] {
            let quadrature = scattered(&*model, theta);
            let (mean, error) = sampled_albedo(&*model, theta, 0.0, 8_000);
            let close = (mean - quadrature).abs() < 4.0 * error + 1e-3;
            assert!(close && error < 0.02, "σ0 {sigma0}, τ {tau}, {theta}°: sampled {mean} ± {error}, quadrature {quadrature}");
        }
    }
}

#[test]
fn colours_come_from_wavelengths_and_metals() {
    let gold = model("htsg", &[("metal", "gold"), ("lambda", "0.6114,0.5491,0.4642"), ("kd", "0.1")], Form::Corrected);
    let (wi, wo) = directions(SETS[0].1);
    let red = model("htsg", &[("metal", "gold"), ("lambda", "0.6114"), ("kd", "0.1")], Form::Corrected);
    assert!((gold.value(wi, wo).x - red.value(wi, wo).x).abs() < 1e-12);
    let mirror = model("htsg", &[("metal", "gold"), ("lambda", "0.6114,0.5491,0.4642"), ("sigma0", "0.01")], Form::Corrected).mirror(wo);
    assert!(mirror.x > mirror.y && mirror.y > mirror.z && mirror.z > 0.1, "{mirror}");
}

/// Row BR-41: single precision, too, from mirrors to the roughest.
#[test]
fn htsg_is_finite_and_not_negative() {
    let mut rng = kajo_sampling::Rng::new(41);
    for (sigma0, tau, lambda) in [
        ("0.0001", "0.01", "100"),
        ("0.0001", "10000", "0.1"),
        ("0.28", "1.77", "0.7,0.5,0.4"),
        ("11.2", "70.8", "0.5"),
        ("100", "0.01", "0.1"),
        ("100", "10000", "0.1"),
    ] {
        for form in [Form::Corrected, Form::Printed] {
            let model = model("htsg", &[("sigma0", sigma0), ("tau", tau), ("lambda", lambda)], form);
            for k in 0..1000 {
                let (wi, wo) = extreme_pair(&mut rng, k);
                assert_finite(&*model, wi, wo);
                let mirror = model.mirror(wo);
                assert!(mirror.is_finite() && mirror.min_element() >= 0.0 && mirror.max_element() <= 1.0 + 1e-12, "{mirror} at {wo}");
            }
        }
    }
}

/// Path tracer and GPU evaluate in single precision: it must stay near double precision at every roughness.
#[test]
fn single_precision_follows_double_precision() {
    let mut rng = kajo_sampling::Rng::new(32);
    for (sigma0, tau) in [("0.02", "3"), ("0.15", "1.77"), ("0.28", "1.77"), ("1", "10"), ("11.2", "70.8"), ("50", "200")] {
        let model = surface(sigma0, tau, "0.5", Form::Corrected);
        for _ in 0..2000 {
            let angles = [85.0, 360.0, 85.0, 360.0].map(|scale| f64::from(rng.next_1d()) * scale);
            let (wi, wo) = directions(angles);
            let (double, single) = (model.value(wi, wo).x, f64::from(model.value_f32(wi.as_vec3(), wo.as_vec3()).x));
            assert!((single - double).abs() <= 2e-3 * double + 1e-6, "σ0 {sigma0}, {angles:?}: f32 {single}, f64 {double}");
        }
    }
}
