use crate::models::Form;
use crate::models::testing::*;
use glam::DVec3;

/// Row BR-8.
#[test]
fn ambient_is_ka_and_reflects_no_light() {
    let ambient = model("ambient", &[("ka", "0.3,0.2,0.1")], Form::Corrected);
    assert_eq!(ambient.ambient(), DVec3::new(0.3, 0.2, 0.1));
    let (wi, wo) = directions(SETS[0].1);
    assert_eq!(ambient.value(wi, wo), DVec3::ZERO);
    assert_eq!(model("lambert", &[], Form::Corrected).ambient(), DVec3::ZERO, "a reflection has none");
}

/// Row BR-41.
#[test]
fn ambient_is_robust() {
    assert_robust("ambient", &[&[]]);
}
