//! Behaviour over time: flicker, ghosts and lag of a technique on sequences in which the camera, a light or a thing moves.
//!
//! A sequence is a list of snapshots, 1/30 s apart ([`motions`]). The path tracer renders the role's image of each, R_t; the technique renders I_t in one go, after as
//! many frames at rest as its history is long. Where a surface point of pixel p was one frame ago, p', is told by the G-buffer ([`track`]).
//!
//! ```text
//! flicker  F = mean over t, p of max(0, |I_t(p) − I_{t−1}(p')| − |R_t(p) − R_{t−1}(p')|)
//! ghost    g = 2 Σ (I_t − R_t)(R_{t−1} − R_{t+1}) / Σ (R_{t−1} − R_{t+1})²
//! lag      the number of frames that are short of 95 % of the way after a light has jumped
//! ```
//!
//! F, in the unit of the role (of light: of the display), is the change from frame to frame, motion taken out, beyond what the reference changes. g is the share of the frame before in the
//! picture, where that changes: 1 for a picture that is one frame late, 1 − α for a blend of α, 0 for a technique that forgets at once, however wrong it is: its errors are as near to the
//! frame after as to the frame before. Both compare with the path tracer. Light is taken as a display would show it, so that no highlight outweighs the picture. Lag needs no reference: the way is measured between the technique's own settled pictures, see [`metrics::progress`].
//!
//! Images have at most [`LONGEST_SIDE`] px a side: a reference for each frame would else take longer than all the rest of a comparison.

mod film;
mod metrics;
mod motions;
mod track;

use crate::judge::{Judge, Kind};
use crate::measure::{Seen, take};
use crate::plan::Choice;
use crate::reference::{judged_lights, references};
use crate::report::{SequenceError, Temporal};
use crate::subject::Subject;
use crate::{CompareOptions, LabError, Progress, ReferenceStop};
pub use film::{FULL_SCALE, Film};
use glam::{UVec2, Vec3};
use kajo_image::{Image, auto_exposure};
use kajo_path_tracer::Tracer;
use kajo_render_graph::Device;
use kajo_renderer::{Error, FrameSettings, Renderer, RendererSettings, RoleSelection};
use kajo_scene::Snapshot;
use kajo_techniques::Role;
use kajo_units::LinearRgb;
use metrics::{Flicker, ghost, progress};
use motions::{Motion, motions, step_of_a_light};
use std::collections::BTreeMap;
use track::Track;

/// Longest side of the images of a sequence, px.
const LONGEST_SIDE: u32 = 320;

/// Samples per pixel of a sequence's references. All frames have the same random numbers: what does not change has the same noise.
const SPP: u32 = 32;

/// Share of the way at which a picture has followed.
const FOLLOWED: f64 = 0.95;

/// The sequences of a scene, with their references.
pub struct Sequences {
    renderer: Renderer,
    played: Vec<Sequence>,
    /// The scene before and after a light jumps, where there is a light.
    step: Option<[Snapshot; 2]>,
    /// Number of the next frame; those of one run follow each other, and no other's.
    next: u32,
    seen: Seen,
}

/// One of them.
struct Sequence {
    motion: Motion,
    /// For each frame, by the role's id.
    judges: Vec<BTreeMap<&'static str, Judge>>,
    /// For each frame but the first: where its pixels were.
    tracks: Vec<Track>,
}

/// At most [`LONGEST_SIDE`], in the same shape.
fn reduced(size: UVec2) -> UVec2 {
    let factor = (LONGEST_SIDE as f32 / size.max_element() as f32).min(1.0);
    (size.as_vec2() * factor).round().as_uvec2().max(UVec2::ONE)
}

impl Sequences {
    /// Renders the references of `options.temporal` frames of each motion. `None` when interrupted.
    ///
    /// # Errors
    /// When the path tracer or the device refuses.
    pub fn new(
        subject: &Subject,
        roles: &[&str],
        options: &CompareOptions,
        (device, pool): (&Device, &rayon::ThreadPool),
        watched: &dyn Progress,
        share: &(dyn Fn(f64) -> f64 + Sync),
    ) -> Result<Option<Self>, LabError> {
        let size = reduced(subject.size);
        let settings = RendererSettings { camera: subject.camera, ..RendererSettings::new(size) };
        let failed = |error: Error| LabError::NotMeasured { reason: format!("a sequence cannot be rendered: {error}") };
        let mut renderer = Renderer::new(device, &subject.scene, &subject.snapshot, settings).map_err(failed)?;
        let tracer = subject.tracer()?;
        renderer.watch(&judged_lights(&tracer));
        let first = track::gbuffer(&mut renderer, &subject.snapshot, &subject.snapshot).map_err(failed)?;
        let motions = motions(subject, &tracer, &first, size, options.temporal);
        let step = step_of_a_light(subject, &tracer);
        let total = motions.iter().map(|motion| motion.snapshots.len()).sum::<usize>().max(1) as f64;
        let settings = kajo_path_tracer::Settings { size, ..subject.tracer_settings(options) };
        let mut played = Vec::new();
        let mut done = 0.0;
        for motion in motions {
            let (mut judges, mut tracks) = (Vec::new(), Vec::new());
            let mut before = None;
            for snapshot in &motion.snapshots {
                let tracer = Tracer::new(&subject.scene, snapshot.clone())?;
                let within = |f: f64| share((done + f) / total);
                let rendered = pool.install(|| references(&tracer, roles, &settings, ReferenceStop::Spp(SPP), watched, &within))?;
                let Some(found) = rendered else { return Ok(None) };
                judges.push(found.judges);
                let last: &Snapshot = before.as_ref().map_or(snapshot, |(snapshot, _)| snapshot);
                let images = track::gbuffer(&mut renderer, snapshot, last).map_err(failed)?;
                if let Some((last, old)) = &before {
                    tracks.push(track::track((snapshot, &images), (last, old)));
                }
                before = Some((snapshot.clone(), images));
                done += 1.0;
            }
            played.push(Sequence { motion, judges, tracks });
        }
        let seen = Seen { ambient_distance: subject.ambient_distance };
        Ok(Some(Self { renderer, played, step, next: options.seed as u32, seen }))
    }

