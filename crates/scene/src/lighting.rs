//! The light for scenes that have none.
//!
//! An object gets a key light, a small sun from the upper left of its camera, and a uniform sky that fills the shadows. A camera
//! inside of the bounds, as in a room, gets a glowing disk before and above it that faces down: no sun comes in where walls are, and a lamp that
//! shone on the ceiling close above it would light the room by a hot spot there.

use crate::{Environment, Light, LightShape, Node, PlacedCamera, Scene, Snapshot, Transform, framing};
use glam::{Quat, Vec3};
use kajo_units::{LinearRgb, Meters, Radians, Seconds};
use std::f32::consts::{FRAC_PI_2, PI};

/// Irradiance of the key light on a surface that faces it, W/m²: a white one shines with radiance 1.
const KEY_IRRADIANCE: f32 = PI;
/// Half angle of the key light: soft, and small enough for crisp contacts.
const KEY_HALF_ANGLE: f32 = 0.02;
/// Irradiance of the floor below the lamp of a room, W/m²: what is farther away and at a slant gets less.
const FLOOR_IRRADIANCE: f32 = 2.0 * PI;
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
        let (light, place) = ceiling_light(camera, bounds);
        add(scene, light, place, Quat::from_rotation_x(-FRAC_PI_2));
        "a lamp before and above the camera was added"
    } else {
        // The key light is made for exposure 0; automatic exposure would look at the sky instead of the object.
        scene.exposure.get_or_insert(0.0);
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

/// Half way to what the camera looks at and half way to the top of the bounds, facing down: away from walls, which it would make too bright.
fn ceiling_light(camera: &PlacedCamera, [low, high]: [Vec3; 2]) -> (Light, Vec3) {
    let eye = camera.world_from_view.w_axis.truncate();
    let forward = camera.world_from_view.transform_vector3(Vec3::NEG_Z).with_y(0.0).normalize_or_zero();
    let ahead = 0.5 * camera.camera.focus_distance.0.min(0.5 * (high - low).max_element());
    let place = eye + forward * ahead + Vec3::Y * 0.5 * (high.y - eye.y);
    let radius = 0.15 * (high.y - low.y);
    let height = place.y - low.y;
    // On the axis of a disk, E = π L r² / (r² + h²).    [PBR4] section 4.2.3
    let radiance = FLOOR_IRRADIANCE * (radius * radius + height * height) / (PI * radius * radius);
    let light =
        Light { name: "default lamp".into(), shape: LightShape::Disk { radius: Meters(radius) }, emission: LinearRgb::splat(radiance) };
    (light, place)
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
        let shines = snapshot.lights[0].world_from_light.transform_vector3(Vec3::NEG_Z);
        assert!(shines.abs_diff_eq(Vec3::NEG_Y, 1e-6), "{shines}");
    }
}
