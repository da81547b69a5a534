//! One rectangular lamp over one rectangular board over a floor, all level: the border of umbra and penumbra is known in closed form. The board's
//! shadow from each point of the lamp is a rectangle; their intersection is the umbra, their union umbra and penumbra.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, turned};
use crate::{LightShape, Scene, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::FRAC_PI_2;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "umbra",
    description: "rectangular lamp over a board over a floor: umbra and penumbra in closed form",
    count: None,
    make,
};

/// Height of the lamp above the floor, m.
const LAMP_HEIGHT: f32 = 2.5;
/// Extent of the lamp along x and z, m.
const LAMP_EXTENT: [f32; 2] = [0.7, 0.5];
/// Half the extent of the board, m.
const BOARD_HALF: Vec3 = Vec3::new(0.5, 0.01, 0.35);
/// Height of the middle of the board, m.
const BOARD_HEIGHT: f32 = 0.8;

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.6);
    let white = stage.material("white", lambert(LinearRgb::splat(0.75)));
    let wood = stage.material("wood", lambert(LinearRgb::new(0.55, 0.3, 0.14)));
    stage.place("floor", shapes::floor(10.0, 10.0, 1.0), white, at(0.0, 0.0, 0.0));
    stage.place("board", shapes::cuboid(BOARD_HALF), wood, at(0.0, BOARD_HEIGHT, 0.0));
    let lamp = LightShape::Rectangle { width: Meters(LAMP_EXTENT[0]), height: Meters(LAMP_EXTENT[1]) };
    let down = turned(Vec3::new(0.0, LAMP_HEIGHT, 0.0), Quat::from_rotation_x(-FRAC_PI_2));
    stage.light("lamp", lamp, LinearRgb::new(13.0, 12.0, 10.5), down);
    stage.camera("camera", Vec3::new(0.9, 1.7, 2.7), Vec3::new(0.0, 0.25, 0.0), 40.0, Some(16.0 / 9.0));
    stage.finish()
}
