//! The experiment: scenes × roles × techniques.

use crate::evaluate::{Evaluation, difference, evaluate, mean_parts, pictures, reference_exr, reference_pictures, run_exr};
use crate::failures::{Failures, LightPlace, places};
use crate::html::{Pictures, page};
use crate::judge::{Judge, Kind, Take};
use crate::measure::{Seen, WARM_UP_FRAMES, measure};
use crate::plan::{Choice, Plan, plan};
use crate::reference::{MAX_LIGHTS, References, judged_lights, references};
use crate::report::{Candidate, DeviceEntry, OK, ReferenceEntry, Report, Run, Settings, Temporal, decide, to_csv};
use crate::settled::settle;
use crate::staging::{MANIFEST, PAGE, Staging};
use crate::subject::Subject;
use crate::temporal::Sequences;
use crate::{CompareOptions, LabError, Progress, ReferenceStop, host};
use kajo_image::write_png;
use kajo_image_metrics::{MetricsError, MseDifference};
use kajo_render_graph::Device;
use kajo_renderer::{FrameSettings, GBufferImages, Renderer, RendererSettings, RoleSelection};
use kajo_techniques::Role;
use std::collections::BTreeMap;

/// What moving sequences add to the reference's share, for the progress bar.
const SEQUENCE_SHARE: f64 = 0.4;

/// Share of a scene's time that the reference takes, for the progress bar.
const REFERENCE_SHARE: f64 = 0.6;

/// Compares techniques on scenes and writes the report.
///
/// # Errors
/// Unknown names, scenes that cannot be loaded, no adapter, a folder that cannot be written to, an interruption before the first
/// result. A technique that cannot run, and a scene without anything to judge it by, is no error; it is listed as skipped, see
/// [`Report::nothing_compared`].
pub fn compare(options: &CompareOptions, progress: &dyn Progress) -> Result<Report, LabError> {
    let plan = plan(options)?;
    let staging = Staging::new(&options.output)?;
    let device = Device::new()?;
    let threads = options.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| LabError::NotMeasured { reason: e.to_string() })?;
    let report = Report {
        kajo: env!("CARGO_PKG_VERSION").into(),
        command: options.command(),
        created: host::now(),
        complete: true,
        device: Some(device_entry(&device)),
        host: host::host(threads),
        settings: settings(options),
        warnings: warnings(options, &device),
        ..Report::default()
    };
    let mut experiment = Experiment { options, plan, device, pool, progress, staging, report, pictures: Pictures::default() };
    for index in 0..options.scenes.len() {
        if !experiment.scene(index)? {
            experiment.report.complete = false;
            break;
        }
    }
    if experiment.report.runs.iter().all(|run| !run.is_ok()) && !experiment.report.complete {
        return Err(LabError::Interrupted);
    }
    experiment.finish()
}

fn device_entry(device: &Device) -> DeviceEntry {
    let info = device.info();
    DeviceEntry {
        name: info.name.clone(),
        driver: info.driver.clone(),
        kind: info.kind.into(),
        backend: info.backend.clone(),
        ray_query: info.ray_query,
        timestamps: info.timestamps,
    }
}

fn settings(options: &CompareOptions) -> Settings {
    let (reference_spp, reference_noise) = match options.reference {
        ReferenceStop::Spp(spp) => (Some(spp), None),
        ReferenceStop::Noise(error) => (None, Some(error)),
    };
    Settings {
        frames: options.frames,
        warm_up_frames: WARM_UP_FRAMES,
        repeat: options.repeat,
        budget_ms: options.budget_ms,
        seed: options.seed,
        reference_spp,
        reference_noise,
        time: options.time,
        temporal: options.temporal,
    }
}

fn warnings(options: &CompareOptions, device: &Device) -> Vec<String> {
    let mut out = Vec::new();
    if device_entry(device).is_software() {
        out.push("Times are those of a software adapter: a processor plays the GPU. Errors are valid; times rank techniques on this machine only.".into());
    }
    if !device.info().timestamps {
        out.push("The device has no timers: passes are timed from outside, which adds the cost of a submission to each.".into());
    }
    if options.repeat == 1 {
        out.push(
            "One repeat: bias and noise are not told apart, and the spread over seeds is missing from how sure a recommendation is.".into(),
        );
    }
    out
}

struct Experiment<'a> {
    options: &'a CompareOptions,
    plan: Plan,
    device: Device,
    pool: rayon::ThreadPool,
    progress: &'a dyn Progress,
    staging: Staging,
    report: Report,
    pictures: Pictures,
}

/// A scene on the device, and what is seen of it.
struct OnDevice {
    renderer: Renderer,
    gbuffer: Option<GBufferImages>,
    /// Where the judged lights are.
    lights: Vec<LightPlace>,
}

