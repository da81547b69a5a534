use crate::models::Form;
use crate::models::testing::*;

/// Row BR-9.
#[test]
fn lambert_is_its_reflectance_over_pi() {
    assert_golden("lambert", &[("kd", "0.8")], Form::Corrected, [0.254_647_908_9; 5], 1e-9);
    let half = model("lambert", &[("kd", "0.8,0.5,0")], Form::Corrected);
    let (wi, wo) = directions(SETS[0].1);
    assert_eq!(half.value(wi, wo).z, 0.0);
    assert_eq!(half.value(-wi, wo).x, 0.0, "below the horizon");
    let bsf = model("lambert-bsf", &[("kd", "0.8")], Form::Corrected);
    assert_eq!(bsf.value(wi, wo).x, 0.8 * wi.z);
}

/// Row BR-9.
#[test]
fn lambert_reflects_kd_from_everywhere() {
    for theta in [0.0, 30.0, 60.0, 75.0, 85.0] {
        for id in ["lambert", "lambert-bsf"] {
            let found = furnace(&*model(id, &[("kd", "0.8")], Form::Corrected), theta);
            assert!((found - 0.8).abs() < 1e-10, "{id} {theta}°: {found}");
        }
    }
    let darker = furnace(&*model("lambert", &[("kd", "0.79999")], Form::Corrected), 30.0);
    assert!((darker - 0.8).abs() > 1e-6, "planted fault");
}

/// Row BR-41.
#[test]
fn lambert_is_robust() {
    assert_robust("lambert", &[&[]]);
    assert_robust("lambert-bsf", &[&[]]);
}
