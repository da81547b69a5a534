//! The thread that owns the graphics device: frames of the real-time renderer, one for each side.
//!
//! It has a device of its own, apart from the one that paints the window: a lost device loses a frame and never the window, and a slow frame never
//! holds the window up. Pictures come back through memory, where the error is measured anyway.

use crate::stage::{Moment, Shot, sentence, serial};
use crate::worker::{Desk, Wake, Worker};
use kajo_render_graph::{Device, DeviceInfo, Error as GraphError};
use kajo_renderer::{Error, FrameOutput, FrameSettings, Renderer, RendererSettings, RoleSelection};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Lights whose visibility is read back while it is not known which ones are judged.
const FIRST_LIGHTS: usize = 12;

/// What is to be rendered.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Question {
    /// Scene, camera and size.
    pub shot: Shot,
    /// One frame for each of these.
    pub sides: Vec<RoleSelection>,
    /// Frame number, exposure, and what is read back.
    pub settings: FrameSettings,
    /// Lights whose visibility is read back; `None`: the first ones.
    pub watch: Option<Vec<usize>>,
    /// How many times the device is to have been lost: to try that.
    pub losses: u32,
}

/// What comes back.
#[derive(Clone, Debug)]
pub(crate) enum Answer {
    /// The device was opened.
    Opened {
        /// Which one.
        info: DeviceInfo,
        /// Techniques that cannot run on it, and what they need.
        missing: Vec<(&'static str, String)>,
    },
    /// Frames.
    Frames(Frames),
    /// Something went wrong and was mended.
    Notice(String),
    /// Nothing can be rendered.
    Failed(String),
}

/// A frame for each side.
#[derive(Clone, Debug)]
pub(crate) struct Frames {
    /// What was asked.
    pub question: Question,
    /// In the order of the question's sides; a technique that cannot run says why.
    pub sides: Vec<Result<Arc<FrameOutput>, String>>,
    /// Names of all lights.
    pub lights: Vec<String>,
    /// Indices of the lights whose visibility was read back.
    pub watched: Vec<usize>,
    /// Who traced rays.
    pub backend: &'static str,
    /// Other frames have another one.
    pub serial: u64,
    /// Wall-clock time of all sides, readback included.
    pub elapsed: Duration,
}

/// The thread's tools: device and renderer, where they are.
#[derive(Default)]
struct Tools {
    device: Option<Device>,
    renderer: Option<(Arc<Moment>, Renderer)>,
    losses: u32,
}

/// Starts the thread.
pub(crate) fn start(wake: Wake) -> Worker<Question, Answer> {
    Worker::new("frames", wake, Tools::default, Tools::answer)
}

impl Tools {
    fn answer(&mut self, question: Question, desk: &Desk<Question, Answer>) {
        if let (Some(device), true) = (&self.device, question.losses > self.losses) {
            device.wgpu.destroy();
        }
        self.losses = question.losses;
        let answer = match self.render(&question, desk) {
            Err(Error::Graph(lost)) if is_lost(&lost) => {
                desk.answer(Answer::Notice(format!("{lost}. It is opened again.")));
                self.render(&question, desk)
            }
            other => other,
        };
        match answer {
            Ok(frames) => desk.answer(Answer::Frames(frames)),
            Err(error) => {
                self.renderer = None;
                desk.answer(Answer::Failed(sentence(&error)));
            }
        }
    }

    /// # Errors
    /// When no frame can be rendered at all; the tools that are at fault are gone then.
    fn render(&mut self, question: &Question, desk: &Desk<Question, Answer>) -> Result<Frames, Error> {
        let start = Instant::now();
        let rendered = self.frames(question, desk, start).map_err(|error| self.explain(error));
        if let Err(Error::Graph(error)) = &rendered {
            self.renderer = None;
            if is_lost(error) {
                self.device = None;
            }
        }
        rendered
    }

    /// A command may be refused because the device is gone, which is heard of a little later.
    fn explain(&self, error: Error) -> Error {
        match (&error, self.device.as_ref().map(Device::wait)) {
            (Error::Graph(_), Some(Err(loss))) if is_lost(&loss) => Error::Graph(loss),
            _ => error,
        }
    }

