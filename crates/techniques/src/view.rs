//! The camera as the rasteriser sees it: matrices in camera-relative coordinates, reversed depth, jitter.
//!
//! *Relative* coordinates have the axes of the world and their origin at the camera, so that far from the world's origin no digit is
//! lost. See `docs/conventions.md` for depth.

use glam::{Mat4, UVec2, Vec2, Vec3, Vec4};
use kajo_scene::{PlacedCamera, Projection};

/// A camera, an image size, and where in each pixel is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Size of the image, px.
    pub size: UVec2,
    /// Position of the camera in the world, m.
    pub position: Vec3,
    /// View axes in the world; no translation.
    pub relative_from_view: Mat4,
    /// Distance of the near plane, m.
    pub near: f32,
    /// False for parallel projection.
    pub perspective: bool,
    /// Where in each pixel is sampled, from its centre, px, x right and y down.
    pub jitter: Vec2,
    clip_from_view: Mat4,
}

impl View {
    /// The view of `camera`, sampled at pixel centres. `far` bounds the depth of parallel projection; perspective has no far plane.
    pub fn new(camera: &PlacedCamera, size: UVec2, far: f32) -> Self {
        let near = camera.camera.near.0.max(MIN_NEAR);
        let aspect = size.x as f32 / size.y as f32;
        let (clip_from_view, perspective) = match camera.camera.projection {
            Projection::Perspective { yfov, .. } => (infinite_reversed(yfov.0, aspect, near), true),
            Projection::Orthographic { ymag, .. } => (parallel_reversed(ymag.0 * aspect, ymag.0, near, far.max(near * 2.0)), false),
        };
        let mut relative_from_view = camera.world_from_view;
        relative_from_view.w_axis = Vec4::W;
        let position = camera.world_from_view.w_axis.truncate();
        Self { size, position, relative_from_view, near, perspective, jitter: Vec2::ZERO, clip_from_view }
    }

    /// The same view, sampled elsewhere in each pixel: `jitter` px from its centre, x right and y down.
    pub fn jittered(mut self, jitter: Vec2) -> Self {
        self.jitter = jitter;
        self
    }

    /// Relative to clip space, without jitter.
    pub fn clip_from_relative(&self) -> Mat4 {
        self.clip_from_view * self.relative_from_view.transpose()
    }

    /// Relative to clip space, so that the sample of each pixel lies at its centre.
    pub fn jittered_clip_from_relative(&self) -> Mat4 {
        let shift = Vec2::new(-self.jitter.x, self.jitter.y) * 2.0 / self.size.as_vec2();
        Mat4::from_translation(shift.extend(0.0)) * self.clip_from_relative()
    }

    /// Distance from the near plane to the far plane of parallel projection, m; 0 for perspective, which has no far plane.
    pub fn depth_range(&self) -> f32 {
        if self.perspective { 0.0 } else { 1.0 / self.clip_from_view.z_axis.z }
    }

    /// Where a point of the world appears, px, x right and y down; `None` behind a perspective camera.
    pub fn project(&self, world: Vec3) -> Option<Vec2> {
        let clip = self.clip_from_relative() * (world - self.position).extend(1.0);
        let ndc = Vec2::new(clip.x, -clip.y) / clip.w;
        (clip.w > 0.0).then(|| (ndc + 1.0) * 0.5 * self.size.as_vec2())
    }
}

/// Keeps near / distance from underflowing for the far side of any scene.
const MIN_NEAR: f32 = 1e-6;

/// Depth near/d: 1 at the near plane, 0 at infinity.
fn infinite_reversed(yfov: f32, aspect: f32, near: f32) -> Mat4 {
    let f = 1.0 / (0.5 * yfov).tan();
    Mat4::from_cols(Vec4::X * (f / aspect), Vec4::Y * f, Vec4::new(0.0, 0.0, 0.0, -1.0), Vec4::new(0.0, 0.0, near, 0.0))
}

/// Depth (far − d)/(far − near): 1 at the near plane, 0 at the far plane.
fn parallel_reversed(half_width: f32, half_height: f32, near: f32, far: f32) -> Mat4 {
    let depth = 1.0 / (far - near);
    Mat4::from_cols(Vec4::X / half_width, Vec4::Y / half_height, Vec4::new(0.0, 0.0, depth, 0.0), Vec4::new(0.0, 0.0, far * depth, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use kajo_scene::Camera;
    use kajo_units::{Meters, Radians};

    fn camera(projection: Projection) -> PlacedCamera {
        let camera = Camera { name: String::new(), projection, lens_radius: Meters(0.0), focus_distance: Meters(1.0), near: Meters(0.1) };
        PlacedCamera {
            camera,
            world_from_view: Mat4::from_rotation_translation(glam::Quat::from_rotation_y(0.7), Vec3::new(1.0, 2.0, 3.0)),
        }
    }

    const PERSPECTIVE: Projection = Projection::Perspective { yfov: Radians(0.8), aspect: None };
    const PARALLEL: Projection = Projection::Orthographic { xmag: Meters(2.0), ymag: Meters(2.0) };

    #[test]
    fn depth_is_one_at_the_near_plane_and_falls_to_zero() {
        for (projection, far_depth) in [(PERSPECTIVE, 0.1 / 50.0), (PARALLEL, 0.0)] {
            let placed = camera(projection);
            let view = View::new(&placed, UVec2::new(64, 32), 50.0);
            let depth = |d: f32| {
                let clip = view.clip_from_relative() * (placed.world_from_view.transform_vector3(Vec3::NEG_Z) * d).extend(1.0);
                clip.z / clip.w
            };
            assert!((depth(0.1) - 1.0).abs() < 1e-5, "{projection:?}");
            assert!((depth(50.0) - far_depth).abs() < 1e-6, "{projection:?}");
        }
    }

    #[test]
    fn the_centre_projects_to_the_middle_and_up_is_up() {
        for projection in [PERSPECTIVE, PARALLEL] {
            let placed = camera(projection);
            let view = View::new(&placed, UVec2::new(64, 32), 50.0);
            let at = |x: f32, y: f32| view.project(placed.world_from_view.transform_point3(Vec3::new(x, y, -4.0))).unwrap();
            assert!(at(0.0, 0.0).abs_diff_eq(Vec2::new(32.0, 16.0), 1e-4));
            assert!(at(0.0, 0.5).y < 15.0 && at(0.5, 0.0).x > 33.0, "{projection:?}");
        }
    }

    #[test]
    fn jitter_moves_the_sample_to_the_pixel_centre() {
        let placed = camera(PERSPECTIVE);
        let view = View::new(&placed, UVec2::new(64, 32), 50.0);
        let point = placed.world_from_view.transform_point3(Vec3::new(0.3, 0.2, -4.0));
        let pixel = view.project(point).unwrap();
        let jittered = view.jittered(Vec2::new(0.25, -0.125));
        let clip = jittered.jittered_clip_from_relative() * (point - view.position).extend(1.0);
        let seen = (Vec2::new(clip.x, -clip.y) / clip.w + 1.0) * 0.5 * Vec2::new(64.0, 32.0);
        assert!(seen.abs_diff_eq(pixel - Vec2::new(0.25, -0.125), 1e-4), "{seen} {pixel}");
    }
}
