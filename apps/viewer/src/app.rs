//! The viewer without its window: model, threads and textures, driven frame by frame.
//!
//! [`App::frame`] takes input and gives shapes to paint. It never waits: answers of the threads are taken when they are there, and questions are
//! asked when what is seen differs from what was asked.

use crate::frames::{self, Frames};
use crate::metering::{LONGEST_STEP, Metering, adapted};
use crate::model::Model;
use crate::show::Show;
use crate::stage::{Kind, Source, Stage};
use crate::textures::Textures;
use crate::worker::{Wake, Worker};
use crate::{errors, panels, reference, viewport};
use egui::{Context, FullOutput, RawInput};
use kajo_image::auto_exposure;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// The viewer.
pub(crate) struct App {
    /// egui's state.
    pub context: Context,
    /// What is shown.
    pub model: Model,
    loader: Worker<Source, Result<Stage, String>>,
    frames: Worker<frames::Question, frames::Answer>,
    reference: Worker<reference::Question, reference::Answer>,
    errors: Worker<errors::Question, errors::Answer>,
    asked: Asked,
    textures: Textures,
    /// When the last frames came.
    metered: Instant,
}

/// The last questions.
#[derive(Default)]
struct Asked {
    frames: Option<frames::Question>,
    reference: Option<reference::Question>,
    /// Numbers of the frames and of the reference, and whether it was asked how shadows fail.
    errors: (u64, u64, bool),
    /// Frames so far, references so far.
    arrived: (u64, u64),
}

impl App {
    /// A viewer that shows nothing yet.
    pub fn new() -> Self {
        let context = Context::default();
        panels::style(&context);
        let repaint = context.clone();
        let wake: Wake = Arc::new(move || repaint.request_repaint());
        let load = |(): &mut (), source: Source, desk: &crate::worker::Desk<_, _>| desk.answer(Stage::load(&source));
        Self {
            model: Model::default(),
            loader: Worker::new("loader", wake.clone(), || (), load),
            frames: frames::start(wake.clone()),
            reference: reference::start(wake.clone()),
            errors: errors::start(wake),
            asked: Asked::default(),
            textures: Textures::default(),
            metered: Instant::now(),
            context,
        }
    }

    /// Loads a scene; the one that is there stays until it is loaded.
    pub fn open(&mut self, source: Source) {
        self.model.loading = Some(source.clone());
        self.loader.ask(source);
    }

    /// Takes a file that was dropped.
    pub fn drop_file(&mut self, path: &Path) {
        let current = self.model.moment.as_ref().map(|moment| moment.stage.source.clone());
        match (Kind::of(path), current) {
            (Some(Kind::Scene), _) => self.open(Source { reference: path.display().to_string(), environment: None }),
            (Some(Kind::Environment), Some(source)) => self.open(Source { environment: Some(path.to_owned()), ..source }),
            (Some(Kind::Environment), None) => self.model.notify("An environment lights a scene: drop the scene first.", true),
            (None, _) => {
                let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
                let takes = "the window takes scenes (.gltf, .glb, .obj, .kajo.toml) and environments (.hdr, .exr)";
                self.model.notify(format!("{name} cannot be shown: {takes}."), true);
            }
        }
    }

    /// One frame of the window.
    pub fn frame(&mut self, input: RawInput) -> FullOutput {
        for file in &input.dropped_files {
            self.drop_file(file.path());
        }
        self.take_answers();
        let context = self.context.clone();
        let (model, textures) = (&mut self.model, &mut self.textures);
        textures.update(&context, model);
        let output = context.run_ui(input, |ui| {
            panels::show(ui, model);
            viewport::show(ui, model, textures);
        });
        self.ask();
        output
    }

    /// True when nothing more will change by itself: every thread has answered, and the reference is finished.
    pub fn is_settled(&self) -> bool {
        let asked = self.asked.frames == self.model.frame_question() && self.asked.reference == self.model.reference_question();
        let idle = self.loader.is_idle() && self.frames.is_idle() && self.reference.is_idle() && self.errors.is_idle();
        asked && idle && self.asked.errors == self.arrived()
    }

    /// What the errors are to be of.
    fn arrived(&self) -> (u64, u64, bool) {
        let (frames, references) = self.asked.arrived;
        (frames, references, self.model.show == Show::Failures)
    }

    /// True when there is a frame of what is seen, or it is known why there is none.
    pub fn has_picture(&self) -> bool {
        let wanted = self.model.frame_question();
        let there = self.model.frames.as_ref().is_some_and(|frames| Some(&frames.question) == wanted.as_ref());
        wanted.is_some() && (there || self.model.frames_failed.is_some()) && self.frames.is_idle() && self.loader.is_idle()
    }

