//! The camera for scenes that have none.
//!
//! Candidates are looked through at thumbnail size (`view`) and the first good one is taken: the three-quarter view of an object; else, where that
//! shows the backs of surfaces (the walls of a room seen from outside), a side from which it does not, as of a stage; else a place inside.

mod view;

use crate::{Camera, Instance, Mesh, PlacedCamera, Projection, Scene, Snapshot};
use glam::{Mat4, Vec3};
use kajo_units::{Meters, Radians, Seconds};
use std::sync::Arc;
use view::{Seen, View};

/// Vertical field of view from outside, and from inside a room.
const OUTSIDE_YFOV: f32 = 40.0;
const INSIDE_YFOV: f32 = 60.0;
/// Share of the covered pixels that may show backs of surfaces.
const TOLERATED_BACKS: f32 = 0.25;
/// Height of the eyes of someone who stands, m.
const EYE_HEIGHT: f32 = 1.6;

/// Smallest and largest corner of what is placed; a unit box around the origin where nothing is.
pub fn bounds(meshes: &[Arc<Mesh>], instances: &[Instance]) -> [Vec3; 2] {
    let mut low = Vec3::INFINITY;
    let mut high = Vec3::NEG_INFINITY;
    for instance in instances {
        for &position in &meshes[instance.mesh].positions {
            let world = instance.world_from_object.transform_point3(position);
            low = low.min(world);
            high = high.max(world);
        }
    }
    if low.is_finite() && high.is_finite() { [low, high] } else { [Vec3::splat(-0.5), Vec3::splat(0.5)] }
}

/// A camera that shows the scene: chosen for the pose at time 0, wide enough for the whole animation that plays.
pub fn camera_for(scene: &Scene) -> PlacedCamera {
    const POSES: u8 = 8;
    let rest = Snapshot::new(scene, Seconds(0.0));
    let duration = scene
        .animations
        .get(scene.animation)
        .map_or(0.0, |animation| animation.channels.iter().filter_map(|channel| channel.times.last()).copied().fold(0.0, f32::max));
    let mut bounds = self::bounds(&rest.meshes, &rest.instances);
    if duration > 0.0 {
        for pose in 1..=POSES {
            let moved = Snapshot::new(scene, Seconds(duration * f32::from(pose) / f32::from(POSES)));
            let [low, high] = self::bounds(&moved.meshes, &moved.instances);
            bounds = [bounds[0].min(low), bounds[1].max(high)];
        }
    }
    choose(&rest.meshes, &rest.instances, bounds)
}

/// A perspective camera of 40° that sees the whole bounding sphere from the front, 20° above and 30° to the right.
pub fn default_camera([low, high]: [Vec3; 2]) -> PlacedCamera {
    let (azimuth, elevation) = (30f32.to_radians(), 20f32.to_radians());
    let towards = Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
    let center = low * 0.5 + high * 0.5;
    let radius = ((high - low).length() * 0.5).max(1e-3);
    let distance = radius / (OUTSIDE_YFOV.to_radians() * 0.5).sin();
    placed(center + towards * distance, center, OUTSIDE_YFOV, (distance - radius) * 0.05)
}

fn choose(meshes: &[Arc<Mesh>], instances: &[Instance], bounds: [Vec3; 2]) -> PlacedCamera {
    let looked = |camera: PlacedCamera| {
        let seen = View::new(&camera).look(meshes, instances);
        (camera, seen)
    };
    let (object, seen) = looked(default_camera(bounds));
    if seen.backs() <= TOLERATED_BACKS {
        return object;
    }
    // Open sides; the front wins a draw.
    let stages = [Vec3::Z, Vec3::X, Vec3::NEG_X, Vec3::NEG_Z].map(|side| looked(stage_camera(bounds, side)));
    let (stage, seen) = stages.into_iter().min_by(|a, b| a.1.backs().total_cmp(&b.1.backs())).expect("four sides");
    if seen.backs() <= TOLERATED_BACKS {
        return stage;
    }
    let score = |seen: &Seen| seen.spaciousness();
    let inside = inside_cameras(bounds).map(looked);
    inside.into_iter().max_by(|a, b| score(&a.1).total_cmp(&score(&b.1))).map_or(object, |(camera, _)| camera)
}

/// Looks straight into a side of the bounds, whose near face fills the height or the width of a square image.
fn stage_camera([low, high]: [Vec3; 2], side: Vec3) -> PlacedCamera {
    let (center, half) = (low * 0.5 + high * 0.5, ((high - low) * 0.5).max(Vec3::splat(1e-3)));
    let depth = half.dot(side.abs());
    let width = half.dot(Vec3::Y.cross(side).abs());
    let distance = half.y.max(width) / (OUTSIDE_YFOV.to_radians() * 0.5).tan() * 1.04;
    placed(center + side * (depth + distance), center, OUTSIDE_YFOV, distance * 0.05)
}

/// In the four corners and before the middles of the four walls, at the height of eyes, looking across.
fn inside_cameras([low, high]: [Vec3; 2]) -> [PlacedCamera; 8] {
    let size = high - low;
    // Where a storey is not of human size, the unit is not the metre or the room no room: a share of the height instead.
    let eye = if (2.0..8.0).contains(&size.y) { EYE_HEIGHT } else { 0.55 * size.y };
    let target = Vec3::new((low.x + high.x) * 0.5, low.y + 0.75 * eye, (low.z + high.z) * 0.5);
    [(1, 1), (-1, 1), (1, -1), (-1, -1), (0, 1), (1, 0), (-1, 0), (0, -1)].map(|(x, z)| {
        let place = Vec3::new(x as f32, 0.0, z as f32) * size * 0.38;
        let eye = Vec3::new(target.x, low.y + eye, target.z) + place;
        placed(eye, target, INSIDE_YFOV, size.max_element() * 1e-3)
    })
}

