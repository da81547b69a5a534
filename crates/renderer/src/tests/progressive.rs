//! The path tracer on the device against the CPU's: the same light but for noise, image by image.

use super::scenes::*;
use crate::{Estimate, ProgressivePathTracer, ProgressiveSettings, Radiances};
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::{Aov, Frame, Settings, Stop, Tracer, render, uncontrolled};
use kajo_render_graph::Device;
use kajo_scene::{Environment, LightShape, Material, Projection, Scene, Snapshot, Texels, TextureImage, builtin, shapes};
use kajo_techniques::TraceBackend;
use kajo_units::{LinearRgb, Meters, Radians};

const SIZE: UVec2 = UVec2::splat(32);

/// What rounding may change of the light of a block.
const ROUNDING: f64 = 1e-3;

/// Side of the blocks that are compared, px.
const BLOCK: u32 = 8;

fn traced(device: &Device, scene: &Scene, settings: ProgressiveSettings, samples: u32) -> Radiances {
    let mut tracer = ProgressivePathTracer::new(device, scene, &Snapshot::new(scene, START), settings).unwrap();
    tracer.add(samples).unwrap();
    tracer.read().unwrap()
}

/// The CPU's images; box filter, rays from the triangles themselves as on the device.
fn truth(scene: &Scene, size: UVec2, samples: u32) -> Frame {
    let tracer = Tracer::new(scene, Snapshot::new(scene, START)).unwrap();
    let aovs = vec![Aov::Emission, Aov::Direct, Aov::SpecularIndirect, Aov::DiffuseIndirect];
    let settings = Settings { size, filter: kajo_path_tracer::Filter::Box, aovs, smooth_terminator: false, ..Settings::default() };
    render(&tracer, &settings, Stop::at_spp(samples), None, &uncontrolled).unwrap().develop()
}

/// How far two estimates of an image are apart.
#[derive(Clone, Copy, Debug)]
struct Agreement {
    /// Mean over mean, and its standard error.
    ratio: f64,
    error: f64,
    /// Mean square over blocks and channels of (difference over its standard error): 1 for noise alone.
    z2: f64,
    /// Largest |z|.
    worst: f64,
}

impl Agreement {
    fn new(ours: &Estimate, theirs: &Estimate) -> Self {
        let size = ours.mean.size();
        let sum = |image: &Image<LinearRgb>| image.pixels().iter().map(|p| f64::from(p.0.element_sum())).sum::<f64>();
        let mut squares = Vec::new();
        let noise = sum(&ours.variance) + sum(&theirs.variance);
        for (y, x) in (0..size.y).step_by(BLOCK as usize).flat_map(|y| (0..size.x).step_by(BLOCK as usize).map(move |x| (y, x))) {
            let places = (y..(y + BLOCK).min(size.y)).flat_map(|v| (x..(x + BLOCK).min(size.x)).map(move |u| (u, v)));
            let (mut difference, mut variance, mut light) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for (u, v) in places {
                for c in 0..3 {
                    let at = |image: &Image<LinearRgb>| f64::from(image.get(u, v)[c]);
                    difference[c] += at(&ours.mean) - at(&theirs.mean);
                    variance[c] += at(&ours.variance) + at(&theirs.variance);
                    light[c] += at(&theirs.mean);
                }
            }
            // Half floats and bytes round what has no noise.
            let lit = (0..3).filter(|c| light[*c] > 0.0);
            squares.extend(lit.map(|c| difference[c].powi(2) / (variance[c] + (ROUNDING * light[c]).powi(2))));
        }
        let count = squares.len().max(1) as f64;
        Self {
            ratio: sum(&ours.mean) / sum(&theirs.mean),
            error: noise.sqrt() / sum(&theirs.mean),
            z2: squares.iter().sum::<f64>() / count,
            worst: squares.iter().copied().fold(0.0, f64::max).sqrt(),
        }
    }

    /// Nothing but noise. The images' variances are conservative where samples are spread evenly, and too small where rare samples carry much light (gloss that sees
    /// gloss): still life and spheres have z² up to 2 with any number of samples that a test can afford.
    fn is_noise(&self) -> bool {
        (self.ratio - 1.0).abs() < 0.01_f64.max(3.0 * self.error) && self.z2 < 2.5 && self.worst < 5.0
    }
}

/// An image of the CPU's, with its noise.
fn estimate(frame: &Frame, name: &str) -> Estimate {
    let image = frame.image(name).unwrap();
    let mean = image.pixels.to_color();
    let none = || mean.map(|_| LinearRgb::BLACK);
    let variance = image.variance.as_ref().map_or_else(none, |variance| variance.to_color());
    Estimate { mean, variance }
}

