//! The thread that measures: how far each side is from the reference, and where.

use crate::stage::sentence;
use crate::worker::{Desk, Wake, Worker};
use kajo_image::Image;
use kajo_image_metrics::{Comparison, ComparisonOptions};
use kajo_lab::failures::{Failures, LightPlace};
use kajo_lab::judge::{Judge, Kind};
use kajo_lab::take;
use kajo_renderer::FrameOutput;
use kajo_techniques::Role;
use kajo_units::Srgb8;
use std::sync::Arc;

/// What is to be measured.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    /// The role that is judged.
    pub role: Role,
    /// Its reference.
    pub judge: Arc<Judge>,
    /// Where the judged lights are, when it is asked how shadows fail: of frames that have their G-buffer.
    pub lights: Option<Vec<LightPlace>>,
    /// Frames of the sides.
    pub sides: Vec<Option<Arc<FrameOutput>>>,
}

/// For each side its error, `None` where there is no frame.
pub(crate) type Answer = Vec<Option<Result<Errors, String>>>;

/// The error of one side.
#[derive(Clone, Debug)]
pub(crate) struct Errors {
    /// RMSE of the role's images, linear, in the role's unit.
    pub rmse: f64,
    /// RMSE that a perfect technique has against this reference; `None` while it is not known.
    pub floor: Option<f64>,
    /// Mean ꟻLIP, [0, 1]; of light HDR-ꟻLIP.
    pub flip: f64,
    /// Mean over the reference's mean; `None` for a black reference.
    pub mean_ratio: Option<f64>,
    /// False while the reference is too noisy to tell the side from the truth.
    pub distinguishable: bool,
    /// ꟻLIP of each pixel, the largest over all lights.
    pub heat: Image<f32>,
    /// How shadows fail, when it was asked for: its picture, and what it found.
    pub failures: Option<(Image<Srgb8>, Failures)>,
}

/// Starts the thread.
pub(crate) fn start(wake: Wake) -> Worker<Question, Answer> {
    Worker::new("errors", wake, || (), answer)
}

fn answer((): &mut (), question: Question, desk: &Desk<Question, Answer>) {
    let lights = question.lights.as_deref();
    let measured = question.sides.iter().map(|side| side.as_ref().map(|frame| measure(question.role, &question.judge, lights, frame)));
    let answer: Answer = measured.collect();
    desk.answer(answer);
}

/// Measures one frame.
///
/// # Errors
/// Images that do not belong together, NaN in them.
pub(crate) fn measure(role: Role, judge: &Judge, lights: Option<&[LightPlace]>, frame: &FrameOutput) -> Result<Errors, String> {
    let take = take(role, frame);
    if take.parts.len() != judge.parts.len() {
        return Err("the lights that are judged are not rendered yet".into());
    }
    let (reference, variance) = (judge.stacked(), judge.stacked_variance());
    // Infinite while there are too few samples to know it.
    let variance = variance.filter(|image| image.pixels().iter().all(|p| p.is_finite()));
    let light = judge.kind == Kind::Light;
    let options =
        ComparisonOptions { view: judge.view(), hdr: light, reference_variance: variance.as_ref(), ..ComparisonOptions::default() };
    let (comparison, map) = Comparison::new(&judge.stacked_take(&take), &reference, &options).map_err(|error| sentence(&error))?;
    let size = judge.size();
    let parts = map.height() / size.y;
    let failures = match (lights, &frame.gbuffer) {
        (Some(lights), Some(gbuffer)) if judge.kind == Kind::Visibility => {
            let found = Failures::new(judge, &take.parts, gbuffer, lights).map_err(|error| sentence(&error))?;
            Some((found.picture(judge), found))
        }
        _ => None,
    };
    Ok(Errors {
        rmse: comparison.rmse,
        floor: comparison.rmse_floor,
        flip: comparison.flip_hdr.unwrap_or(comparison.flip),
        mean_ratio: comparison.mean_ratio,
        distinguishable: comparison.distinguishable.unwrap_or(false),
        heat: Image::from_fn(size, |x, y| (0..parts).map(|part| *map.get(x, y + part * size.y)).fold(0.0, f32::max)),
        failures,
    })
}
