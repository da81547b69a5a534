//! N bodies of six shapes strewn over a polished floor, many small ones and a few large ones, all around the camera: an upper structure of many instances, most of
//! which a reflection hardly shows.

use super::BuiltinScene;
use super::stage::{Stage, lambert, looking, plastic};
use super::{Count, noise};
use crate::{LightShape, Scene, Transform, shapes};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Radians};
use std::f32::consts::TAU;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "scatter",
    description: "N bodies strewn over a polished floor all around the camera: many instances",
    count: Some(Count { what: "bodies", default: 10_000, max: 1_000_000 }),
    make,
};

/// Radius of the strewn disc, m.
const REACH: f32 = 100.0;
/// Around the camera nothing stands, m.
const CLEAR: f32 = 1.5;
/// Sizes of the smallest and the largest bodies, m; between them their number falls with the square of the size.
const SIZES: [f32; 2] = [0.04, 1.2];

fn make(bodies: u32) -> Scene {
    let mut stage = Stage::new(0.3);
    let rgb = LinearRgb::new;
    let floor = stage.material("floor", plastic(rgb(0.05, 0.05, 0.06), 0.12));
    let colors =
        [rgb(0.7, 0.2, 0.12), rgb(0.75, 0.55, 0.15), rgb(0.2, 0.5, 0.25), rgb(0.15, 0.35, 0.65), rgb(0.6, 0.6, 0.58), rgb(0.4, 0.25, 0.5)];
    stage.place("floor", shapes::floor(2.2 * REACH, 2.2 * REACH, 1.0), floor, Transform::default());
    let half = Vec3::splat(0.5);
    let bodies_of = [
        shapes::rounded_cuboid(half, 0.1, 3),
        shapes::sphere(0.5, 24),
        shapes::cylinder(0.35, 1.0, 24).moved(Quat::IDENTITY, Vec3::NEG_Y * 0.5),
        shapes::torus(0.38, 0.12, [24, 12]),
        shapes::cuboid(half * Vec3::new(0.4, 1.0, 0.4)),
        shapes::rounded_cuboid(half * Vec3::new(1.0, 0.5, 0.7), 0.08, 3),
    ];
    let meshes: Vec<usize> = bodies_of
        .into_iter()
        .enumerate()
        .map(|(i, mesh)| {
            let material = stage.material(&format!("paint {i}"), lambert(colors[i]));
            stage.mesh(&format!("body {i}"), mesh, material)
        })
        .collect();
    for i in 0..bodies {
        let unit = |dimension| noise::unit(i, dimension);
        // Evenly over the disc.
        let (distance, angle) = ((CLEAR * CLEAR + unit(1) * (REACH * REACH - CLEAR * CLEAR)).sqrt(), TAU * unit(2));
        let [low, high] = SIZES;
        let size = (1.0 / (1.0 / low + unit(3) * (1.0 / high - 1.0 / low))).min(0.8 * distance);
        let translation = Vec3::new(distance * angle.cos(), 0.55 * size, distance * angle.sin());
        let transform = Transform::Trs { translation, rotation: Quat::from_rotation_y(TAU * unit(4)), scale: Vec3::splat(size) };
        stage.instance(&format!("body {i}"), meshes[(unit(5) * meshes.len() as f32) as usize % meshes.len()], transform);
    }
    let sun = LightShape::Directional { half_angle: Radians(0.00465) };
    stage.light("sun", sun, rgb(2.4, 2.1, 1.7), looking(Vec3::new(3.0, 4.0, 2.0), Vec3::ZERO));
    stage.environment(rgb(0.35, 0.42, 0.5));
    stage.camera("camera", Vec3::new(0.0, 1.5, 0.0), Vec3::new(0.0, 0.6, -6.0), 55.0, Some(16.0 / 9.0));
    stage.finish()
}