    fn frames(&mut self, question: &Question, desk: &Desk<Question, Answer>, start: Instant) -> Result<Frames, Error> {
        let device = self.device(desk)?;
        let renderer = self.renderer(&device, &question.shot)?;
        let count = renderer.light_names().len();
        let watched = question.watch.clone().unwrap_or_else(|| (0..count.min(FIRST_LIGHTS)).collect());
        renderer.watch(&watched);
        let mut sides = Vec::new();
        for roles in &question.sides {
            sides.push(match settled(renderer, roles, &question.settings, desk) {
                Ok(output) => Ok(Arc::new(output)),
                Err(error) => match device.wait() {
                    Err(loss) if is_lost(&loss) => return Err(loss.into()),
                    _ => match lost(error) {
                        Ok(lost) => return Err(lost),
                        Err(refused) => Err(sentence(&refused)),
                    },
                },
            });
        }
        // A loss may be reported late, after frames that are black.
        device.wait()?;
        Ok(Frames {
            question: question.clone(),
            sides,
            lights: renderer.light_names().to_vec(),
            watched: watched.into_iter().filter(|&light| light < count).collect(),
            backend: renderer.backend().id(),
            serial: serial(),
            elapsed: start.elapsed(),
        })
    }

    fn device(&mut self, desk: &Desk<Question, Answer>) -> Result<Device, Error> {
        if let Some(device) = &self.device {
            return Ok(device.clone());
        }
        let device = Device::new()?;
        let missing = kajo_techniques::all().filter_map(|technique| Some((technique.id, technique.missing(&device)?))).collect();
        desk.answer(Answer::Opened { info: device.info().clone(), missing });
        Ok(self.device.insert(device).clone())
    }

    /// The renderer, with the shot before it.
    fn renderer(&mut self, device: &Device, shot: &Shot) -> Result<&mut Renderer, Error> {
        let moment = &shot.moment;
        if !self.renderer.as_ref().is_some_and(|(before, _)| before.same_stage(moment)) {
            // Two scenes at once may not fit.
            self.renderer = None;
            let renderer = Renderer::new(device, &moment.stage.scene, &moment.snapshot, RendererSettings::new(shot.size))?;
            self.renderer = Some((moment.clone(), renderer));
        }
        let (before, renderer) = self.renderer.as_mut().expect("it was made");
        if !before.is(moment) {
            renderer.set_snapshot(&moment.snapshot, &moment.snapshot)?;
            *before = moment.clone();
        }
        renderer.resize(shot.size)?;
        renderer.set_camera(&shot.camera, &shot.camera)?;
        Ok(renderer)
    }
}

/// A frame of a camera that stands still: techniques that keep something from frame to frame get as many frames as they remember, unless something
/// newer is asked.
fn settled(
    renderer: &mut Renderer,
    roles: &RoleSelection,
    settings: &FrameSettings,
    desk: &Desk<Question, Answer>,
) -> Result<FrameOutput, Error> {
    let count = renderer.history(roles)?.max(1);
    // Numbers that do not follow each other begin anew.
    let first = settings.index.wrapping_mul(count + u32::from(count > 1));
    let mut frame = renderer.render(roles, &FrameSettings { index: first, ..*settings })?;
    for step in 1..count {
        if desk.superseded() {
            break;
        }
        frame = renderer.render(roles, &FrameSettings { index: first.wrapping_add(step), ..*settings })?;
    }
    Ok(frame)
}

fn is_lost(error: &GraphError) -> bool {
    matches!(error, GraphError::DeviceLost { .. } | GraphError::OutOfMemory)
}

/// `Ok` for an error that ends every frame, `Err` for one of this technique alone.
fn lost(error: Error) -> Result<Error, Error> {
    match error {
        Error::Graph(graph) if is_lost(&graph) => Ok(Error::Graph(graph)),
        Error::Technique(kajo_techniques::Error::Graph(graph)) if is_lost(&graph) => Ok(Error::Graph(graph)),
        other => Err(other),
    }
}
