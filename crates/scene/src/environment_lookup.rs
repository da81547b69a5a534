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
        match self.image {
            None => self.scale,
            Some(_) => self.radiance_at(self.uv(direction)),
        }
    }

    /// [`Environment::radiance`] by [image coordinates](Environment::uv).
    pub fn radiance_at(&self, uv: Vec2) -> LinearRgb {
        match &self.image {
            None => self.scale,
            Some(image) => LinearRgb(LAT_LONG.lookup(image, uv).truncate()) * self.scale,
        }
    }

    /// Image coordinates, both in [0, 1], of a unit vector in the world.
    ///
    /// ```text
    /// u = ½ + atan2(d.x, −d.z) / 2π,   v = acos(d.y) / π,   with d = R_y(−rotation) · direction
    /// ```
    ///
    /// The arc cosine is taken as atan2(√(d.x² + d.z²), d.y), which keeps its digits near the poles.
    pub fn uv(&self, direction: Vec3) -> Vec2 {
        let d = rotate_about_y(direction, -self.rotation.0);
        Vec2::new(0.5 + d.x.atan2(-d.z) / TAU, d.x.hypot(d.z).atan2(d.y) / PI)
    }

    /// The unit vector in the world of image coordinates; the inverse of [`Environment::uv`].
    pub fn direction(&self, uv: Vec2) -> Vec3 {
        rotate_about_y(Self::image_direction(uv), self.rotation.0)
    }

    /// The same of an environment that is not turned.
    pub fn image_direction(uv: Vec2) -> Vec3 {
        let ((sin_phi, cos_phi), (sin_theta, cos_theta)) = (((uv.x - 0.5) * TAU).sin_cos(), (uv.y * PI).sin_cos());
        Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
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
        let (width, height) = (image.width as usize, image.height);
        let along_u = |y: u32| -> Vec<f32> {
            let texel = |x| LinearRgb(image.texel(x, y, ColorSpace::Linear).truncate()) * self.scale;
            let luminance: Vec<f32> = (0..image.width).map(|x| texel(x).luminance().max(0.0)).collect();
            let neighbours =
                |x: usize| luminance[if x == 0 { width - 1 } else { x - 1 }] + luminance[if x + 1 == width { 0 } else { x + 1 }];
            (0..width).map(|x| 0.75 * luminance[x] + 0.125 * neighbours(x)).collect()
        };
        // Three rows at a time: a whole image between the two passes would be a quarter of the environment's memory.
        let mut rows = [Vec::new(), along_u(0), along_u(0)];
        let mut weights = Vec::with_capacity(width * height as usize);
        for y in 0..height {
            rows.rotate_left(1);
            rows[2] = if y + 1 < height { along_u(y + 1) } else { rows[1].clone() };
            let theta = |row: u32| f64::from(row) / f64::from(height) * std::f64::consts::PI;
            let row_measure = (theta(y).cos() - theta(y + 1).cos()) as f32;
            let [above, row, below] = &rows;
            weights.extend((0..width).map(|x| (0.75 * row[x] + 0.125 * (above[x] + below[x])) * row_measure));
        }
        Some(Image::from_pixels((image.width, height).into(), weights))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Texels, TextureImage};
    use kajo_units::Radians;
    use std::sync::Arc;

    fn environment(width: u32, height: u32, texel: impl Fn(u32, u32) -> [f32; 3]) -> Environment {
        let texels = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| Vec3::from_array(texel(x, y)).extend(1.0).to_array())
            .collect();
        let image = TextureImage { name: String::new(), width, height, texels: Texels::Rgba32F(texels) };
        Environment { image: Some(Arc::new(image)), scale: LinearRgb::WHITE, rotation: Radians(0.0) }
    }

    #[test]
    fn axes_map_to_their_places_in_the_image() {
        let environment = environment(1, 1, |_, _| [1.0; 3]);
        for (direction, u, v) in [(Vec3::NEG_Z, 0.5, 0.5), (Vec3::X, 0.75, 0.5), (Vec3::NEG_X, 0.25, 0.5), (Vec3::Z, 1.0, 0.5)] {
            let uv = environment.uv(direction);
            assert!((uv - Vec2::new(u, v)).length() < 1e-6 || (direction == Vec3::Z && uv.x < 1e-6), "{direction}: {uv}");
        }
        assert_eq!(environment.uv(Vec3::Y).y, 0.0);
        assert_eq!(environment.uv(Vec3::NEG_Y).y, 1.0);
    }

    #[test]
    fn rotation_is_counter_clockwise_seen_from_above() {
        let mut environment = environment(1, 1, |_, _| [1.0; 3]);
        environment.rotation = Radians::from_degrees(90.0);
        // What stood at the centre, −z, now stands at −x: a quarter turn to the left of someone who looks along −z.
        assert!((environment.uv(Vec3::NEG_X) - Vec2::splat(0.5)).length() < 1e-6);
    }

    #[test]
    fn direction_and_uv_are_inverse() {
        let mut environment = environment(1, 1, |_, _| [1.0; 3]);
        environment.rotation = Radians(2.3);
        for i in 1..40 {
            for j in 1..20 {
                let uv = Vec2::new(i as f32 / 40.0, j as f32 / 20.0);
                let direction = environment.direction(uv);
                assert!((direction.length() - 1.0).abs() < 1e-6);
                assert!((environment.uv(direction) - uv).length() < 1e-5, "{uv}");
            }
        }
    }

    #[test]
    fn texel_centres_are_exact_and_columns_wrap() {
        let environment = environment(8, 4, |x, y| [x as f32, y as f32, 1.0]);
        for y in 0..4 {
            for x in 0..8 {
                let uv = Vec2::new((x as f32 + 0.5) / 8.0, (y as f32 + 0.5) / 4.0);
                let value = environment.radiance(environment.direction(uv)).0;
                assert!((value - Vec3::new(x as f32, y as f32, 1.0)).length() < 1e-4, "{x} {y}: {value}");
            }
        }
        // The seam lies half-way between column 7 and column 0.
        let seam = environment.radiance(Vec3::Z).0.x;
        assert!((seam - 3.5).abs() < 1e-3, "{seam}");
    }

    /// ∫ over the sphere of a uniform environment's weight is 4π / 2π: the grid carries sin θ dθ, and the columns share 2π.
    #[test]
    fn importance_of_a_white_image_is_solid_angle() {
        let grid = environment(16, 8, |_, _| [1.0; 3]).importance().unwrap();
        let sum: f32 = grid.pixels().iter().sum();
        assert!((sum * TAU / 16.0 - 4.0 * PI).abs() < 1e-4, "{sum}");
        // Polar rows are small: 1 − cos(π/8) against cos(3π/8) at the equator.
        let ratio = grid.get(0, 0) / grid.get(0, 4);
        assert!((ratio - (1.0 - (PI / 8.0).cos()) / (3.0 * PI / 8.0).cos()).abs() < 1e-5, "{ratio}");
    }

    #[test]
    fn importance_is_positive_wherever_filtering_carries_light() {
        let environment = environment(8, 8, |x, y| if (x, y) == (0, 3) { [5.0; 3] } else { [0.0; 3] });
        let grid = environment.importance().unwrap();
        for i in 0..64 {
            for j in 0..64 {
                let uv = Vec2::new((i as f32 + 0.5) / 64.0, (j as f32 + 0.5) / 64.0);
                let lit = environment.radiance(environment.direction(uv)).luminance() > 1e-6;
                assert!(!lit || *grid.get(i / 8, j / 8) > 0.0, "{uv} is lit and would never be sampled");
            }
        }
        assert_eq!(*grid.get(4, 3), 0.0);
    }

    /// The weight of a texel is the integral of the filtered luminance over it, found here by a fine sum.
    #[test]
    fn importance_is_the_integral_of_the_filtered_image() {
        let environment = environment(6, 5, |x, y| [((x * 7 + y * 3) % 5) as f32; 3]);
        let grid = environment.importance().unwrap();
        const N: u32 = 24;
        for y in 1..4 {
            for x in 0..6 {
                let mut sum = 0.0;
                for j in 0..N {
                    for i in 0..N {
                        let uv = Vec2::new((x * N + i) as f32 + 0.5, (y * N + j) as f32 + 0.5) / Vec2::new((6 * N) as f32, (5 * N) as f32);
                        sum += environment.radiance(environment.direction(uv)).luminance();
                    }
                }
                let theta = |row: u32| row as f32 / 5.0 * PI;
                let expected = sum / (N * N) as f32 * (theta(y).cos() - theta(y + 1).cos());
                assert!((grid.get(x, y) - expected).abs() < 2e-3 * expected.max(0.1), "({x}, {y}): {} {expected}", grid.get(x, y));
            }
        }
    }

    #[test]
    fn pdf_conversion_integrates_to_one_over_the_sphere() {
        let environment = environment(1, 1, |_, _| [1.0; 3]);
        // p_uv = 1: ∫ p_ω dω = ∫∫ 1/(2π² sin θ) sin θ dθ dφ = 1.
        let (rows, mut sum) = (2000, 0.0f64);
        for row in 0..rows {
            let v = (row as f32 + 0.5) / rows as f32;
            let solid_angle = TAU * (v * PI).sin() * PI / rows as f32;
            sum += f64::from(environment.pdf_from_uv(1.0, Vec2::new(0.3, v)) * solid_angle);
        }
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        assert_eq!(environment.pdf_from_uv(1.0, Vec2::new(0.3, 0.0)), 0.0);
    }

    #[test]
    fn uniform_environment_has_no_grid() {
        let environment = Environment::uniform(LinearRgb::splat(2.0));
        assert!(environment.importance().is_none());
        assert_eq!(environment.radiance(Vec3::X), LinearRgb::splat(2.0));
    }
}
