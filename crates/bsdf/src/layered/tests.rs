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
                    let albedo = sampled_albedo(&params, direction(degrees, 0.3) * side, 1 << 15).total().0;
                    assert!((albedo - Vec3::ONE).abs().max_element() < 5e-3, "{name}, roughness {r}, {degrees}°, side {side}: {albedo}");
                }
            }
        }
    }
}

/// Every channel of a film keeps its light: 1 ± 0.5 % over all directions. Single ones are off by the coarse table of the film, up to 1 %.
#[test]
fn white_furnace_films_keep_all_light_of_every_channel() {
    for roughness in [0.0, 0.05, 0.1, 0.4, 0.8] {
        let roughness = PerceptualRoughness(roughness);
        let film = MaterialParams { iridescence: 1.0, iridescence_ior: 1.4, iridescence_thickness: 420.0, roughness, ..Default::default() };
        for degrees in ANGLES {
            let albedo = sampled_albedo(&film, direction(degrees, 0.3), 1 << 14).total().0;
            assert!((albedo - Vec3::ONE).abs().max_element() < 1e-2, "{roughness:?}, {degrees}°: {albedo}");
        }
        let mean = sampled_mean_albedo(&film, 1.0, 1 << 15);
        assert!((mean - Vec3::ONE).abs().max_element() < 5e-3, "{roughness:?}: {mean}");
    }
}

/// Roughness and strength over glTF's square, its edges included.
const ANISOTROPIES: [(f32, f32); 8] = [(0.0, 0.5), (0.0, 1.0), (0.1, 0.6), (0.25, 0.3), (0.4, 0.9), (0.5, 1.0), (0.8, 0.6), (0.9, 1.0)];

fn anisotropic(material: &MaterialParams, (roughness, anisotropy): (f32, f32)) -> MaterialParams {
    let anisotropy_rotation = kajo_units::Radians(0.4);
    MaterialParams { roughness: PerceptualRoughness(roughness), anisotropy, anisotropy_rotation, ..*material }
}

/// What the worst direction of a white, anisotropic material loses or gains, and which one it is.
fn worst_anisotropic_furnace(material: &MaterialParams, side: f32) -> (f32, String) {
    let mut worst = (0.0f32, String::new());
    for widths in ANISOTROPIES {
        let params = anisotropic(material, widths);
        for (degrees, azimuth) in [(0.0, 0.0), (40.0, 0.4), (40.0, 1.2), (65.0, 1.9), (80.0, 0.4), (80.0, 0.9), (80.0, 1.97), (86.0, 1.4)] {
            let albedo = sampled_albedo(&params, direction(degrees, azimuth) * side, 1 << 15).total().0;
            let error = (albedo - Vec3::ONE).abs().max_element();
            if error > worst.0 {
                worst = (error, format!("roughness and anisotropy {widths:?}, {degrees}°, azimuth {azimuth}: {albedo}"));
            }
        }
    }
    worst
}

/// Metals and dielectrics, down to 4° above the horizon: 1 ± 0.5 % in every direction.
#[test]
fn white_furnace_anisotropic_materials_keep_all_light() {
    let base = MaterialParams::default();
    for (name, params) in [
        ("conductor", MaterialParams { metallic: 1.0, ..base }),
        ("dielectric", base),
        ("diamond-like dielectric", MaterialParams { ior: 2.4, ..base }),
        ("half metal", MaterialParams { metallic: 0.5, ..base }),
        ("thin glass", MaterialParams { transmission: 1.0, ..base }),
    ] {
        let (worst, at) = worst_anisotropic_furnace(&params, 1.0);
        assert!(worst < 5e-3, "{name}, {at}");
    }
}

/// The boundary of a volume: over all directions 1 ± 0.5 % from outside and ± 0.6 % from inside. Single directions are worse by what their
/// table can hold: 2 % from outside, and 12 % from inside for the most stretched facets, where total reflection meets the horizon.
#[test]
fn white_furnace_anisotropic_glass_keeps_all_light() {
    for ior in [1.1, 1.33, 1.5, 2.4] {
        let glass = MaterialParams { transmission: 1.0, thin: false, ior, ..MaterialParams::default() };
        for (side, mean_limit, limit) in [(1.0, 5e-3, 0.02), (-1.0, 6e-3, 0.13)] {
            let mut worst_mean = 0.0f32;
            for widths in ANISOTROPIES {
                let albedo = sampled_mean_albedo(&anisotropic(&glass, widths), side, 1 << 16);
                worst_mean = worst_mean.max((albedo - Vec3::ONE).abs().max_element());
            }
            let (worst, at) = worst_anisotropic_furnace(&glass, side);
            println!("index {ior}, side {side}: {worst_mean} over all directions; {worst}, {at}");
            assert!(worst_mean < mean_limit && worst < limit, "index {ior}, side {side}: {worst_mean} over all directions; {at}");
        }
    }
}

