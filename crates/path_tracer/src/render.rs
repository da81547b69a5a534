//! Rendering: passes over all pixels until a stop condition holds.

use crate::camera::CameraView;
use crate::extra::Extras;
use crate::film::{Film, FilmLayout};
use crate::filter::FilterSampler;
use crate::fingerprint::fingerprint;
use crate::integrator::Context;
use crate::integrator::first_hit::Previous;
use crate::pixels::{Counts, Pixels};
use crate::record::Slots;
use crate::{Integrator, PathTracerError, Settings, Stop, Tracer};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// How far a rendering is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Samples that every pixel has at least; with adaptive sampling their mean.
    pub spp: u32,
    /// Samples of all pixels together, those of a resumed film included.
    pub samples: u64,
    /// Estimated share of the work that is done, [0, 1].
    pub fraction: f32,
    /// Time of this run.
    pub elapsed: Duration,
    /// Relative standard error after the last pass; `None` before the first.
    pub relative_standard_error: Option<f32>,
}

/// Watches a rendering and may end it. Closures that take a [`Progress`] are controls.
pub trait Control: Sync {
    /// Called after every row of pixels, from any thread, also while it is decided which of
    /// them get additional rays. [`ControlFlow::Break`] ends the rendering; what has been sampled is kept.
    fn progress(&self, progress: &Progress) -> ControlFlow<()>;

    /// Called between passes with the film so far; the place to save checkpoints.
    fn pass(&self, _film: &Film) {}
}

impl<F: Fn(&Progress) -> ControlFlow<()> + Sync> Control for F {
    fn progress(&self, progress: &Progress) -> ControlFlow<()> {
        self(progress)
    }
}

/// Lets a rendering run.
pub fn uncontrolled(_: &Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A pass aims to last no longer than this, so that checkpoints and stop conditions come round.
const PASS_TIME: Duration = Duration::from_secs(2);
/// Fewest samples per pixel before a noise level is believed: earlier, rare bright samples are missing from it.
const MIN_NOISE_SPP: u32 = 16;

/// Renders until `stop`, from nothing or on top of `resume`.
///
/// The result depends on the scene, the settings and the number of samples, and on nothing else: not on threads (those of the
/// current rayon pool), not on passes, not on interruptions.
///
/// # Errors
/// Settings out of range, an image that memory does not hold, an unknown camera, light or image, [`PathTracerError::EndlessStop`], and
/// [`PathTracerError::CheckpointMismatch`] for a film of another picture.
pub fn render(
    tracer: &Tracer,
    settings: &Settings,
    stop: Stop,
    resume: Option<Film>,
    control: &dyn Control,
) -> Result<Film, PathTracerError> {
    let start = Instant::now();
    settings.validate()?;
    stop.validate()?;
    let camera = tracer.camera(settings)?;
    let layout = FilmLayout::new(&tracer.resolve_aovs(&settings.aovs)?);
    let slots = Slots::new(&layout, &tracer.lights)?;
    let fingerprint = fingerprint(tracer.hash(), settings);
    let mut film = match resume {
        None => {
            layout.check_memory(settings.size, settings.adaptive)?;
            Film::new(settings.size, layout, fingerprint, settings.adaptive)
        }
        Some(film) if film.fingerprint.scene != fingerprint.scene => {
            return Err(PathTracerError::CheckpointMismatch { what: "the scene, or the light or environment sampler, differs" });
        }
        Some(film) if film.layout != layout => {
            return Err(PathTracerError::CheckpointMismatch { what: "its images differ: --aov and --denoise must be as before" });
        }
        Some(film) if film.fingerprint.settings != fingerprint.settings || film.size != settings.size => {
            return Err(PathTracerError::CheckpointMismatch { what: "the settings differ" });
        }
        Some(film) => film,
    };
    let view_of = |snapshot: &kajo_scene::Snapshot| snapshot.cameras.get(camera).map(|camera| CameraView::new(camera, settings.size));
    let previous = tracer.previous.as_ref().and_then(|snapshot| Some(Previous { snapshot, view: view_of(snapshot)? }));
    let max_depth = if settings.integrator == Integrator::Direct { settings.max_depth.min(1) } else { settings.max_depth };
    let cx = Context { world: &tracer.world, lights: &tracer.lights, settings, max_depth };
    let view = CameraView::new(&tracer.world.snapshot.cameras[camera], settings.size);
    let pixels =
        Pixels { extras: None, cx, view, previous, filter: FilterSampler::new(settings.filter), slots, channels: film.layout.channels };
    Run { pixels, stop, control, start, seconds_before: film.seconds }.run(&mut film);
    Ok(film)
}

/// One call of [`render`].
struct Run<'a> {
    pixels: Pixels<'a>,
    stop: Stop,
    control: &'a dyn Control,
    start: Instant,
    /// Time that a resumed film already took.
    seconds_before: f64,
}

