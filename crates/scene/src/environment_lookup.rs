//! Radiance of an environment by direction, and the grid that its importance sampling is built on.

use crate::{ColorSpace, Environment, Filter, Texture, Wrap};
use glam::{Vec2, Vec3};
use kajo_image::Image;
use kajo_units::LinearRgb;
use std::f32::consts::{PI, TAU};

/// How latitude-longitude images are read: u goes round, v ends at the poles.
const LAT_LONG: Texture = Texture { image: 0, wrap: [Wrap::Repeat, Wrap::Clamp], filter: Filter::Linear, color_space: ColorSpace::Linear };

impl Environment {
    /// The same radiance from everywhere.
    pub fn uniform(radiance: LinearRgb) -> Self {
        Self { image: None, scale: radiance, rotation: kajo_units::Radians(0.0) }
    }

    /// Radiance that arrives from the unit vector `direction` (pointing away from the viewer), W/(m² sr).
    pub fn radiance(&self, direction: Vec3) -> LinearRgb {
        match &self.image {
            None => self.scale,
            Some(image) => LinearRgb(LAT_LONG.lookup(image, self.uv(direction)).truncate()) * self.scale,
        }
    }

    /// Image coordinates, both in [0, 1], of a unit vector in the world.
    ///
    ///     u = ½ + atan2(d.x, −d.z) / 2π,   v = acos(d.y) / π,   with d = R_y(−rotation) · direction
    ///
    /// The arc cosine is taken as atan2(√(d.x² + d.z²), d.y), which keeps its digits near the poles.
    pub fn uv(&self, direction: Vec3) -> Vec2 {
        let d = rotate_about_y(direction, -self.rotation.0);
        Vec2::new(0.5 + d.x.atan2(-d.z) / TAU, d.x.hypot(d.z).atan2(d.y) / PI)
    }

    /// The unit vector in the world of image coordinates; the inverse of [`Environment::uv`].
    pub fn direction(&self, uv: Vec2) -> Vec3 {
        let ((sin_phi, cos_phi), (sin_theta, cos_theta)) = (((uv.x - 0.5) * TAU).sin_cos(), (uv.y * PI).sin_cos());
        rotate_about_y(Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi), self.rotation.0)
    }

    /// Converts a density over (u, v) into one over solid angle: p_ω = p_uv / (2π² sin θ), θ = π v.
    ///
    /// Zero at the poles, where a point of the sphere is a line of the image.
    pub fn pdf_from_uv(&self, pdf_uv: f32, uv: Vec2) -> f32 {
        let sin_theta = (uv.y * PI).sin();
        if sin_theta > 0.0 { pdf_uv / (2.0 * PI * PI * sin_theta) } else { 0.0 }
    }

    /// Weight of each texel of the image for importance sampling; `None` for a uniform environment.
    ///
    /// The weight is ∫∫ Y(u, v) sin(π v) π dv over the texel, with the luminance Y of the *filtered* image averaged over the texel:
    /// bilinear filtering carries light into dark texels, which must not get weight 0 (the kernel is 1/8, 6/8, 1/8 along each axis).
    /// `sin` is integrated exactly over the row. `height × width`, row-major, all weights ≥ 0, unit W/(m² sr) × rad.
    pub fn importance(&self) -> Option<Image<f32>> {
        let image = self.image.as_ref()?;
        let luminance = Image::from_fn((image.width, image.height).into(), |x, y| {
            let value = LinearRgb(image.texel(x, y, ColorSpace::Linear).truncate()) * self.scale;
            value.luminance().max(0.0)
        });
        let (width, height) = (image.width, image.height);
        let along_u = |x: u32, y: u32| {
            let (left, right) = (if x == 0 { width - 1 } else { x - 1 }, if x + 1 == width { 0 } else { x + 1 });
            0.75 * luminance.get(x, y) + 0.125 * (luminance.get(left, y) + luminance.get(right, y))
        };
        Some(Image::from_fn((width, height).into(), |x, y| {
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            let mean = 0.75 * along_u(x, y) + 0.125 * (along_u(x, above) + along_u(x, below));
            let theta = |row: u32| f64::from(row) / f64::from(height) * std::f64::consts::PI;
            mean * (theta(y).cos() - theta(y + 1).cos()) as f32
        }))
    }
}

/// Rotates counter-clockwise about +y, seen from above.
fn rotate_about_y(v: Vec3, angle: f32) -> Vec3 {
    if angle == 0.0 {
        return v;
    }
    let (sin, cos) = angle.sin_cos();
    Vec3::new(v.x * cos + v.z * sin, v.y, -v.x * sin + v.z * cos)
}
