//! The camera in the user's hand: orbit around a point, or fly.
//!
//! Angles are about the world's up axis, +y, and never tilt the horizon. A camera of the scene stays exactly as it is until it is first moved.

use glam::{Mat4, Quat, Vec2, Vec3};
use kajo_scene::{PlacedCamera, Projection};

/// Turn of a drag, radians a point of the screen.
const TURN: f32 = 0.006;
/// Largest angle to the horizon: beyond it up and down change places.
const STEEPEST: f32 = 1.55;
/// Share of the distance that one step of the wheel moves.
const ZOOM: f32 = 0.12;
/// Factor of one step of the wheel to the speed.
const FASTER: f32 = 1.25;
/// Slowest and fastest flight, in sizes of the scene a second.
const SPEEDS: [f32; 2] = [1e-3, 10.0];

/// What a drag and the wheel do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Turn around a point; the wheel moves nearer.
    #[default]
    Orbit,
    /// Turn the head; the wheel changes the speed.
    Fly,
}

/// A camera that can be moved.
#[derive(Clone, Debug)]
pub(crate) struct Rig {
    /// Lens and name.
    lens: PlacedCamera,
    /// As the scene has it; gone once it was moved.
    exact: Option<Mat4>,
    position: Vec3,
    /// About +y, 0 looks along −z, radians.
    yaw: f32,
    /// Above the horizon, radians.
    pitch: f32,
    /// To the point that orbits go around, m.
    distance: f32,
    /// Largest side of the scene, m.
    extent: f32,
    /// Of flight, m/s.
    pub speed: f32,
    /// What a drag does.
    pub mode: Mode,
}

impl Rig {
    /// Takes a camera of a scene in hand; `bounds` are the scene's corners.
    pub fn new(camera: &PlacedCamera, bounds: [Vec3; 2]) -> Self {
        let extent = (bounds[1] - bounds[0]).max_element().max(1e-3);
        let mut rig = Self {
            lens: camera.clone(),
            exact: None,
            position: Vec3::ZERO,
            yaw: 0.0,
            pitch: 0.0,
            distance: 1.0,
            extent,
            speed: 0.25 * extent,
            mode: Mode::Orbit,
        };
        rig.place(camera, 0.5 * (bounds[0] + bounds[1]));
        rig
    }

