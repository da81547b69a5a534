//! Whether what light depends on has moved since it was computed: bodies and lights, but not the camera.

use crate::FrameContext;
use kajo_scene::Snapshot;

/// The scene that something was computed for.
#[derive(Default)]
pub(crate) struct StillLife(Option<(Snapshot, bool)>);

impl StillLife {
    /// True when bodies or lights differ from those of the last call, and at the first one.
    pub fn changed(&mut self, frame: &FrameContext) -> bool {
        self.differs(frame.snapshot, frame.environment_light)
    }

    fn differs(&mut self, now: &Snapshot, environment: bool) -> bool {
        let same = self.0.as_ref().is_some_and(|(before, lit)| before.same_bodies_and_lights(now) && *lit == environment);
        if !same {
            self.0 = Some((now.clone(), environment));
        }
        !same
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::builtin;
    use kajo_units::Seconds;

    #[test]
    fn bodies_and_lights_count_and_cameras_do_not() {
        let scene = builtin::load("moving").unwrap();
        let [still, moved] = [0.5, 0.6].map(|time| Snapshot::new(&scene, Seconds(time)));
        let mut life = StillLife::default();
        assert!(life.differs(&still, true) && !life.differs(&still, true));
        assert!(life.differs(&still, false) && life.differs(&still, true), "the light of the environment counts");
        let camera = Snapshot { cameras: moved.cameras.clone(), ..still.clone() };
        assert!(camera.cameras[0].world_from_view != still.cameras[0].world_from_view && !life.differs(&camera, true));
        for other in
            [Snapshot { lights: moved.lights.clone(), ..still.clone() }, Snapshot { instances: moved.instances.clone(), ..still.clone() }]
        {
            assert!(life.differs(&other, true) && life.differs(&still, true));
        }
    }
}
