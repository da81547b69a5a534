//! `kajo render --renderer reference`: the path tracer, with progress, checkpoints and statistics.

use super::denoise;
use super::shadow_class::{self, Classes};
use super::write::{Picture, provenance};
use crate::arguments::{Common, Render};
use crate::failure::{Failure, Outcome};
use crate::path_tracing::{self, DEFAULT_SPP, in_pool, max_depth};
use crate::{output, progress, view};
use indicatif::ProgressBar;
use kajo_image::Layer;
use kajo_path_tracer::{Aov, Control, Film, Filter, Frame, FrameImage, PathTracerError, Pixels, Progress, Settings, Stop, Tracer, render};
use kajo_scene::{Scene, Snapshot};
use kajo_units::Seconds;
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Time between two writes of the checkpoint.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(30);

/// Renders the scene at `time` into `output`.
pub fn run(common: &Common, arguments: &Render, scene: &Scene, time: f64, output: &Path) -> Outcome {
    let started = Instant::now();
    let (snapshot, camera) = view::snapshot(scene, &arguments.view, time)?;
    let size = arguments.size.map_or_else(|| snapshot.cameras[camera].camera.default_image_size(), |size| size.0);
    let previous = Snapshot::new(scene, Seconds((time - 1.0 / arguments.fps) as f32));
    let tracer = path_tracing::tracer(scene, snapshot, &arguments.tracing)?.with_previous(previous)?;
    let build_seconds = started.elapsed().as_secs_f64();

    let wanted = aovs(&arguments.aov, &tracer, max_depth(&arguments.tracing))?;
    let settings = Settings {
        integrator: arguments.integrator.unwrap_or_default(),
        adaptive: arguments.adaptive,
        ambient_distance: arguments.view.ambient_distance.map_or(f32::INFINITY, |distance| distance as f32),
        aovs: with_sources(if arguments.denoise { denoise::with_features(&wanted) } else { wanted.clone() }, &arguments.aov),
        ..path_tracing::settings(&arguments.tracing, size, camera, arguments.spp.unwrap_or(DEFAULT_SPP))
    };
    let settings = match arguments.tracing.filter {
        // Classes are of points.
        None if shadow_class::is_asked(&arguments.aov) => {
            if !common.quiet && !shadow_class::is_picture(arguments) {
                eprintln!(
                    "note: shadow classes are of points: all images are sampled at pixel centres, without anti-aliasing; --filter chooses otherwise"
                );
            }
            Settings { filter: Filter::Center, ..settings }
        }
        _ => settings,
    };
    let tracer = tracer.with_culling(arguments.view.ray_culling, &settings)?;
    let film = resumed(arguments)?;
    let watch = Watch::new(common, arguments.checkpoint.clone(), output);
    let film = in_pool(arguments.tracing.threads, || render(&tracer, &settings, stop(arguments), film, &watch))?.map_err(failure)?;
    watch.bar.finish_and_clear();
    if let Some(path) = &arguments.checkpoint {
        film.save(path)?;
    }
    if film.spp() == 0 {
        return Err(Failure::run("interrupted before every pixel had a sample; nothing was written"));
    }

    let frame = film.develop();
    // A picture that cannot be denoised is written as it is before the command fails.
    let (denoised, refused) = match arguments.denoise.then(|| in_pool(arguments.tracing.threads, || denoise::run(&frame))).transpose()? {
        Some(Ok(denoised)) => (Some(denoised), None),
        Some(Err(failure)) => (None, Some(failure)),
        None => (None, None),
    };
    let stats = stats(arguments, &frame, build_seconds, tracer.bvh_bytes(), denoised.as_ref().map(|denoised| denoised.seconds));
    let mut metadata = provenance();
    let filter = Filter::ALL.iter().find(|(_, filter)| *filter == settings.filter).map_or("", |(name, _)| name);
    metadata.insert("filter".into(), filter.into());
    metadata.extend(stats.as_object().into_iter().flatten().map(|(key, value)| (key.clone(), value.to_string())));
    let image = denoised.as_ref().map_or(frame.beauty(), |denoised| &denoised.image);
    let classes = classes(&frame, &arguments.aov)?;
    match &classes[..] {
        [one] if shadow_class::is_picture(arguments) => shadow_class::write(one, metadata, output, common.quiet || common.json)?,
        _ => {
            let layers = layers(&frame, &wanted, denoised.is_some()).into_iter().chain(classes.iter().map(Classes::layer)).collect();
            Picture { image, layers, metadata, scene_exposure: scene.exposure }.write(arguments, output)?;
        }
    }
    if let Some(path) = &arguments.stats {
        kajo_image::write_atomic(path, serde_json::to_string_pretty(&stats)?.as_bytes())?;
    }
    say(common, &frame, &stats, output)?;
    if progress::interrupted() {
        return Err(Failure::run(format!("interrupted at {} samples per pixel; {} holds what was rendered", frame.spp, output.display())));
    }
    match refused {
        Some(Failure::Run(error) | Failure::Usage(error)) => {
            Err(Failure::Run(error.context(format!("{} was not denoised: it holds the noisy picture", output.display()))))
        }
        None => Ok(()),
    }
}

