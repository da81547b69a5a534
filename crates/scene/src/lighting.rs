//! The light for scenes that have none.
//!
//! An object gets a key light, a small sun from the upper left of its camera, and a uniform sky that fills the shadows. A camera
//! inside of the bounds, as in a room, gets a glowing sphere above it: no sun comes in where walls are.

use crate::{Environment, Light, LightShape, Node, PlacedCamera, Scene, Snapshot, Transform, framing};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters, Radians, Seconds};
use std::f32::consts::PI;

/// Irradiance of the key light on a surface that faces it, W/m²: a white one shines with radiance 1.
const KEY_IRRADIANCE: f32 = PI;
/// Half angle of the key light: soft, and small enough for crisp contacts.
const KEY_HALF_ANGLE: f32 = 0.02;
/// Where the key light stands, seen from the camera: right, up, towards the viewer.
const KEY_FROM: Vec3 = Vec3::new(-0.6, 0.9, 0.5);
/// Radiance of the sky, W/(m² sr).
const SKY: f32 = 0.4;

/// Lights a scene that has none, and says how.
pub fn light(scene: &mut Scene) -> &'static str {
    let snapshot = Snapshot::new(scene, Seconds(0.0));
    let bounds = framing::bounds(&snapshot.meshes, &snapshot.instances);
    let camera = &snapshot.cameras[0];
    let eye = camera.world_from_view.w_axis.truncate();
    let inside = eye.cmpgt(bounds[0]).all() && eye.cmplt(bounds[1]).all();
    if inside {
        let (light, place) = ceiling_light(eye, bounds);
        add(scene, light, place, Quat::IDENTITY);
        "a glowing sphere above the camera was added"
    } else {
        let (light, rotation) = key_light(camera);
        add(scene, light, eye, rotation);
        scene.environment = Some(Environment::uniform(LinearRgb::splat(SKY)));
        "a key light and a uniform sky were added; give an environment with --env"
    }
}

fn key_light(camera: &PlacedCamera) -> (Light, Quat) {
    let towards = camera.world_from_view.transform_vector3(KEY_FROM).normalize_or(Vec3::Y);
    let shape = LightShape::Directional { half_angle: Radians(KEY_HALF_ANGLE) };
    let light = Light { name: "default key".into(), shape, emission: LinearRgb::splat(KEY_IRRADIANCE) };
    (light, Quat::from_rotation_arc(Vec3::Z, towards))
}

/// Half way from the eye to the top of the bounds; as bright that the far wall gets about [`KEY_IRRADIANCE`].
fn ceiling_light(eye: Vec3, [low, high]: [Vec3; 2]) -> (Light, Vec3) {
    let size = high - low;
    let radius = 0.02 * size.y;
    let distance = 0.5 * size.max_element();
    // E = L π r² / d² on a surface that faces the sphere from afar.
    let radiance = KEY_IRRADIANCE * distance * distance / (PI * radius * radius);
    let shape = LightShape::Sphere { radius: Meters(radius) };
    let light = Light { name: "default lamp".into(), shape, emission: LinearRgb::splat(radiance) };
    (light, eye + Vec3::Y * 0.5 * (high.y - eye.y))
}

fn add(scene: &mut Scene, light: Light, translation: Vec3, rotation: Quat) {
    let transform = Transform::Trs { translation, rotation, scale: Vec3::ONE };
    scene.nodes.push(Node { name: light.name.clone(), transform, light: Some(scene.lights.len()), ..Node::default() });
    scene.lights.push(light);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, shapes};
    use std::sync::Arc;

    fn scene(mesh: crate::Mesh) -> Scene {
        let mut scene = Scene {
            nodes: vec![Node { meshes: vec![0], ..Node::default() }],
            meshes: vec![Arc::new(mesh)],
            materials: vec![Material::default()],
            ..Scene::default()
        };
        crate::load::complete(&mut scene);
        scene
    }

    #[test]
    fn an_object_is_lit_from_the_upper_left_of_the_camera() {
        let scene = scene(shapes::sphere(1.0, 8));
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        let view_from_world = snapshot.cameras[0].world_from_view.inverse();
        let to_light = view_from_world.transform_vector3(snapshot.lights[0].world_from_light.transform_vector3(Vec3::Z));
        assert!(to_light.abs_diff_eq(KEY_FROM.normalize(), 1e-5), "{to_light}");
        assert!(scene.environment.is_some());
    }

    #[test]
    fn a_closed_room_is_lit_from_inside() {
        let mut room = shapes::cuboid(Vec3::new(2.0, 1.5, 2.5));
        room.indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        let scene = scene(room);
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        let place = snapshot.lights[0].world_from_light.translation;
        assert!(place.abs().cmplt(glam::Vec3A::new(2.0, 1.5, 2.5)).all(), "{place}");
        assert!(matches!(scene.lights[0].shape, LightShape::Sphere { .. }));
    }
}