    /// What a technique does on them, and a strip of film from each where it flickers.
    ///
    /// # Errors
    /// When the device fails.
    pub fn measure(&mut self, role: Role, choice: &Choice) -> Result<(Temporal, Vec<Film>), Error> {
        let selection = RoleSelection::new().with(choice.technique, choice.params.clone());
        let played = std::mem::take(&mut self.played);
        let (mut sequences, mut films) = (Vec::new(), Vec::new());
        for sequence in &played {
            if let Some(judges) = sequence.judges.iter().map(|judges| judges.get(role.id())).collect::<Option<Vec<&Judge>>>() {
                let (error, film) = self.play(role, &selection, sequence, &judges)?;
                sequences.push(error);
                films.extend(film);
            }
        }
        let judge = played.iter().find_map(|sequence| sequence.judges.first()?.get(role.id()));
        let response = match (&self.step.clone(), judge) {
            (Some(step), Some(judge)) => self.jump(role, &selection, step, judge)?,
            _ => Vec::new(),
        };
        self.played = played;
        let mean = |of: fn(&SequenceError) -> Option<f64>| {
            let values: Vec<f64> = sequences.iter().filter_map(of).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        let temporal = Temporal {
            flicker: mean(|s| s.flicker),
            ghost: mean(|s| s.ghost),
            lag: (!response.is_empty()).then(|| response.iter().take_while(|way| **way < FOLLOWED).count() as f64),
            response,
            sequences,
            still_flicker: None,
        };
        Ok((temporal, films))
    }

    fn play(
        &mut self,
        role: Role,
        selection: &RoleSelection,
        sequence: &Sequence,
        judges: &[&Judge],
    ) -> Result<(SequenceError, Option<Film>), Error> {
        let snapshots = &sequence.motion.snapshots;
        self.settle(role, selection, &snapshots[0], judges[0])?;
        let mut images = Vec::new();
        for (frame, (snapshot, judge)) in snapshots.iter().zip(judges).enumerate() {
            images.push(self.frame(role, selection, (snapshot, &snapshots[frame.max(1) - 1]), judge)?);
        }
        let mut references: Vec<Image<LinearRgb>> = judges.iter().map(|judge| judge.stacked()).collect();
        let mut variances: Option<Vec<_>> = judges.iter().map(|judge| judge.stacked_variance()).collect();
        let squares: f64 = images.iter().zip(&references).map(|(i, r)| metrics::mean_square(i, r)).sum();
        if judges[0].kind == Kind::Light {
            let scale = auto_exposure(&references[0]).exp2();
            let shown = |image: &mut Image<LinearRgb>| *image = image.map(|c| LinearRgb((c.0 * scale).clamp(Vec3::ZERO, Vec3::ONE)));
            images.iter_mut().chain(&mut references).for_each(shown);
            variances.iter_mut().flatten().for_each(|v| *v = v.map(|c| *c * (scale * scale)));
        }
        let Flicker { mean, map } = Flicker::new(&images, &references, &sequence.tracks);
        let error = SequenceError {
            motion: sequence.motion.name.into(),
            flicker: mean,
            ghost: ghost(&images, &references, variances.as_deref()),
            rmse: (squares / images.len() as f64).sqrt(),
        };
        Ok((error, Film::new(sequence.motion.name, &images, &references, &map)))
    }

    /// The way towards the new picture, frame by frame after a light has jumped, to the first that has followed.
    fn jump(&mut self, role: Role, selection: &RoleSelection, [old, new]: &[Snapshot; 2], judge: &Judge) -> Result<Vec<f64>, Error> {
        let history = self.renderer.history(selection)?;
        let goals = [self.settle(role, selection, new, judge)?, self.settle(role, selection, new, judge)?];
        let starts = [self.settle(role, selection, old, judge)?, self.settle(role, selection, old, judge)?];
        let mut response = Vec::new();
        for _ in 0..4 * history + 8 {
            let image = self.frame(role, selection, (new, new), judge)?;
            let Some(way) = progress(&image, &starts, &goals) else { return Ok(Vec::new()) };
            response.push(way);
            if way >= FOLLOWED {
                break;
            }
        }
        Ok(response)
    }

    /// The picture of a scene at rest, begun anew.
    fn settle(&mut self, role: Role, selection: &RoleSelection, at: &Snapshot, judge: &Judge) -> Result<Image<LinearRgb>, Error> {
        // A gap between the numbers of frames.
        self.next = self.next.wrapping_add(1);
        let mut image = self.frame(role, selection, (at, at), judge)?;
        for _ in 1..self.renderer.history(selection)? {
            image = self.frame(role, selection, (at, at), judge)?;
        }
        Ok(image)
    }

    fn frame(
        &mut self,
        role: Role,
        selection: &RoleSelection,
        (now, before): (&Snapshot, &Snapshot),
        judge: &Judge,
    ) -> Result<Image<LinearRgb>, Error> {
        self.renderer.set_snapshot(now, before)?;
        let settings = FrameSettings { index: self.next, ..self.seen.settings(role) };
        self.next = self.next.wrapping_add(1);
        Ok(judge.stacked_take(&take(role, &self.renderer.render(selection, &settings)?)))
    }
}

#[cfg(test)]
mod tests;