/// Share of light that leaves into all directions of one side, cosine-weighted; without the 1/η² scale.
fn sampled_mean_albedo(params: &MaterialParams, side: f32, n: u32) -> Vec3 {
    let bsdf = Bsdf::new(params);
    (0..n).fold(Vec3::ZERO, |sum, i| {
        let mut s = Sampler::new(SamplerKind::Sobol, 1, UVec2::ZERO, i);
        let wo = kajo_sampling::warp::cosine_hemisphere(s.next_2d()) * side;
        let sample = bsdf.sample(wo, s.next_1d(), s.next_2d());
        sum + sample.map_or(Vec3::ZERO, |sample| sample.weight.total().0 * (sample.eta2 / n as f32))
    })
}

/// Materials as scenes use them: coloured, mixed, layered.
fn library() -> Vec<(&'static str, MaterialParams)> {
    let base = MaterialParams::default();
    let rgb = LinearRgb::new;
    let rough = PerceptualRoughness;
    vec![
        ("gold", MaterialParams { metallic: 1.0, base_color: rgb(1.0, 0.78, 0.34), roughness: rough(0.2), ..base }),
        (
            "brushed aluminium",
            MaterialParams { metallic: 1.0, base_color: rgb(0.91, 0.92, 0.92), roughness: rough(0.4), anisotropy: 0.8, ..base },
        ),
        ("red plastic", MaterialParams { base_color: rgb(0.7, 0.02, 0.02), roughness: rough(0.3), ..base }),
        (
            "pink highlight",
            MaterialParams { base_color: rgb(0.2, 0.2, 0.2), roughness: rough(0.5), specular_color: rgb(4.0, 0.5, 2.0), ..base },
        ),
        ("chalk", MaterialParams { base_color: rgb(0.9, 0.9, 0.85), specular: 0.2, ..base }),
        ("car paint", MaterialParams { base_color: rgb(0.02, 0.1, 0.5), metallic: 0.4, roughness: rough(0.5), clearcoat: 1.0, ..base }),
        (
            "coat with its own normal",
            MaterialParams {
                clearcoat: 1.0,
                clearcoat_roughness: rough(0.25),
                clearcoat_normal: Vec3::new(0.15, 0.1, 1.0).normalize(),
                roughness: rough(0.6),
                base_color: rgb(0.9, 0.9, 0.9),
                ..base
            },
        ),
        ("velvet", MaterialParams { base_color: rgb(0.2, 0.0, 0.1), sheen_color: rgb(0.9, 0.5, 0.7), sheen_roughness: rough(0.4), ..base }),
        ("green bottle", MaterialParams { transmission: 1.0, thin: false, base_color: rgb(0.5, 0.9, 0.6), roughness: rough(0.25), ..base }),
        ("frosted sheet", MaterialParams { transmission: 0.9, base_color: rgb(0.9, 0.9, 1.0), roughness: rough(0.5), ..base }),
        ("prism", MaterialParams { transmission: 1.0, thin: false, dispersion: 4.0, roughness: rough(0.3), ..base }),
        ("soap film", MaterialParams { transmission: 1.0, iridescence: 1.0, iridescence_ior: 1.33, roughness: rough(0.35), ..base }),
        ("oiled metal", MaterialParams { metallic: 1.0, base_color: rgb(0.6, 0.5, 0.4), iridescence: 1.0, roughness: rough(0.35), ..base }),
        ("pearl", MaterialParams { iridescence: 0.8, iridescence_thickness: 550.0, roughness: rough(0.4), ..base }),
        (
            "everything",
            MaterialParams {
                metallic: 0.3,
                transmission: 0.4,
                thin: false,
                roughness: rough(0.4),
                anisotropy: 0.5,
                clearcoat: 0.5,
                clearcoat_roughness: rough(0.3),
                sheen_color: rgb(0.3, 0.3, 0.1),
                sheen_roughness: rough(0.6),
                iridescence: 0.5,
                dispersion: 1.0,
                ..base
            },
        ),
    ]
}

