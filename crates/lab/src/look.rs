//! A camera placed by hand: where it stands, and what it looks at.

use glam::{Mat4, Vec3};
use kajo_scene::{PlacedCamera, Projection};
use kajo_units::Radians;

/// Replaces the place of a camera; horizons stay level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Where it stands, world, m.
    pub from: Vec3,
    /// A point in the middle of the picture, world, m.
    pub at: Vec3,
    /// Vertical angle of view, degrees; `None` keeps the camera's. Parallel projection has none.
    pub fov: Option<f32>,
}

/// Closest to ±1 that the direction's height may be before another axis says what is up.
const STEEP: f32 = 0.999_99;

impl Look {
    /// The lens of `camera` at this place. A place that is its own target looks along −z.
    pub fn place(&self, camera: &PlacedCamera) -> PlacedCamera {
        let forward = (self.at - self.from).try_normalize().unwrap_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > STEEP { Vec3::Z } else { Vec3::Y };
        let right = forward.cross(up).normalize();
        let axes = [right.extend(0.0), right.cross(forward).extend(0.0), (-forward).extend(0.0), self.from.extend(1.0)];
        let mut placed =
            PlacedCamera { world_from_view: Mat4::from_cols(axes[0], axes[1], axes[2], axes[3]), camera: camera.camera.clone() };
        if let (Some(degrees), Projection::Perspective { yfov, .. }) = (self.fov, &mut placed.camera.projection) {
            *yfov = Radians::from_degrees(degrees);
        }
        placed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::framing;

    fn placed(from: Vec3, at: Vec3) -> PlacedCamera {
        Look { from, at, fov: Some(30.0) }.place(&framing::default_camera([Vec3::ZERO, Vec3::ONE]))
    }

    #[test]
    fn the_target_is_straight_ahead_and_the_horizon_level() {
        for (from, at) in [
            (Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 1.0, -1.0)),
            (Vec3::ZERO, Vec3::new(0.0, 0.0, 5.0)),
            (Vec3::new(3.0, 1.0, 0.0), Vec3::new(-3.0, 1.0, 0.1)),
        ] {
            let view = placed(from, at).world_from_view;
            let seen = view.inverse().transform_point3(at);
            assert!(seen.truncate().length() < 1e-4 && seen.z < 0.0, "{seen}");
            assert!(view.x_axis.y.abs() < 1e-6 && view.y_axis.y > 0.0 && (view.determinant() - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn straight_down_and_no_direction_are_cameras_too() {
        for at in [Vec3::NEG_Y, Vec3::Y, Vec3::ZERO] {
            let view = placed(Vec3::ZERO, at).world_from_view;
            assert!(view.is_finite() && (view.determinant() - 1.0).abs() < 1e-4, "{view}");
        }
    }

    #[test]
    fn the_angle_replaces_the_lens() {
        let Projection::Perspective { yfov, .. } = placed(Vec3::ZERO, Vec3::X).camera.projection else { panic!("perspective") };
        assert!((yfov.0.to_degrees() - 30.0).abs() < 1e-4);
    }
}
