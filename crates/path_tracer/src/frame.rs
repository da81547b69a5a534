//! A developed film: images, their uncertainty, and what they cost.

use crate::aov::Combine;
use crate::blocks::BlockSums;
use crate::film::{Film, ImageSpec};
use glam::{UVec2, Vec3};
use kajo_image::Image;
use kajo_units::LinearRgb;

/// The result of a rendering.
///
/// # The stated uncertainty
/// The variance of each pixel's mean is measured between blocks of its samples. For independent samples it is unbiased; for
/// quasi-random ones it is conservative: the true error is smaller, often by much on smooth pixels. It knows noise only: what no
/// sample has found yet (a caustic from a tiny lamp) is in no interval.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Width and height, px.
    pub size: UVec2,
    /// Samples that every pixel has at least; with adaptive sampling their mean, see [`Settings::adaptive`](crate::Settings::adaptive).
    pub spp: u32,
    /// Samples of all pixels together.
    pub samples: u64,
    /// Rays traced.
    pub rays: u64,
    /// Wall-clock time, s.
    pub seconds: f64,
    /// Samples that were NaN or infinite and count as black. Anything but 0 is a defect worth reporting.
    pub invalid_samples: u64,
    /// All images, `beauty` first, then in the order of the settings.
    pub images: Vec<FrameImage>,
    /// Relative standard error of `beauty`: the root mean square of the standard errors of all pixels' luminance, divided by the
    /// mean luminance. Infinite while it is unknown (fewer than 2 samples), 0 for a black image.
    pub relative_standard_error: f32,
    /// Mean luminance of `beauty`, and the half width of its 95 % confidence interval, W/(m² sr). Pixels are taken as independent,
    /// which blue-noise sampling breaks: then it is an over-estimate.
    pub mean_luminance: (f32, f32),
    /// Factor from a pixel's standard error to the half width of its 95 % confidence interval: Student's t for the number of blocks, of the pixel
    /// that has the fewest.
    pub confidence_factor: f32,
}

/// One image of a [`Frame`].
#[derive(Clone, Debug)]
pub struct FrameImage {
    /// `beauty`, or the name of the [`Aov`](crate::Aov).
    pub name: String,
    /// Pixels.
    pub pixels: Pixels,
    /// Variance of each pixel's mean, for `beauty`, `direct` and the images of roles; infinite while unknown.
    pub variance: Option<Pixels>,
}

/// Pixels of an image by what they hold.
#[derive(Clone, Debug)]
pub enum Pixels {
    /// Radiance, irradiance or reflectance.
    Color(Image<LinearRgb>),
    /// Directions or positions; motion in x and y, px.
    Vector(Image<Vec3>),
    /// One number.
    Scalar(Image<f32>),
}

impl Pixels {
    /// Pixel as three numbers; a scalar is repeated.
    pub fn get(&self, x: u32, y: u32) -> Vec3 {
        match self {
            Self::Color(image) => image.get(x, y).0,
            Self::Vector(image) => *image.get(x, y),
            Self::Scalar(image) => Vec3::splat(*image.get(x, y)),
        }
    }

    /// The picture of it: a scalar is grey, a vector is its components.
    pub fn to_color(&self) -> Image<LinearRgb> {
        match self {
            Self::Color(image) => image.clone(),
            Self::Vector(image) => image.map(|&v| LinearRgb(v)),
            Self::Scalar(image) => image.map(|&v| LinearRgb::splat(v)),
        }
    }

    /// The layer of an EXR file; names of channels follow the kind.
    pub fn to_layer(&self, name: &str) -> kajo_image::Layer {
        match self {
            Self::Color(image) => kajo_image::Layer::color(name, image),
            Self::Vector(image) => kajo_image::Layer::vector(name, image),
            Self::Scalar(image) => kajo_image::Layer::scalar(name, image),
        }
    }
}

impl Frame {
    /// The picture, W/(m² sr).
    pub fn beauty(&self) -> &Image<LinearRgb> {
        match &self.images[0].pixels {
            Pixels::Color(image) => image,
            Pixels::Vector(_) | Pixels::Scalar(_) => unreachable!("beauty is a colour image"),
        }
    }

    /// Variance of the mean of each pixel and channel of the picture.
    pub fn beauty_variance(&self) -> &Image<LinearRgb> {
        match &self.images[0].variance {
            Some(Pixels::Color(image)) => image,
            _ => unreachable!("the variance of beauty is tracked"),
        }
    }