    /// True when no scene is there and none will come.
    pub fn is_empty(&self) -> bool {
        self.loader.is_idle() && self.model.frame_question().is_none()
    }

    /// Everything that the window tells.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        let model = &self.model;
        let failed = [&model.frames_failed, &model.reference_failed].into_iter().flatten();
        let sides = model.frames.iter().flat_map(|frames| &frames.sides).filter_map(|side| side.as_ref().err());
        model.notices.iter().map(|notice| &notice.text).chain(failed).chain(sides).map(String::as_str)
    }

    fn take_answers(&mut self) {
        for answer in self.loader.answers() {
            self.model.loading = None;
            match answer {
                Ok(stage) => self.model.enter(stage),
                Err(reason) => self.model.notify(reason, true),
            }
        }
        for answer in self.frames.answers() {
            self.take_frames(answer);
        }
        for answer in self.reference.answers() {
            self.take_reference(answer);
        }
        if let Some(errors) = self.errors.answers().pop_back() {
            self.model.errors = errors;
            self.model.errors_serial += 1;
        }
        let threads =
            [("loader", self.loader.has_ended()), ("renderer", self.frames.has_ended()), ("reference", self.reference.has_ended())];
        for (name, _) in threads.into_iter().filter(|(_, ended)| *ended) {
            self.model.notify(format!("The thread of the {name} ended by a defect of Kajo; start the viewer again."), true);
        }
    }

    fn take_frames(&mut self, answer: frames::Answer) {
        match answer {
            frames::Answer::Opened { info, missing } => {
                if self.model.device.is_none() && self.model.coarseness == 1 && info.kind == "software" {
                    self.model.coarseness = 2;
                }
                (self.model.device, self.model.missing) = (Some(info), missing);
            }
            frames::Answer::Notice(text) => self.model.notify(text, false),
            frames::Answer::Failed(reason) => (self.model.frames_failed, self.model.frames) = (Some(reason), None),
            frames::Answer::Frames(frames) => {
                self.model.frames_failed = None;
                self.asked.arrived.0 += 1;
                self.expose(&frames);
                self.model.frames = Some(frames);
            }
        }
    }

    /// Middle grey for the mean of the first frame of a scene that does not say how it is to be exposed, or of every frame where that is wanted.
    fn expose(&mut self, frames: &Frames) {
        // A window at rest has no frames: what was metered long ago is followed as if it had just been seen.
        let elapsed = self.metered.elapsed().min(LONGEST_STEP);
        self.metered = Instant::now();
        let current = self.model.moment.as_ref().is_some_and(|moment| moment.is(&frames.question.shot.moment));
        let Some(Ok(frame)) = frames.sides.first().filter(|_| current) else { return };
        match self.model.metering {
            Metering::Fixed => {}
            Metering::Once => {
                self.model.metering = Metering::Fixed;
                // Tenths of a stop are enough, and easy to repeat.
                self.model.exposure = (auto_exposure(&frame.color) * 10.0).round() / 10.0;
            }
            Metering::Following => self.model.exposure = adapted(self.model.exposure, auto_exposure(&frame.color), elapsed),
        }
    }

    fn take_reference(&mut self, answer: reference::Answer) {
        match answer {
            reference::Answer::Lights(lights) => {
                self.model.reference_failed = None;
                self.model.judged_lights = Some(lights);
            }
            reference::Answer::Reference(reference) => {
                self.asked.arrived.1 += 1;
                self.model.reference = Some(*reference);
            }
            reference::Answer::Failed(reason) => {
                (self.model.reference_failed, self.model.reference) = (Some(reason), None);
                self.model.errors.clear();
            }
        }
    }

    fn ask(&mut self) {
        let question = self.model.frame_question();
        if question != self.asked.frames {
            if let Some(question) = &question {
                self.frames.ask(question.clone());
            }
            self.asked.frames = question;
        }
        let question = self.model.reference_question();
        if question != self.asked.reference {
            // A camera that is still moved is judged when it stands.
            self.reference.cancel();
            if self.frames.is_idle() || question.is_none() {
                if let Some(question) = &question {
                    self.reference.ask(question.clone());
                }
                self.asked.reference = question;
            } else {
                self.asked.reference = None;
            }
        }
        if self.asked.errors != self.arrived() {
            match self.model.errors_question() {
                Some(question) => self.errors.ask(question),
                None => self.model.errors.clear(),
            }
            self.asked.errors = self.arrived();
        }
    }
}
