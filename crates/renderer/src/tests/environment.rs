//! Light of the environment on diffuse lobes, against the path tracer.

use super::scenes::*;
use crate::{FrameSettings, RoleSelection};
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{Environment, Material, Scene, Texels, TextureImage, shapes};
use kajo_units::{LinearRgb, Radians};
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

const SIZE: UVec2 = UVec2::new(64, 64);

/// Colours that differ in every direction.
fn sky() -> Environment {
    let texel = |i: u32| [0.2 + 0.1 * (i % 8) as f32, 0.3 + 0.2 * (i / 8) as f32, 0.9 - 0.1 * ((i * 5) % 8) as f32, 1.0];
    let image = TextureImage { name: String::new(), width: 8, height: 4, texels: Texels::Rgba32F((0..32).map(texel).collect()) };
    Environment { image: Some(Arc::new(image)), scale: LinearRgb::new(0.5, 0.7, 1.1), rotation: Radians(2.1) }
}

/// The picture, and the light that the path tracer gives the same surfaces straight from the environment.
fn both(scene: &Scene, ambient: (&str, &[(&str, &str)]), settings: FrameSettings, spp: u32) -> (Image<Vec3>, Image<Vec3>, Image<bool>) {
    let device = Device::new().unwrap();
    let roles = RoleSelection::new().choose(ambient.0, ambient.1).unwrap();
    let settings = FrameSettings { gbuffer: true, ..settings };
    let output = renderer(&device, scene, SIZE, None).render(&roles, &settings).unwrap();
    let surface = output.gbuffer.as_ref().unwrap().depth.map(|depth| depth.is_finite());
    let frame = reference(scene, START, None, SIZE, spp, vec![Aov::Direct]);
    (output.color.map(|c| c.0), frame.image("direct").unwrap().pixels.to_color().map(|c| c.0), surface)
}

/// Means over the pixels that show a surface, and the RMSE over them relative to the mean of the second.
fn compared((a, b, surface): (Image<Vec3>, Image<Vec3>, Image<bool>)) -> (Vec3, Vec3, f32) {
    let pairs: Vec<(Vec3, Vec3)> =
        a.pixels().iter().zip(b.pixels()).zip(surface.pixels()).filter(|(_, on)| **on).map(|((a, b), _)| (*a, *b)).collect();
    let count = pairs.len() as f32;
    assert!(count > 500.0, "surfaces are seen");
    let mean = |of: fn(&(Vec3, Vec3)) -> Vec3| pairs.iter().map(of).sum::<Vec3>() / count;
    let squares: f32 = pairs.iter().map(|(a, b)| (*a - *b).length_squared() / 3.0).sum();
    (mean(|p| p.0), mean(|p| p.1), (squares / count).sqrt() / mean(|p| p.1).element_sum() * 3.0)
}

fn ball(material: Material) -> Scene {
    let mut scene = Scene { environment: Some(sky()), ..Scene::default() };
    place(&mut scene, shapes::sphere(1.0, 64), material, Affine3A::IDENTITY);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.5, 0.8, 3.4), Vec3::ZERO);
    scene
}

/// Nothing hides the environment from a ball: its matt surface reflects ρ/π ∫ L cos θ dω.
#[test]
fn a_matt_ball_in_the_open_is_lit_as_by_the_path_tracer() {
    let scene = ball(lambert(0.6));
    let (mean, truth, error) = compared(both(&scene, ("ao/none", &[]), FrameSettings::default(), 256));
    assert!((mean / truth - 1.0).abs().max_element() < 0.01, "{mean} {truth}");
    assert!(error < 0.02, "{error}");
    // Turned the other way it is another picture: the comparison can fail.
    let mut turned = scene.clone();
    turned.environment.as_mut().unwrap().rotation = Radians(-2.1);
    let (a, _, surface) = both(&turned, ("ao/none", &[]), FrameSettings::default(), 1);
    let (_, b, _) = both(&scene, ("ao/none", &[]), FrameSettings::default(), 256);
    assert!(compared((a, b, surface)).2 > 0.05);
}

/// In a corner under an even sky light is ρ L V, V the ambient visibility.
#[test]
fn ambient_visibility_weighs_the_environment() {
    let mut scene = Scene { environment: Some(Environment::uniform(LinearRgb::new(1.0, 2.0, 0.5))), ..Scene::default() };
    let wall = shapes::rectangle(4.0, 4.0);
    place(
        &mut scene,
        wall.clone(),
        lambert(0.5),
        Affine3A::from_rotation_translation(Quat::from_rotation_x(-FRAC_PI_2), Vec3::new(0.0, 0.0, 2.0)),
    );
    place(&mut scene, wall, lambert(0.5), Affine3A::from_translation(Vec3::new(0.0, 2.0, 0.0)));
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.4, 2.2, 4.0), Vec3::new(0.0, 0.3, 0.3));
    let samples: (&str, &[(&str, &str)]) = ("ao/ray-traced", &[("samples", "64")]);
    let (mean, truth, error) = compared(both(&scene, samples, FrameSettings::default(), 256));
    assert!((mean / truth - 1.0).abs().max_element() < 0.02, "{mean} {truth}");
    assert!(error < 0.06, "{error}");
    let (open, _, _) = compared(both(&scene, ("ao/none", &[]), FrameSettings::default(), 1));
    assert!((open - Vec3::new(0.5, 1.0, 0.25)).abs().max_element() < 2e-3, "ρ L where nothing counts as near: {open}");
    assert!(mean.x < 0.9 * open.x, "{mean} {open}");
}

#[test]
fn the_environment_can_be_seen_without_lighting_anything() {
    let dark = FrameSettings { environment_light: false, ..FrameSettings::default() };
    let (picture, _, surface) = both(&ball(lambert(0.6)), ("ao/none", &[]), dark, 1);
    for (color, surface) in picture.pixels().iter().zip(surface.pixels()) {
        assert_eq!(*surface, color.max_element() == 0.0, "{color}");
    }
}