    /// Goes to a camera of the scene; orbits go around the point before it that is nearest to `center`.
    pub fn place(&mut self, camera: &PlacedCamera, center: Vec3) {
        let matrix = camera.world_from_view;
        self.lens = camera.clone();
        self.exact = Some(matrix);
        self.position = matrix.w_axis.truncate();
        let forward = -matrix.z_axis.truncate().normalize_or(Vec3::Z);
        self.yaw = (-forward.x).atan2(-forward.z);
        self.pitch = forward.y.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST);
        let ahead = (center - self.position).dot(forward);
        self.distance = if ahead > 0.01 * self.extent { ahead } else { 0.5 * self.extent };
    }

    /// Stands at `eye` and looks at `target`.
    pub fn look_at(&mut self, eye: Vec3, target: Vec3) {
        let forward = (target - eye).try_normalize().unwrap_or(Vec3::NEG_Z);
        (self.position, self.distance, self.exact) = (eye, (target - eye).length().max(1e-4), None);
        self.yaw = (-forward.x).atan2(-forward.z);
        self.pitch = forward.y.asin().clamp(-STEEPEST, STEEPEST);
    }

    /// The camera as it stands.
    pub fn placed(&self) -> PlacedCamera {
        let moved = || Mat4::from_rotation_translation(self.rotation(), self.position);
        PlacedCamera { camera: self.lens.camera.clone(), world_from_view: self.exact.unwrap_or_else(moved) }
    }

    /// True when it is no longer where the scene has it.
    #[cfg(test)]
    pub fn is_moved(&self) -> bool {
        self.exact.is_none()
    }

    /// Where it stands, and a point that it looks at.
    pub fn eye_and_target(&self) -> [Vec3; 2] {
        [self.position, self.target()]
    }

    /// Turns around the target by a drag, points of the screen.
    pub fn orbit(&mut self, drag: Vec2) {
        let target = self.target();
        self.turn(drag);
        self.position = target - self.forward() * self.distance;
    }

    /// Turns the head by a drag, points of the screen.
    pub fn look(&mut self, drag: Vec2) {
        self.turn(drag);
    }

    /// Moves sideways with the target, so that it follows a drag; `height` is the picture's, points.
    pub fn pan(&mut self, drag: Vec2, height: f32) {
        let span = match self.lens.camera.projection {
            Projection::Perspective { yfov, .. } => 2.0 * self.distance * (0.5 * yfov.0).tan(),
            Projection::Orthographic { ymag, .. } => 2.0 * ymag.0.abs(),
        };
        let step = drag * span / height.max(1.0);
        self.advance(self.rotation() * Vec3::new(-step.x, step.y, 0.0));
    }

    /// Nearer to the target by steps of the wheel; a parallel projection shows less instead.
    pub fn zoom(&mut self, steps: f32) {
        let factor = (-ZOOM * steps).exp();
        if let Projection::Orthographic { xmag, ymag } = &mut self.lens.camera.projection {
            (xmag.0, ymag.0) = (xmag.0 * factor, ymag.0 * factor);
            return;
        }
        let target = self.target();
        self.free();
        self.distance = (self.distance * factor).clamp(1e-4 * self.extent, 1e3 * self.extent);
        self.position = target - self.forward() * self.distance;
    }

    /// Flies for `seconds`; `direction`: x right, y up, z back, in the camera's axes, but up is the world's.
    pub fn fly(&mut self, direction: Vec3, seconds: f32) {
        let along = self.rotation() * Vec3::new(direction.x, 0.0, direction.z) + Vec3::Y * direction.y;
        self.advance(along * (self.speed * seconds));
    }

    /// Faster or slower by steps of the wheel.
    pub fn hasten(&mut self, steps: f32) {
        self.speed = (self.speed * FASTER.powf(steps)).clamp(SPEEDS[0] * self.extent, SPEEDS[1] * self.extent);
    }

    fn turn(&mut self, drag: Vec2) {
        if drag != Vec2::ZERO {
            self.free();
            self.yaw = (self.yaw - drag.x * TURN).rem_euclid(std::f32::consts::TAU);
            self.pitch = (self.pitch - drag.y * TURN).clamp(-STEEPEST, STEEPEST);
        }
    }

    fn advance(&mut self, by: Vec3) {
        if by != Vec3::ZERO && by.is_finite() {
            self.free();
            self.position += by;
        }
    }

    /// No longer the scene's.
    fn free(&mut self) {
        self.exact = None;
    }

    fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.yaw) * Quat::from_rotation_x(self.pitch)
    }

    fn forward(&self) -> Vec3 {
        self.rotation() * Vec3::NEG_Z
    }

    fn target(&self) -> Vec3 {
        self.position + self.forward() * self.distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::{Camera, framing};
    use kajo_units::Meters;

    const BOUNDS: [Vec3; 2] = [Vec3::new(-1.0, 0.0, -2.0), Vec3::new(3.0, 2.0, 2.0)];

    fn rig() -> Rig {
        Rig::new(&framing::default_camera(BOUNDS), BOUNDS)
    }

    fn close(a: Mat4, b: Mat4) -> bool {
        a.abs_diff_eq(b, 1e-4)
    }

    #[test]
    fn a_camera_of_the_scene_stays_as_it_is_until_it_is_moved() {
        let tilted = PlacedCamera {
            world_from_view: framing::default_camera(BOUNDS).world_from_view * Mat4::from_rotation_z(0.3),
            ..framing::default_camera(BOUNDS)
        };
        let mut rig = Rig::new(&tilted, BOUNDS);
        assert!(!rig.is_moved() && rig.placed().world_from_view == tilted.world_from_view);
        rig.orbit(Vec2::ZERO);
        rig.fly(Vec3::ZERO, 1.0);
        assert!(!rig.is_moved(), "no movement is none");
        rig.look(Vec2::X);
        assert!(rig.is_moved());
    }

    #[test]
    fn angles_give_the_camera_back() {
        let mut rig = rig();
        let before = rig.placed().world_from_view;
        rig.free();
        assert!(close(rig.placed().world_from_view, before), "a camera without roll is yaw and pitch");
    }

    #[test]
    fn orbits_keep_distance_and_target() {
        let mut rig = rig();
        let [_, target] = rig.eye_and_target();
        for drag in [Vec2::new(40.0, 9.0), Vec2::new(-300.0, 500.0), Vec2::new(0.0, -9999.0)] {
            rig.orbit(drag);
            let [eye, now] = rig.eye_and_target();
            assert!(now.abs_diff_eq(target, 1e-3) && (eye.distance(target) - rig.distance).abs() < 1e-3, "{now} {target}");
            assert!(rig.placed().world_from_view.is_finite() && rig.pitch.abs() <= STEEPEST);
        }
    }

    #[test]
    fn a_drag_turns_the_picture_with_the_hand() {
        // Orbit: dragging right turns the scene right, so the camera goes left. Head: dragging right looks right.
        let mut rig = rig();
        let right = rig.placed().world_from_view.x_axis.truncate();
        let before = rig.position;
        rig.orbit(Vec2::new(10.0, 0.0));
        assert!((rig.position - before).dot(right) < 0.0);
        let forward = rig.forward();
        let right = rig.placed().world_from_view.x_axis.truncate();
        rig.look(Vec2::new(10.0, 0.0));
        assert!((rig.forward() - forward).dot(right) > 0.0);
    }

    #[test]
    fn panning_moves_the_target_by_what_the_hand_moves() {
        let mut rig = rig();
        let [_, target] = rig.eye_and_target();
        let yfov = match rig.lens.camera.projection {
            Projection::Perspective { yfov, .. } => yfov.0,
            Projection::Orthographic { .. } => unreachable!("the default camera is in perspective"),
        };
        rig.pan(Vec2::new(0.0, 50.0), 100.0);
        let [_, now] = rig.eye_and_target();
        let expected = rig.distance * (0.5 * yfov).tan();
        assert!(((now - target).length() - expected).abs() < 1e-3 * expected && now.y > target.y, "half the height of the view");
    }

    #[test]
    fn flight_goes_where_the_eye_looks_at_the_speed_that_is_set() {
        let mut rig = rig();
        let (before, forward) = (rig.position, rig.forward());
        rig.hasten(1.0);
        rig.fly(Vec3::NEG_Z, 2.0);
        assert!((rig.position - before).abs_diff_eq(forward * rig.speed * 2.0, 1e-4));
        rig.hasten(1e6);
        assert_eq!(rig.speed, SPEEDS[1] * rig.extent);
        let y = rig.position.y;
        rig.fly(Vec3::Y, 1.0);
        assert!(rig.position.y > y, "up is the world's");
    }

    #[test]
    fn the_wheel_goes_nearer_and_never_through() {
        let mut rig = rig();
        let [_, target] = rig.eye_and_target();
        (0..2000).for_each(|_| rig.zoom(1.0));
        let [eye, now] = rig.eye_and_target();
        assert!(eye.distance(target) > 0.0 && eye.is_finite() && now.abs_diff_eq(target, 1e-2));
        let parallel = PlacedCamera {
            camera: Camera {
                projection: Projection::Orthographic { xmag: Meters(2.0), ymag: Meters(1.0) },
                ..framing::default_camera(BOUNDS).camera
            },
            ..framing::default_camera(BOUNDS)
        };
        let mut rig = Rig::new(&parallel, BOUNDS);
        rig.zoom(3.0);
        let Projection::Orthographic { xmag, ymag } = rig.placed().camera.projection else { unreachable!("it stays parallel") };
        assert!(ymag.0 < 1.0 && (xmag.0 / ymag.0 - 2.0).abs() < 1e-5);
    }

    #[test]
    fn look_at_is_what_the_command_line_says() {
        let mut rig = rig();
        rig.look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 1.0, 0.0));
        let [eye, target] = rig.eye_and_target();
        assert!(eye == Vec3::new(1.0, 2.0, 3.0) && target.abs_diff_eq(Vec3::new(0.0, 1.0, 0.0), 1e-4));
        rig.look_at(Vec3::ONE, Vec3::ONE);
        assert!(rig.placed().world_from_view.is_finite());
    }
}
