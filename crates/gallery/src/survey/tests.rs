//! Row BR-37: what section 5 asks of each figure, on rendered pixels.

use super::*;

fn assert_measured(number: &str) {
    let figure = FIGURES.iter().find(|figure| figure.number == number).unwrap();
    let rows = (figure.rows)();
    let measured = (figure.measure)(&rows).unwrap();
    assert!(!measured.checks.is_empty() && measured.curves.iter().all(|curves| curves.curves.iter().all(|curve| curve.points.len() > 100)));
    let wrong: Vec<&Check> = measured.checks.iter().filter(|check| !check.holds).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn figure_2_1_pixels_are_as_one_to_five() {
    assert_measured("2.1");
}

#[test]
fn figure_2_3_highlights_halve_where_section_5_says() {
    assert_measured("2.3");
}

#[test]
fn figure_2_4_highlights_are_twice_as_wide_as_phongs() {
    assert_measured("2.4");
}

#[test]
fn figure_3_7_pixels_are_the_golden_values_and_copper_turns_white() {
    assert_measured("3.7");
}

#[test]
fn figure_3_8_albedos_are_those_of_section_5_and_highlights_shrink() {
    assert_measured("3.8");
}

#[test]
fn figure_3_9_contours_are_wider_than_cook_torrances() {
    assert_measured("3.9");
}

#[test]
fn figure_4_1_smoothness_sets_exponent_and_diffuse_share() {
    assert_measured("4.1");
}

#[test]
fn figure_4_2_metalness_sets_the_highlights_colour() {
    assert_measured("4.2");
}

#[test]
fn figure_4_3_axes_are_as_the_slopes_and_exchange_is_a_turn() {
    assert_measured("4.3");
}

#[test]
fn figure_4_5_zenith_factors_halve_where_section_5_says() {
    assert_measured("4.5");
}

#[test]
fn figure_4_6_azimuth_factors_span_one_over_p() {
    assert_measured("4.6");
}

#[test]
fn figure_4_7_widths_scale_as_the_root_of_the_exponent() {
    assert_measured("4.7");
}

/// Spheres of other parameters do not pass for a figure's.
#[test]
fn a_wrong_sphere_is_noticed() {
    for (number, change) in [("4.2", "e=0.6"), ("4.5", "r=0.21"), ("4.6", "p=0.31")] {
        let figure = FIGURES.iter().find(|figure| figure.number == number).unwrap();
        let mut rows = (figure.rows)();
        for (_, balls) in &mut rows {
            balls[2] = balls[2].with(change);
        }
        let measured = (figure.measure)(&rows).unwrap();
        assert!(measured.checks.iter().any(|check| !check.holds), "{number} {change}");
    }
}