fn check(name: &str, scene: &Scene, device: &Device, (ours, theirs): (u32, u32), backend: Option<TraceBackend>) {
    let settings = ProgressiveSettings { irradiance: true, backend, ..ProgressiveSettings::new(SIZE) };
    let found = traced(device, scene, settings, ours);
    assert_eq!((found.samples, found.invalid), (ours, 0));
    let truth = truth(scene, SIZE, theirs);
    let irradiance = found.diffuse_indirect.as_ref().unwrap();
    let pairs = [
        ("beauty", &found.beauty),
        ("direct", &found.direct),
        ("specular-indirect", &found.specular_indirect),
        ("diffuse-indirect", irradiance),
    ];
    let images: Vec<_> = pairs.map(|(image, ours)| (image, ours, Agreement::new(ours, &estimate(&truth, image)))).into();
    for (image, _, agreement) in &images {
        eprintln!("{name}, {image}: {agreement:?}");
    }
    for (image, ours, agreement) in images {
        if truth.image(image).unwrap().pixels.to_color().pixels().iter().any(|p| !p.is_black()) {
            assert!(agreement.is_noise(), "{name}, {image}: {agreement:?}");
        } else {
            assert!(ours.mean.pixels().iter().all(|p| p.is_black()), "{name}, {image}");
        }
    }
    // Emission has the noise of the pixel filter alone, alike in three channels.
    let emission = truth.image("emission").unwrap().pixels.to_color();
    let sum = |image: &Image<LinearRgb>| image.pixels().iter().map(|p| f64::from(p.0.element_sum())).sum::<f64>();
    let (ours, theirs, error) = (sum(&found.emission.mean), sum(&emission), (3.0 * sum(&found.emission.variance)).sqrt());
    assert!((ours - theirs).abs() <= 0.005 * theirs + 4.0 * error, "{name}: {ours} of {theirs}, {error}");
}

#[test]
fn a_box_of_diffuse_walls_is_the_cpus() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    check("cornell", &scene, &device, (64, 256), None);
    check("cornell, compute", &scene, &device, (32, 64), Some(TraceBackend::Compute));
}

#[test]
fn gloss_and_metal_under_lamps_are_the_cpus() {
    let device = Device::new().unwrap();
    let mut scene = builtin::load("spheres").unwrap();
    scene.materials.iter_mut().for_each(|material| (material.transmission, material.iridescence) = (0.0, 0.0));
    check("spheres", &scene, &device, (32, 256), None);
}

/// Textures, normal maps, a clear coat: the example of the repository.
#[test]
fn the_still_life_is_the_cpus() {
    let device = Device::new().unwrap();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/still-life.gltf");
    let scene = kajo_scene::load(path, &Default::default()).unwrap();
    assert_eq!(crate::not_path_traced(&scene, &Snapshot::new(&scene, START), 0).len(), 0);
    check("still life", &scene, &device, (256, 512), None);
}

/// Everything that shines, at once, on matt and glossy surfaces: a point, a spot, two suns, areas of three shapes, an emissive mesh and a sky with a bright spot.
fn every_light() -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(3.0, 3.0, 1.0), lambert(0.6), Affine3A::IDENTITY);
    let gloss = Material { base_color: LinearRgb::new(0.8, 0.6, 0.3), metallic: 1.0, roughness: 0.3, ..Material::default() };
    place(
        &mut scene,
        shapes::cuboid(Vec3::splat(0.5)),
        gloss,
        Affine3A::from_rotation_translation(Quat::from_rotation_y(0.5), Vec3::new(-0.6, 0.26, 0.0)),
    );
    let coat = Material { base_color: LinearRgb::new(0.2, 0.4, 0.7), clearcoat: 1.0, ..Material::default() };
    place(&mut scene, shapes::cuboid(Vec3::new(0.4, 0.8, 0.4)), coat, Affine3A::from_translation(Vec3::new(0.5, 0.41, -0.3)));
    let glow = Material { emission: LinearRgb::new(6.0, 3.0, 1.0), ..lambert(0.2) };
    place(&mut scene, shapes::cuboid(Vec3::splat(0.15)), glow, Affine3A::from_translation(Vec3::new(0.0, 0.1, 0.6)));
    let down = Vec3::new(0.2, -1.0, -0.1);
    light(&mut scene, LightShape::Point, 0.5, Vec3::new(-1.0, 1.5, 0.5), down);
    light(&mut scene, LightShape::Spot { inner: Radians(0.3), outer: Radians(0.6) }, 2.0, Vec3::new(1.0, 2.0, 0.5), down);
    light(&mut scene, LightShape::Directional { half_angle: Radians(0.0) }, 0.3, Vec3::ZERO, Vec3::new(0.5, -1.0, 0.2));
    light(&mut scene, LightShape::Directional { half_angle: Radians(0.1) }, 0.5, Vec3::ZERO, Vec3::new(-0.5, -1.0, -0.4));
    light(&mut scene, LightShape::Rectangle { width: Meters(0.8), height: Meters(0.3) }, 3.0, Vec3::new(-0.5, 1.2, -0.6), down);
    light(&mut scene, LightShape::Disk { radius: Meters(0.2) }, 4.0, Vec3::new(0.2, 1.1, 0.4), down);
    light(&mut scene, LightShape::Sphere { radius: Meters(0.1) }, 5.0, Vec3::new(-1.1, 0.4, 0.5), down);
    let (width, height) = (32, 16);
    let texel = |i: u32| if (i % width, i / width) == (9, 4) { [60.0, 50.0, 40.0] } else { [0.2, 0.3, 0.5] };
    let image = TextureImage { name: "sky".into(), width, height, texels: Texels::Rgb32F((0..width * height).map(texel).collect()) };
    scene.environment = Some(Environment { image: Some(image.into()), scale: LinearRgb::splat(0.8), rotation: Radians(0.7) });
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.8, 1.4, 2.6), Vec3::new(0.0, 0.3, 0.0));
    scene
}