#[test]
fn no_material_reflects_more_than_it_receives() {
    for (name, params) in library() {
        for degrees in ANGLES {
            let sampled = sampled_albedo(&params, direction(degrees, 0.7), 1 << 13).total();
            // A film's energy is that of a table with few nodes.
            let slack = if params.iridescence > 0.0 { 3e-3 } else { 1e-3 };
            // A dispersive sample carries three channels with different 1/η² scales and the η² of one: no exact sum.
            let slack = if params.dispersion > 0.0 { 0.12 } else { slack };
            assert!(sampled.max_component() <= 1.0 + slack + 2e-3, "{name}, {degrees}°: {sampled:?}");
        }
    }
}

#[test]
fn reported_albedo_is_near_the_sampled_one() {
    for (name, params) in library() {
        let bsdf = Bsdf::new(&params);
        for degrees in [0.0, 45.0, 75.0] {
            let wo = direction(degrees, 0.7);
            let (sampled, reported) = (sampled_albedo(&params, wo, 1 << 12), bsdf.albedo(wo));
            let error = (sampled.total().0 - reported.total().0).abs().max_element();
            let limit = if params.dispersion > 0.0 || params.clearcoat_normal != Vec3::Z { 0.12 } else { 0.05 };
            assert!(error < limit, "{name}, {degrees}°: sampled {sampled:?}, reported {reported:?}");
            let diffuse = (sampled.diffuse.0 - reported.diffuse.0).abs().max_element();
            assert!(diffuse < 0.02, "{name}, {degrees}°: diffuse {sampled:?}, {reported:?}");
        }
    }
}

const THETA_CELLS: usize = 24;
const PHI_CELLS: usize = 24;

/// χ² of sampled directions against `pdf_scale` × pdf integrated over cells of the sphere, and by how much the integral of the
/// pdf exceeds the share of samples that are not absorbed.
fn p_value(bsdf: &Bsdf, wo: Vec3, n: u32, seed: u64, pdf_scale: impl Fn(Vec3) -> f32) -> (f64, f64) {
    const SUB: usize = 14;
    let view = bsdf.view(wo);
    let mut rng = kajo_sampling::Rng::new(seed);
    let mut observed = vec![0.0; THETA_CELLS * PHI_CELLS];
    for _ in 0..n {
        let Some(s) = view.sample(rng.next_1d(), rng.next_2d()) else { continue };
        let theta = (s.wi.z.clamp(-1.0, 1.0).acos() / std::f32::consts::PI * THETA_CELLS as f32) as usize;
        let phi = ((s.wi.y.atan2(s.wi.x) / std::f32::consts::TAU).rem_euclid(1.0) * PHI_CELLS as f32) as usize;
        let cell = theta.min(THETA_CELLS - 1) * PHI_CELLS + phi.min(PHI_CELLS - 1);
        observed[cell] += 1.0;
    }
    let (d_theta, d_phi) = (std::f32::consts::PI / (THETA_CELLS * SUB) as f32, std::f32::consts::TAU / (PHI_CELLS * SUB) as f32);
    let mut expected = vec![0.0; observed.len()];
    for i in 0..THETA_CELLS * SUB {
        let (sin, cos) = ((i as f32 + 0.5) * d_theta).sin_cos();
        for j in 0..PHI_CELLS * SUB {
            let (sp, cp) = ((j as f32 + 0.5) * d_phi).sin_cos();
            let wi = Vec3::new(sin * cp, sin * sp, cos);
            let share = view.pdf(wi) * pdf_scale(wi) * sin * d_theta * d_phi;
            expected[i / SUB * PHI_CELLS + j / SUB] += f64::from(share) * f64::from(n);
        }
    }
    let (total, kept) = (expected.iter().sum::<f64>(), observed.iter().sum::<f64>());
    expected.iter_mut().for_each(|e| *e *= kept / total);
    (kajo_sampling::statistics::chi_square_p_value(&observed, &expected, 0), (total - kept) / f64::from(n))
}

