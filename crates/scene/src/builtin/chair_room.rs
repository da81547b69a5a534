//! A furnished room: a table and two chairs with thin legs on a polished floor, daylight through a window and a lamp. The chairs are what box-shaped
//! proxies of the room cannot reflect.

use super::BuiltinScene;
use super::room::{Walls, room};
use super::stage::{Stage, at, lambert, plastic, turned};
use crate::{LightShape, Material, Mesh, Scene, shapes};
use glam::{Quat, Vec2, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::{FRAC_PI_2, PI};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "chair-room",
    description: "room with table and chairs on a polished floor, daylight from a window and a lamp",
    count: None,
    make,
};

fn make(_: u32) -> Scene {
    let mut stage = Stage::new(0.6);
    let rgb = LinearRgb::new;
    let wall = stage.material("wall", lambert(rgb(0.7, 0.67, 0.6)));
    let accent = stage.material("accent wall", lambert(rgb(0.16, 0.3, 0.32)));
    let ceiling = stage.material("ceiling", lambert(rgb(0.78, 0.78, 0.76)));
    let planks = stage.texture("planks", 8, 4.0, |x, y| {
        let shade = [0u8, 14, 5, 20, 9, 2, 17, 11][((y + x / 4 * 3) % 8) as usize];
        [140 - shade, 92 - shade, 56 - shade / 2, 255]
    });
    let floor = stage.material("floor", Material { base_color_texture: Some(planks), ..plastic(LinearRgb::WHITE, 0.12) });
    let oak = stage.material("oak", plastic(rgb(0.42, 0.25, 0.12), 0.35));
    let cushion = stage.material("cushion", lambert(rgb(0.5, 0.1, 0.07)));
    let ceramic = stage.material("ceramic", plastic(rgb(0.75, 0.74, 0.7), 0.08));
    let brass = stage.material("brass", super::stage::metal(rgb(0.89, 0.75, 0.42), 0.25));
    let shade = stage.material("lamp shade", Material { double_sided: true, ..lambert(rgb(0.82, 0.76, 0.62)) });

    let size = Vec3::new(4.4, 2.6, 4.8);
    let walls =
        Walls { floor: Some(floor), ceiling: Some(ceiling), left: Some(wall), right: Some(wall), back: Some(accent), front: Some(wall) };
    room(&mut stage, size, &walls);

    stage.place("table", table(), oak, at(0.1, 0.0, -0.5));
    for (name, place, turn) in [("chair", Vec3::new(-0.85, 0.0, 0.25), 2.5), ("second chair", Vec3::new(0.95, 0.0, -1.2), -0.7)] {
        let transform = turned(place, Quat::from_rotation_y(turn));
        stage.place(name, chair(), oak, transform);
        let pad = shapes::rounded_cuboid(Vec3::new(0.2, 0.025, 0.2), 0.02, 4).moved(Quat::IDENTITY, Vec3::new(0.0, 0.475, 0.0));
        stage.place(&format!("{name} cushion"), pad, cushion, transform);
    }
    stage.place("vase", vase(), ceramic, at(0.3, 0.75, -0.55));
    stage.place("bowl", bowl(), brass, at(-0.25, 0.75, -0.35));

    // A lamp over the table: a shade with a glowing ball in it.
    stage.place("cord", shapes::cylinder(0.006, 0.75, 12), brass, at(0.1, 1.85, -0.5));
    let shade_profile = [Vec2::new(0.28, 0.0), Vec2::new(0.1, 0.2), Vec2::new(0.02, 0.22)];
    stage.place("lamp shade", shapes::lathe("shade", &shade_profile, 64), shade, at(0.1, 1.65, -0.5));
    stage.light("lamp", LightShape::Sphere { radius: Meters(0.05) }, rgb(80.0, 58.0, 34.0), at(0.1, 1.72, -0.5));

    // The window: a bright pane in a frame on the left wall.
    let left = -size.x / 2.0;
    let window = LightShape::Rectangle { width: Meters(1.5), height: Meters(1.3) };
    let inwards = turned(Vec3::new(left + 0.02, 1.5, -0.3), Quat::from_rotation_y(-FRAC_PI_2));
    stage.light("window", window, rgb(6.0, 7.0, 8.4), inwards);
    for (name, offset, half) in [
        ("window bar", Vec3::ZERO, Vec3::new(0.015, 0.65, 0.02)),
        ("window cross bar", Vec3::ZERO, Vec3::new(0.015, 0.02, 0.75)),
        ("window sill", Vec3::new(0.07, -0.68, 0.0), Vec3::new(0.09, 0.02, 0.82)),
    ] {
        let place = Vec3::new(left + 0.045, 1.5, -0.3) + offset;
        stage.place(name, shapes::cuboid(half), ceiling, at(place.x, place.y, place.z));
    }
    stage.camera("camera", Vec3::new(1.55, 1.5, 2.15), Vec3::new(-0.2, 0.72, -0.5), 55.0, Some(16.0 / 9.0));
    stage.finish()
}

