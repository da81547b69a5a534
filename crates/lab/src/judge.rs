//! A role's reference: what its techniques are compared with.

use glam::UVec2;
use kajo_image::Image;
use kajo_image_metrics::{View, rmse_floor};
use kajo_units::LinearRgb;

/// The images that judge one role on one scene. A visibility has one for each light.
#[derive(Clone, Debug)]
pub struct Judge {
    /// In the order of the technique's outputs.
    pub parts: Vec<Part>,
    /// Pixels that show a surface, where the role says nothing about the others.
    pub mask: Option<Image<bool>>,
    /// What the pixels are.
    pub kind: Kind,
    /// The picture in which the role's output is used.
    pub composed: Option<Composed>,
}

/// The reference of a composed picture.
#[derive(Clone, Debug)]
pub struct Composed {
    /// The picture, with all the light there is.
    pub part: Part,
    /// The part of its light that the real-time renderer simulates at all: a technique can be blamed for the difference to this one
    /// only. `None` when it cannot be told apart.
    pub simulated: Option<Image<LinearRgb>>,
}

/// What the pixels of a role are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Fractions in [0, 1] with borders between shadow and light.
    Visibility,
    /// Fractions in [0, 1].
    Fraction,
    /// Radiance or irradiance.
    Light,
}

/// One reference image.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its name in the path tracer: `visibility.Key`, `diffuse-indirect`, `direct`, ….
    pub name: String,
    /// Pixels.
    pub image: Image<LinearRgb>,
    /// Variance of their means; `None` when it is not known.
    pub variance: Option<Image<LinearRgb>>,
    /// Role direct visibility: false where a border of the shadow runs between the centres of pixels, unseen by `image`; such pixels are neither on a border nor
    /// away from it. `None` where nobody looked.
    pub settled: Option<Image<bool>>,
}

/// What a technique gave for one seed.
#[derive(Clone, Debug)]
pub struct Take {
    /// In the order of [`Judge::parts`].
    pub parts: Vec<Image<LinearRgb>>,
    /// See [`Judge::composed`].
    pub composed: Option<Image<LinearRgb>>,
}

impl Judge {
    /// Size of each part, px.
    pub fn size(&self) -> UVec2 {
        self.parts[0].image.size()
    }

    /// Parts below each other, pixels without a surface black: one image to compare.
    pub fn stacked(&self) -> Image<LinearRgb> {
        self.stack(self.parts.iter().map(|p| &p.image))
    }

    /// Variance of [`Self::stacked`].
    pub fn stacked_variance(&self) -> Option<Image<LinearRgb>> {
        let variances: Option<Vec<_>> = self.parts.iter().map(|p| p.variance.as_ref()).collect();
        variances.map(|v| self.stack(v.into_iter()))
    }

    /// A take as one image, like [`Self::stacked`].
    pub fn stacked_take(&self, take: &Take) -> Image<LinearRgb> {
        self.stack(take.parts.iter())
    }

    fn stack<'a>(&self, parts: impl ExactSizeIterator<Item = &'a Image<LinearRgb>>) -> Image<LinearRgb> {
        let size = UVec2::new(self.size().x, self.size().y * parts.len() as u32);
        Image::from_pixels(size, parts.flat_map(|part| self.masked(part).pixels().to_vec()).collect())
    }

    /// Pixels without a surface black.
    pub fn masked(&self, image: &Image<LinearRgb>) -> Image<LinearRgb> {
        let Some(mask) = &self.mask else { return image.clone() };
        let pixels = image.pixels().iter().zip(mask.pixels());
        Image::from_pixels(image.size(), pixels.map(|(p, on)| if *on { *p } else { LinearRgb::BLACK }).collect())
    }

    /// How the images are shown, and seen by PSNR, SSIM and FLIP.
    pub fn view(&self) -> View {
        if self.kind == Kind::Light { View::fit(&self.parts[0].image) } else { View::FRACTION }
    }

    /// RMSE that a perfect image has.
    pub fn floor(&self) -> f64 {
        self.stacked_variance().map_or(0.0, |v| rmse_floor(&v))
    }

    /// Floor divided by the mean; `None` for a black reference.
    pub fn relative_standard_error(&self) -> Option<f64> {
        let image = self.stacked();
        let mean = image.pixels().iter().map(|p| f64::from(p.luminance())).sum::<f64>() / image.pixels().len() as f64;
        (mean > 0.0).then(|| self.floor() / mean)
    }

    /// Names of the parts that are black wherever there is a surface.
    pub fn unseen_parts(&self) -> impl Iterator<Item = &str> {
        let black = |part: &&Part| self.masked(&part.image).pixels().iter().all(|p| *p == LinearRgb::BLACK);
        self.parts.iter().filter(black).map(|part| part.name.as_str())
    }

    /// The image of each part.
    pub fn images(&self) -> Vec<Image<LinearRgb>> {
        self.parts.iter().map(|p| p.image.clone()).collect()
    }

    /// One picture of all parts: their mean.
    pub fn picture(&self, parts: &[Image<LinearRgb>]) -> Image<LinearRgb> {
        let scale = 1.0 / parts.len() as f32;
        let sum = |i: usize| parts.iter().map(|p| p.pixels()[i]).sum::<LinearRgb>() * scale;
        self.masked(&Image::from_pixels(self.size(), (0..self.size().element_product() as usize).map(sum).collect()))
    }
}
