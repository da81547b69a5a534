//! Energy: closed rooms and uniform skies have known answers.

use super::scenes::{Stage, at, glowing, mean, render_at, sized};
use crate::{Integrator, RussianRoulette, Settings};
use glam::Vec3;
use kajo_scene::{Material, Scene, shapes};
use kajo_units::LinearRgb;

/// A closed box whose walls emit 1 and reflect half, seen from inside.
fn closed_furnace() -> Scene {
    let room = shapes::cuboid(Vec3::new(1.0, 0.7, 1.3)).inside_out();
    Stage::default().mesh(room, glowing(1.0, 0.5), at(Vec3::ZERO)).perspective(Vec3::new(0.3, 0.1, 0.5), Vec3::ZERO, 80.0).0
}

/// Rows L-08 and M-08. Each bounce reflects half of the uniform light: after D bounces the radiance is Σ_{k ≤ D} 2^−k.
#[test]
fn closed_furnace_gives_the_partial_sums() {
    let scene = closed_furnace();
    for (depth, exact) in [1.0, 1.5, 1.75, 1.875, 1.9375].into_iter().enumerate() {
        for (integrator, tolerance) in [(Integrator::BsdfOnly, 1e-5), (Integrator::Path, 0.004)] {
            let settings = Settings { max_depth: depth as u32, integrator, russian_roulette: RussianRoulette::Off, ..sized(16, 16) };
            let got = mean(&render_at(&scene, &settings, 64));
            assert!((got / exact - 1.0).abs() < tolerance, "{integrator:?}, depth {depth}: {got} for {exact}");
        }
    }
}

/// E / (1 − a) = 2 with roulette and without a depth limit.
#[test]
fn closed_furnace_converges_to_the_geometric_series() {
    let settings = Settings { max_depth: 1000, ..sized(16, 16) };
    let got = mean(&render_at(&closed_furnace(), &settings, 64));
    assert!((got / 2.0 - 1.0).abs() < 0.005, "{got}");
}

/// `builtin:furnace` is 1 at every pixel, whatever stands in the room.
#[test]
fn builtin_furnace_is_one_everywhere() {
    let scene = kajo_scene::load("builtin:furnace", &Default::default()).unwrap();
    let settings = Settings { integrator: Integrator::BsdfOnly, max_depth: 64, russian_roulette: RussianRoulette::Off, ..sized(24, 24) };
    let frame = render_at(&scene, &settings, 64);
    for pixel in frame.beauty().pixels() {
        assert!((pixel[0] - 1.0).abs() < 1e-4, "{pixel:?}");
    }
    let got = mean(&render_at(&scene, &Settings { max_depth: 64, ..sized(24, 24) }, 64));
    assert!((got - 1.0).abs() < 0.005, "path: {got}");
}

/// Every material of `builtin:spheres`, made white and lossless, is invisible before a uniform white sky: 1 ± 0.5 %.
#[test]
fn white_materials_vanish_in_the_white_furnace() {
    let spheres = kajo_scene::load("builtin:spheres", &Default::default()).unwrap();
    let mut wrong = Vec::new();
    for material in spheres.materials.iter().filter(|m| m.name != "ground") {
        let white = Material {
            base_color: LinearRgb::WHITE,
            base_color_texture: None,
            emission: LinearRgb::BLACK,
            attenuation_distance: f32::INFINITY,
            specular_color: LinearRgb::WHITE,
            sheen_color: if material.sheen_color.is_black() { LinearRgb::BLACK } else { LinearRgb::WHITE },
            ..material.clone()
        };
        let scene = Stage::default()
            .mesh(shapes::sphere(1.0, 128), white, at(Vec3::ZERO))
            .environment(1.0)
            .orthographic(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, 1.6)
            .0;
        let settings = Settings { max_depth: 200, ..sized(16, 16) };
        let got = mean(&render_at(&scene, &settings, 256));
        if !(0.995..1.005).contains(&got) {
            wrong.push((material.name.clone(), got));
        }
    }
    assert!(wrong.is_empty(), "not invisible: {wrong:?}");
}
