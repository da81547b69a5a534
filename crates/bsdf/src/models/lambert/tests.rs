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
}
