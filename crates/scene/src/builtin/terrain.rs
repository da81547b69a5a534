//! Hills of exactly N triangles under a sun: the scene for cost against triangle count.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, looking};
use super::{Count, noise};
use crate::{LightShape, Scene, shapes};
use glam::Vec3;
use kajo_units::{LinearRgb, Radians};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "terrain",
    description: "hills of exactly N triangles under a sun",
    count: Some(Count { what: "triangles", default: 100_000, max: 20_000_000 }),
    make,
};

/// Side of the square, m.
const SIDE: f32 = 200.0;

fn make(triangles: u32) -> Scene {
    let mut stage = Stage::new(0.0);
    let ground = stage.material("ground", lambert(LinearRgb::new(0.36, 0.34, 0.22)));
    // The smallest grid, about square, with at least N triangles; the surplus of less than one row is cut off.
    let columns = f64::from(triangles).div_euclid(2.0).sqrt().ceil().max(1.0) as u32;
    let rows = triangles.div_ceil(2 * columns);
    let mut mesh = shapes::height_field([SIDE; 2], [columns, rows], height);
    mesh.indices.truncate(triangles as usize);
    stage.place("terrain", mesh, ground, at(0.0, 0.0, 0.0));

    let sun = LightShape::Directional { half_angle: Radians(0.00465) };
    stage.light("sun", sun, LinearRgb::new(4.2, 3.4, 2.4), looking(Vec3::new(-3.0, 1.2, -0.6), Vec3::ZERO));
    stage.environment(LinearRgb::new(0.15, 0.22, 0.34));
    let eye_ground = height(0.0, 70.0);
    stage.camera("camera", Vec3::new(0.0, eye_ground + 14.0, 88.0), Vec3::new(0.0, 12.0, -10.0), 45.0, Some(16.0 / 9.0));
    stage.finish()
}

/// Height of the ground, m: broad hills with ridges of all sizes.
fn height(x: f32, z: f32) -> f32 {
    let broad = noise::fractal(x / 70.0 + 3.1, z / 70.0 + 8.4, 10);
    38.0 * broad * broad
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn count_is_exact() {
        for count in [1, 2, 3, 7, 8, 9, 100, 4999, 100_000] {
            assert_eq!(make(count).meshes[0].indices.len(), count as usize);
        }
    }
}
