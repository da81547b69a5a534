//! Whether anything moves between two snapshots of one scene.

use kajo_scene::{PlacedCamera, PlacedLight, Snapshot};
use std::sync::Arc;

/// True when a picture of one is a picture of the other: snapshots of one scene, between which neither bodies nor lights nor cameras move.
pub fn nothing_moves(a: &Snapshot, b: &Snapshot) -> bool {
    let meshes = a.meshes.len() == b.meshes.len() && a.meshes.iter().zip(&b.meshes).all(|(a, b)| Arc::ptr_eq(a, b));
    let instances = a.instances.len() == b.instances.len()
        && a.instances.iter().zip(&b.instances).all(|(a, b)| a.mesh == b.mesh && a.world_from_object == b.world_from_object);
    let light = |(a, b): (&PlacedLight, &PlacedLight)| a.light == b.light && a.world_from_light == b.world_from_light;
    let camera = |(a, b): (&PlacedCamera, &PlacedCamera)| same_view(a, b);
    meshes
        && instances
        && a.lights.len() == b.lights.len()
        && a.lights.iter().zip(&b.lights).all(light)
        && a.cameras.len() == b.cameras.len()
        && a.cameras.iter().zip(&b.cameras).all(camera)
}

/// True when both cameras see the same.
pub(crate) fn same_view(a: &PlacedCamera, b: &PlacedCamera) -> bool {
    a.camera == b.camera && a.world_from_view == b.world_from_view
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::builtin;
    use kajo_units::Seconds;

    #[test]
    fn motion_of_camera_light_and_body_is_seen() {
        let scene = builtin::load("moving").unwrap();
        let at = |time: f32| Snapshot::new(&scene, Seconds(time));
        assert!(nothing_moves(&at(0.5), &at(0.5)));
        let still = at(0.5);
        let moved = at(0.6);
        let faults: [fn(&mut Snapshot, &Snapshot); 3] =
            [|a, b| a.cameras = b.cameras.clone(), |a, b| a.lights = b.lights.clone(), |a, b| a.instances = b.instances.clone()];
        for fault in faults {
            let mut other = still.clone();
            fault(&mut other, &moved);
            assert!(!nothing_moves(&still, &other));
        }
    }
}
