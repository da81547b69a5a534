//! Two boards one above the other over a floor: where the light sees the edge of the upper one over the lower one, a filtered map holds both depths, and of
//! the floor below, which is in the shadow of both, it knows no more than that.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, looking};
use crate::{LightShape, Scene, shapes};
use glam::Vec3;
use kajo_units::{LinearRgb, Radians};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "stacked",
    description: "two stacked boards under one spot: where filtered shadow maps leak light",
    count: None,
    make,
};

/// Heights of the boards, m.
const HEIGHTS: [f32; 2] = [1.2, 2.4];
/// Height of the light, m.
const LIGHT_HEIGHT: f32 = 4.0;

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(1.5);
    let white = stage.material("white", lambert(LinearRgb::splat(0.75)));
    let [low, high] = [LinearRgb::new(0.15, 0.35, 0.55), LinearRgb::new(0.6, 0.3, 0.12)].map(lambert);
    let (low, high) = (stage.material("low", low), stage.material("high", high));
    stage.place("floor", shapes::floor(8.0, 8.0, 1.0), white, at(0.0, 0.0, 0.0));
    // The shadow of the upper one ends within that of the lower one.
    stage.place("low board", shapes::cuboid(Vec3::new(0.55, 0.01, 0.55)), low, at(0.0, HEIGHTS[0], 0.0));
    stage.place("high board", shapes::cuboid(Vec3::new(0.25, 0.01, 0.25)), high, at(0.0, HEIGHTS[1], 0.0));
    let spot = LightShape::Spot { inner: Radians(0.6), outer: Radians(0.65) };
    stage.light("spot", spot, LinearRgb::splat(40.0), looking(Vec3::new(0.0, LIGHT_HEIGHT, 0.0), Vec3::ZERO));
    stage.camera("camera", Vec3::new(1.7, 1.1, 1.7), Vec3::new(0.0, 0.12, 0.0), 48.0, Some(16.0 / 9.0));
    stage.finish()
}