impl OnDevice {
    /// How a shadow technique fails; `None` for other roles.
    fn failures(&self, judge: &Judge, takes: &[Take]) -> Result<Option<Failures>, MetricsError> {
        let gbuffer = self.gbuffer.as_ref().filter(|_| judge.kind == Kind::Visibility);
        gbuffer.map(|gbuffer| Failures::new(judge, &mean_parts(takes), gbuffer, &self.lights)).transpose()
    }
}

impl Experiment<'_> {
    /// All roles of one scene. False when interrupted.
    fn scene(&mut self, index: usize) -> Result<bool, LabError> {
        let count = self.options.scenes.len() as f64;
        let share = |f: f64| (index as f64 + f) / count;
        self.progress.at("scene", share(0.0));
        let subject = Subject::load(self.options, index)?;
        self.report.ignored.extend(subject.scene.ignored.iter().cloned());
        let tracer = subject.tracer()?;
        let roles: Vec<&str> = self.plan.iter().map(|(role, _)| role.id()).collect();
        let settings = subject.tracer_settings(self.options);
        let reference_share = |f: f64| share(f * REFERENCE_SHARE);
        let rendered =
            self.pool.install(|| references(&tracer, &roles, &settings, self.options.reference, self.progress, &reference_share))?;
        let Some(mut references) = rendered else { return Ok(false) };
        if let Some(judge) = references.judges.get_mut(Role::DirectVisibility.id())
            && !self.pool.install(|| settle(judge, &tracer, &settings, self.progress))?
        {
            return Ok(false);
        }
        self.warn_about(&subject, &references, tracer.visibility_light_names().count());

        let mut sequences = None;
        if self.options.temporal > 0 {
            let part = |f: f64| share(REFERENCE_SHARE * (1.0 + SEQUENCE_SHARE * f));
            let made = Sequences::new(&subject, &roles, self.options, (&self.device, &self.pool), self.progress, &part)?;
            let Some(made) = made else { return Ok(false) };
            sequences = Some(made);
        }
        let mut renderer = self.renderer(&subject, &judged_lights(&tracer));
        let total: usize = self.plan.iter().map(|(_, choices)| choices.len()).sum();
        let mut done = 0;
        for (role, choices) in self.plan.clone() {
            let Some(judge) = references.judges.get(role.id()) else {
                for choice in &choices {
                    self.skip(new_run(&subject, role, choice), NEEDS_A_LIGHT);
                }
                done += choices.len();
                continue;
            };
            let slug = self.reference(&subject, role, judge, &references)?;
            let mut evaluated = Vec::new();
            for choice in &choices {
                let begun = REFERENCE_SHARE * if sequences.is_some() { 1.0 + SEQUENCE_SHARE } else { 1.0 };
                let fraction = begun + (1.0 - begun) * done as f64 / total as f64;
                self.progress.at(choice.technique.id, share(fraction));
                if self.progress.interrupted() {
                    self.decide(&subject, role, judge, &evaluated);
                    return Ok(false);
                }
                let run = self.run(&subject, role, choice, judge, renderer.as_mut(), &slug)?;
                if let (Some((run, _)), Some(sequences)) = (&run, &mut sequences) {
                    self.watch_motion(*run, sequences, role, choice)?;
                }
                evaluated.extend(run);
                done += 1;
            }
            self.decide(&subject, role, judge, &evaluated);
        }
        self.progress.at("scene", share(1.0));
        Ok(true)
    }

    fn warn_about(&mut self, subject: &Subject, references: &References, lights: usize) {
        let name = &subject.name;
        let mut warn = |text: String| self.report.warnings.push(text);
        if references.invalid_samples > 0 {
            warn(format!("{name}: {} samples of the reference were NaN or infinite and count as black.", references.invalid_samples));
        }
        for part in references.judges.values().filter(|judge| judge.kind == Kind::Visibility).flat_map(Judge::unseen_parts) {
            let light = part.strip_prefix("visibility.").unwrap_or(part);
            warn(format!(
                "{name}: nothing in the picture sees the light {light}, so its visibility tells no technique from another; a shade around it, or \
                 glass, which is opaque to shadow rays, hides it."
            ));
        }
        if lights > MAX_LIGHTS {
            warn(format!("{name}: visibility is judged for the {MAX_LIGHTS} strongest of {lights} lights."));
        }
    }

    /// The scene on the device, after one frame that makes what all techniques share; or the reason why not. `lights` are judged.
    fn renderer(&mut self, subject: &Subject, lights: &[usize]) -> Result<OnDevice, String> {
        let ray_culling = self.options.ray_culling;
        let settings = RendererSettings { camera: subject.camera, ray_culling, ..RendererSettings::new(subject.size) };
        let made = Renderer::new(&self.device, &subject.scene, &subject.snapshot, settings).and_then(|mut renderer| {
            renderer.watch(lights);
            let seen = renderer.render(&RoleSelection::new(), &FrameSettings { gbuffer: true, ..FrameSettings::default() })?;
            Ok(OnDevice { renderer, gbuffer: seen.gbuffer, lights: places(&subject.scene, &subject.snapshot, lights) })
        });
        match made {
            Ok(on_device) => {
                let new: Vec<_> = on_device.renderer.ignored().into_iter().filter(|i| !self.report.ignored.contains(i)).collect();
                self.report.ignored.extend(new);
                Ok(on_device)
            }
            Err(error) => Err(error.to_string()),
        }
    }

    /// Files and entry of a role's reference; returns the folder of its images.
    fn reference(&mut self, subject: &Subject, role: Role, judge: &Judge, found: &References) -> Result<String, LabError> {
        let folder = format!("images/{}/{}", subject.slug, role.id());
        let shown = reference_pictures(judge);
        let mut files = BTreeMap::new();
        let mut file = |kind: &str, end: &str| {
            let file = format!("{folder}/reference{end}");
            files.insert(kind.to_owned(), file.clone());
            self.staging.place(&file)
        };
        write_png(&file("png", ".png")?, &shown.image, &BTreeMap::new())?;
        if let Some(composed) = &shown.composed {
            write_png(&file("composed", "-composed.png")?, composed, &BTreeMap::new())?;
        }
        reference_exr(judge).write(&file("exr", ".exr")?)?;
        self.pictures.references.push(Some(shown));
        self.report.references.push(ReferenceEntry {
            scene: subject.name.clone(),
            role: role.id().into(),
            role_title: role.title().into(),
            estimates: role.estimates().into(),
            ambient_distance: (role == Role::AmbientVisibility).then_some(subject.ambient_distance),
            unit: role.unit().into(),
            judged_by: judge.parts.iter().map(|p| p.name.clone()).collect(),
            size: judge.size().to_array(),
            spp: found.renderings[role.id()].spp,
            relative_standard_error: judge.relative_standard_error(),
            rmse_floor: judge.floor(),
            seconds: found.renderings[role.id()].seconds,
            rays: found.renderings[role.id()].rays,
            images: files,
        });
        Ok(folder)
    }

    /// One run; `None` when it was skipped.
    fn run(
        &mut self,
        subject: &Subject,
        role: Role,
        choice: &Choice,
        judge: &Judge,
        on_device: Result<&mut OnDevice, &mut String>,
        folder: &str,
    ) -> Result<Option<(usize, Evaluation)>, LabError> {
        let mut run = new_run(subject, role, choice);
        let what = format!("{}, {}", run.scene, run.label());
        let result = match (choice.technique.missing(&self.device), on_device) {
            (Some(needs), _) => Err(format!("needs {needs}")),
            (_, Err(reason)) => Err(reason.clone()),
            (None, Ok(on_device)) => {
                let seeds = (self.options.seed, self.options.frames, self.options.repeat);
                let seen = Seen { ambient_distance: subject.ambient_distance };
                let measured = measure(&mut on_device.renderer, role, choice, seeds, seen).map_err(|e| e.to_string());
                measured.and_then(|m| Ok((on_device.failures(judge, &m.takes).map_err(|e| e.to_string())?, m)))
            }
        };
        // An image that cannot be judged (NaN in it) is a fault of the technique: it is shown, and the others go on.
        let judged = result.and_then(|(f, m)| evaluate(judge, &m.takes, &what).map(|e| (m, f, e)).map_err(|e| e.to_string()));
        let (measured, failures, evaluation) = match judged {
            Ok(both) => both,
            Err(reason) => {
                self.skip(run, &reason);
                return Ok(None);
            }
        };
        self.files(&mut run, judge, &measured.takes[0], (&evaluation, failures.as_ref()), folder)?;
        run.failures = failures.map(|failures| failures.by_id()).unwrap_or_default();
        run.error = Some(evaluation.error.clone());
        run.temporal = evaluation.temporal.clone();
        let new: Vec<_> = measured.ignored.into_iter().filter(|i| !self.report.ignored.contains(i)).collect();
        self.report.ignored.extend(new);
        run.cost = Some(measured.cost);
        self.report.runs.push(run);
        Ok(Some((self.report.runs.len() - 1, evaluation)))
    }

    /// Behaviour on moving sequences; a failure of the device there takes nothing from the rest.
    fn watch_motion(&mut self, index: usize, sequences: &mut Sequences, role: Role, choice: &Choice) -> Result<(), LabError> {
        let run = &mut self.report.runs[index];
        let (temporal, films) = match sequences.measure(role, choice) {
            Ok(measured) => measured,
            Err(error) => {
                self.report.warnings.push(format!("{}, {}: no moving sequence: {error}", run.scene, run.label()));
                return Ok(());
            }
        };
        run.temporal = Temporal { still_flicker: run.temporal.still_flicker, ..temporal };
        for film in &films {
            let kind = format!("film-{}", film.motion);
            let file = format!("{}-{kind}.png", run.images["png"].trim_end_matches(".png"));
            write_png(&self.staging.place(&file)?, &film.image, &BTreeMap::new())?;
            run.images.insert(kind, file);
        }
        if let Some(Some(pictures)) = self.pictures.runs.get_mut(index) {
            pictures.films = films;
        }
        Ok(())
    }

    fn skip(&mut self, run: Run, reason: &str) {
        self.report.runs.push(Run { status: format!("skipped: {reason}"), ..run });
        self.pictures.runs.push(None);
    }

    fn files(
        &mut self,
        run: &mut Run,
        judge: &Judge,
        take: &Take,
        (evaluation, failures): (&Evaluation, Option<&Failures>),
        folder: &str,
    ) -> Result<(), LabError> {
        let shown = pictures(judge, take, evaluation, failures);
        let name = format!("{folder}/{:02}-{}", self.report.runs.len() + 1, slug(&run.label()));
        let mut file = |kind: &str, end: &str| {
            let file = format!("{name}{end}");
            run.images.insert(kind.to_owned(), file.clone());
            self.staging.place(&file)
        };
        write_png(&file("png", ".png")?, &shown.image, &BTreeMap::new())?;
        if let Some(composed) = &shown.composed {
            write_png(&file("composed", "-composed.png")?, composed, &BTreeMap::new())?;
        }
        write_png(&file("heatmap", "-error.png")?, &shown.heat, &BTreeMap::new())?;
        if let Some(failures) = &shown.failures {
            write_png(&file("failures", "-failures.png")?, failures, &BTreeMap::new())?;
        }
        run_exr(judge, take, evaluation).write(&file("exr", ".exr")?)?;
        self.pictures.runs.push(Some(shown));
        Ok(())
    }

    fn decide(&mut self, subject: &Subject, role: Role, judge: &Judge, evaluated: &[(usize, Evaluation)]) {
        let candidate = |(run, evaluation): &(usize, Evaluation)| Candidate {
            run: *run,
            label: self.report.runs[*run].label(),
            mse: evaluation.error.image.mse,
            ms: self.report.runs[*run].cost.as_ref().map_or(f64::INFINITY, |c| c.ms()),
            distinguishable: evaluation.error.image.distinguishable != Some(false),
        };
        let candidates: Vec<Candidate> = evaluated.iter().map(candidate).collect();
        let between = |a: usize, b: usize| {
            difference(judge, (&evaluated[a].1, &candidates[a]), (&evaluated[b].1, &candidates[b]))
                .unwrap_or(MseDifference { value: candidates[a].mse - candidates[b].mse, standard_error: 0.0 })
        };
        self.report.decisions.push(decide(&subject.name, role.id(), &candidates, self.options.budget_ms, between));
    }

    fn finish(mut self) -> Result<Report, LabError> {
        const TABLE: &str = "table.csv";
        self.report.files = self.staging.files();
        self.report.files.extend([PAGE, MANIFEST, TABLE].map(str::to_owned));
        self.staging.write(TABLE, to_csv(&self.report).as_bytes())?;
        let json = serde_json::to_vec_pretty(&self.report).expect("a report has only text keys");
        self.staging.write(MANIFEST, &json)?;
        self.staging.write(PAGE, page(&self.report, &self.pictures).as_bytes())?;
        self.staging.publish()?;
        Ok(self.report)
    }
}

/// Why a role has no judge: those of the other roles are images of every scene.
const NEEDS_A_LIGHT: &str = "needs a light with a place or a direction: the scene has no point, spot, directional or area light and no \
                             emissive mesh; an environment is none";

fn new_run(subject: &Subject, role: Role, choice: &Choice) -> Run {
    Run {
        scene: subject.name.clone(),
        role: role.id().into(),
        technique: choice.technique.id.into(),
        title: choice.technique.title.into(),
        params: choice.params.to_json(),
        changed_params: choice.changed_params(),
        status: OK.into(),
        ..Run::default()
    }
}

/// A name for files: letters, digits, dots, hyphens.
pub(crate) fn slug(text: &str) -> String {
    let mapped: String = text.chars().map(|c| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' }).collect();
    let trimmed = mapped.trim_matches(['-', '.']);
    if trimmed.is_empty() { "unnamed".into() } else { trimmed.to_owned() }
}
