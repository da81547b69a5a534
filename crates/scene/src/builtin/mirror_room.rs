//! A closed room with a perfect mirror on the left wall, a slightly tinted one on the back wall and a polished floor tile: planar reflections of things in
//! view, out of view and behind the camera.

use super::BuiltinScene;
use super::room::{Walls, room};
use super::stage::{Stage, at, lambert, metal, plastic, turned};
use crate::{LightShape, Material, Scene, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "mirror-room",
    description: "closed room with two flat mirrors: reflections of what is in view, off screen and behind the camera",
    count: None,
    make,
};

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.6);
    let rgb = LinearRgb::new;
    let white = stage.material("white", lambert(rgb(0.72, 0.7, 0.66)));
    let ochre = stage.material("ochre", lambert(rgb(0.62, 0.38, 0.12)));
    let blue = stage.material("blue", lambert(rgb(0.12, 0.22, 0.5)));
    let boards = stage.texture("boards", 2, 8.0, |x, y| if (x + y) % 2 == 0 { [150, 118, 84, 255] } else { [124, 92, 62, 255] });
    let floor = stage.material("floor", Material { base_color_texture: Some(boards), ..lambert(LinearRgb::WHITE) });
    let silver = stage.material("silver", metal(rgb(0.97, 0.96, 0.95), 0.0));
    let bronze = stage.material("bronze", metal(rgb(0.78, 0.63, 0.48), 0.0));
    let frame = stage.material("frame", plastic(rgb(0.05, 0.035, 0.025), 0.35));
    let red = stage.material("red", plastic(rgb(0.55, 0.04, 0.03), 0.3));
    let green = stage.material("green", lambert(rgb(0.12, 0.42, 0.16)));

    let walls =
        Walls { floor: Some(floor), ceiling: Some(white), left: Some(white), right: Some(ochre), back: Some(white), front: Some(blue) };
    room(&mut stage, Vec3::new(5.0, 2.8, 6.0), &walls);

    // Mirrors stand 3 cm before their walls, in frames.
    let framed = |stage: &mut Stage, name: &str, material, centre: Vec3, turn: f32, [width, height]: [f32; 2]| {
        let rotation = Quat::from_rotation_y(turn);
        stage.place(name, shapes::rectangle(width, height), material, turned(centre, rotation));
        let border = 0.05;
        for (index, (x, y, half)) in [
            (0.0, (height + border) / 2.0, Vec3::new(width / 2.0 + border, border / 2.0, 0.025)),
            (0.0, -(height + border) / 2.0, Vec3::new(width / 2.0 + border, border / 2.0, 0.025)),
            ((width + border) / 2.0, 0.0, Vec3::new(border / 2.0, height / 2.0, 0.025)),
            (-(width + border) / 2.0, 0.0, Vec3::new(border / 2.0, height / 2.0, 0.025)),
        ]
        .into_iter()
        .enumerate()
        {
            let place = centre + rotation * Vec3::new(x, y, 0.0);
            stage.place(&format!("{name} frame {index}"), shapes::cuboid(half), frame, turned(place, rotation));
        }
    };
    framed(&mut stage, "left mirror", silver, Vec3::new(-2.47, 1.35, -0.6), FRAC_PI_2, [3.0, 1.9]);
    framed(&mut stage, "back mirror", bronze, Vec3::new(1.1, 1.4, -2.97), 0.0, [1.4, 1.7]);

    stage.place("sphere", shapes::sphere(0.4, 96), red, at(-0.9, 0.4, -1.2));
    stage.place("column", shapes::cylinder(0.18, 1.5, 64), green, at(0.35, 0.0, -1.9));
    let block = shapes::rounded_cuboid(Vec3::new(0.3, 0.45, 0.3), 0.03, 4);
    stage.place("block", block, ochre, turned(Vec3::new(1.35, 0.45, -1.0), Quat::from_rotation_y(FRAC_PI_4)));
    stage.place("torus", shapes::torus(0.32, 0.1, [96, 48]), blue, turned(Vec3::new(0.1, 0.42, -0.5), Quat::from_rotation_x(1.3)));
    // Behind the camera, seen in mirrors only.
    stage.place("hidden column", shapes::cylinder(0.22, 1.8, 64), red, at(-1.4, 0.0, 2.4));

    let panel = LightShape::Rectangle { width: Meters(1.6), height: Meters(1.0) };
    let down = turned(Vec3::new(0.0, 2.79, -0.4), Quat::from_rotation_x(-FRAC_PI_2));
    stage.light("panel", panel, rgb(11.0, 10.4, 9.4), down);
    stage.camera("camera", Vec3::new(1.2, 1.5, 2.2), Vec3::new(-0.5, 0.95, -1.6), 52.0, Some(16.0 / 9.0));
    stage.finish()
}