/// A chair that faces +z: seat at 0.45 m, back slats, four turned legs.
fn chair() -> Mesh {
    let mut chair = Mesh::default();
    let mut part = |mesh: Mesh, x: f32, y: f32, z: f32| chair.append(&mesh.moved(Quat::IDENTITY, Vec3::new(x, y, z)));
    part(shapes::rounded_cuboid(Vec3::new(0.22, 0.018, 0.22), 0.012, 3), 0.0, 0.432, 0.0);
    for (x, z, height) in [(-0.19, 0.19, 0.42), (0.19, 0.19, 0.42), (-0.19, -0.19, 0.92), (0.19, -0.19, 0.92)] {
        part(shapes::rounded_cuboid(Vec3::new(0.018, height / 2.0, 0.018), 0.006, 2), x, height / 2.0, z);
    }
    for y in [0.6, 0.72, 0.84] {
        part(shapes::rounded_cuboid(Vec3::new(0.175, 0.028, 0.008), 0.006, 2), 0.0, y, -0.19);
    }
    for z in [-0.19, 0.19] {
        part(shapes::cuboid(Vec3::new(0.175, 0.01, 0.01)), 0.0, 0.2, z);
    }
    chair
}

/// A table of 1.4 m × 0.8 m, 0.75 m high.
fn table() -> Mesh {
    let mut table = shapes::rounded_cuboid(Vec3::new(0.7, 0.018, 0.4), 0.012, 3).moved(Quat::IDENTITY, Vec3::new(0.0, 0.732, 0.0));
    for (x, z) in [(-0.62, -0.32), (0.62, -0.32), (-0.62, 0.32), (0.62, 0.32)] {
        let leg = shapes::rounded_cuboid(Vec3::new(0.028, 0.357, 0.028), 0.008, 2);
        table.append(&leg.moved(Quat::IDENTITY, Vec3::new(x, 0.357, z)));
    }
    table
}

/// A vase with a smooth outline and a wall of 5 mm, 0.3 m high.
fn vase() -> Mesh {
    let radius = |t: f32| 0.045 + 0.035 * (PI * (1.5 * t + 0.05)).sin();
    let outer = (0..=24).map(|i| i as f32 / 24.0).map(|t| Vec2::new(radius(t), 0.3 * t));
    let inner = (1..=24).rev().map(|i| i as f32 / 24.0).map(|t| Vec2::new(radius(t) - 0.005, 0.3 * t));
    let bottom = Vec2::new(0.0, 0.0125);
    let outline: Vec<Vec2> = std::iter::once(Vec2::ZERO).chain(outer).chain(inner).chain(std::iter::once(bottom)).collect();
    shapes::smooth_lathe("vase", &outline, 64)
}

/// A bowl: a hemisphere with a wall of 4 mm.
fn bowl() -> Mesh {
    let arc = |radius: f32, i: u32| Vec2::from_angle(-FRAC_PI_2 + FRAC_PI_2 * i as f32 / 12.0) * radius;
    let outer = (0..=12).map(|i| arc(0.12, i));
    let inner = (0..=12).rev().map(|i| arc(0.116, i));
    let outline: Vec<Vec2> = outer.chain(inner).map(|p| Vec2::new(p.x.max(0.0), p.y + 0.12)).collect();
    shapes::smooth_lathe("bowl", &outline, 64)
}
