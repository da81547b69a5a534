//! `kajo render --denoise`: the picture without its noise, for previews.

use crate::arguments::Render;
use crate::failure::{Failure, Outcome};
use kajo_image::Image;
use kajo_image_denoise::{Input, denoise};
use kajo_path_tracer::{Aov, Frame, Integrator, Pixels};
use kajo_units::LinearRgb;
use std::time::Instant;

/// What the denoiser knows of a pixel besides its colour.
const FEATURES: [Aov; 5] = [Aov::Emission, Aov::Coverage, Aov::Albedo, Aov::ShadingNormal, Aov::Depth];

/// A picture without noise, and the time that took.
pub struct Denoised {
    /// The picture, W/(m² sr).
    pub image: Image<LinearRgb>,
    /// Wall-clock time, s.
    pub seconds: f64,
}

/// Refuses to denoise what has no noise of light.
///
/// # Errors
/// Wrong usage: integrators that show surfaces, not light.
pub fn check(arguments: &Render) -> Outcome {
    match arguments.integrator {
        Some(Integrator::Albedo | Integrator::Normal) if arguments.denoise => {
            Err(Failure::usage("--denoise is for light, which the integrators albedo and normal do not show; remove it or --integrator"))
        }
        _ => Ok(()),
    }
}

/// The images to render when the picture is to be denoised.
pub fn with_features(wanted: &[Aov]) -> Vec<Aov> {
    let missing = FEATURES.into_iter().filter(|feature| !wanted.contains(feature));
    wanted.iter().cloned().chain(missing).collect()
}

/// Denoises the picture of a frame that has the images of [`with_features`].
///
/// # Errors
/// Those of [`denoise`].
pub fn run(frame: &Frame) -> Outcome<Denoised> {
    let begin = Instant::now();
    let feature = |aov: &Aov| frame.image(&aov.to_string()).map(|image| &image.pixels);
    let [
        Some(Pixels::Color(emission)),
        Some(Pixels::Scalar(coverage)),
        Some(Pixels::Color(albedo)),
        Some(Pixels::Vector(normal)),
        Some(Pixels::Scalar(depth)),
    ] = FEATURES.each_ref().map(feature)
    else {
        return Err(Failure::run("the rendering lacks the images that denoising needs"));
    };
    let input = Input { color: frame.beauty(), emission, variance: frame.beauty_variance(), coverage, albedo, normal, depth };
    Ok(Denoised { image: denoise(&input)?, seconds: begin.elapsed().as_secs_f64() })
}
