//! The reference by the path tracer on the device, where it gives the images of the judged role and the scene holds nothing that it lacks.

use super::{Answer, Question, Reference};
use crate::stage::{Moment, sentence, serial};
use crate::worker::Desk;
use kajo_lab::{depth_of, is_judged_progressively, progressive_judge, progressive_picture, spread_of};
use kajo_render_graph::Device;
use kajo_renderer::{Error, ProgressivePathTracer, ProgressiveSettings, not_path_traced};
use kajo_techniques::Role;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Who traces the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TracedBy {
    /// The device where it can and is no software adapter, which has the same cores; else the CPU.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// The device where it can; else the CPU.
    Device,
}

impl TracedBy {
    /// Each with its name.
    pub const ALL: [(&'static str, Self); 3] = [("auto", Self::Auto), ("cpu", Self::Cpu), ("gpu", Self::Device)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.into_iter().find(|(_, by)| *by == self).map_or("", |(name, _)| name)
    }
}

/// Longest time between two answers, and about how long the device works on one call.
const ANSWER: Duration = Duration::from_millis(250);
const CALL: Duration = Duration::from_millis(60);

/// Most samples of a call.
const MOST: u32 = 64;

/// Device and scene, where they are.
#[derive(Default)]
pub(super) struct OnDevice {
    /// Kind of the adapter that would be opened.
    kind: Option<&'static str>,
    device: Option<Device>,
    tracer: Option<(Arc<Moment>, ProgressiveSettings, ProgressivePathTracer)>,
}

impl OnDevice {
    /// Answers until every sample is there or something else is asked; `lights` are those that are judged.
    ///
    /// # Errors
    /// Why the CPU has to do it.
    pub fn trace(&mut self, question: &Question, lights: &[usize], desk: &Desk<Question, Answer>) -> Result<(), String> {
        self.refuse(question)?;
        self.samples(question, lights, desk).map_err(|error| {
            (self.device, self.tracer) = (None, None);
            sentence(&error)
        })
    }

    fn refuse(&mut self, question: &Question) -> Result<(), String> {
        if question.by == TracedBy::Cpu {
            return Err("the CPU is chosen".into());
        }
        if !is_judged_progressively(question.role) {
            return Err("the images of visibilities are the CPU's".into());
        }
        if question.by == TracedBy::Auto {
            let kind = *self.kind.get_or_insert_with(|| Device::list().first().map_or("missing", |info| info.kind));
            if matches!(kind, "software" | "missing") {
                return Err(format!("the adapter is {kind}"));
            }
        }
        let moment = &question.shot.moment;
        let mut scene = moment.snapshot.clone();
        scene.cameras[0] = question.shot.camera.clone();
        match not_path_traced(&moment.stage.scene, &scene, 0).first() {
            Some(ignored) => Err(format!("{} {}: {}", ignored.place, ignored.feature, ignored.consequence)),
            None => Ok(()),
        }
    }

    fn samples(&mut self, question: &Question, lights: &[usize], desk: &Desk<Question, Answer>) -> Result<(), Error> {
        let start = Instant::now();
        let (name, tracer) = self.tracer(question)?;
        let (mut batch, mut answered) = (1, Instant::now());
        while tracer.samples() < question.spp {
            if desk.superseded() {
                return Ok(());
            }
            let call = Instant::now();
            let added = batch.min(question.spp - tracer.samples());
            tracer.add(added)?;
            let took = call.elapsed().as_secs_f64().max(1e-4);
            batch = (f64::from(added) * CALL.as_secs_f64() / took).clamp(1.0, f64::from(MOST)) as u32;
            let first = tracer.samples() == added;
            if !first && tracer.samples() < question.spp && answered.elapsed() < ANSWER {
                continue;
            }
            answered = Instant::now();
            let found = tracer.read()?;
            let Some(judge) = progressive_judge(question.role, &found) else { return Ok(()) };
            desk.answer(Answer::Reference(Box::new(Reference {
                question: question.clone(),
                judge: Arc::new(judge),
                lights: lights.to_vec(),
                picture: progressive_picture(question.light, &found),
                serial: serial(),
                spp: found.samples,
                seconds: start.elapsed().as_secs_f64(),
                invalid: found.invalid,
                on_device: Ok(name.clone()),
            })));
        }
        Ok(())
    }

    /// The device's name, and the path tracer at the shot without samples.
    fn tracer(&mut self, question: &Question) -> Result<(String, &mut ProgressivePathTracer), Error> {
        let device = match &self.device {
            Some(device) => device.clone(),
            None => self.device.insert(Device::new()?).clone(),
        };
        let shot = &question.shot;
        let defaults = ProgressiveSettings::new(shot.size);
        let wanted = ProgressiveSettings {
            spread: spread_of(question.role),
            irradiance: question.role == Role::DiffuseIndirect,
            max_depth: depth_of(question.role, question.light, defaults.max_depth),
            ..defaults
        };
        let fits = |(moment, settings, _): &(Arc<Moment>, ProgressiveSettings, ProgressivePathTracer)| {
            moment.is(&shot.moment) && ProgressiveSettings { size: wanted.size, ..*settings } == wanted
        };
        if !self.tracer.as_ref().is_some_and(fits) {
            // Two scenes at once may not fit.
            self.tracer = None;
            let tracer = ProgressivePathTracer::new(&device, &shot.moment.stage.scene, &shot.moment.snapshot, wanted)?;
            self.tracer = Some((shot.moment.clone(), wanted, tracer));
        }
        let (_, _, tracer) = self.tracer.as_mut().expect("it was made");
        tracer.set_view(&shot.camera, shot.size)?;
        Ok((device.info().name.clone(), tracer))
    }
}