/// An image that does not exist is wrong usage.
fn failure(error: PathTracerError) -> Failure {
    match error {
        PathTracerError::Aov { .. } => Failure::Usage(error.into()),
        other => other.into(),
    }
}

fn stop(arguments: &Render) -> Stop {
    match (arguments.spp, arguments.time, arguments.noise) {
        (_, Some(time), _) => Stop::at_time(time),
        (_, _, Some(noise)) => Stop::at_noise(noise as f32),
        (spp, _, _) => Stop::at_spp(spp.unwrap_or(DEFAULT_SPP)),
    }
}

/// The images of `--aov`; `all` is every one, with the bounces that are worth a layer.
fn aovs(words: &[String], tracer: &Tracer, max_depth: u32) -> Outcome<Vec<Aov>> {
    const MAX_BOUNCE_LAYERS: u32 = 8;
    let mut aovs: Vec<Aov> = Vec::new();
    let derived = |word: &&str| shadow_class::light_of(word).is_some();
    for word in words.iter().map(|word| word.trim()).filter(|word| !word.is_empty() && *word != "beauty" && !derived(word)) {
        if word == "all" {
            aovs.extend(tracer.all_aovs(max_depth.min(MAX_BOUNCE_LAYERS)));
        } else {
            aovs.push(word.parse().map_err(failure)?);
        }
    }
    let mut unique = Vec::new();
    aovs.into_iter().for_each(|aov| {
        if !unique.contains(&aov) {
            unique.push(aov)
        }
    });
    Ok(unique)
}

/// The images, with those that classes are derived from.
fn with_sources(mut aovs: Vec<Aov>, words: &[String]) -> Vec<Aov> {
    let lights = words.iter().filter_map(|word| shadow_class::light_of(word));
    let sources = lights.flat_map(|light| [Aov::Visibility(light.to_owned()), Aov::Coverage]);
    sources.for_each(|source| {
        if !aovs.contains(&source) {
            aovs.push(source);
        }
    });
    aovs
}

/// Umbra, penumbra and lit of each light that was asked for.
fn classes(frame: &Frame, words: &[String]) -> Outcome<Vec<Classes>> {
    let scalar = |image: &FrameImage| match &image.pixels {
        Pixels::Scalar(pixels) => Some(pixels.clone()),
        Pixels::Color(_) | Pixels::Vector(_) => None,
    };
    let Some(coverage) = frame.image(&Aov::Coverage.to_string()).and_then(scalar) else { return Ok(Vec::new()) };
    let seen = coverage.map(|share| *share > 0.5);
    let asked = |light: &str| words.iter().filter_map(|word| shadow_class::light_of(word)).any(|word| word == "*" || word == light);
    let visibilities = frame.images.iter().filter_map(|image| Some((image.name.strip_prefix("visibility.")?, scalar(image)?)));
    visibilities.filter(|(light, _)| asked(light)).map(|(light, visibility)| Classes::new(light, &visibility, &seen)).collect()
}

/// The film of `--resume`.
fn resumed(arguments: &Render) -> Outcome<Option<Film>> {
    let Some(path) = &arguments.checkpoint else { return Ok(None) };
    match (arguments.resume, path.exists()) {
        (true, true) => Ok(Some(Film::load(path)?)),
        (true, false) => {
            eprintln!("note: there is no checkpoint {} yet; rendering from the start", path.display());
            Ok(None)
        }
        (false, true) => {
            let path = path.display();
            Err(Failure::run(format!("the checkpoint {path} exists already; add --resume to go on with it, or delete it to start anew")))
        }
        (false, false) => Ok(None),
    }
}

/// Shows progress, listens to Ctrl-C, and keeps the checkpoint fresh.
struct Watch {
    bar: ProgressBar,
    checkpoint: Option<PathBuf>,
    saved: Mutex<Instant>,
}

