//! Rooms that several scenes stand in.

use super::stage::{Stage, at};
use crate::{Mesh, shapes};
use glam::{Quat, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Materials of the six sides of a room; `None` leaves a side open.
pub(super) struct Walls {
    pub floor: Option<usize>,
    pub ceiling: Option<usize>,
    pub left: Option<usize>,
    pub right: Option<usize>,
    pub back: Option<usize>,
    pub front: Option<usize>,
}

/// The inner faces of a room of the given size, floor at y = 0 and centred on the y axis; left is −x, back is −z.
pub(super) fn room(stage: &mut Stage, size: Vec3, walls: &Walls) {
    let Vec3 { x: width, y: height, z: depth } = size;
    let wall = |width, height, turn: f32, centre| shapes::rectangle(width, height).moved(Quat::from_rotation_y(turn), centre);
    let middle = height / 2.0;
    let sides: [(&str, Option<usize>, Mesh); 6] = [
        ("floor", walls.floor, shapes::floor(width, depth, 1.0)),
        ("ceiling", walls.ceiling, shapes::floor(width, depth, 1.0).moved(Quat::from_rotation_x(PI), Vec3::new(0.0, height, 0.0))),
        ("left wall", walls.left, wall(depth, height, FRAC_PI_2, Vec3::new(-width / 2.0, middle, 0.0))),
        ("right wall", walls.right, wall(depth, height, -FRAC_PI_2, Vec3::new(width / 2.0, middle, 0.0))),
        ("back wall", walls.back, wall(width, height, 0.0, Vec3::new(0.0, middle, -depth / 2.0))),
        ("front wall", walls.front, wall(width, height, PI, Vec3::new(0.0, middle, depth / 2.0))),
    ];
    for (name, material, mesh) in sides {
        if let Some(material) = material {
            stage.place(name, mesh, material, at(0.0, 0.0, 0.0));
        }
    }
}