/// Lobes × roughness × angle × side; the significance 0.01 is divided by the number of tests (Bonferroni).
#[test]
fn sampled_directions_follow_the_pdf() {
    let base = MaterialParams::default();
    let coat = MaterialParams { clearcoat: 1.0, clearcoat_roughness: PerceptualRoughness(0.4), ..base };
    let materials = [
        ("conductor", MaterialParams { metallic: 1.0, ..base }),
        ("dielectric", MaterialParams { base_color: LinearRgb::splat(0.3), ..base }),
        ("anisotropic", MaterialParams { metallic: 1.0, anisotropy: 0.7, anisotropy_rotation: kajo_units::Radians(0.9), ..base }),
        ("thin glass", MaterialParams { transmission: 1.0, ..base }),
        ("glass", MaterialParams { transmission: 1.0, thin: false, ..base }),
        ("dispersive glass", MaterialParams { transmission: 1.0, thin: false, dispersion: 8.0, ..base }),
        ("coat", MaterialParams { base_color: LinearRgb::BLACK, ..coat }),
        ("tilted coat", MaterialParams { clearcoat_normal: Vec3::new(0.3, 0.0, 1.0).normalize(), ..coat }),
        ("sheen", MaterialParams { sheen_color: LinearRgb::WHITE, sheen_roughness: PerceptualRoughness(0.5), ..base }),
        ("everything", library().pop().unwrap().1),
    ];
    let mut tests = Vec::new();
    for (name, params) in materials {
        for r in [0.35, 0.6, 1.0] {
            let bsdf = Bsdf::new(&MaterialParams { roughness: PerceptualRoughness(r), ..params });
            for degrees in [0.0, 40.0, 75.0] {
                let wo = direction(degrees, 2.0);
                let side = if params.transmission > 0.0 && !params.thin && degrees == 40.0 { -1.0 } else { 1.0 };
                tests.push((name, r, degrees, side, p_value(&bsdf, wo * side, 20_000, tests.len() as u64, |_| 1.0)));
            }
        }
    }
    let significance = 0.01 / tests.len() as f64;
    for (name, r, degrees, side, (p, excess)) in &tests {
        // The pdf of very rough glass ends in a step, which the midpoints integrate to 1 %.
        assert!(excess.abs() < 0.015, "{name}, roughness {r}, {degrees}°, side {side}: pdf integrates to {excess} too much");
        assert!(*p > significance, "{name}, roughness {r}, {degrees}°, side {side}: p = {p}");
    }
}

#[test]
fn planted_fault_a_pdf_off_by_5_percent_is_seen() {
    let bsdf = Bsdf::new(&MaterialParams { roughness: PerceptualRoughness(0.5), ..MaterialParams::default() });
    let wo = direction(40.0, 2.0);
    let (p, _) = p_value(&bsdf, wo, 100_000, 1, |wi| if wi.x > 0.0 { 1.05 } else { 0.95 });
    assert!(p < 1e-4, "{p}");
}

#[test]
fn weight_times_pdf_is_f_cos() {
    let mut rng = kajo_sampling::Rng::new(3);
    for (name, params) in library() {
        let bsdf = Bsdf::new(&params);
        for _ in 0..300 {
            let wo = kajo_sampling::warp::uniform_sphere(rng.next_2d());
            let Some(s) = bsdf.sample(wo, rng.next_1d(), rng.next_2d()) else { continue };
            if s.lobe.is_delta() {
                assert_eq!(s.weight.diffuse, LinearRgb::BLACK);
                continue;
            }
            assert_eq!(s.lobe.contains(Lobe::TRANSMIT), s.wi.z * wo.z < 0.0, "{name}");
            let (f, pdf) = (bsdf.f_cos(wo, s.wi).total().0, bsdf.pdf(wo, s.wi));
            assert!((pdf / s.pdf - 1.0).abs() < 1e-4, "{name}: pdf {pdf}, sampled with {}", s.pdf);
            let product = s.weight.total().0 * s.pdf;
            assert!((product - f).abs().max_element() <= 1e-4 * f.max_element().max(1e-6), "{name}: {product} {f}");
        }
    }
}

