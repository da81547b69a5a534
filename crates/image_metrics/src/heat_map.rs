//! Errors as colour.

use kajo_image::Image;
use kajo_units::Srgb8;

/// A perceptually even scale from dark (no error) to light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// Black, purple, orange, pale yellow: the scale FLIP maps are published in.
    #[default]
    Magma,
    /// Purple, teal, yellow: also even for the colour blind.
    Viridis,
}

impl Palette {
    /// The colour of `t` in [0, 1]; values outside are clamped, NaN is magenta, which no palette holds.
    pub fn color(self, t: f32) -> Srgb8 {
        if t.is_nan() {
            return Srgb8([255, 0, 255]);
        }
        let gradient = match self {
            Self::Magma => colorous::MAGMA,
            Self::Viridis => colorous::VIRIDIS,
        };
        Srgb8(gradient.eval_continuous(f64::from(t.clamp(0.0, 1.0))).as_array())
    }
}

/// `error / full_scale` as colour.
pub fn heat_map(error: &Image<f32>, full_scale: f32, palette: Palette) -> Image<Srgb8> {
    error.map(|&e| palette.color(e / full_scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn palettes_rise_in_lightness_and_have_the_published_ends() {
        for palette in [Palette::Magma, Palette::Viridis] {
            let lightness: Vec<f32> = (0..=255).map(|i| palette.color(i as f32 / 255.0).to_linear().luminance()).collect();
            // One 8-bit step of a channel is the tables' rounding.
            assert!(lightness.windows(2).all(|w| w[1] >= w[0] - 2e-3), "{palette:?}");
        }
        assert_eq!(Palette::Viridis.color(0.0), Srgb8([68, 1, 84]));
        assert_eq!(Palette::Viridis.color(1.0), Srgb8([253, 231, 37]));
        assert_eq!(Palette::Magma.color(0.0), Srgb8([0, 0, 4]));
        assert_eq!(Palette::Magma.color(1.0), Srgb8([252, 253, 191]));
    }

    #[test]
    fn scale_clamps_and_nan_stands_out() {
        let map = heat_map(&Image::from_pixels(UVec2::new(3, 1), vec![0.0, 9.0, f32::NAN]), 2.0, Palette::Magma);
        assert_eq!(map.pixels(), [Srgb8([0, 0, 4]), Srgb8([252, 253, 191]), Srgb8([255, 0, 255])]);
    }
}
