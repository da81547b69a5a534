//! Closed bodies stay closed: rays start on the seen side of all surfaces around, not of their own alone.

use super::scenes::{Stage, at, glowing, lambert, mean, mirror, render_at, sized};
use crate::{Integrator, RussianRoulette, Settings};
use glam::{Quat, Vec3};
use kajo_scene::{Material, Mesh, Scene, Transform, shapes};

/// A closed room of perfect reflectors under a bright sky. Everything touches its floor, and the opaque bodies have a lamp inside.
fn dark_room() -> Scene {
    let glass = Material { transmission: 1.0, thickness: 1.0, roughness: 0.0, metallic: 0.0, ..Material::default() };
    let turned = |x, y, z| Transform::Trs { translation: Vec3::new(x, y, z), rotation: Quat::from_rotation_y(0.5), scale: Vec3::ONE };
    let lamp = |radius| (shapes::sphere(radius, 16), glowing(1.0, 0.0));
    let filled = |stage: Stage, body: Mesh, material, (lamp, glow): (Mesh, Material), place: Transform| {
        stage.mesh(body, material, place).mesh(lamp, glow, place)
    };
    let room = Stage::default()
        .mesh(shapes::cuboid(Vec3::new(2.0, 1.5, 2.5)).inside_out(), lambert(1.0), at(Vec3::Y * 1.5))
        .mesh(shapes::sphere(0.4, 24), glass, at(Vec3::new(0.0, 0.4, 0.2)))
        .mesh(shapes::torus(0.35, 0.12, [24, 12]), lambert(1.0), at(Vec3::new(0.8, 0.12, 0.5)))
        .perspective(Vec3::new(0.0, 1.4, 2.3), Vec3::new(0.0, 0.3, 0.0), 60.0)
        .environment(1.0);
    let room = filled(room, shapes::sphere(0.5, 32), lambert(1.0), lamp(0.4), at(Vec3::new(-0.7, 0.5, -0.6)));
    let room = filled(room, shapes::sphere(0.3, 16), mirror(), lamp(0.2), at(Vec3::new(-0.9, 0.3, 0.5)));
    filled(room, shapes::cuboid(Vec3::new(0.4, 0.7, 0.4)), lambert(1.0), lamp(0.3), turned(0.8, 0.7, -0.9)).0
}

/// No path of up to 64 bounces leaves the room or enters a body. When points were lifted off the smooth meshes without looking, 1 path of
/// 100 did; with steps along the normal, 1 of 250 000.
#[test]
fn no_light_enters_a_closed_room_or_leaves_a_closed_body() {
    for integrator in [Integrator::BsdfOnly, Integrator::Path] {
        let settings = Settings { integrator, max_depth: 64, russian_roulette: RussianRoulette::Off, ..sized(32, 32) };
        assert_eq!(mean(&render_at(&dark_room(), &settings, 64)), 0.0, "{integrator:?}");
    }
}

/// The check above sees a lamp through a hole: one body of the room is left away, but not what is inside of it.
#[test]
fn planted_fault_an_open_lamp_is_seen() {
    let mut open = dark_room();
    open.nodes.iter_mut().filter(|node| node.meshes == [3]).for_each(|node| node.meshes.clear());
    assert!(mean(&render_at(&open, &Settings { max_depth: 4, ..sized(32, 32) }, 4)) > 0.0);
}
