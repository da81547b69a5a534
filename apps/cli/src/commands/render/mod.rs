//! `kajo render`: one image, or a sequence of them.

mod denoise;
mod realtime;
mod reference;
mod shadow_class;
mod write;

use crate::arguments::{Common, Render, RendererChoice, SamplerChoice};
use crate::failure::{Failure, Outcome};
use crate::view;
use kajo_scene::Scene;
use std::path::{Path, PathBuf};

/// Renders and writes what was asked for.
pub fn run(common: &Common, arguments: &Render) -> Outcome {
    check(arguments)?;
    let scene = view::load_scene(&arguments.scene, &arguments.view)?;
    note_ignored(common, &scene);
    for (time, output) in frames(arguments) {
        match arguments.renderer {
            RendererChoice::Reference => reference::run(common, arguments, &scene, time, &output)?,
            RendererChoice::Realtime => realtime::run(common, arguments, &scene, time, &output)?,
        }
    }
    Ok(())
}

/// Refuses what cannot end well before anything is rendered.
fn check(arguments: &Render) -> Outcome {
    let format = write::Format::of(&arguments.output)?;
    if !arguments.aov.is_empty() && format != write::Format::Exr {
        if format == write::Format::Hdr {
            return Err(Failure::usage("--aov writes layers of one file, which only .exr has; change the name of the output"));
        }
        shadow_class::check_png(arguments)?;
    }
    if arguments.renderer == RendererChoice::Reference && !arguments.technique.is_empty() {
        return Err(Failure::usage("--technique chooses for the real-time renderer; add --renderer realtime"));
    }
    if arguments.renderer == RendererChoice::Reference && arguments.debug.is_some() {
        return Err(Failure::usage("--debug shows the inner workings of the real-time renderer; add --renderer realtime"));
    }
    let tracing = &arguments.tracing;
    let reference_only = [
        ("--time", arguments.time.is_some()),
        ("--noise", arguments.noise.is_some()),
        ("--adaptive", arguments.adaptive),
        ("--denoise", arguments.denoise),
        ("--checkpoint", arguments.checkpoint.is_some()),
        ("--integrator", arguments.integrator.is_some()),
        ("--max-depth", tracing.max_depth.is_some()),
        ("--no-rr", tracing.no_rr),
        ("--threads", tracing.threads.is_some()),
        ("--sampler", tracing.sampler.is_some()),
        ("--strategy", tracing.strategy.is_some()),
        ("--env-sampler", tracing.env_sampler.is_some()),
        ("--light-sampler", tracing.light_sampler.is_some()),
        ("--filter", tracing.filter.is_some()),
    ];
    if let Some((flag, _)) = reference_only.iter().find(|(_, given)| *given && arguments.renderer == RendererChoice::Realtime) {
        return Err(Failure::usage(format!("{flag} is for the path tracer; remove it or --renderer realtime")));
    }
    denoise::check(arguments)?;
    if arguments.adaptive && tracing.sampler == Some(SamplerChoice::BlueNoise) {
        return Err(Failure::usage(
            "--adaptive needs pixels whose random numbers are independent, which blue noise does not have; remove one of them",
        ));
    }
    let outputs: Vec<&PathBuf> = std::iter::once(&arguments.output).chain(&arguments.stats).chain(&arguments.checkpoint).collect();
    for (index, path) in outputs.iter().enumerate() {
        if outputs[..index].contains(path) {
            return Err(Failure::usage(format!(
                "{} is to be written twice; give -o, --stats and --checkpoint different names",
                path.display()
            )));
        }
        write::check_folder(path)?;
    }
    Ok(())
}

/// Times and files of the frames.
fn frames(arguments: &Render) -> impl Iterator<Item = (f64, PathBuf)> {
    let single = arguments.frames.is_none().then(|| (arguments.view.frame, arguments.output.clone()));
    let numbers = arguments.frames.into_iter().flat_map(|range| range.first..=range.last);
    single.into_iter().chain(numbers.map(|number| (f64::from(number) / arguments.fps, numbered(&arguments.output, number))))
}

/// `dir/name.0007.png`.
fn numbered(output: &Path, number: u32) -> PathBuf {
    let extension = output.extension().unwrap_or_default().to_string_lossy();
    output.with_extension(format!("{number:04}.{extension}"))
}

fn note_ignored(common: &Common, scene: &Scene) {
    if !common.quiet {
        scene.ignored.iter().for_each(|ignored| eprintln!("note: {ignored}"));
    }
}

#[cfg(test)]
mod tests {
    use super::numbered;
    use std::path::Path;

    #[test]
    fn frame_numbers_stand_before_the_ending() {
        assert_eq!(numbered(Path::new("a/b.exr"), 7), Path::new("a/b.0007.exr"));
    }
}
