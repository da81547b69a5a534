//! A paved yard under a low sun, a spot light and a lantern: columns from thick to thin, a fence, steps, a body that touches the ground at one point and
//! one that floats. Small features, contact, long receivers and grazing light are where shadow techniques differ.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, looking, plastic, turned};
use crate::{LightShape, Material, Mesh, Scene, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Radians};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "shadows",
    description: "yard with columns, fence, steps and floating bodies under a sun, a spot light and a point light",
    count: None,
    make,
};

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.0);
    let rgb = LinearRgb::new;
    let tiles = stage.texture("tiles", 2, 1.0, |x, y| if (x + y) % 2 == 0 { [196, 190, 180, 255] } else { [172, 166, 158, 255] });
    let ground = stage.material("ground", Material { base_color_texture: Some(tiles), ..lambert(LinearRgb::WHITE) });
    let plaster = stage.material("plaster", lambert(rgb(0.68, 0.64, 0.58)));
    let clay = stage.material("clay", lambert(rgb(0.55, 0.24, 0.14)));
    let iron = stage.material("iron", plastic(rgb(0.05, 0.055, 0.06), 0.5));
    let glaze = stage.material("glaze", plastic(rgb(0.08, 0.28, 0.36), 0.15));

    stage.place("ground", shapes::floor(30.0, 30.0, 15.0), ground, at(0.0, 0.0, 0.0));
    stage.place("wall", shapes::cuboid(Vec3::new(5.0, 1.4, 0.15)), plaster, at(0.0, 1.4, -3.4));

    // Columns of radius 0.32, 0.16, 0.08, 0.04, 0.02 m.
    for i in 0..5 {
        let radius = 0.32 / f32::from(1u8 << i);
        let column = shapes::cylinder(radius, 2.2, 48);
        stage.place(&format!("column {i}"), column, plaster, at(-3.6 + 0.95 * i as f32, 0.0, -1.9));
    }
    stage.place("fence", fence(), iron, turned(Vec3::new(2.6, 0.0, -1.5), Quat::from_rotation_y(-0.35)));
    for step in 0..4 {
        let height = 0.15 * (step + 1) as f32;
        let half = Vec3::new(0.7, height / 2.0, 0.15);
        stage.place(&format!("step {step}"), shapes::cuboid(half), plaster, at(-2.6, height / 2.0, 0.7 - 0.3 * step as f32));
    }
    stage.place("sphere", shapes::sphere(0.45, 96), glaze, at(-0.6, 0.45, 0.5));
    stage.place("torus", shapes::torus(0.5, 0.13, [96, 48]), clay, turned(Vec3::new(0.9, 1.25, 0.2), Quat::from_rotation_x(1.1)));
    let block = shapes::rounded_cuboid(Vec3::new(0.35, 0.25, 0.35), 0.04, 4);
    stage.place("block", block, clay, turned(Vec3::new(2.3, 0.25, 0.9), Quat::from_rotation_y(0.6)));

    let sun = LightShape::Directional { half_angle: Radians(0.00465) };
    stage.light("sun", sun, rgb(2.6, 2.3, 1.9), looking(Vec3::new(5.0, 4.2, 3.5), Vec3::ZERO));
    let spot = LightShape::Spot { inner: Radians::from_degrees(16.0), outer: Radians::from_degrees(26.0) };
    stage.light("spot", spot, rgb(9.0, 10.5, 13.0), looking(Vec3::new(-4.2, 3.6, 2.6), Vec3::new(-1.4, 0.0, 0.2)));
    stage.light("lantern", LightShape::Point, rgb(2.4, 1.4, 0.6), at(1.35, 0.55, 1.5));
    stage.environment(rgb(0.10, 0.13, 0.18));
    stage.camera("camera", Vec3::new(0.6, 2.5, 6.2), Vec3::new(-0.3, 0.55, -0.6), 38.0, Some(16.0 / 9.0));
    stage.finish()
}

/// 13 bars of 12 mm and two rails, 2.4 m wide.
fn fence() -> Mesh {
    let mut fence = Mesh::default();
    for bar in 0..13 {
        let x = -1.2 + 0.2 * bar as f32;
        fence.append(&shapes::cylinder(0.006, 1.1, 12).moved(Quat::IDENTITY, Vec3::new(x, 0.0, 0.0)));
    }
    for y in [0.2, 1.0] {
        fence.append(&shapes::cuboid(Vec3::new(1.22, 0.02, 0.012)).moved(Quat::IDENTITY, Vec3::new(0.0, y, 0.0)));
    }
    fence
}
