//! Glass whose index depends on the channel.

use super::compare::largest_channel_z;
use super::scenes::{Stage, at, floor, glowing, lambert, mean, render_at, sized};
use crate::{Integrator, Settings};
use glam::Vec3;
use kajo_bsdf::MaterialParams;
use kajo_sampling::SamplerKind;
use kajo_scene::{Material, Scene, shapes};

const IOR: f32 = 1.8;

fn glass(ior: f32, roughness: f32, dispersion: f32) -> Material {
    Material { transmission: 1.0, thickness: 1.0, metallic: 0.0, roughness, ior, dispersion, ..Material::default() }
}

/// A ball of glass on a floor before a bright wall.
fn ball(glass: Material) -> Scene {
    Stage::default()
        .mesh(floor(), lambert(0.6), at(Vec3::ZERO))
        .mesh(shapes::sphere(0.5, 24), glass, at(Vec3::Y * 0.5))
        .mesh(shapes::rectangle(1.0, 3.0), glowing(3.0, 0.2), at(Vec3::new(0.0, 1.0, -1.5)))
        .environment(0.2)
        .perspective(Vec3::new(0.0, 1.2, 3.0), Vec3::new(0.0, 0.5, 0.0), 30.0)
        .0
}

/// Each channel of dispersive glass is that channel of glass with its index and no dispersion, within noise, and not that with another's.
#[test]
fn each_channel_shows_glass_of_its_own_index() {
    /// 4 standard errors for one comparison, corrected for 96 of them.
    const LIMIT: f64 = 5.0;
    let dispersion = 6.0;
    let iors = MaterialParams { ior: IOR, dispersion, thin: false, ..MaterialParams::default() }.channel_iors();
    for (integrator, roughness) in [(Integrator::Path, 0.0), (Integrator::BsdfOnly, 0.0), (Integrator::Path, 0.4)] {
        let settings = |seed| Settings { integrator, seed, max_depth: 8, sampler: SamplerKind::Independent, ..sized(32, 32) };
        let all = render_at(&ball(glass(IOR, roughness, dispersion)), &settings(1), 128);
        for channel in [0, 2] {
            let one = render_at(&ball(glass(iors[channel], roughness, 0.0)), &settings(2), 128);
            let [same, other] = [channel, 2 - channel].map(|c| largest_channel_z(&all, &one, 8, c));
            assert!(same < LIMIT && other > LIMIT, "{integrator:?}, roughness {roughness}, channel {channel}: {same}, other index {other}");
        }
    }
}

/// A diamond is invisible before a white sky, and takes no more samples to be so than one without colours: without roulette every path brings the
/// whole light.
#[test]
fn white_furnace_of_a_dispersive_diamond() {
    let scene = Stage::default()
        .mesh(shapes::sphere(1.0, 128), glass(2.42, 0.0, 0.36), at(Vec3::ZERO))
        .environment(1.0)
        .orthographic(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, 1.6)
        .0;
    for (integrator, tolerance) in [(Integrator::BsdfOnly, 1e-4), (Integrator::Path, 0.005)] {
        let got = mean(&render_at(&scene, &Settings { integrator, max_depth: 200, ..sized(16, 16) }, 64));
        assert!((got - 1.0).abs() < tolerance, "{integrator:?}: {got}");
    }
}
