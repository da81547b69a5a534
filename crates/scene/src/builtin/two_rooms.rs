//! Two rooms side by side with a wall of 2 cm between them, open towards the camera: one is bright, the other has a candle alone. The wall reaches the
//! open front, beyond which nothing reflects, so no path leads from the bright lamp into the dark room: all its light there is leak.

use super::BuiltinScene;
use super::room::{Walls, room};
use super::stage::{Stage, at, lambert, plastic, turned};
use crate::{LightShape, Scene, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::FRAC_PI_2;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "two-rooms",
    description: "bright and dark room with a wall of 2 cm between: shows light that leaks through it",
    count: None,
    make,
};

/// Thickness of the wall between the rooms, m.
const THICKNESS: f32 = 0.02;
/// Inner size of the whole house, m.
const SIZE: Vec3 = Vec3::new(6.0, 2.6, 3.2);

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.0);
    let rgb = LinearRgb::new;
    let white = stage.material("white", lambert(rgb(0.74, 0.72, 0.68)));
    let warm = stage.material("warm", lambert(rgb(0.66, 0.36, 0.2)));
    let cool = stage.material("cool", lambert(rgb(0.24, 0.36, 0.56)));
    let floor = stage.material("floor", lambert(rgb(0.36, 0.26, 0.18)));
    let glaze = stage.material("glaze", plastic(rgb(0.5, 0.48, 0.42), 0.2));

    let walls = Walls { floor: Some(floor), ceiling: Some(white), left: Some(warm), right: Some(cool), back: Some(white), front: None };
    room(&mut stage, SIZE, &walls);
    let partition = shapes::cuboid(Vec3::new(THICKNESS / 2.0, SIZE.y / 2.0, SIZE.z / 2.0));
    stage.place("partition", partition, white, at(0.0, SIZE.y / 2.0, 0.0));
    // A skirting on both sides, where coarse probes and voxels leak first.
    for side in [-1.0, 1.0] {
        let skirting = shapes::cuboid(Vec3::new(0.01, 0.05, SIZE.z / 2.0));
        stage.place("skirting", skirting, floor, at(side * (THICKNESS / 2.0 + 0.01), 0.05, 0.0));
    }
    for (name, x) in [("bright", -1.6), ("dark", 1.6)] {
        stage.place(&format!("{name} sphere"), shapes::sphere(0.35, 64), glaze, at(x + 0.5, 0.35, -0.5));
        let block = shapes::rounded_cuboid(Vec3::new(0.3, 0.55, 0.3), 0.02, 3);
        stage.place(&format!("{name} block"), block, white, turned(Vec3::new(x - 0.5, 0.55, -0.7), Quat::from_rotation_y(0.5)));
    }
    let panel = LightShape::Rectangle { width: Meters(1.2), height: Meters(1.2) };
    let down = turned(Vec3::new(-1.5, SIZE.y - 0.01, 0.0), Quat::from_rotation_x(-FRAC_PI_2));
    stage.light("panel", panel, rgb(9.0, 8.4, 7.4), down);
    stage.light("candle", LightShape::Sphere { radius: Meters(0.02) }, rgb(320.0, 150.0, 50.0), at(2.3, 0.5, 0.6));
    stage.camera("camera", Vec3::new(0.0, 1.4, 6.2), Vec3::new(0.0, 1.27, 0.0), 33.0, Some(16.0 / 9.0));
    stage.finish()
}
