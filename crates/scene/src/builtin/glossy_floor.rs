//! A hall whose floor lies in four lanes of roughness 0.05, 0.15, 0.3 and 0.5, with columns and glowing panels along it: the reflections blur with
//! roughness and with distance from the contact.

use super::BuiltinScene;
use super::room::{Walls, room};
use super::stage::{Stage, at, lambert, plastic, turned};
use crate::{LightShape, Material, Scene, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::FRAC_PI_2;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "glossy-floor",
    description: "hall with a floor in four lanes of roughness, columns and glowing panels: glossy reflections",
    count: None,
    make,
};

/// Roughness of the lanes, left to right.
const ROUGHNESS: [f32; 4] = [0.05, 0.15, 0.3, 0.5];
const WIDTH: f32 = 8.0;
const DEPTH: f32 = 9.0;

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.0);
    let rgb = LinearRgb::new;
    let white = stage.material("white", lambert(rgb(0.66, 0.65, 0.62)));
    let lane_width = WIDTH / ROUGHNESS.len() as f32;
    for (lane, roughness) in ROUGHNESS.into_iter().enumerate() {
        let material = Material { ior: 1.8, ..plastic(rgb(0.07, 0.075, 0.085), roughness) };
        let material = stage.material(&format!("lane {roughness}"), material);
        let x = (lane as f32 + 0.5) * lane_width - WIDTH / 2.0;
        stage.place(&format!("lane {roughness}"), shapes::floor(lane_width, DEPTH, 1.0), material, at(x, 0.0, 0.0));
    }
    let walls = Walls { floor: None, ceiling: Some(white), left: Some(white), right: Some(white), back: Some(white), front: Some(white) };
    room(&mut stage, Vec3::new(WIDTH, 3.6, DEPTH), &walls);

    let column_colors = [rgb(0.6, 0.1, 0.06), rgb(0.62, 0.45, 0.08), rgb(0.1, 0.4, 0.14), rgb(0.09, 0.2, 0.52)];
    let panel_colors = [rgb(3.4, 2.2, 1.1), rgb(1.2, 2.8, 3.2), rgb(3.0, 1.2, 2.2), rgb(1.8, 3.0, 1.2)];
    for lane in 0..ROUGHNESS.len() {
        let x = (lane as f32 + 0.5) * lane_width - WIDTH / 2.0;
        let color = stage.material(&format!("column {lane}"), lambert(column_colors[lane]));
        stage.place(&format!("column {lane}"), shapes::cylinder(0.22, 1.5, 64), color, at(x - 0.35, 0.0, -1.4));
        let ball = stage.material(&format!("ball {lane}"), plastic(column_colors[3 - lane], 0.3));
        stage.place(&format!("ball {lane}"), shapes::sphere(0.28, 64), ball, at(x + 0.3, 0.28, -0.3));
        let glow = Material { emission: panel_colors[lane], ..lambert(LinearRgb::splat(0.2)) };
        let glow = stage.material(&format!("panel {lane}"), glow);
        let panel = shapes::rounded_cuboid(Vec3::new(0.5, 0.9, 0.04), 0.02, 3);
        stage.place(&format!("panel {lane}"), panel, glow, at(x, 1.25, -DEPTH / 2.0 + 0.3));
    }
    let ceiling_light = LightShape::Rectangle { width: Meters(5.0), height: Meters(0.5) };
    let down = turned(Vec3::new(0.0, 3.58, -0.5), Quat::from_rotation_x(-FRAC_PI_2));
    stage.light("ceiling light", ceiling_light, rgb(7.0, 6.8, 6.4), down);
    stage.camera("camera", Vec3::new(0.0, 1.5, 4.3), Vec3::new(0.0, 0.72, -1.6), 50.0, Some(16.0 / 9.0));
    stage.finish()
}
