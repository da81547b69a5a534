//! Directions and colours over any [`Real`].

use super::Real;
use std::f64::consts::TAU;
use std::ops::{Add, Mul, Sub};

/// Three numbers: a direction in the local frame (x tangent, y bitangent, z normal), or a linear RGB colour.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct V3<T> {
    pub x: T,
    pub y: T,
    pub z: T,
}

/// Linear RGB: x, y, z are red, green and blue.
pub type Rgb<T> = V3<T>;

impl<T: Real> V3<T> {
    /// From its components.
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// The same number three times.
    #[inline(always)]
    pub fn splat(value: T) -> Self {
        Self { x: value, y: value, z: value }
    }

    /// Constants in this number type.
    #[inline(always)]
    pub fn of(values: [f64; 3]) -> Self {
        Self::new(T::of(values[0]), T::of(values[1]), T::of(values[2]))
    }

    /// The direction with inclination θ from the normal and azimuth φ from the tangent, rad.
    #[inline(always)]
    pub fn from_angles(theta: T, phi: T) -> Self {
        let sin = theta.sin();
        Self::new(phi.cos() * sin, phi.sin() * sin, theta.cos())
    }

    /// The inclination θ from the normal, in [0, π], and the azimuth φ from the tangent, in [0, 2π), rad. Of a multiple of the vector the same.
    #[inline(always)]
    pub fn angles(self) -> [T; 2] {
        let theta = (self.x.squared() + self.y.squared()).sqrt().atan2(self.z);
        let phi = self.y.atan2(self.x);
        [theta, T::select(phi.lt(T::zero()), phi + T::of(TAU), phi)]
    }

    #[inline(always)]
    #[allow(missing_docs)]
    pub fn dot(self, other: Self) -> T {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    #[inline(always)]
    #[allow(missing_docs)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(self.y * other.z - self.z * other.y, self.z * other.x - self.x * other.z, self.x * other.y - self.y * other.x)
    }

    /// The unit vector along it; of the zero vector something finite.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        // Below, the square underflows f32; a half vector that short has no direction.
        self * (T::one() / self.dot(self).max(T::of(1e-36)).sqrt())
    }

    /// self·factor + addend.
    #[inline(always)]
    pub fn mul_add(self, factor: T, addend: Self) -> Self {
        Self::new(self.x.mul_add(factor, addend.x), self.y.mul_add(factor, addend.y), self.z.mul_add(factor, addend.z))
    }

    /// Each component by its own function value.
    #[inline(always)]
    pub fn map(self, f: impl Fn(T) -> T) -> Self {
        Self::new(f(self.x), f(self.y), f(self.z))
    }

    /// The product component by component.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    /// The mean of the components; the weight by which a colour takes part in choices.
    #[inline(always)]
    pub fn mean(self) -> T {
        (self.x + self.y + self.z) * T::of(1.0 / 3.0)
    }

    /// The components.
    #[inline(always)]
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }
}

impl<T: Real> Add for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Real> Sub for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Real> Mul<T> for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl From<V3<f32>> for glam::Vec3 {
    fn from(v: V3<f32>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

impl From<glam::Vec3> for V3<f32> {
    fn from(v: glam::Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<glam::DVec3> for V3<f64> {
    fn from(v: glam::DVec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<V3<f64>> for glam::DVec3 {
    fn from(v: V3<f64>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row BR-1.
    #[test]
    fn angles_and_directions_are_inverse() {
        let mut rng = kajo_sampling::Rng::new(5);
        for _ in 0..10_000 {
            let (theta, phi) = (std::f64::consts::PI * rng.next_f64(), TAU * rng.next_f64());
            let direction = V3::from_angles(theta, phi);
            let [theta_back, phi_back] = direction.angles();
            assert!((theta_back - theta).abs() < 1e-14, "θ {theta}: {theta_back}");
            // Near the poles the azimuth is as uncertain as the sine is small.
            assert!((phi_back - phi).abs() * theta.sin() < 1e-14, "φ {phi}: {phi_back}");
            let back = V3::from_angles(theta_back, phi_back) - direction;
            assert!(back.dot(back).sqrt() < 1e-14, "{direction:?}");
        }
        assert_eq!(V3::new(0.0, 0.0, 1.0).angles(), [0.0, 0.0]);
        assert!((V3::new(0.0, -2.0, 0.0).angles()[1] - 1.5 * std::f64::consts::PI).abs() < 1e-14);
    }
}