/// f(o, i) = f(i, o) for what has no layer above and no rough glass.
#[test]
fn opaque_base_is_reciprocal() {
    let base = MaterialParams { roughness: PerceptualRoughness(0.4), base_color: LinearRgb::new(0.9, 0.5, 0.1), ..Default::default() };
    let asymmetry = |params: &MaterialParams| {
        let bsdf = Bsdf::new(params);
        let mut rng = kajo_sampling::Rng::new(8);
        (0..2000).fold(0.0f32, |worst, _| {
            let [o, i] = [(); 2].map(|()| kajo_sampling::warp::cosine_hemisphere(rng.next_2d()));
            let (a, b) = (bsdf.f_cos(o, i).total().0 / i.z, bsdf.f_cos(i, o).total().0 / o.z);
            worst.max((a - b).abs().max_element() / a.max(b).max_element().max(1e-6))
        })
    };
    for params in [
        base,
        MaterialParams { metallic: 1.0, ..base },
        MaterialParams { metallic: 0.5, anisotropy: 0.5, ..base },
        MaterialParams { metallic: 0.5, iridescence: 1.0, ..base },
    ] {
        assert!(asymmetry(&params) < 1e-4, "{params:?}: {}", asymmetry(&params));
    }
    let coated = asymmetry(&MaterialParams { clearcoat: 1.0, ..base });
    assert!(coated > 1e-2, "planted fault, the one-sided coat: {coated}");
}

/// Light that enters and leaves smooth glass keeps its radiance: the 1/η² of the way in is undone on the way out.
#[test]
fn radiance_scale_of_a_pane_of_volume_cancels() {
    let bsdf = Bsdf::new(&MaterialParams { transmission: 1.0, thin: false, roughness: PerceptualRoughness(0.0), ..Default::default() });
    let wo = direction(30.0, 0.0);
    let enter = bsdf.sample(wo, 0.99, Vec2::splat(0.5)).unwrap();
    assert!(enter.lobe.contains(Lobe::TRANSMIT | Lobe::DELTA) && (enter.eta2 - 2.25).abs() < 1e-5);
    assert!((enter.weight.total().0.x - 1.0 / 2.25).abs() < 1e-5);
    // The second surface faces the other way: in its frame the light comes from inside.
    let leave = bsdf.sample(-enter.wi * Vec3::new(1.0, 1.0, -1.0), 0.99, Vec2::splat(0.5)).unwrap();
    assert!((leave.eta2 * enter.eta2 - 1.0).abs() < 1e-5);
    assert!((leave.weight.total().0.x * enter.weight.total().0.x - 1.0).abs() < 1e-5);
}

/// KHR_materials_dispersion: red bends least.
#[test]
fn dispersion_refracts_each_channel_with_its_own_index() {
    let params =
        MaterialParams { transmission: 1.0, thin: false, dispersion: 2.0, roughness: PerceptualRoughness(0.0), ..Default::default() };
    let bsdf = Bsdf::new(&params);
    let (wo, mut seen) = (direction(60.0, 0.0), [0; 3]);
    for i in 0..1000 {
        let s = bsdf.sample(wo, i as f32 / 1000.0, Vec2::splat(0.5)).unwrap();
        if s.lobe.contains(Lobe::TRANSMIT) {
            let w = s.weight.total().0;
            let channel = (0..3).max_by(|&a, &b| w[a].total_cmp(&w[b])).unwrap();
            assert!((0..3).all(|c| c == channel || w[c] == 0.0), "one channel: {w}");
            let eta = 1.5 + [-1.0, 0.0, 1.0][channel] * 0.5 * 0.025 * 2.0;
            assert!((s.wi.x.abs() * eta - wo.x).abs() < 1e-5, "Snell's law with η = {eta}");
            seen[channel] += 1;
        }
    }
    assert!(seen.iter().all(|&n| n > 200), "{seen:?}");
}

#[test]
fn one_channel_of_a_dispersive_material_is_itself() {
    let params =
        MaterialParams { transmission: 1.0, thin: false, dispersion: 5.0, roughness: PerceptualRoughness(0.5), ..Default::default() };
    let (wo, wi) = (direction(35.0, 0.4), -direction(22.0, 0.5));
    let all = Bsdf::new(&params).f_cos(wo, wi).specular.0;
    for channel in 0..3 {
        let one = Bsdf::new(&params.for_channel(channel)).f_cos(wo, wi).specular.0;
        assert!((one[channel] / all[channel] - 1.0).abs() < 1e-4, "channel {channel}: {all} {one}");
    }
    assert!((all.x / all.z - 1.0).abs() > 0.05, "the channels differ: {all}");
}