impl Watch {
    fn new(common: &Common, checkpoint: Option<PathBuf>, output: &Path) -> Self {
        let name = output.file_name().unwrap_or_default().to_string_lossy();
        Self { bar: progress::bar(common.quiet, &name), checkpoint, saved: Mutex::new(Instant::now()) }
    }
}

impl Control for Watch {
    fn progress(&self, progress: &Progress) -> ControlFlow<()> {
        self.bar.set_position((progress.fraction * 1000.0) as u64);
        let error = progress.relative_standard_error.filter(|error| error.is_finite());
        let error = error.map_or_else(String::new, |error| format!(", error {:.2} %", error * 100.0));
        self.bar.set_message(format!("{} spp{error}", progress.spp));
        if progress::interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn pass(&self, film: &Film) {
        let Some(path) = &self.checkpoint else { return };
        let mut saved = self.saved.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if saved.elapsed() < CHECKPOINT_EVERY {
            return;
        }
        if let Err(error) = film.save(path) {
            tracing::warn!("{error}");
        }
        *saved = Instant::now();
    }
}

/// The `wanted` images, each followed by its variance where that is known; before them the noisy picture where another stands in its place.
fn layers(frame: &Frame, wanted: &[Aov], denoised: bool) -> Vec<Layer> {
    let picture = if denoised { "noisy" } else { "beauty" };
    let is_wanted = |name: &str| name == "beauty" || wanted.iter().any(|aov| is_image_of(name, &aov.to_string()));
    let of_image = |image: &kajo_path_tracer::FrameImage| {
        let name = if image.name == "beauty" { picture } else { &image.name };
        let variance = image.variance.as_ref().map(|variance| variance.to_layer(&format!("{name}.variance")));
        let own = (name != "beauty").then(|| image.pixels.to_layer(name));
        own.into_iter().chain(variance)
    };
    frame.images.iter().filter(|image| is_wanted(&image.name)).flat_map(of_image).collect()
}

/// Whether an image is what was asked for; `visibility.*` asks for those of every light.
fn is_image_of(name: &str, wanted: &str) -> bool {
    name == wanted || wanted.strip_suffix('*').is_some_and(|start| name.starts_with(start))
}

fn stats(arguments: &Render, frame: &Frame, build_seconds: f64, bvh_bytes: usize, denoise_seconds: Option<f64>) -> Value {
    let per_second = |count: u64| count as f64 / frame.seconds.max(1e-9);
    let finite = |value: f32| if value.is_finite() { json!(value) } else { Value::Null };
    let mut stats = json!({
        "scene": arguments.scene,
        "width": frame.size.x,
        "height": frame.size.y,
        "spp": frame.spp,
        "max_depth": max_depth(&arguments.tracing),
        "seed": arguments.tracing.seed,
        "samples": frame.samples,
        "rays": frame.rays,
        "render_seconds": frame.seconds,
        "build_seconds": build_seconds,
        "samples_per_s": per_second(frame.samples),
        "rays_per_s": per_second(frame.rays),
        "relative_standard_error": finite(frame.relative_standard_error),
        "mean_luminance": frame.mean_luminance.0,
        "mean_luminance_confidence_95": finite(frame.mean_luminance.1),
        "invalid_samples": frame.invalid_samples,
        "bvh_bytes": bvh_bytes,
    });
    if let Some(seconds) = denoise_seconds {
        stats["denoise_seconds"] = json!(seconds);
    }
    stats
}

fn say(common: &Common, frame: &Frame, stats: &Value, path: &Path) -> Outcome {
    if frame.invalid_samples > 0 {
        tracing::warn!("{} samples were not finite and count as black; please report this scene", frame.invalid_samples);
    }
    if common.json {
        return output::json(stats);
    }
    if common.quiet {
        return Ok(());
    }
    let noise = match frame.relative_standard_error {
        error if error.is_finite() => format!("relative standard error {:.2} %", error * 100.0),
        _ => "unknown standard error".into(),
    };
    let speed = frame.samples as f64 / frame.seconds.max(1e-9) / 1e6;
    let denoised = stats["denoise_seconds"].as_f64().map_or(String::new(), |seconds| format!(" before it was denoised in {seconds:.1} s"));
    output::text(&format!("{}: {} spp in {:.1} s ({speed:.2} Msamples/s), {noise}{denoised}\n", path.display(), frame.spp, frame.seconds))
}
