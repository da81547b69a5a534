//! What a technique tells of a frame beside its output: counts, pictures of its inner workings, what it did otherwise than asked.

use kajo_image::Image;
use kajo_units::LinearRgb;

/// A count, e.g. of the polygons that it drew for one light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Statistic {
    /// What was counted.
    pub name: &'static str,
    /// Index of the light in the list of all lights, or [`Self::NO_LIGHT`].
    pub light: u32,
    /// How many.
    pub value: u64,
}

impl Statistic {
    /// In the place of a light, where all of them or none is meant; in [`DebugView`]s, too.
    pub const NO_LIGHT: u32 = u32::MAX;
}

/// A picture of the technique's inner workings. It may have another size than the frame: a shadow map has its own.
#[derive(Clone, Debug)]
pub struct DebugView {
    /// What it shows, in words for file names: `silhouettes`, `light-depth`.
    pub name: &'static str,
    /// Index of the light in the list of all lights, or [`Statistic::NO_LIGHT`].
    pub light: u32,
    /// The picture.
    pub pixels: DebugPixels,
}

/// Pixels of a [`DebugView`].
#[derive(Clone, Debug)]
pub enum DebugPixels {
    /// A quantity: depth, counts. It is shown as grey between its least and its greatest finite value.
    Scalar(Image<f32>),
    /// A picture; 1 is white.
    Color(Image<LinearRgb>),
}

impl DebugPixels {
    /// As a picture in [0, 1].
    pub fn to_color(&self) -> Image<LinearRgb> {
        match self {
            Self::Color(image) => image.clone(),
            Self::Scalar(image) => {
                let finite = image.pixels().iter().filter(|value| value.is_finite());
                let [low, high] = finite.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &v| [low.min(v), high.max(v)]);
                let scale = if high > low { 1.0 / (high - low) } else { 0.0 };
                image.map(|&v| LinearRgb::splat(if v.is_nan() { 0.0 } else { ((v.clamp(low, high)) - low) * scale }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn scalars_are_shown_from_black_to_white() {
        let image = Image::from_pixels(UVec2::new(4, 1), vec![-2.0, 2.0, f32::INFINITY, f32::NAN]);
        let shown = DebugPixels::Scalar(image).to_color();
        let grey: Vec<f32> = shown.pixels().iter().map(|p| p[0]).collect();
        assert_eq!(grey, [0.0, 1.0, 1.0, 0.0]);
        let flat = DebugPixels::Scalar(Image::from_pixels(UVec2::ONE, vec![7.0])).to_color();
        assert_eq!(flat.pixels()[0], LinearRgb::BLACK);
    }
}
