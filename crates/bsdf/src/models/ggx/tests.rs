use crate::models::testing::*;
use crate::models::{Form, find};
use crate::{f0_from_ior, fresnel_conductor, fresnel_schlick, ggx_d_aniso, ggx_visibility_aniso};
use glam::{Vec2, Vec3};

/// Against the crate's functions in f32, which the glTF material is made of.
#[test]
fn ggx_is_what_the_gltf_material_is_made_of() {
    for (alpha_x, alpha_y) in [("0.3", "0.3"), ("0.1", "0.4")] {
        let schlick = model("ggx", &[("alpha_x", alpha_x), ("alpha_y", alpha_y), ("f0", "0.9,0.6,0.1")], Form::Corrected);
        let exact = model("ggx", &[("alpha_x", alpha_x), ("alpha_y", alpha_y), ("eta", "1.0"), ("kappa", "2.39")], Form::Corrected);
        for (name, angles) in SETS {
            let (wi, wo) = directions(angles);
            let (i, o) = (wi.as_vec3(), wo.as_vec3());
            let h = (i + o).normalize();
            let alpha = Vec2::new(alpha_x.parse().unwrap(), alpha_y.parse().unwrap());
            let facets = ggx_d_aniso(alpha, h) * ggx_visibility_aniso(alpha, o, i);
            let close =
                |value: glam::DVec3, expected: Vec3| (value.as_vec3() - expected).abs().max_element() < 2e-4 * expected.max_element();
            let expected = facets * fresnel_schlick(Vec3::new(0.9, 0.6, 0.1), Vec3::ONE, h.dot(o));
            assert!(close(schlick.value(wi, wo), expected), "{name}: {} {expected}", schlick.value(wi, wo));
            assert!(!close(schlick.value(wi, wo), 1.001 * expected), "planted fault");
            let expected = facets * fresnel_conductor(h.dot(o), Vec3::ONE, Vec3::splat(2.39));
            assert!(close(exact.value(wi, wo), expected), "{name}: {} {expected}", exact.value(wi, wo));
        }
    }
}

#[test]
fn the_reflectance_is_the_one_asked_for() {
    let (wi, wo) = directions([70.0, 0.0, 70.0, 180.0]);
    let value = |pairs: &[(&str, &str)]| model("ggx", pairs, Form::Corrected).value(wi, wo).x;
    let f0 = f0_from_ior(1.5).to_string();
    let (schlick, exact) = (value(&[("f0", &f0)]), value(&[("eta", "1.5")]));
    assert!((schlick / exact - 1.0).abs() > 0.01, "Schlick's approximation differs at 70°");
    assert!((value(&[("f0", &f0), ("fresnel", "exact")]) / exact - 1.0).abs() < 1e-5);
    assert!((value(&[("eta", "1.5"), ("fresnel", "schlick")]) / schlick - 1.0).abs() < 1e-5);
    assert!(value(&[("metal", "silver")]) > 5.0 * exact);
    let error = find("ggx").unwrap().from_pairs(&[("kappa", "2")], Form::Corrected).err().unwrap().to_string();
    assert!(error.contains("kappa is given without eta"), "{error}");
}

#[test]
fn white_facets_keep_all_light_with_multiple_scattering() {
    for (alpha_x, alpha_y, tolerance) in
        [("0.1", "0.1", 4e-3), ("0.5", "0.5", 4e-3), ("1", "1", 4e-3), ("0.2", "0.8", 5e-3), ("0.8", "0.05", 5e-3)]
    {
        let pairs = [("alpha_x", alpha_x), ("alpha_y", alpha_y), ("f0", "1"), ("multiple_scattering", "true")];
        let (whole, single) = (model("ggx", &pairs, Form::Corrected), model("ggx", &pairs[..3], Form::Corrected));
        for (theta, phi) in [(0.0, 0.0), (80.0, 40.0)] {
            let quadrature = albedo(&*whole, theta, phi);
            assert!((quadrature - 1.0).abs() < tolerance, "α {alpha_x}, {alpha_y}, {theta}°: {quadrature}");
        }
        assert!(albedo(&*single, 80.0, 40.0) < 1.0 - 2.0 * tolerance, "planted fault: the light between facets left out");
    }
    let single = model("ggx", &[("alpha", "1"), ("f0", "1")], Form::Corrected);
    assert!((albedo(&*single, 0.0, 0.0) - 0.307).abs() < 1e-3, "ln 2 of the light meets a second facet");
}

#[test]
fn ggx_samples_give_its_albedo_and_follow_its_density() {
    for pairs in [
        [("alpha_x", "0.2"), ("alpha_y", "0.2"), ("metal", "copper"), ("multiple_scattering", "true")],
        [("alpha_x", "0.1"), ("alpha_y", "0.6"), ("f0", "0.5"), ("multiple_scattering", "false")],
    ] {
        let ggx = model("ggx", &pairs, Form::Corrected);
        for (theta, phi) in [(0.0, 0.0), (75.0, 30.0)] {
            let quadrature = albedo(&*ggx, theta, phi);
            let (mean, error) = sampled_albedo(&*ggx, theta, phi, 100_000);
            assert!(
                (mean - quadrature).abs() < 4.0 * error + 2e-5,
                "{pairs:?}, {theta}°: sampled {mean} ± {error}, quadrature {quadrature}"
            );
        }
        assert_samples_follow(&*ggx, 30.0, 10.0);
        assert_samples_follow(&*ggx, 75.0, 30.0);
    }
}

#[test]
fn ggx_is_reciprocal() {
    for multiple in ["false", "true"] {
        let pairs = [("alpha_x", "0.1"), ("alpha_y", "0.5"), ("eta", "0.2"), ("kappa", "3"), ("multiple_scattering", multiple)];
        let ggx = model("ggx", &pairs, Form::Corrected);
        assert!(asymmetry(|a, b| ggx.value(a, b).x, 20_000) < 1e-11);
    }
}

/// Schlick's zenith term with r = α² is this distribution.
#[test]
fn schlicks_zenith_term_is_this_distribution() {
    let ggx = model("ggx", &[("alpha", "0.3"), ("f0", "1")], Form::Corrected);
    let schlick = model("schlick-single", &[("c", "1"), ("r", "0.09"), ("directional", "simple")], Form::Corrected);
    let (wi, wo) = directions([20.0, 0.0, 20.0, 180.0]);
    let (i, o) = (wi.as_vec3(), wo.as_vec3());
    let masking = 4.0 * wi.z * wo.z * f64::from(ggx_visibility_aniso(Vec2::splat(0.3), o, i));
    assert!((schlick.value(wi, wo).x * masking / ggx.value(wi, wo).x - 1.0).abs() < 1e-5);
}
