//! A closed room in which every surface emits E = 0.5 and reflects a = 0.5: the radiance is E / (1 − a) = 1 in every direction at every point,
//! whatever stands in the room. A pixel that is not 1 shows lost or invented energy.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, turned};
use crate::{Material, Scene, shapes};
use glam::{Quat, Vec3};
use kajo_units::LinearRgb;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "furnace",
    description: "closed room where every surface emits 0.5 and reflects half: every pixel must be exactly 1",
    count: None,
    make,
};

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(-1.0);
    let half = LinearRgb::splat(0.5);
    let glowing = stage.material("glowing", Material { emission: half, ..lambert(half) });
    stage.place("room", shapes::cuboid(Vec3::new(2.0, 1.5, 2.5)).inside_out(), glowing, at(0.0, 1.5, 0.0));
    stage.place("sphere", shapes::sphere(0.5, 64), glowing, at(-0.7, 0.5, -0.6));
    stage.place("box", shapes::cuboid(Vec3::new(0.4, 0.7, 0.4)), glowing, turned(Vec3::new(0.8, 0.7, -0.9), Quat::from_rotation_y(0.5)));
    stage.place("torus", shapes::torus(0.35, 0.12, [64, 32]), glowing, turned(Vec3::new(0.2, 0.6, 0.3), Quat::from_rotation_x(1.0)));
    stage.camera("camera", Vec3::new(0.0, 1.4, 2.3), Vec3::new(0.0, 0.8, 0.0), 60.0, None);
    stage.finish()
}
