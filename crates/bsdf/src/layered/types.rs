//! What evaluating and sampling the material return.

use glam::Vec3;
use kajo_units::LinearRgb;
use std::ops::{Add, AddAssign, BitOr, Mul};

/// A value of the BSDF, split as the light-path roles split it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LobeValues {
    /// Diffuse reflection.
    pub diffuse: LinearRgb,
    /// Everything else: specular reflection, coat, sheen, transmission.
    pub specular: LinearRgb,
}

impl LobeValues {
    /// No light.
    pub const ZERO: Self = Self { diffuse: LinearRgb::BLACK, specular: LinearRgb::BLACK };

    /// Diffuse and specular together.
    #[inline]
    pub fn total(self) -> LinearRgb {
        self.diffuse + self.specular
    }

    #[inline]
    pub(super) fn new(diffuse: Vec3, specular: Vec3) -> Self {
        Self { diffuse: LinearRgb(diffuse), specular: LinearRgb(specular) }
    }
}

impl Add for LobeValues {
    type Output = Self;
    #[inline]
    fn add(self, rhs: Self) -> Self {
        Self { diffuse: self.diffuse + rhs.diffuse, specular: self.specular + rhs.specular }
    }
}

impl AddAssign for LobeValues {
    #[inline]
    fn add_assign(&mut self, rhs: Self) {
        *self = *self + rhs;
    }
}

impl Mul<f32> for LobeValues {
    type Output = Self;
    #[inline]
    fn mul(self, rhs: f32) -> Self {
        Self { diffuse: self.diffuse * rhs, specular: self.specular * rhs }
    }
}

/// What kind of scattering a sample is: a set of flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Lobe(u8);

impl Lobe {
    /// The diffuse part of the reflection.
    pub const DIFFUSE: Self = Self(1);
    /// Specular reflection, coat, sheen or transmission.
    pub const SPECULAR: Self = Self(2);
    /// To the side of `wo`.
    pub const REFLECT: Self = Self(4);
    /// To the other side.
    pub const TRANSMIT: Self = Self(8);
    /// A single direction: `f_cos` and `pdf` do not see it, and light sampling cannot find it.
    pub const DELTA: Self = Self(16);

    /// True when every flag of `other` is set.
    #[inline]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// True for a perfect mirror or a smooth refraction.
    #[inline]
    pub const fn is_delta(self) -> bool {
        self.contains(Self::DELTA)
    }
}

impl BitOr for Lobe {
    type Output = Self;
    fn bitor(self, rhs: Self) -> Self {
        Self(self.0 | rhs.0)
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Towards the light, unit length, local frame.
    pub wi: Vec3,
    /// f_cos / pdf with the pdf of the mixture of all lobes; for a delta lobe its reflectance over the chance to pick it.
    pub weight: LobeValues,
    /// Density of `wi` per solid angle, of the mixture. For a delta lobe the discrete chance to pick it.
    pub pdf: f32,
    /// The lobe that made the sample.
    pub lobe: Lobe,
    /// (n_i / n_o)²: what the radiance that `weight` carries was divided by when it entered another medium; 1 for reflection.
    /// Russian roulette multiplies the throughput by the product of these to judge it free of that scale.
    pub eta2: f32,
}
