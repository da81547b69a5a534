//! The Cornell box, number for number the scene dictionary `cornell_box()` that Mitsuba 3 (3.9) publishes, so that pictures compare one to one.
//!
//! \[Goral84] built the first; the reflectances and the emission here are those of the dictionary. Its surfaces reflect on their front only, and its
//! lamp is a white rectangle that emits: here an analytic light lies a tenth of a millimetre before a plate of the same size, white below
//! and black above.

use super::BuiltinScene;
use super::stage::{Stage, lambert, turned};
use crate::{LightShape, Scene, Transform, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::FRAC_PI_2;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "cornell",
    description: "Cornell box with two blocks and a rectangle light: diffuse interreflection and soft shadows",
    count: None,
    make,
};

const WHITE: LinearRgb = LinearRgb::new(0.885809, 0.698859, 0.666422);
const GREEN: LinearRgb = LinearRgb::new(0.105421, 0.37798, 0.076425);
const RED: LinearRgb = LinearRgb::new(0.570068, 0.0430135, 0.0443706);
const RADIANCE: LinearRgb = LinearRgb::new(18.387, 13.9873, 6.75357);

/// Distance between the light and the plate behind it, m: enough to keep rays apart in single precision, 1 % of the gap to the ceiling.
const PLATE_OFFSET: f32 = 1e-4;

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.0);
    let white = stage.material("white", lambert(WHITE));
    let green = stage.material("green", lambert(GREEN));
    let red = stage.material("red", lambert(RED));
    let black = stage.material("black", lambert(LinearRgb::BLACK));

    let upwards = Quat::from_rotation_x(-FRAC_PI_2);
    let downwards = Quat::from_rotation_x(FRAC_PI_2);
    let wall = |stage: &mut Stage, name, material, translation, rotation| {
        stage.place(name, shapes::rectangle(2.0, 2.0), material, turned(translation, rotation));
    };
    wall(&mut stage, "floor", white, Vec3::NEG_Y, upwards);
    wall(&mut stage, "ceiling", white, Vec3::Y, downwards);
    wall(&mut stage, "back", white, Vec3::NEG_Z, Quat::IDENTITY);
    wall(&mut stage, "green wall", green, Vec3::X, Quat::from_rotation_y(-FRAC_PI_2));
    wall(&mut stage, "red wall", red, Vec3::NEG_X, Quat::from_rotation_y(FRAC_PI_2));

    let block = |stage: &mut Stage, name, translation, degrees: f32, scale| {
        let rotation = Quat::from_rotation_y(degrees.to_radians());
        stage.place(name, shapes::cuboid(Vec3::ONE), white, Transform::Trs { translation, rotation, scale });
    };
    block(&mut stage, "small box", Vec3::new(0.335, -0.7, 0.38), -17.0, Vec3::splat(0.3));
    block(&mut stage, "large box", Vec3::new(-0.33, -0.4, -0.28), 18.25, Vec3::new(0.3, 0.61, 0.3));

    let [width, height] = [0.46, 0.38];
    let centre = Vec3::new(0.0, 0.99, 0.01);
    // A light shines along −z, a rectangle faces +z: the same way down takes opposite turns.
    stage.light("light", LightShape::Rectangle { width: Meters(width), height: Meters(height) }, RADIANCE, turned(centre, upwards));
    stage.place("light plate", shapes::rectangle(width, height), white, turned(centre + Vec3::Y * PLATE_OFFSET, downwards));
    stage.place("light back", shapes::rectangle(width, height), black, turned(centre + Vec3::Y * 2.0 * PLATE_OFFSET, upwards));

    stage.camera("camera", Vec3::new(0.0, 0.0, 3.9), Vec3::ZERO, 39.3077, Some(1.0));
    stage.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Projection;
    use crate::builtin::tests::world_positions;

    /// Bounds and areas that Mitsuba 3.9.1 prints for the shapes of `mi.cornell_box()`.
    #[test]
    fn geometry_is_that_of_the_published_dictionary() {
        let scene = make(0);
        let corners = |name: &str| world_positions(&scene, name);
        for (name, min, max) in [
            ("red wall", [-1.0, -1.0, -1.0], [-1.0, 1.0, 1.0]),
            ("green wall", [1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
            ("floor", [-1.0, -1.0, -1.0], [1.0, -1.0, 1.0]),
            ("ceiling", [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]),
            ("back", [-1.0, -1.0, -1.0], [1.0, 1.0, -1.0]),
            ("large box", [-0.708859, -1.01, -0.658859], [0.048859, 0.21, 0.098859]),
            ("small box", [-0.039603, -1.0, 0.005397], [0.709603, -0.4, 0.754603]),
            ("light plate", [-0.23, 0.9901, -0.18], [0.23, 0.9901, 0.2]),
        ] {
            let (low, high) =
                corners(name).into_iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
            assert!((low - Vec3::from_array(min)).abs().max_element() < 2e-6, "{name}: {low}");
            assert!((high - Vec3::from_array(max)).abs().max_element() < 2e-6, "{name}: {high}");
        }
    }

    #[test]
    fn colours_light_and_camera_are_those_of_the_published_dictionary() {
        let scene = make(0);
        let color = |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap().base_color.0.to_array();
        assert_eq!(color("white"), [0.885809, 0.698859, 0.666422]);
        assert_eq!(color("green"), [0.105421, 0.37798, 0.076425]);
        assert_eq!(color("red"), [0.570068, 0.0430135, 0.0443706]);
        assert_eq!(scene.lights[0].emission.0.to_array(), [18.387, 13.9873, 6.75357]);
        let LightShape::Rectangle { width, height } = scene.lights[0].shape else { panic!("a rectangle") };
        assert!((width.0 * height.0 - 0.1748).abs() < 1e-6);
        let Projection::Perspective { yfov, .. } = scene.cameras[0].projection else { panic!("a perspective camera") };
        assert!((yfov.0.to_degrees() - 39.3077).abs() < 1e-4);
        let camera = scene.nodes.iter().find(|n| n.camera.is_some()).unwrap();
        let world_from_view = super::super::tests::matrix_of(camera.transform);
        assert_eq!(world_from_view.w_axis.truncate(), Vec3::new(0.0, 0.0, 3.9));
        assert!((world_from_view.transform_vector3(Vec3::NEG_Z) - Vec3::NEG_Z).length() < 1e-6);
    }
}
