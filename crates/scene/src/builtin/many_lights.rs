//! A court of columns under N small coloured lamps that hang at scattered heights. The lamps share one total power, so scenes of different N have the same
//! mean brightness and differ in the number of choices alone.

use super::BuiltinScene;
use super::stage::{Stage, at, lambert, plastic};
use super::{Count, noise};
use crate::{LightShape, Material, Scene, shapes};
use glam::{Vec2, Vec3};
use kajo_units::{LinearRgb, Meters};
use std::f32::consts::PI;

pub(super) const SCENE: BuiltinScene = BuiltinScene {
    name: "many-lights",
    description: "court of columns under N coloured lamps of one total power",
    count: Some(Count { what: "lamps", default: 1000, max: 100_000 }),
    make,
};

/// Radius of a lamp, m.
const LAMP_RADIUS: f32 = 0.02;
/// Radius of a column, m.
pub(super) const COLUMN_RADIUS: f32 = 0.25;

/// Radiant power of all lamps together, W; a lamp of radiance L and radius r has 4π² r² L.
pub(super) const TOTAL_POWER: f32 = 900.0;
/// Half the side of the court, m.
const HALF: f32 = 9.0;

fn make(lamps: u32) -> Scene {
    let mut stage = court();
    let radiance = TOTAL_POWER / lamps as f32 / (4.0 * PI * PI * LAMP_RADIUS * LAMP_RADIUS);
    for i in 0..lamps {
        let place = lamp_position(i);
        let color = hue(noise::unit(i, 7));
        let shape = LightShape::Sphere { radius: Meters(LAMP_RADIUS) };
        stage.light(&format!("lamp {i}"), shape, color * (radiance / color.luminance()), at(place.x, place.y, place.z));
    }
    stage.finish()
}

/// The columns of the court, 5 × 5, by their row and place in it.
pub(super) fn columns() -> impl Iterator<Item = (u8, u8, Vec2)> {
    let place = |i: u8| 3.6 * (f32::from(i) - 2.0);
    (0..5).flat_map(move |i| (0..5).map(move |j| (i, j, Vec2::new(place(i), place(j)))))
}

/// The court without its lamps, under a night sky.
pub(super) fn court() -> Stage {
    let mut stage = Stage::new(0.0);
    let rgb = LinearRgb::new;
    let tiles = stage.texture("tiles", 2, 1.0, |x, y| if (x + y) % 2 == 0 { [170, 168, 164, 255] } else { [140, 138, 136, 255] });
    let ground = stage.material("ground", Material { base_color_texture: Some(tiles), ..plastic(LinearRgb::WHITE, 0.35) });
    let stone = stage.material("stone", lambert(rgb(0.62, 0.6, 0.56)));
    let glaze = stage.material("glaze", plastic(rgb(0.3, 0.3, 0.32), 0.2));
    stage.place("ground", shapes::floor(2.0 * HALF, 2.0 * HALF, 9.0), ground, at(0.0, 0.0, 0.0));

    let column = stage.mesh("column", shapes::cylinder(COLUMN_RADIUS, 3.0, 48), stone);
    let ball = stage.mesh("ball", shapes::sphere(0.35, 48), glaze);
    for (i, j, place) in columns() {
        let Vec2 { x, y: z } = place;
        stage.instance(&format!("column {i}{j}"), column, at(x, 0.0, z));
        if i < 4 && j < 4 && (i + j) % 2 == 0 {
            stage.instance(&format!("ball {i}{j}"), ball, at(x + 1.8, 0.35, z + 1.8));
        }
    }
    stage.environment(rgb(0.004, 0.006, 0.012));
    stage.camera("camera", Vec3::new(7.2, 4.6, 11.0), Vec3::new(0.0, 0.9, 0.0), 42.0, Some(16.0 / 9.0));
    stage
}

/// Over the court by the R2 sequence of low discrepancy \[Roberts18], between the columns: positions inside a column move to its side.
fn lamp_position(i: u32) -> Vec3 {
    let n = f64::from(i);
    let square = |alpha: f64| ((0.5 + alpha * n).fract() * 2.0 - 1.0) as f32 * (HALF - 0.3);
    let mut place = Vec2::new(square(0.754_877_666_246_693), square(0.569_840_290_998_053));
    let nearest = (place / 3.6).round().clamp(Vec2::splat(-2.0), Vec2::splat(2.0)) * 3.6;
    let clearance = COLUMN_RADIUS + 2.0 * LAMP_RADIUS;
    if place.distance(nearest) < clearance {
        place = nearest + (place - nearest).normalize_or(Vec2::X) * clearance;
    }
    Vec3::new(place.x, 0.4 + 2.8 * noise::unit(i, 3), place.y)
}

/// A saturated but not pure colour of the given hue, [0, 1].
pub(super) fn hue(h: f32) -> LinearRgb {
    let channel = |shift: f32| 0.55 + 0.45 * ((h + shift) * 2.0 * PI).cos();
    LinearRgb::new(channel(0.0), channel(1.0 / 3.0), channel(2.0 / 3.0))
}
