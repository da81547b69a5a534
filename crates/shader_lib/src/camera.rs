//! Pixels, view rays and reversed depth: the twin of `shader_lib::camera`.

use glam::{Vec2, Vec3};

/// A distance that stands for infinity: rays and depths beyond every scene, whose square does not overflow.
pub const FAR: f32 = 1e18;

/// Reversed depth, infinite far plane: 1 at the near plane, 0 at infinity. `distance` along the viewing axis, m.
pub fn depth_from_distance(distance: f32, near: f32) -> f32 {
    near / distance
}

/// The inverse of [`depth_from_distance`]; [`FAR`] where the depth is 0.
pub fn distance_from_depth(depth: f32, near: f32) -> f32 {
    near / depth.max(near / FAR)
}

/// Pixel to clip space: x right, y up, both in [−1, 1]. `pixel` grows to the right and down; centres are at ½.
pub fn ndc_from_pixel(pixel: Vec2, size: Vec2) -> Vec2 {
    (pixel / size * 2.0 - 1.0) * Vec2::new(1.0, -1.0)
}

/// The inverse of [`ndc_from_pixel`].
pub fn pixel_from_ndc(ndc: Vec2, size: Vec2) -> Vec2 {
    (ndc * Vec2::new(1.0, -1.0) * 0.5 + 0.5) * size
}

/// View-space direction through a pixel of a perspective camera, of length 1 along the axis (−z): times a distance it is a position.
/// `half_extent` is half the image at distance 1: (tan(yfov/2) · width/height, tan(yfov/2)).
pub fn view_ray(pixel: Vec2, size: Vec2, half_extent: Vec2) -> Vec3 {
    (ndc_from_pixel(pixel, size) * half_extent).extend(-1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The helpers are the projection matrix of the rasteriser, written out.
    #[test]
    fn ray_and_depth_invert_the_projection_matrix() {
        let (near, yfov, size) = (0.1, 0.9f32, Vec2::new(160.0, 90.0));
        let clip_from_view = glam::camera::rh::proj::directx::perspective_infinite_reverse(yfov, size.x / size.y, near);
        let half_extent = Vec2::new((0.5 * yfov).tan() * size.x / size.y, (0.5 * yfov).tan());
        for pixel in [Vec2::new(0.5, 0.5), Vec2::new(80.0, 45.0), Vec2::new(159.5, 3.5)] {
            for distance in [0.1, 1.0, 750.0] {
                let clip = clip_from_view * (view_ray(pixel, size, half_extent) * distance).extend(1.0);
                assert!((clip.z / clip.w - depth_from_distance(distance, near)).abs() < 1e-6);
                assert!(pixel_from_ndc(clip.truncate().truncate() / clip.w, size).abs_diff_eq(pixel, 1e-3));
                assert!((distance_from_depth(clip.z / clip.w, near) - distance).abs() < 1e-4 * distance);
            }
        }
        assert_eq!(distance_from_depth(0.0, near), FAR);
    }
}