#[test]
fn every_light_is_the_cpus() {
    let device = Device::new().unwrap();
    check("every light", &every_light(), &device, (128, 256), None);
}

/// A constant sky is found by reflection alone; a parallel camera starts its rays on its near plane.
#[test]
fn an_even_sky_seen_by_a_parallel_camera_is_the_cpus() {
    let device = Device::new().unwrap();
    let mut scene = every_light();
    scene.lights.clear();
    scene.nodes.iter_mut().for_each(|node| node.light = None);
    scene.environment = Some(Environment::uniform(LinearRgb::new(0.5, 0.8, 1.2)));
    scene.cameras[0].projection = Projection::Orthographic { xmag: Meters(1.5), ymag: Meters(1.5) };
    check("even sky", &scene, &device, (96, 256), None);
}

/// The comparison is red where it must be: lights 5 % brighter, one that is off, a missing bounce, two channels swapped, a share of the sky's light counted twice, as by
/// a wrong weight of two strategies.
#[test]
fn the_comparison_finds_planted_faults() {
    let device = Device::new().unwrap();
    let scene = every_light();
    let truth = truth(&scene, SIZE, 256);
    let beauty = estimate(&truth, "beauty");
    let of = |scene: &Scene, max_depth| traced(&device, scene, ProgressiveSettings { max_depth, ..ProgressiveSettings::new(SIZE) }, 128);
    let right = of(&scene, 32);
    let agrees = |ours: &Estimate| Agreement::new(ours, &beauty).is_noise();
    assert!(agrees(&right.beauty));
    let mut brighter = scene.clone();
    brighter.lights.iter_mut().for_each(|light| light.emission *= 1.05);
    assert!(!agrees(&of(&brighter, 32).beauty), "lights are brighter");
    let mut dark = scene.clone();
    dark.lights[3].emission = LinearRgb::BLACK;
    assert!(!agrees(&of(&dark, 32).beauty), "a light is off");
    assert!(!agrees(&of(&scene, 2).beauty), "a bounce is missing");
    let swapped = Estimate { mean: right.beauty.mean.map(|p| LinearRgb::new(p[2], p[1], p[0])), ..right.beauty.clone() };
    assert!(!agrees(&swapped), "channels are swapped");
    let pairs = right.beauty.mean.pixels().iter().zip(right.direct_by_others.mean.pixels());
    let twice = Image::from_pixels(SIZE, pairs.map(|(all, sky)| *all + *sky * 0.1).collect());
    assert!(!agrees(&Estimate { mean: twice, ..right.beauty.clone() }), "light of the sky weighs too much");
}

/// Samples are the same however they are dealt out to calls; another seed gives others; a view begins anew.
#[test]
fn the_result_does_not_depend_on_calls() {
    let device = Device::new().unwrap();
    let scene = builtin::load("cornell").unwrap();
    let size = UVec2::new(20, 12);
    let snapshot = Snapshot::new(&scene, START);
    let settings = ProgressiveSettings::new(size);
    let mut tracer = ProgressivePathTracer::new(&device, &scene, &snapshot, settings).unwrap();
    assert!(tracer.read().unwrap().beauty.variance.pixels().iter().all(|v| v[0] == f32::INFINITY));
    tracer.add(8).unwrap();
    let whole = tracer.read().unwrap();
    tracer.set_view(&snapshot.cameras[0], size).unwrap();
    (0..4).for_each(|_| tracer.add(2).unwrap());
    let parts = tracer.read().unwrap();
    assert_eq!((parts.samples, parts.beauty.mean.pixels()), (8, whole.beauty.mean.pixels()));
    let other = traced(&device, &scene, ProgressiveSettings { seed: 1, ..settings }, 8);
    assert_ne!(other.beauty.mean.pixels(), whole.beauty.mean.pixels());
    tracer.set_view(&snapshot.cameras[0], size + 1).unwrap();
    tracer.add(1).unwrap();
    assert_eq!(tracer.read().unwrap().beauty.mean.size(), size + 1);
}
