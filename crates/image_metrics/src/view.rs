//! How numbers become a picture for the metrics that model a viewer: PSNR, SSIM, FLIP.

use kajo_image::Image;
use kajo_units::{LinearRgb, Srgb8, srgb_from_linear};

/// What the channel values of the picture are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transfer {
    /// sRGB-encoded: pictures made of light.
    #[default]
    Srgb,
    /// As they are: fractions, such as visibility.
    Identity,
}

/// The picture clamp(exposure · v, 0, 1), encoded by `transfer`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct View {
    /// Multiplies linear light before the clamp.
    pub exposure: f32,
    /// Encoding of the result.
    pub transfer: Transfer,
}

impl Default for View {
    /// Exposure 1, sRGB: the content of an 8-bit file as it is.
    fn default() -> Self {
        Self { exposure: 1.0, transfer: Transfer::Srgb }
    }
}

impl View {
    /// For fractions in [0, 1].
    pub const FRACTION: Self = Self { exposure: 1.0, transfer: Transfer::Identity };

    /// Shows 99 % of the reference's pixels below white: exposure = 0.9 / (99th percentile of the largest channel); 1 for a black one.
    pub fn fit(reference: &Image<LinearRgb>) -> Self {
        let mut values: Vec<f32> = reference.pixels().iter().map(|p| p.max_component()).filter(|v| v.is_finite()).collect();
        let rank = (values.len() * 99 / 100).min(values.len().saturating_sub(1));
        let white = if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(rank, f32::total_cmp).1 };
        Self { exposure: if white > 0.0 { 0.9 / white } else { 1.0 }, transfer: Transfer::Srgb }
    }

    /// Channel values of the picture, in [0, 1].
    pub fn picture(&self, image: &Image<LinearRgb>) -> Image<LinearRgb> {
        image.map(|p| {
            let v = (p.0 * self.exposure).clamp(glam::Vec3::ZERO, glam::Vec3::ONE);
            LinearRgb(match self.transfer {
                Transfer::Srgb => v.to_array().map(srgb_from_linear).into(),
                Transfer::Identity => v,
            })
        })
    }

    /// Light in [0, 1] that a display with this exposure emits.
    pub fn light(&self, image: &Image<LinearRgb>) -> Image<LinearRgb> {
        image.map(|p| LinearRgb((p.0 * self.exposure).clamp(glam::Vec3::ZERO, glam::Vec3::ONE)))
    }

    /// The picture in 8 bits, always sRGB-encoded, so that fractions are shown as amounts of light.
    pub fn to_srgb8(&self, image: &Image<LinearRgb>) -> Image<Srgb8> {
        image.map(|p| (*p * self.exposure).to_srgb8())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn eight_bit_content_is_seen_as_it_is() {
        let image = Image::from_fn(UVec2::new(256, 1), |x, _| Srgb8([x as u8; 3]));
        let picture = View::default().picture(&image.map(|p| p.to_linear()));
        for (v, p) in picture.pixels().iter().enumerate() {
            assert!((p[1] - v as f32 / 255.0).abs() < 1e-6);
        }
        assert_eq!(View::default().to_srgb8(&image.map(|p| p.to_linear())), image);
    }

    #[test]
    fn fit_ignores_one_percent_of_fireflies_and_survives_black() {
        let image = Image::from_fn(UVec2::new(1000, 1), |x, _| LinearRgb::splat(if x < 5 { 1e9 } else { 4.5 }));
        assert!((View::fit(&image).exposure - 0.2).abs() < 1e-6);
        assert_eq!(View::fit(&image.map(|_| LinearRgb::BLACK)), View::default());
    }
}