    /// The image of that name.
    pub fn image(&self, name: &str) -> Option<&FrameImage> {
        self.images.iter().find(|image| image.name == name)
    }
}

impl Film {
    /// Turns sums into images. Cheap compared with rendering; can be called at any time.
    pub fn develop(&self) -> Frame {
        let images: Vec<_> = self
            .layout
            .images
            .iter()
            .map(|spec| FrameImage {
                name: spec.name.clone(),
                pixels: self.pixels(spec, |pixel, channel| self.value(spec, pixel, channel)),
                variance: spec.tracked.map(|tracked| {
                    self.pixels(spec, |pixel, channel| {
                        self.blocks[pixel * self.layout.tracked + tracked + channel].variance_of_mean(self.count(pixel))
                    })
                }),
            })
            .collect();
        let mut frame = Frame {
            size: self.size,
            spp: self.spp(),
            samples: self.samples(),
            rays: self.rays,
            seconds: self.seconds,
            invalid_samples: self.invalid,
            images,
            relative_standard_error: 0.0,
            mean_luminance: (0.0, 0.0),
            confidence_factor: self.confidence_factor(),
        };
        (frame.relative_standard_error, frame.mean_luminance) = self.uncertainty();
        frame
    }

    fn confidence_factor(&self) -> f32 {
        let pixels = self.size.x as usize * self.size.y as usize;
        let distinct = if self.plan.is_none() { 1 } else { pixels };
        let largest = (0..distinct).map(|pixel| BlockSums::confidence_factor(self.count(pixel))).fold(0.0, f32::max);
        largest.max(BlockSums::confidence_factor(self.spp()))
    }

    fn value(&self, spec: &ImageSpec, pixel: usize, channel: usize) -> f32 {
        let sums = &self.sums[pixel * self.layout.channels..][..self.layout.channels];
        let count = match spec.combine {
            Combine::Mean | Combine::TrackedMean => f64::from(self.count(pixel)),
            Combine::Covered => self.layout.coverage.map_or(0.0, |coverage| sums[coverage]),
            Combine::First => 1.0,
            Combine::Count => return self.count(pixel) as f32,
        };
        if count > 0.0 { (sums[spec.offset + channel] / count) as f32 } else { 0.0 }
    }

    fn pixels(&self, spec: &ImageSpec, value: impl Fn(usize, usize) -> f32) -> Pixels {
        let count = self.size.x as usize * self.size.y as usize;
        let rgb = |pixel| Vec3::from_array([0, 1, 2].map(|channel| if channel < spec.channels { value(pixel, channel) } else { 0.0 }));
        if spec.channels == 1 {
            Pixels::Scalar(Image::from_pixels(self.size, (0..count).map(|pixel| value(pixel, 0)).collect()))
        } else if spec.aov.as_ref().is_none_or(crate::Aov::is_color) {
            Pixels::Color(Image::from_pixels(self.size, (0..count).map(|pixel| LinearRgb(rgb(pixel))).collect()))
        } else {
            Pixels::Vector(Image::from_pixels(self.size, (0..count).map(rgb).collect()))
        }
    }

    /// Relative standard error of the image, and its mean luminance with the half width of the 95 % interval.
    ///
    /// The variance of luminance is bounded by treating the channels as fully correlated, √Var Y = Σ w_c √Var c: exact for grey light.
    pub(crate) fn uncertainty(&self) -> (f32, (f32, f32)) {
        const NORMAL_95: f64 = 1.959_964;
        let weights = LinearRgb::LUMINANCE.map(f64::from);
        let pixels = self.size.x as usize * self.size.y as usize;
        let (mut mean, mut variance) = (0.0f64, 0.0f64);
        for pixel in 0..pixels {
            let n = self.count(pixel);
            if n == 0 {
                return (f32::INFINITY, (0.0, f32::INFINITY));
            }
            let mut deviation = 0.0;
            for (c, weight) in weights.iter().enumerate() {
                mean += weight * self.sums[pixel * self.layout.channels + c] / f64::from(n);
                deviation += weight * f64::from(self.blocks[pixel * self.layout.tracked + c].variance_of_mean(n)).sqrt();
            }
            variance += deviation * deviation;
        }
        let count = pixels as f64;
        let mean = mean / count;
        let noise = (variance / count).sqrt();
        let relative = if noise == 0.0 { 0.0 } else { noise / mean.abs() };
        (relative as f32, (mean as f32, (NORMAL_95 * noise / count.sqrt()) as f32))
    }
}
