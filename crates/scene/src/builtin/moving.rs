//! A loop of four seconds: the camera drifts along the room, a spot light swings, a ball bounces, a torus turns and a bar sweeps through the light.

use super::BuiltinScene;
use super::room::{Walls, room};
use super::stage::{Stage, at, lambert, looking, plastic, turned};
use crate::{Animation, Channel, Interpolation, LightShape, Material, Property, Scene, Transform, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters, Radians};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

pub(super) const SCENE: BuiltinScene =
    BuiltinScene { name: "moving", description: "loop of 4 s: camera, spot light and bodies in motion", count: None, make };

/// Length of the loop, s.
const DURATION: f32 = 4.0;

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.0);
    let rgb = LinearRgb::new;
    let white = stage.material("white", lambert(rgb(0.68, 0.66, 0.62)));
    let teal = stage.material("teal", lambert(rgb(0.1, 0.34, 0.34)));
    let tiles = stage.texture("tiles", 2, 6.0, |x, y| if (x + y) % 2 == 0 { [188, 184, 178, 255] } else { [120, 118, 116, 255] });
    let floor = stage.material("floor", Material { base_color_texture: Some(tiles), ..plastic(LinearRgb::WHITE, 0.25) });
    let red = stage.material("red", plastic(rgb(0.6, 0.05, 0.03), 0.2));
    let yellow = stage.material("yellow", lambert(rgb(0.7, 0.5, 0.08)));
    let steel = stage.material("steel", super::stage::metal(rgb(0.56, 0.57, 0.58), 0.2));

    let walls =
        Walls { floor: Some(floor), ceiling: Some(white), left: Some(teal), right: Some(white), back: Some(white), front: Some(white) };
    room(&mut stage, Vec3::new(6.0, 3.0, 7.0), &walls);
    for i in 0..4 {
        stage.place(&format!("column {i}"), shapes::cylinder(0.12, 3.0, 48), white, at(-1.8 + 1.2 * i as f32, 0.0, -2.4));
    }
    let ball = stage.place("ball", shapes::sphere(0.3, 64), red, at(-0.9, 0.3, -0.6));
    let ring = stage.place("ring", shapes::torus(0.42, 0.09, [96, 32]), yellow, at(0.9, 0.9, -0.9));
    let bar = stage.place("bar", shapes::rounded_cuboid(Vec3::new(0.9, 0.03, 0.05), 0.02, 3), steel, at(0.0, 1.6, -0.4));

    let panel = LightShape::Rectangle { width: Meters(1.4), height: Meters(1.0) };
    stage.light("panel", panel, rgb(11.0, 11.8, 13.0), turned(Vec3::new(0.0, 2.98, 1.0), Quat::from_rotation_x(-FRAC_PI_2)));
    let spot = LightShape::Spot { inner: Radians::from_degrees(18.0), outer: Radians::from_degrees(28.0) };
    let lamp = Vec3::new(0.0, 2.8, 0.8);
    let spot = stage.light("swinging spot", spot, rgb(48.0, 41.0, 30.0), looking(lamp, Vec3::new(0.0, 0.0, -0.8)));
    let eye = Vec3::new(0.0, 1.5, 3.2);
    let camera = stage.camera("camera", eye, Vec3::new(0.0, 0.8, -1.0), 48.0, Some(16.0 / 9.0));

    let target = |x: f32| Vec3::new(x, 0.8, -1.0);
    stage.animation(Animation {
        name: "loop".into(),
        channels: vec![
            translation(ball, 32, |t| Vec3::new(-0.9, 0.3 + 1.1 * 4.0 * (2.0 * t).fract() * (1.0 - (2.0 * t).fract()), -0.6)),
            rotation(ring, 16, |t| Quat::from_rotation_y(TAU * t) * Quat::from_rotation_x(FRAC_PI_2)),
            rotation(bar, 16, |t| Quat::from_rotation_y(-TAU * t)),
            rotation(spot, 32, |t| aim(lamp, Vec3::new(1.5 * (TAU * t).sin(), 0.0, -0.8))),
            translation(camera, 32, |t| eye + Vec3::X * 1.2 * (TAU * t).sin()),
            rotation(camera, 32, |t| aim(eye + Vec3::X * 1.2 * (TAU * t).sin(), target(0.3 * (TAU * t + PI).sin()))),
        ],
    });
    stage.finish()
}

/// Linear keys of a translation at `keys + 1` times over the loop; `at` takes the phase in [0, 1].
fn translation(node: usize, keys: u32, at: impl Fn(f32) -> Vec3) -> Channel {
    channel(node, Property::Translation, keys, |phase| at(phase).to_array().to_vec())
}

/// Linear keys of a rotation.
fn rotation(node: usize, keys: u32, at: impl Fn(f32) -> Quat) -> Channel {
    channel(node, Property::Rotation, keys, |phase| at(phase).normalize().to_array().to_vec())
}

fn channel(node: usize, property: Property, keys: u32, at: impl Fn(f32) -> Vec<f32>) -> Channel {
    let phases: Vec<f32> = (0..=keys).map(|k| k as f32 / keys as f32).collect();
    Channel {
        node,
        property,
        interpolation: Interpolation::Linear,
        values: phases.iter().flat_map(|&phase| at(phase)).collect(),
        times: phases.into_iter().map(|phase| phase * DURATION).collect(),
    }
}

/// The rotation of something at `eye` that points its −z at `target`.
fn aim(eye: Vec3, target: Vec3) -> Quat {
    match looking(eye, target) {
        Transform::Trs { rotation, .. } => rotation,
        Transform::Matrix(_) => unreachable!("looking() gives parts"),
    }
}
