//! Tests of the layered material: energy, density, reciprocity, robustness.

use super::*;
use glam::UVec2;
use kajo_sampling::{Sampler, SamplerKind};
use kajo_units::{LinearRgb, PerceptualRoughness};

const ROUGHNESSES: [f32; 6] = [0.0, 0.1, 0.3, 0.5, 0.7, 1.0];
const ANGLES: [f32; 5] = [0.0, 30.0, 60.0, 75.0, 85.0];

fn direction(degrees: f32, azimuth: f32) -> Vec3 {
    let (s, c) = degrees.to_radians().sin_cos();
    Vec3::new(s * azimuth.cos(), s * azimuth.sin(), c)
}

/// Share of light that leaves along `wo`, by sampling; transmission without its 1/η² scale.
fn sampled_albedo(params: &MaterialParams, wo: Vec3, n: u32) -> LobeValues {
    let bsdf = Bsdf::new(params);
    let view = bsdf.view(wo);
    let mut sum = LobeValues::ZERO;
    for i in 0..n {
        let mut s = Sampler::new(SamplerKind::Sobol, 1, UVec2::ZERO, i);
        if let Some(sample) = view.sample(s.next_1d(), s.next_2d()) {
            sum += sample.weight * (sample.eta2 / n as f32);
        }
    }
    sum
}

/// White, lossless materials: each must reflect and transmit everything.
fn lossless() -> Vec<(&'static str, MaterialParams)> {
    let base = MaterialParams::default();
    vec![
        ("conductor", MaterialParams { metallic: 1.0, ..base }),
        ("dielectric", base),
        ("diamond-like dielectric", MaterialParams { ior: 2.4, ..base }),
        ("half metal", MaterialParams { metallic: 0.5, ..base }),
        ("no specular", MaterialParams { specular: 0.0, ..base }),
        ("thin glass", MaterialParams { transmission: 1.0, ..base }),
        ("half glass", MaterialParams { transmission: 0.5, thin: false, ..base }),
        ("glass", MaterialParams { transmission: 1.0, thin: false, ..base }),
        ("water", MaterialParams { transmission: 1.0, thin: false, ior: 1.33, ..base }),
        ("coated", MaterialParams { clearcoat: 1.0, clearcoat_roughness: PerceptualRoughness(0.3), ..base }),
        ("smoothly coated metal", MaterialParams { clearcoat: 0.7, metallic: 1.0, ..base }),
        ("sheen", MaterialParams { sheen_color: LinearRgb::WHITE, sheen_roughness: PerceptualRoughness(0.5), ..base }),
        ("narrow sheen", MaterialParams { sheen_color: LinearRgb::WHITE, sheen_roughness: PerceptualRoughness(0.25), ..base }),
    ]
}

#[test]
fn white_furnace_white_materials_keep_all_light() {
    for (name, params) in lossless() {
        for r in ROUGHNESSES {
            let params = MaterialParams { roughness: PerceptualRoughness(r), ..params };
            for degrees in ANGLES {
                let mut sides = vec![1.0];
                if params.transmission > 0.0 && !params.thin {
                    sides.push(-1.0);
                }
                for side in sides {
                    let albedo = sampled_albedo(&params, direction(degrees, 0.3) * side, 1 << 16).total().0.x;
                    assert!((albedo - 1.0).abs() < 5e-3, "{name}, roughness {r}, {degrees}°, side {side}: {albedo}");
                }
            }
        }
    }
}
