//! Penumbra wedges against the path tracer's area lights.

use super::scenes::*;
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::Aov;
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Mesh, Scene, shapes};
use kajo_units::Meters;

/// An occluder over a floor under one light that looks down.
fn over_floor(occluder: Mesh, shape: LightShape) -> Scene {
    let mut scene = Scene::default();
    place(&mut scene, shapes::floor(5.0, 5.0, 1.0), lambert(0.7), Affine3A::IDENTITY);
    place(&mut scene, occluder, lambert(0.5), Affine3A::from_translation(Vec3::Y * 0.9));
    light(&mut scene, shape, 1.0, Vec3::new(0.2, 2.4, 0.1), Vec3::NEG_Y);
    camera(&mut scene, PERSPECTIVE, Vec3::new(0.6, 3.6, 3.4), Vec3::new(0.0, 0.2, 0.0));
    scene
}

/// Figure 3's occluder: a plate without thickness, a little turned.
fn plate() -> Mesh {
    let flat = Quat::from_rotation_y(0.4) * Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    shapes::rectangle(0.9, 0.6).moved(flat, Vec3::ZERO)
}

/// Mean |V − R| over the pixels whose reference is in the penumbra, and over all; and how many are in the penumbra.
fn errors(scene: &Scene, size: UVec2) -> (f32, f32, usize) {
    let rays = reference(scene, START, None, size, 1024, vec![Aov::Visibility("*".into()), Aov::InstanceId]);
    let out = frame(&Device::new().unwrap(), scene, size, "shadow/wedges", &[]);
    let image = |name: &str| Image::from_fn(size, |x, y| rays.image(name).unwrap().pixels.get(x, y).x);
    let (truth, ids) = (image("visibility.light 0"), image("instance-id"));
    let surfaces = (0..truth.pixels().len()).filter(|&i| ids.pixels()[i] >= 0.0);
    let pairs: Vec<(f32, f32)> = surfaces.map(|i| (out.visibility[0].pixels()[i], truth.pixels()[i])).collect();
    let mean = |of: &dyn Fn(f32) -> bool| {
        let errors: Vec<f32> = pairs.iter().filter(|(_, r)| of(*r)).map(|(v, r)| (v - r).abs()).collect();
        (errors.iter().sum::<f32>() / errors.len() as f32, errors.len())
    };
    let (penumbra, count) = mean(&|r| r > 0.01 && r < 0.99);
    (penumbra, mean(&|_| true).0, count)
}

/// Row SH-16: a rectangle over a rectangle is exact but for noise.
#[test]
fn a_rectangle_before_a_rectangle_is_within_two_percent() {
    let size = UVec2::new(128, 128);
    let rectangle = LightShape::Rectangle { width: Meters(0.8), height: Meters(0.5) };
    let (penumbra, all, count) = errors(&over_floor(plate(), rectangle), size);
    assert!(count > 1000, "{count} pixels of penumbra");
    assert!(penumbra <= 0.02 && all <= 0.02, "{penumbra} in the penumbra, {all} over all");
}

/// Disks are as exact as rectangles; of a sphere the disk of its cone is taken.
#[test]
fn disks_and_spheres_have_their_penumbrae() {
    let size = UVec2::new(96, 96);
    for (shape, most) in [(LightShape::Disk { radius: Meters(0.35) }, 0.02), (LightShape::Sphere { radius: Meters(0.35) }, 0.03)] {
        let (penumbra, all, count) = errors(&over_floor(plate(), shape), size);
        assert!(count > 500 && penumbra <= most && all <= 0.02, "{shape:?}: {penumbra} in {count} pixels of penumbra, {all} over all");
    }
}

/// Row SH-16: one silhouette stands for the whole light, so the error of a body grows with the light.
#[test]
fn the_error_grows_with_the_light() {
    let size = UVec2::new(96, 96);
    let body = shapes::cuboid(Vec3::new(0.3, 0.45, 0.2)).moved(Quat::from_rotation_y(0.5), Vec3::ZERO);
    let all = [0.2, 0.6, 1.8].map(|side| {
        let square = LightShape::Rectangle { width: Meters(side), height: Meters(side) };
        errors(&over_floor(body.clone(), square), size).1
    });
    assert!(all[0] < all[1] && all[1] < all[2], "{all:?}");
    assert!(all[0] < 0.01, "{all:?}");
}
