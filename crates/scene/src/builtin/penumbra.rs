//! A strip light above a white floor, and five boards at heights from 5 cm to 0.8 m: under the far edge of each the penumbra is wide along the strip and
//! narrow across it, and its width is known: w = e h / (H − h) for a light of extent e at height H and an edge at height h.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, turned};
use crate::{LightShape, Scene, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::FRAC_PI_2;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "penumbra",
    description: "strip light over five boards at growing heights: penumbrae of known width",
    count: None,
    make,
};

/// Height of the light above the floor, m.
const LIGHT_HEIGHT: f32 = 3.0;
/// Extent of the light along x and z, m.
const LIGHT_EXTENT: [f32; 2] = [0.1, 1.6];
/// Heights of the lower edges of the boards, m.
const HEIGHTS: [f32; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.8);
    let white = stage.material("white", lambert(LinearRgb::splat(0.75)));
    let board = stage.material("board", lambert(LinearRgb::new(0.6, 0.2, 0.12)));
    stage.place("floor", shapes::floor(12.0, 12.0, 1.0), white, at(0.0, 0.0, 0.0));
    for (index, height) in HEIGHTS.into_iter().enumerate() {
        let half = Vec3::new(0.22, 0.01, 0.22);
        stage.place(&format!("board {index}"), shapes::cuboid(half), board, at(0.85 * (index as f32 - 2.0), height + half.y, 0.0));
    }
    let strip = LightShape::Rectangle { width: Meters(LIGHT_EXTENT[0]), height: Meters(LIGHT_EXTENT[1]) };
    let down = turned(Vec3::new(0.0, LIGHT_HEIGHT, 0.0), Quat::from_rotation_x(-FRAC_PI_2));
    stage.light("strip", strip, LinearRgb::new(60.0, 57.0, 52.0), down);
    stage.camera("camera", Vec3::new(0.15, 2.3, 3.9), Vec3::new(0.15, 0.2, 0.0), 40.0, Some(16.0 / 9.0));
    stage.finish()
}
