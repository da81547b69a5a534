//! Real spherical harmonics up to the second band: functions of the direction in nine numbers.
//!
//! Irradiance is radiance convolved with a cosine, which leaves little beyond the second band: the nine coefficients of the radiance around a point
//! give the irradiance there for every normal. The shaders' twin is `shader_lib::spherical_harmonics`.

use glam::Vec3;
use std::f32::consts::PI;

/// Coefficients of bands 0, 1 and 2.
pub const SH_COUNT: usize = 9;

/// Y_lm(d), in the order (0,0), (1,−1), (1,0), (1,1), (2,−2), (2,−1), (2,0), (2,1), (2,2).    \[Ramamoorthi01] eq. 3
///
/// `d` is a unit vector. Orthonormal: ∫ Y_i Y_j dω = δ_ij.
pub fn sh_basis(d: Vec3) -> [f32; SH_COUNT] {
    // √(1/4π), √(3/4π), √(15/4π), √(5/16π), √(15/16π).
    [
        0.282_094_8,
        0.488_602_5 * d.y,
        0.488_602_5 * d.z,
        0.488_602_5 * d.x,
        1.092_548_4 * d.x * d.y,
        1.092_548_4 * d.y * d.z,
        0.315_391_57 * (3.0 * d.z * d.z - 1.0),
        1.092_548_4 * d.z * d.x,
        0.546_274_2 * (d.x * d.x - d.y * d.y),
    ]
}

/// Y_lm(n) times the factor of its band in the convolution with max(cos θ, 0), which is π, 2π/3, π/4.    \[Ramamoorthi01] eq. 7, 8
///
/// The irradiance of a surface with normal `n` (unit) is Σ L_i sh_cosine_basis(n)_i.
pub fn sh_cosine_basis(n: Vec3) -> [f32; SH_COUNT] {
    let mut y = sh_basis(n);
    y[0] *= PI;
    y[1..4].iter_mut().for_each(|y| *y *= 2.0 * PI / 3.0);
    y[4..].iter_mut().for_each(|y| *y *= PI / 4.0);
    y
}

/// Radiance around a point, W/(m² sr), as coefficients of [`sh_basis`], each a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShRadiance(pub [Vec3; SH_COUNT]);

impl ShRadiance {
    /// Adds radiance that arrives from `direction` (unit), times the solid angle it stands for: the coefficients are ∫ L Y dω.
    pub fn add(&mut self, direction: Vec3, radiance_times_solid_angle: Vec3) {
        for (coefficient, basis) in self.0.iter_mut().zip(sh_basis(direction)) {
            *coefficient += radiance_times_solid_angle * basis;
        }
    }

    /// The radiance from `direction` (unit) that nine coefficients can tell of: Σ L_i Y_i.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.0.iter().zip(sh_basis(direction)).map(|(coefficient, basis)| *coefficient * basis).sum()
    }

    /// Irradiance of a surface with this normal (unit), W/m²: Σ A_i L_i Y_i.    \[Ramamoorthi01] eq. 7
    ///
    /// One distant light differs from its clamped cosine by at most 3/32 of the peak; nothing keeps the sum from being negative there.
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        self.0.iter().zip(sh_cosine_basis(normal)).map(|(coefficient, basis)| *coefficient * basis).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::uniform_sphere;
    use crate::{Rng, hammersley_2d};

    /// Directions and the solid angle each stands for, sr.
    fn sphere(count: u32) -> impl Iterator<Item = (Vec3, f32)> {
        (0..count).map(move |i| (uniform_sphere(hammersley_2d(i, count)), 4.0 * PI / count as f32))
    }

    /// Largest |∫ Y_i Y_j dω − δ_ij|.
    fn deviation(basis: impl Fn(Vec3) -> [f32; SH_COUNT]) -> f64 {
        let mut products = [[0.0f64; SH_COUNT]; SH_COUNT];
        for (direction, weight) in sphere(16_384) {
            let y = basis(direction);
            for i in 0..SH_COUNT {
                for j in 0..SH_COUNT {
                    products[i][j] += f64::from(y[i] * y[j] * weight);
                }
            }
        }
        let off = |i: usize, j: usize| (products[i][j] - if i == j { 1.0 } else { 0.0 }).abs();
        (0..SH_COUNT * SH_COUNT).map(|k| off(k / SH_COUNT, k % SH_COUNT)).fold(0.0, f64::max)
    }

    #[test]
    fn the_basis_is_orthonormal() {
        assert!(deviation(sh_basis) < 2e-3, "{}", deviation(sh_basis));
        let swapped = |d: Vec3| {
            let mut y = sh_basis(d);
            y[6] = y[8];
            y
        };
        assert!(deviation(swapped) > 0.5, "planted fault: the same function twice");
    }

    /// Row R-11: a constant environment comes back, and its irradiance is π L.
    #[test]
    fn a_constant_environment_is_reconstructed() {
        let radiance = Vec3::new(1.0, 0.5, 2.0);
        let mut sh = ShRadiance::default();
        sphere(1024).for_each(|(direction, weight)| sh.add(direction, radiance * weight));
        let mut rng = Rng::new(3);
        for _ in 0..1000 {
            let direction = uniform_sphere(rng.next_2d());
            let errors = [sh.radiance(direction) / radiance - 1.0, sh.irradiance(direction) / (PI * radiance) - 1.0];
            assert!(errors.iter().all(|error| error.abs().max_element() < 0.01), "{direction}: {errors:?}");
        }
    }

    /// Row R-11: E/peak − max(cos θ, 0) is greatest at right angles to the light, 3/32.
    #[test]
    fn one_distant_light_is_the_clamped_cosine_up_to_three_thirty_seconds() {
        let mut rng = Rng::new(4);
        let mut greatest = 0.0f32;
        for _ in 0..64 {
            let light = uniform_sphere(rng.next_2d());
            let mut sh = ShRadiance::default();
            sh.add(light, Vec3::ONE);
            for _ in 0..512 {
                let normal = uniform_sphere(rng.next_2d());
                greatest = greatest.max((sh.irradiance(normal).x - light.dot(normal).max(0.0)).abs());
            }
        }
        assert!((0.0900..=0.09375 + 1e-3).contains(&greatest), "{greatest}");
    }

    /// The closed form of the row above: E = 1/4 + cos θ/2 + 5/64 (3 cos 2θ + 1).
    #[test]
    fn the_irradiance_of_one_light_is_its_closed_form() {
        let mut sh = ShRadiance::default();
        sh.add(Vec3::Z, Vec3::ONE);
        for i in 0..=180 {
            let theta = (i as f32).to_radians();
            let expected = 0.25 + 0.5 * theta.cos() + 5.0 / 64.0 * (3.0 * (2.0 * theta).cos() + 1.0);
            let got = sh.irradiance(Vec3::new(theta.sin(), 0.0, theta.cos())).x;
            assert!((got - expected).abs() < 1e-5, "{i}°: {got}, {expected}");
        }
    }
}
