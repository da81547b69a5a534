//! Camera rays, and the way back from a point to its pixel.

use glam::{UVec2, Vec2, Vec3};
use kajo_bvh::Ray;
use kajo_sampling::warp::concentric_disk;
use kajo_scene::{PlacedCamera, Projection};

/// A ray that leaves the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CameraRay {
    pub origin: Vec3,
    /// Unit length.
    pub direction: Vec3,
    /// Distance at which the near plane is crossed, m.
    pub t_min: f32,
}

impl CameraRay {
    /// The ray as it is traced.
    pub(crate) fn traced(self) -> Ray {
        Ray { origin: self.origin, t_min: self.t_min, direction: self.direction, t_max: f32::INFINITY }
    }
}

/// A placed camera and an image size. Pixels are square; an image of another shape than the camera was made for keeps the vertical
/// extent. x grows to the right, y down, and pixel (i, j) covers [i, i + 1) × [j, j + 1).
///
/// Nothing nearer than the camera's near plane is seen, as in the rasteriser. A thin lens of radius r focuses the plane at the focus
/// distance f: the ray starts at a point l of the lens disk and passes through the point where the central ray meets that plane.
#[derive(Clone, Debug)]
pub(crate) struct CameraView {
    origin: Vec3,
    right: Vec3,
    up: Vec3,
    /// Away from the scene: the camera looks along −back.
    back: Vec3,
    size: Vec2,
    /// Half the extent of the image: at distance 1 (perspective), or m (orthographic).
    half: Vec2,
    perspective: bool,
    near: f32,
    lens_radius: f32,
    focus: f32,
}

impl CameraView {
    pub(crate) fn new(placed: &PlacedCamera, size: UVec2) -> Self {
        let axes = placed.world_from_view;
        let (half_height, perspective) = match placed.camera.projection {
            Projection::Perspective { yfov, .. } => ((0.5 * yfov.0).tan(), true),
            Projection::Orthographic { ymag, .. } => (ymag.0, false),
        };
        let size = size.as_vec2();
        Self {
            origin: axes.w_axis.truncate(),
            right: axes.x_axis.truncate(),
            up: axes.y_axis.truncate(),
            back: axes.z_axis.truncate(),
            size,
            half: Vec2::new(half_height * size.x / size.y, half_height),
            perspective,
            near: placed.camera.near.0.max(0.0),
            lens_radius: placed.camera.lens_radius.0.max(0.0),
            focus: placed.camera.focus_distance.0,
        }
    }

    /// True when [`CameraView::ray`] makes use of its second argument.
    pub(crate) fn has_lens(&self) -> bool {
        self.lens_radius > 0.0 && self.focus > 0.0
    }

    /// The ray through a point of the image, px; `u` in [0, 1)² chooses the point of the lens.
    pub(crate) fn ray(&self, pixel: Vec2, u: Vec2) -> CameraRay {
        let ndc = (pixel / self.size * 2.0 - 1.0) * Vec2::new(1.0, -1.0);
        let on_image = self.right * (ndc.x * self.half.x) + self.up * (ndc.y * self.half.y);
        let (mut origin, mut along) =
            if self.perspective { (self.origin, on_image - self.back) } else { (self.origin + on_image, -self.back) };
        if self.has_lens() {
            let lens = concentric_disk(u) * self.lens_radius;
            let shift = self.right * lens.x + self.up * lens.y;
            along = (along * self.focus - shift) / self.focus;
            origin += shift;
        }
        // `along` has length 1 along the axis, so that its length turns depth into distance.
        let length = along.length();
        CameraRay { origin, direction: along / length, t_min: self.near * length }
    }

    /// Distance along the viewing axis, m.
    pub(crate) fn depth(&self, point: Vec3) -> f32 {
        -(point - self.origin).dot(self.back)
    }

    /// Where a point appears, px; `None` behind a perspective camera.
    pub(crate) fn project(&self, point: Vec3) -> Option<Vec2> {
        let relative = point - self.origin;
        let depth = self.depth(point);
        let scale = if self.perspective { depth } else { 1.0 };
        let ndc = Vec2::new(relative.dot(self.right), -relative.dot(self.up)) / (self.half * scale);
        (scale > 0.0 && ndc.is_finite()).then(|| (ndc + 1.0) * 0.5 * self.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Mat4, Quat};
    use kajo_scene::Camera;
    use kajo_units::{Meters, Radians};

    fn placed(projection: Projection, lens_radius: f32) -> PlacedCamera {
        let camera =
            Camera { name: String::new(), projection, lens_radius: Meters(lens_radius), focus_distance: Meters(3.0), near: Meters(0.1) };
        let rotation = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(-0.4);
        PlacedCamera { camera, world_from_view: Mat4::from_rotation_translation(rotation, Vec3::new(1.0, 2.0, 3.0)) }
    }

    const PERSPECTIVE: Projection = Projection::Perspective { yfov: Radians(0.8), aspect: Some(1.0) };
    const ORTHOGRAPHIC: Projection = Projection::Orthographic { xmag: Meters(5.0), ymag: Meters(2.0) };

    #[test]
    fn projection_is_the_inverse_of_the_ray() {
        for projection in [PERSPECTIVE, ORTHOGRAPHIC] {
            let view = CameraView::new(&placed(projection, 0.0), UVec2::new(160, 90));
            for pixel in [Vec2::ZERO, Vec2::new(80.0, 45.0), Vec2::new(159.5, 0.5), Vec2::new(3.0, 88.0)] {
                let ray = view.ray(pixel, Vec2::ZERO);
                let point = ray.origin + 7.0 * ray.direction;
                assert!(view.project(point).unwrap().abs_diff_eq(pixel, 1e-3), "{projection:?} {pixel}");
                assert!((view.depth(ray.origin + ray.t_min * ray.direction) - 0.1).abs() < 1e-5);
                assert!((ray.direction.length() - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn the_top_left_pixel_looks_up_and_to_the_left() {
        let mut camera = placed(PERSPECTIVE, 0.0);
        camera.world_from_view = Mat4::IDENTITY;
        let direction = CameraView::new(&camera, UVec2::new(4, 2)).ray(Vec2::splat(0.1), Vec2::ZERO).direction;
        assert!(direction.x < 0.0 && direction.y > 0.0 && direction.z < 0.0);
        assert!((-direction.y / direction.z - 0.9 * 0.4f32.tan()).abs() < 1e-5, "the vertical field of view is kept");
    }

    #[test]
    fn the_lens_keeps_points_at_the_focus_distance_sharp() {
        for projection in [PERSPECTIVE, ORTHOGRAPHIC] {
            let view = CameraView::new(&placed(projection, 0.2), UVec2::new(160, 90));
            let pixel = Vec2::new(20.0, 70.0);
            let at = |depth: f32, u: Vec2| {
                let ray = view.ray(pixel, u);
                ray.origin + ray.direction * ray.t_min * depth / 0.1
            };
            let (a, b) = (Vec2::new(0.1, 0.3), Vec2::new(0.9, 0.6));
            assert!(at(3.0, a).abs_diff_eq(at(3.0, b), 1e-4), "{projection:?}: sharp at 3 m");
            assert!(!at(1.0, a).abs_diff_eq(at(1.0, b), 1e-2), "{projection:?}: blurred at 1 m");
        }
    }

    #[test]
    fn points_behind_a_perspective_camera_have_no_pixel() {
        let camera = placed(PERSPECTIVE, 0.0);
        let view = CameraView::new(&camera, UVec2::new(16, 9));
        assert_eq!(view.project(camera.world_from_view.transform_point3(Vec3::Z)), None);
    }
}
