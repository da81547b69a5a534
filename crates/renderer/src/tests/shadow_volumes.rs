//! Shadow volumes against the path tracer's rays.

use super::scenes::*;
use crate::FrameOutput;
use glam::{Affine3A, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::{Aov, Pixels};
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Mesh, Projection, Scene, shapes};
use kajo_units::{Meters, Radians};

/// Visibility of each light by rays from pixel centres, and what each pixel shows.
struct Rays {
    visibility: Vec<Image<f32>>,
    instance: Image<f32>,
    normal: Image<Vec3>,
}

fn rays(scene: &Scene, size: UVec2) -> Rays {
    let frame = reference(scene, START, None, size, 1, vec![Aov::Visibility("*".into()), Aov::InstanceId, Aov::Normal]);
    let image = |pixels: &Pixels| Image::from_fn(size, |x, y| pixels.get(x, y));
    let lights = frame.images.iter().filter(|image| image.name.starts_with("visibility."));
    Rays {
        visibility: lights.map(|light| image(&light.pixels).map(|v| v.x)).collect(),
        instance: image(&frame.image("instance-id").unwrap().pixels).map(|v| v.x),
        normal: image(&frame.image("normal").unwrap().pixels),
    }
}

/// Pixels of a light more than one pixel off the border of its shadow that differ. Where rays and rasteriser see different triangles, at the outlines of
/// things, nothing can be said.
fn mismatches(out: &FrameOutput, rays: &Rays, light: usize) -> Vec<UVec2> {
    let truth = |x, y| *rays.visibility[light].get(x, y);
    let seen = out.gbuffer.as_ref().expect("asked for");
    let same = |p: &UVec2| {
        let id = seen.instance.get(p.x, p.y).map_or(-1.0, |id| id as f32);
        id >= 0.0 && id == *rays.instance.get(p.x, p.y) && seen.normal.get(p.x, p.y).dot(*rays.normal.get(p.x, p.y)) > 0.999
    };
    let differs = |p: &UVec2| same(p) && (out.visibility[light].get(p.x, p.y) - truth(p.x, p.y)).abs() > 0.5;
    off_border(&truth, out.visibility[light].size()).into_iter().filter(differs).collect()
}

fn shadowed(rays: &Rays, light: usize) -> usize {
    let pixels = rays.visibility[light].pixels().iter().zip(rays.instance.pixels());
    pixels.filter(|(v, instance)| **instance >= 0.0 && **v < 0.5).count()
}

/// Closed bodies over a floor that is closed too: 20 cm thick.
fn bodies() -> Scene {
    let mut scene = Scene::default();
    let mut body = |mesh: Mesh, at: Vec3, turn: Quat| place(&mut scene, mesh, lambert(0.6), Affine3A::from_rotation_translation(turn, at));
    body(shapes::cuboid(Vec3::new(4.0, 0.1, 4.0)), Vec3::new(0.0, -0.1, 0.0), Quat::from_rotation_y(0.2));
    body(shapes::cuboid(Vec3::new(0.3, 0.5, 0.3)), Vec3::new(-0.7, 0.5, 0.1), Quat::IDENTITY);
    body(shapes::cuboid(Vec3::new(0.5, 0.05, 0.3)), Vec3::new(0.6, 0.9, -0.2), Quat::from_rotation_y(0.6));
    body(shapes::sphere(0.35, 64), Vec3::new(0.2, 0.35, 0.9), Quat::from_rotation_x(0.3));
    body(shapes::torus(0.4, 0.12, [48, 24]), Vec3::new(-0.2, 1.3, -0.4), Quat::from_rotation_x(1.1));
    body(shapes::rounded_cuboid(Vec3::new(0.25, 0.2, 0.3), 0.05, 4), Vec3::new(1.3, 0.2, 0.5), Quat::from_rotation_y(0.9));
    scene
}

fn lights() -> [(&'static str, LightShape, Vec3); 3] {
    [
        ("spot", LightShape::Spot { inner: Radians(0.5), outer: Radians(0.75) }, Vec3::new(1.5, 4.0, 1.0)),
        ("sun", LightShape::Directional { half_angle: Radians(0.0) }, Vec3::new(2.0, 2.6, 1.2)),
        ("point", LightShape::Point, Vec3::new(-0.4, 2.2, 0.8)),
    ]
}

const CLOSE: Projection = Projection::Perspective { yfov: Radians(0.9), aspect: None };
const PARALLEL: Projection = Projection::Orthographic { xmag: Meters(1.6), ymag: Meters(1.6) };

/// Cameras outside of all volumes, inside of one, at the border of one, and parallel ones.
fn cameras() -> [(&'static str, Projection, Vec3, Vec3); 5] {
    [
        ("above", CLOSE, Vec3::new(1.0, 3.2, 4.2), Vec3::new(0.0, 0.3, 0.0)),
        ("low", CLOSE, Vec3::new(2.2, 0.12, 2.4), Vec3::new(0.0, 0.5, 0.0)),
        ("in a shadow", CLOSE, Vec3::new(0.35, 0.25, -0.45), Vec3::new(-0.3, 0.3, 1.0)),
        ("from below", CLOSE, Vec3::new(-1.4, 0.2, -1.2), Vec3::new(0.3, 1.2, 0.1)),
        ("parallel", PARALLEL, Vec3::new(1.0, 2.2, 3.0), Vec3::new(0.0, 0.5, 0.0)),
    ]
}

/// The scene seen by one of the cameras under all lights.
fn lit(mut scene: Scene, (_, projection, eye, target): (&str, Projection, Vec3, Vec3)) -> Scene {
    for (_, shape, position) in lights() {
        light(&mut scene, shape, 1.0, position, -position);
    }
    camera(&mut scene, projection, eye, target);
    scene
}

/// No pixel of any light may differ; each has shadows to find.
fn assert_equal(scene: &Scene, size: UVec2, technique: &str, what: &str) {
    let device = Device::new().unwrap();
    let (rays, out) = (rays(scene, size), frame(&device, scene, size, technique, &[]));
    for light in 0..out.visibility.len() {
        let (wrong, dark) = (mismatches(&out, &rays, light), shadowed(&rays, light));
        assert!(dark * 100 > size.element_product() as usize, "{what}, light {light}: {dark} pixels in shadow");
        assert!(wrong.is_empty(), "{technique}, {what}, light {light}: {} pixels, {:?}", wrong.len(), &wrong[..wrong.len().min(8)]);
    }
}

/// Row SH-04. One of the lights lies in the plane of a face.
#[test]
fn z_fail_equals_rays_off_the_border_for_every_camera() {
    for (index, camera) in cameras().into_iter().enumerate() {
        let size = UVec2::splat(if index == 0 { 1024 } else { 512 });
        assert_equal(&lit(bodies(), camera), size, "shadow/volume-zfail", camera.0);
    }
}
