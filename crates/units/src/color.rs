//! Colour: linear RGB with the BT.709 primaries (the working space), and its 8-bit sRGB encoding.

use glam::Vec3;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

/// Linear-light RGB, BT.709 primaries, white D65. Holds radiance, reflectance or throughput; the context gives the unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable, serde::Serialize, serde::Deserialize)]
#[repr(transparent)]
#[serde(transparent)]
pub struct LinearRgb(pub Vec3);

/// Display-referred sRGB, 8 bits a channel (IEC 61966-2-1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Srgb8(pub [u8; 3]);

impl LinearRgb {
    /// No light.
    pub const BLACK: Self = Self(Vec3::ZERO);
    /// One in every channel.
    pub const WHITE: Self = Self(Vec3::ONE);

    /// From the three channels.
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }

    /// The same value in every channel.
    pub const fn splat(v: f32) -> Self {
        Self(Vec3::splat(v))
    }

    /// Share of each channel in the luminance.    ITU-R BT.709-6, item 3.2
    pub const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

    /// Relative luminance Y = 0.2126 R + 0.7152 G + 0.0722 B, the weights of [`LinearRgb::LUMINANCE`].
    pub fn luminance(self) -> f32 {
        self.0.dot(Vec3::from_array(Self::LUMINANCE))
    }

    /// Largest channel.
    pub fn max_component(self) -> f32 {
        self.0.max_element()
    }

    /// True when every channel is exactly zero.
    pub fn is_black(self) -> bool {
        self.0 == Vec3::ZERO
    }

    /// True when no channel is NaN or infinite.
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Linear interpolation, `t` in [0, 1].
    pub fn lerp(self, other: Self, t: f32) -> Self {
        Self(self.0.lerp(other.0, t))
    }

    /// Clamps to [0, 1], encodes and rounds to 8 bits.
    pub fn to_srgb8(self) -> Srgb8 {
        Srgb8(self.0.to_array().map(|c| (srgb_from_linear(c.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8))
    }
}

impl Srgb8 {
    /// Decodes to linear light.
    pub fn to_linear(self) -> LinearRgb {
        LinearRgb(Vec3::from_array(self.0.map(|c| linear_from_srgb(f32::from(c) / 255.0))))
    }
}

/// The sRGB encoding of one channel, `linear` in [0, 1].    IEC 61966-2-1, 5.2
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb_from_linear`], `encoded` in [0, 1].
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

macro_rules! binary {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for LinearRgb {
            type Output = Self;
            #[inline]
            fn $method(self, rhs: Self) -> Self {
                Self(self.0 $op rhs.0)
            }
        }
    };
}
binary!(Add, add, +);
binary!(Sub, sub, -);
binary!(Mul, mul, *);
binary!(Div, div, /);

impl Mul<f32> for LinearRgb {
    type Output = Self;
    #[inline]
    fn mul(self, rhs: f32) -> Self {
        Self(self.0 * rhs)
    }
}

impl Div<f32> for LinearRgb {
    type Output = Self;
    #[inline]
    fn div(self, rhs: f32) -> Self {
        Self(self.0 / rhs)
    }
}

impl AddAssign for LinearRgb {
    #[inline]
    fn add_assign(&mut self, rhs: Self) {
        self.0 += rhs.0;
    }
}

impl MulAssign for LinearRgb {
    #[inline]
    fn mul_assign(&mut self, rhs: Self) {
        self.0 *= rhs.0;
    }
}

impl MulAssign<f32> for LinearRgb {
    #[inline]
    fn mul_assign(&mut self, rhs: f32) {
        self.0 *= rhs;
    }
}

impl Sum for LinearRgb {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::BLACK, Add::add)
    }
}

impl Index<usize> for LinearRgb {
    type Output = f32;
    fn index(&self, channel: usize) -> &f32 {
        &self.0[channel]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_round_trips_all_256_values() {
        for v in 0..=255u8 {
            assert_eq!(Srgb8([v; 3]).to_linear().to_srgb8(), Srgb8([v; 3]));
        }
    }

    /// Row D-09.
    #[test]
    fn luminance_of_white_is_one_and_of_green_0_7152() {
        assert!((LinearRgb::WHITE.luminance() - 1.0).abs() < 1e-6);
        assert_eq!(LinearRgb::new(0.0, 1.0, 0.0).luminance(), 0.7152);
    }
}
