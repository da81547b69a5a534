//! The thread that path traces: the judge of the role that is looked at, better with every pass.
//!
//! It renders the role's own images and nothing else, at pixel centres, so that the error is one of the same light transport. The CPU traces, with one core left to the
//! window, or the device does where that is wanted and it can: see [`on_device`].

mod on_device;

pub use on_device::TracedBy;

use crate::stage::{Moment, Shot, sentence, serial};
use crate::worker::{Desk, Wake, Worker};
use kajo_image::Image;
use kajo_lab::judge::Judge;
use kajo_lab::{Pictured, ReferencePlan, ambient_distance, judged_lights};
use kajo_path_tracer::{Control, Film, PathTracerError, Progress, Settings, Stop, Tracer, render};
use kajo_techniques::Role;
use kajo_units::LinearRgb;
use on_device::OnDevice;
use std::ops::ControlFlow;
use std::sync::Arc;

/// What is to be judged.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Question {
    /// Scene, camera and size.
    pub shot: Shot,
    /// The role.
    pub role: Role,
    /// The light of its picture.
    pub light: Pictured,
    /// Samples per pixel to end at.
    pub spp: u32,
    /// Who traces.
    pub by: TracedBy,
}

/// What comes back, again and again.
#[derive(Clone, Debug)]
pub(crate) enum Answer {
    /// Indices of the lights that are judged.
    Lights(Vec<usize>),
    /// The reference so far.
    Reference(Box<Reference>),
    /// There is nothing to judge, or the scene cannot be traced.
    Failed(String),
}

/// A reference in the making.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    /// What was asked.
    pub question: Question,
    /// Judges the role.
    pub judge: Arc<Judge>,
    /// Indices of the lights that are judged.
    pub lights: Vec<usize>,
    /// The picture with the light that the question asks for.
    pub picture: Image<LinearRgb>,
    /// Other passes have another one.
    pub serial: u64,
    /// Samples per pixel so far.
    pub spp: u32,
    /// Time so far, s.
    pub seconds: f64,
    /// Samples that were not finite.
    pub invalid: u64,
    /// The device traced it, which the question left open or asked for; else why it did not.
    pub on_device: Result<String, String>,
}

struct Tools {
    pool: rayon::ThreadPool,
    tracer: Option<(Arc<Moment>, Tracer)>,
    device: OnDevice,
}

/// Starts the thread.
pub(crate) fn start(wake: Wake) -> Worker<Question, Answer> {
    Worker::new("reference", wake, || Tools { pool: pool(), tracer: None, device: OnDevice::default() }, answer)
}

/// All cores but one.
fn pool() -> rayon::ThreadPool {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = cores.saturating_sub(1).max(1);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a system that has started this thread starts another")
}

fn answer(tools: &mut Tools, question: Question, desk: &Desk<Question, Answer>) {
    let Tools { pool, tracer, device } = tools;
    if let Err(error) = pool.install(|| trace(tracer, device, &question, desk)) {
        desk.answer(Answer::Failed(sentence(&error)));
    }
}

fn trace(
    kept: &mut Option<(Arc<Moment>, Tracer)>,
    device: &mut OnDevice,
    question: &Question,
    desk: &Desk<Question, Answer>,
) -> Result<(), PathTracerError> {
    let Shot { moment, camera, size } = &question.shot;
    if !kept.as_ref().is_some_and(|(before, _)| before.is(moment)) {
        *kept = None;
        *kept = Some((moment.clone(), Tracer::new(&moment.stage.scene, moment.snapshot.clone())?));
    }
    let (_, tracer) = kept.as_mut().expect("it was made");
    tracer.set_camera(0, camera.clone())?;
    let Some(plan) = ReferencePlan::new(tracer, question.role.id()) else {
        let title = question.role.title().to_lowercase();
        desk.answer(Answer::Failed(format!("there is nothing to judge: the scene has no light for the role {title}")));
        return Ok(());
    };
    let plan = plan.with_picture(question.light);
    let lights = judged_lights(tracer);
    desk.answer(Answer::Lights(lights.clone()));
    let Err(not_on_device) = device.trace(question, &lights, desk) else { return Ok(()) };
    let base = Settings { size: *size, ambient_distance: ambient_distance(moment.bounds), ..Settings::default() };
    let settings = plan.settings(tracer, &base);
    let watch = Watch { desk, plan: &plan, tracer, question, lights, not_on_device };
    render(tracer, &settings, Stop::at_spp(question.spp), None, &watch)?;
    Ok(())
}

/// Sends the film after every pass, and ends when something else is asked.
struct Watch<'a> {
    desk: &'a Desk<Question, Answer>,
    plan: &'a ReferencePlan,
    tracer: &'a Tracer,
    question: &'a Question,
    lights: Vec<usize>,
    not_on_device: String,
}

impl Control for Watch<'_> {
    fn progress(&self, _: &Progress) -> ControlFlow<()> {
        if self.desk.superseded() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn pass(&self, film: &Film) {
        let frame = film.develop();
        let Some(judge) = self.plan.judges(self.tracer, &frame).remove(self.question.role.id()) else { return };
        let picture = self.plan.picture(&frame).unwrap_or_else(|| frame.beauty().clone());
        self.desk.answer(Answer::Reference(Box::new(Reference {
            question: self.question.clone(),
            judge: Arc::new(judge),
            lights: self.lights.clone(),
            picture,
            serial: serial(),
            spp: frame.spp,
            seconds: frame.seconds,
            invalid: frame.invalid_samples,
            on_device: Err(self.not_on_device.clone()),
        })));
    }
}
