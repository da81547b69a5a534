//! Whether anything moves between two snapshots of one scene.

use kajo_scene::{PlacedCamera, Snapshot};

/// True when a picture of one is a picture of the other: snapshots of one scene, between which neither bodies nor lights nor cameras move.
pub fn nothing_moves(a: &Snapshot, b: &Snapshot) -> bool {
    let cameras = a.cameras.len() == b.cameras.len() && a.cameras.iter().zip(&b.cameras).all(|(a, b)| same_view(a, b));
    a.same_bodies_and_lights(b) && cameras
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
