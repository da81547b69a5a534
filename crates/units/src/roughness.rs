//! Two scales of surface roughness that must not mix.

/// The artist's roughness of glTF and most tools, in [0, 1]; visually about linear.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[repr(transparent)]
pub struct PerceptualRoughness(pub f32);

/// The microfacet width α of the GGX and Beckmann distributions, in (0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[repr(transparent)]
pub struct Alpha(pub f32);

impl PerceptualRoughness {
    /// α = r².    \[Burley12] section 5.4, glTF 2.0 appendix B.2.3
    pub fn to_alpha(self) -> Alpha {
        Alpha(self.0 * self.0)
    }
}

impl Alpha {
    /// r = √α, the inverse of [`PerceptualRoughness::to_alpha`].
    pub fn to_perceptual(self) -> PerceptualRoughness {
        PerceptualRoughness(self.0.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_and_perceptual_are_inverse() {
        for i in 0..=10 {
            let r = i as f32 / 10.0;
            assert!((PerceptualRoughness(r).to_alpha().to_perceptual().0 - r).abs() < 1e-6);
        }
    }
}