fn placed(eye: Vec3, target: Vec3, yfov_degrees: f32, near: f32) -> PlacedCamera {
    let camera = Camera {
        name: "default".into(),
        projection: Projection::Perspective { yfov: Radians::from_degrees(yfov_degrees), aspect: None },
        lens_radius: Meters(0.0),
        focus_distance: Meters(eye.distance(target)),
        near: Meters(near),
    };
    let world_from_view: Mat4 = glam::camera::rh::view::look_at_mat4(eye, target, Vec3::Y).inverse();
    PlacedCamera { camera, world_from_view }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Animation, Channel, Interpolation, Node, Property, builtin, shapes};
    use glam::Affine3A;

    fn chosen(meshes: Vec<Mesh>) -> (PlacedCamera, [Vec3; 2]) {
        let meshes: Vec<_> = meshes.into_iter().map(Arc::new).collect();
        let instances: Vec<_> = (0..meshes.len()).map(|mesh| Instance { node: 0, mesh, world_from_object: Affine3A::IDENTITY }).collect();
        let bounds = bounds(&meshes, &instances);
        (choose(&meshes, &instances, bounds), bounds)
    }

    fn eye(camera: &PlacedCamera) -> Vec3 {
        camera.world_from_view.w_axis.truncate()
    }

    fn inside([low, high]: [Vec3; 2], p: Vec3) -> bool {
        p.cmpgt(low).all() && p.cmplt(high).all()
    }

    #[test]
    fn an_object_is_seen_from_outside_and_fits_the_image() {
        for scale in [1e-3, 1.0, 1e4] {
            let (camera, [low, high]) = chosen(vec![shapes::cuboid(Vec3::new(1.0, 2.0, 0.5) * scale)]);
            assert!(eye(&camera).z > 0.0 && eye(&camera).y > 0.0 && eye(&camera).x > 0.0);
            let view_from_world = camera.world_from_view.inverse();
            let tan = (OUTSIDE_YFOV.to_radians() * 0.5).tan();
            for corner in 0..8 {
                let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
                let p = view_from_world.transform_point3(Vec3::new(pick(0), pick(1), pick(2)));
                assert!(-p.z > camera.camera.near.0, "{p}");
                assert!(p.x.abs() / -p.z < tan && p.y.abs() / -p.z < tan, "{p}");
            }
        }
    }

    #[test]
    fn a_closed_room_is_seen_from_inside() {
        let room = shapes::cuboid(Vec3::new(3.0, 1.4, 2.0)).inside_out();
        let (camera, bounds) = chosen(vec![room, shapes::sphere(0.4, 16)]);
        assert!(inside(bounds, eye(&camera)), "{}", eye(&camera));
        assert!((eye(&camera).y - (-1.4 + EYE_HEIGHT)).abs() < 1e-4);
    }

    #[test]
    fn a_room_with_an_open_side_is_looked_into() {
        for open in 2..6 {
            let mut room = shapes::cuboid(Vec3::ONE).inside_out();
            let [right, up] =
                [room.positions[4 * open + 1] - room.positions[4 * open], room.positions[4 * open + 2] - room.positions[4 * open + 1]];
            let side = right.cross(up).normalize();
            room.indices.drain(2 * open..2 * open + 2);
            let (camera, bounds) = chosen(vec![room, shapes::sphere(0.3, 16)]);
            if side.y == 0.0 {
                assert!(eye(&camera).normalize().dot(side) > 0.9, "open towards {side}, seen from {}", eye(&camera));
            } else {
                assert!(side.y > 0.0 || inside(bounds, eye(&camera)), "open towards {side}, seen from {}", eye(&camera));
            }
        }
    }

    #[test]
    fn cornell_box_without_its_camera_is_looked_into_from_the_front() {
        let mut scene = builtin::load("cornell").unwrap();
        scene.nodes.retain(|node| node.camera.is_none());
        scene.cameras.clear();
        let camera = camera_for(&scene);
        assert!(eye(&camera).z > 2.0 && eye(&camera).x.abs() < 0.1, "{}", eye(&camera));
    }

    #[test]
    fn nothing_and_flat_things_still_give_a_camera() {
        for meshes in [vec![], vec![shapes::rectangle(1.0, 1.0)], vec![Mesh::default()]] {
            let (camera, _) = chosen(meshes);
            assert!(camera.world_from_view.is_finite() && camera.camera.near.0 > 0.0);
        }
    }

    #[test]
    fn a_moving_scene_is_framed_over_its_whole_loop() {
        let node = Node { meshes: vec![0], ..Node::default() };
        let channel = Channel {
            node: 0,
            property: Property::Translation,
            interpolation: Interpolation::Linear,
            times: vec![0.0, 1.0],
            values: vec![0.0, 0.0, 0.0, 6.0, 0.0, 0.0],
        };
        let animation = Animation { name: String::new(), channels: vec![channel] };
        let meshes = vec![Arc::new(shapes::cuboid(Vec3::ONE))];
        let resting = Scene { nodes: vec![node], meshes, ..Scene::default() };
        let moving = Scene { animations: vec![animation], ..resting.clone() };
        // The union of the boxes at both ends is 8 m wide and centred at x = 3.
        let expected = default_camera([Vec3::NEG_ONE, Vec3::new(7.0, 1.0, 1.0)]);
        assert!(eye(&camera_for(&moving)).distance(eye(&expected)) < 1e-4);
        assert!(eye(&camera_for(&resting)).distance(eye(&default_camera([Vec3::NEG_ONE, Vec3::ONE]))) < 1e-4);
    }
}
