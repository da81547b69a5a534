//! Colour and tone maps.

use crate::compare::{Tolerance, conform};
use glam::Vec3;
use kajo_image::ToneMap;
use kajo_sampling::Rng;
use kajo_units::{LinearRgb, linear_from_srgb, srgb_from_linear};

/// Colours over 24 stops: greys, saturated ones, zeros, negative channels and random ones.
fn colors() -> Vec<[f32; 3]> {
    let mut rng = Rng::new(5);
    let greys = (0..200).map(|i| [(-16.0 + i as f32 * 0.12f32).exp2(); 3]);
    let edges = [[0.0; 3], [-1.0, 0.5, 2.0], [0.08; 3], [0.76, 0.8, 0.84], [1e9, 0.0, 0.0], [1e-30, 1.0, 1e5]];
    let random = (0..4000).map(|_| [0; 3].map(|_: u8| (-16.0 + 24.0 * rng.next_1d()).exp2()));
    greys.chain(edges).chain(random).collect()
}

#[test]
fn tone_maps_match() {
    for (index, curve) in ToneMap::ALL.into_iter().enumerate() {
        let shader = format!(
            "import shader_lib::tone_map::tone_map;
            fn eval(x: array<f32, 3>) -> array<f32, 3> {{
                let c = tone_map({index}u, vec3f(x[0], x[1], x[2]));
                return array(c.r, c.g, c.b);
            }}"
        );
        let twin = |x: [f32; 3]| curve.map(LinearRgb(Vec3::from_array(x))).0.to_array();
        // A display shows steps of 1/255; near black the difference of the matrix rows cancels digits.
        conform(&format!("tone_map {curve}"), &shader, &colors(), twin, Tolerance { relative: 2e-4, absolute: 1e-5 });
    }
}

#[test]
fn srgb_and_luminance_match() {
    let shader = "import shader_lib::color::{srgb_from_linear, linear_from_srgb, luminance};
        fn eval(x: array<f32, 2>) -> array<f32, 3> {
            return array(srgb_from_linear(x[0]), linear_from_srgb(x[0]), luminance(vec3f(x[0], x[1], 0.5)));
        }";
    let twin = |x: [f32; 2]| [srgb_from_linear(x[0]), linear_from_srgb(x[0]), LinearRgb::new(x[0], x[1], 0.5).luminance()];
    conform("color", shader, &crate::points::unit_square(), twin, Tolerance::USUAL);
}