impl Run<'_> {
    fn run(mut self, film: &mut Film) {
        let mut error = (film.spp() > 0).then(|| film.uncertainty().0);
        let mut time_per_spp = None;
        film.revise();
        if self.goal(film, error, time_per_spp).is_none() || self.find_extras(film, error).is_break() {
            film.seconds = self.seconds_before + self.start.elapsed().as_secs_f64();
            return;
        }
        while let Some(goal) = self.goal(film, error, time_per_spp) {
            let (begin, from) = (Instant::now(), film.spp());
            let cancelled = self.pass(film, goal, error);
            film.seconds = self.seconds_before + self.start.elapsed().as_secs_f64();
            if cancelled {
                return;
            }
            time_per_spp = Some(begin.elapsed() / (goal - from));
            error = Some(film.uncertainty().0);
            film.revise();
            self.control.pass(film);
        }
    }

    /// The additional rays are the same in every run; looking for them counts among the rays of a film once.
    fn find_extras(&mut self, film: &mut Film, error: Option<f32>) -> ControlFlow<()> {
        let (spp, samples) = (film.spp(), film.samples());
        let row = || {
            let elapsed = self.start.elapsed();
            let fraction = self.fraction(samples as f64 / f64::from(film.size.x) / f64::from(film.size.y), elapsed, error);
            self.control.progress(&Progress { spp, samples, fraction, elapsed, relative_standard_error: error })
        };
        let (extras, rays) = Extras::find(&self.pixels.cx, &self.pixels.view, row)?;
        film.rays = film.rays.max(rays);
        self.pixels.extras = extras;
        ControlFlow::Continue(())
    }

    /// Samples per pixel to have after the next pass; `None` to stop. The first passes double the samples.
    fn goal(&self, film: &Film, error: Option<f32>, time_per_spp: Option<Duration>) -> Option<u32> {
        let spp = film.spp();
        let remaining = self.stop.time.map(|time| time.saturating_sub(self.start.elapsed()));
        let quiet = self.stop.noise.zip(error).is_some_and(|(goal, error)| spp >= MIN_NOISE_SPP && error <= goal);
        if quiet || self.stop.spp.is_some_and(|goal| spp >= goal) || (spp > 0 && remaining == Some(Duration::ZERO)) {
            return None;
        }
        let affordable = |time: Duration, each: Duration| (time.as_secs_f64() / each.as_secs_f64().max(1e-9)) as u32;
        let mut step = spp.max(1);
        if let Some(each) = time_per_spp {
            step = step.min(affordable(PASS_TIME, each)).min(remaining.map_or(u32::MAX, |time| affordable(time, each)));
        }
        let revision = film.plan.as_ref().map_or(u32::MAX, |plan| plan.revision());
        let goal = spp.saturating_add(step.max(1)).min(revision);
        Some(self.stop.spp.map_or(goal, |limit| goal.min(limit)))
    }

    /// Brings every row to `goal` samples per pixel; true when cancelled.
    fn pass(&self, film: &mut Film, goal: u32, error: Option<f32>) -> bool {
        let cancelled = AtomicBool::new(false);
        let (spp, width, height) = (film.spp(), u64::from(film.size.x), u64::from(film.size.y));
        let samples = AtomicU64::new(film.samples());
        let counts = film
            .rows()
            .into_par_iter()
            .map(|mut row| {
                if cancelled.load(Ordering::Relaxed) {
                    return Counts::default();
                }
                let added = u64::from(goal.saturating_sub(*row.level)) * width;
                let counts = self.pixels.row(&mut row, goal);
                let samples = samples.fetch_add(added, Ordering::Relaxed) + added;
                let elapsed = self.start.elapsed();
                let fraction = self.fraction(samples as f64 / (width * height) as f64, elapsed, error);
                let progress = Progress { spp, samples, fraction, elapsed, relative_standard_error: error };
                if self.control.progress(&progress).is_break() {
                    cancelled.store(true, Ordering::Relaxed);
                }
                counts
            })
            .reduce(Counts::default, |a, b| Counts { rays: a.rays + b.rays, invalid: a.invalid + b.invalid });
        film.rays += counts.rays;
        film.invalid += counts.invalid;
        cancelled.into_inner()
    }

    /// Share of the work done by the condition that is nearest to its end; noise falls with the square root of samples.
    fn fraction(&self, spp: f64, elapsed: Duration, error: Option<f32>) -> f32 {
        let by_spp = self.stop.spp.map_or(0.0, |goal| spp / f64::from(goal));
        let by_time = self.stop.time.map_or(0.0, |time| elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9));
        let by_noise = self.stop.noise.zip(error).map_or(0.0, |(goal, error)| f64::from(goal / error).powi(2));
        by_spp.max(by_time).max(by_noise).min(1.0) as f32
    }
}