#[test]
fn index_one_and_index_zero_are_clear_and_mirror() {
    let clear = Bsdf::new(&MaterialParams { transmission: 1.0, thin: false, ior: 1.0, ..Default::default() });
    let s = clear.sample(direction(70.0, 0.0), 0.3, Vec2::splat(0.5)).unwrap();
    assert_eq!((s.wi, s.weight.total()), (-direction(70.0, 0.0), LinearRgb::WHITE));
    let mirror = MaterialParams { ior: 0.0, roughness: PerceptualRoughness(0.0), base_color: LinearRgb::splat(0.5), ..Default::default() };
    let albedo = sampled_albedo(&mirror, direction(20.0, 0.0), 1024);
    assert!((albedo.specular.0.x - 1.0).abs() < 1e-3 && albedo.diffuse.0.x < 1e-3, "{albedo:?}");
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 2000, ..Default::default() })]

    /// Nothing is NaN, infinite or negative anywhere in the parameter range, its ends included.
    #[test]
    fn values_are_finite_for_all_parameters(
        p in proptest::array::uniform12(edge_biased()),
        q in proptest::array::uniform12(edge_biased()),
        u in proptest::array::uniform3(0.0f32..1.0),
    ) {
        let params = MaterialParams {
            base_color: LinearRgb::new(p[0], p[1], p[2]),
            metallic: p[3],
            roughness: PerceptualRoughness(p[4]),
            ior: [0.0, 1.0, 1.0 + p[5], 1.0 + 4.0 * p[5]][(p[6] * 3.99) as usize],
            specular: p[7],
            specular_color: LinearRgb::new(4.0 * p[8], p[9], p[10]),
            clearcoat: p[11],
            clearcoat_roughness: PerceptualRoughness(q[0]),
            clearcoat_normal: Vec3::new(q[1] - 0.5, q[2] - 0.5, 1.0).normalize(),
            sheen_color: LinearRgb::splat(q[3]),
            sheen_roughness: PerceptualRoughness(q[4]),
            anisotropy: q[5],
            anisotropy_rotation: kajo_units::Radians(7.0 * q[6]),
            transmission: q[7],
            thin: u[0] < 0.5,
            iridescence: q[8],
            iridescence_ior: 1.0 + 2.0 * q[9],
            iridescence_thickness: 1500.0 * q[10],
            dispersion: 10.0 * q[11],
        };
        let bsdf = Bsdf::new(&params);
        let around = kajo_sampling::warp::uniform_sphere(Vec2::new(u[1], u[2]));
        let grazing = Vec3::new(around.x, around.y, 1e-4 * around.z).normalize();
        for wo in [around, grazing, Vec3::Z, Vec3::X, -Vec3::Z] {
            proptest::prop_assert!(bsdf.albedo(wo).total().is_finite(), "{params:?} {wo}");
            for wi in [Vec3::Z, grazing, -around, wo, -wo] {
                let (f, pdf) = bsdf.view(wo).eval(wi);
                let f_ok = f.total().is_finite() && f.diffuse.0.min_element() >= 0.0 && f.specular.0.min_element() >= 0.0;
                proptest::prop_assert!(f_ok && pdf.is_finite() && pdf >= 0.0, "{params:?} {wo} {wi}: {f:?} {pdf}");
            }
            for u_lobe in [0.0, u[0], 0.999_999_9] {
                if let Some(s) = bsdf.sample(wo, u_lobe, Vec2::new(u[1], u[2])) {
                    let ok = s.weight.total().is_finite() && s.weight.total().0.min_element() >= 0.0 && s.pdf > 0.0 && s.eta2 > 0.0;
                    proptest::prop_assert!(ok && (s.wi.length() - 1.0).abs() < 1e-3, "{params:?} {wo}: {s:?}");
                }
            }
        }
    }
}

/// Numbers in [0, 1], often the ends.
fn edge_biased() -> impl proptest::strategy::Strategy<Value = f32> {
    proptest::prop_oneof![1 => proptest::strategy::Just(0.0f32), 1 => proptest::strategy::Just(1.0f32), 4 => 0.0f32..=1.0]
}
