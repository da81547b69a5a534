//! The court of `many-lights` with N glowing triangles in the place of lamps: embers that whirl around the columns, one mesh a column. They share one total
//! power, so scenes of different N differ in the number of choices alone.

use super::many_lights::{COLUMN_RADIUS, TOTAL_POWER, columns, court, hue};
use super::stage::{at, lambert};
use super::{BuiltinScene, Count, noise};
use crate::{Material, Mesh, Scene};
use glam::{Quat, Vec2, Vec3};
use kajo_units::LinearRgb;
use std::f32::consts::{PI, TAU};

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "embers",
    description: "court of columns in whirls of N glowing triangles of one total power",
    count: Some(Count { what: "glowing triangles", default: 1000, max: 1_000_000 }),
    make,
};

/// Area of all embers together, one side, m².
const TOTAL_AREA: f32 = 2.0;

fn make(embers: u32) -> Scene {
    let mut stage = court();
    // An ember has 0.01 m² at most: up to 200 of them have less than the total area.
    let area = TOTAL_AREA.min(0.01 * embers as f32);
    let side = (area / embers as f32 * 4.0 / 3f32.sqrt()).sqrt();
    let radiance = TOTAL_POWER / (PI * area);
    let whirls: Vec<(u8, u8, Vec2)> = columns().collect();
    for (index, &(i, j, place)) in whirls.iter().enumerate() {
        let own = (index as u32..embers).step_by(whirls.len());
        if own.len() == 0 {
            continue;
        }
        let color = hue(-0.12 * noise::unit(index as u32, 7));
        let emission = color * (radiance / color.luminance());
        let material = stage.material(&format!("ember {i}{j}"), Material { emission, ..lambert(LinearRgb::splat(0.05)) });
        stage.place(&format!("embers {i}{j}"), whirl(own, side), material, at(place.x, 0.0, place.y));
    }
    stage.finish()
}

/// Triangles of that side around the y axis, each where its number puts it.
fn whirl(numbers: impl Iterator<Item = u32>, side: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let reach = side / 3f32.sqrt();
    let nearest = f32::max(0.32, COLUMN_RADIUS + reach);
    for number in numbers {
        let random = |stream: u32| noise::unit(number, stream);
        let height = random(1);
        let angle = TAU * (random(2) + 1.5 * height);
        // Wide below, narrow above, never inside of the column.
        let radius = nearest + 0.9 * (1.0 - height) * random(3).sqrt();
        let center = Vec3::new(radius * angle.cos(), 0.1 + 3.2 * height, radius * angle.sin());
        let up = 2.0 * random(4) - 1.0;
        let (sin, cos) = (TAU * random(5)).sin_cos();
        let normal = Vec3::new((1.0 - up * up).sqrt() * cos, up, (1.0 - up * up).sqrt() * sin);
        let turn = Quat::from_rotation_arc(Vec3::Z, normal);
        let first = mesh.positions.len() as u32;
        for k in 0..3u8 {
            let (sin, cos) = (f32::from(k) * TAU / 3.0).sin_cos();
            mesh.positions.push(center + turn * (Vec3::new(cos, sin, 0.0) * reach));
            mesh.normals.push(normal);
            mesh.tangents.push((turn * Vec3::X).extend(1.0));
            mesh.uvs[0].push(Vec2::new(0.5 + 0.5 * cos, 0.5 - 0.5 * sin));
        }
        mesh.indices.push([first, first + 1, first + 2]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embers_of_any_number_stay_clear_of_the_columns() {
        for embers in [1, 25, 100, 200, 1000] {
            let scene = make(embers);
            let whirls = scene.nodes.iter().filter(|node| node.name.starts_with("embers")).flat_map(|node| &node.meshes);
            let meshes: Vec<&Mesh> = whirls.map(|&mesh| &*scene.meshes[mesh]).collect();
            assert_eq!(meshes.iter().map(|mesh| mesh.indices.len()).sum::<usize>(), embers as usize);
            for (mesh, corners) in meshes.iter().flat_map(|mesh| mesh.indices.iter().map(move |corners| (mesh, corners))) {
                let [a, b, c] = corners.map(|index| mesh.positions[index as usize]);
                // Corners, middles of the sides, and the middle.
                for p in [a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0] {
                    assert!(Vec2::new(p.x, p.z).length() > COLUMN_RADIUS - 1e-4, "{embers} embers: {p}");
                }
            }
        }
    }
}
