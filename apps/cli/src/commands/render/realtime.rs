//! `kajo render --renderer realtime`: one frame of the real-time renderer with chosen techniques, or the mean of `--spp` frames.

use super::shadow_class::{self, Classes};
use super::write::{Picture, provenance};
use crate::arguments::{Common, Render};
use crate::failure::{Failure, Outcome};
use crate::{output, view};
use kajo_image::{ExrFile, Layer, ToneMap, tone_map, write_png};
use kajo_params::ParamValues;
use kajo_render_graph::Device;
use kajo_renderer::{FrameOutput, FrameSettings, GBufferImages, Read, Renderer, RendererSettings, RoleSelection};
use kajo_scene::Scene;
use kajo_techniques::{DebugPixels, DebugView, Error, Role};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

/// Renders the scene at `time` into `output`.
pub fn run(common: &Common, arguments: &Render, scene: &Scene, time: f64, output: &Path) -> Outcome {
    let roles = roles(&arguments.technique)?;
    let (snapshot, camera) = view::snapshot(scene, &arguments.view, time)?;
    let (previous, _) = view::snapshot(scene, &arguments.view, time - 1.0 / arguments.fps)?;
    let size = arguments.size.map_or_else(|| snapshot.cameras[camera].camera.default_image_size(), |size| size.0);
    let device = Device::new()?;
    let settings = RendererSettings { camera, ray_culling: arguments.view.ray_culling, ..RendererSettings::new(size) };
    let mut renderer = Renderer::new(&device, scene, &snapshot, settings)?;
    renderer.set_snapshot(&snapshot, &previous)?;
    let seed = arguments.tracing.seed as u32;
    if arguments.aov.is_empty() {
        renderer.watch(&[]);
    }
    let begin = Instant::now();
    let settings = FrameSettings {
        index: seed,
        gbuffer: !arguments.aov.is_empty(),
        read: if arguments.aov.is_empty() { Read::Nothing } else { Read::Every },
        ambient_distance: arguments.view.ambient_distance.map_or(f32::INFINITY, |distance| distance as f32),
        debug: arguments.debug.is_some(),
        ..Default::default()
    };
    let frame = match arguments.spp {
        Some(count) if count > 1 => renderer.accumulate(&roles, &settings, count)?,
        _ => renderer.render(&roles, &settings)?,
    };
    let points = points(&mut renderer, &roles, &settings, arguments)?;
    if !common.quiet {
        if points.is_some() {
            eprintln!("note: shadow classes are of a frame of their own at pixel centres; the other images are as without them");
        }
        frame.ignored.iter().for_each(|ignored| eprintln!("note: {ignored}"));
    }
    if let Some(folder) = &arguments.debug {
        if frame.debug.is_empty() && !common.quiet {
            let id =
                roles.technique(Role::DirectVisibility).map_or("the technique of the role direct visibility", |technique| technique.id);
            eprintln!("note: {id} has no debug views; nothing is written to {}", folder.display());
        }
        write_debug_views(folder, &frame.debug, renderer.light_names())?;
    }
    let stats = stats(&device, &renderer, &roles, &frame, begin.elapsed().as_secs_f64());

    let mut metadata = provenance();
    metadata.insert("adapter".into(), device.info().name.clone());
    let classes = classes(points.as_ref().unwrap_or(&frame), renderer.light_names(), &arguments.aov)?;
    let light = arguments.aov.first().and_then(|word| shadow_class::light_of(word)).filter(|_| shadow_class::is_picture(arguments));
    let mut layers = layers(&frame, renderer.light_names());
    layers.extend(classes.iter().map(Classes::layer));
    let layers = chosen_layers(&arguments.aov, layers)?;
    match light.and_then(|light| classes.iter().find(|classes| classes.light() == light)) {
        Some(one) => shadow_class::write(one, metadata, output, common.quiet || common.json)?,
        None => Picture { image: &frame.color, layers, metadata, scene_exposure: scene.exposure }.write(arguments, output)?,
    }
    if let Some(path) = &arguments.stats {
        kajo_image::write_atomic(path, serde_json::to_string_pretty(&stats)?.as_bytes())?;
    }
    if common.json {
        return output::json(&stats);
    }
    if common.quiet {
        return Ok(());
    }
    output::text(&format!("{}: {:.2} ms on {}\n", output.display(), frame.timings.total_ms(), device.info().name))
}

/// The frame that classes are of where the picture's is no image of points at pixel centres: the mean of several, or smoothed between frames.
fn points(renderer: &mut Renderer, roles: &RoleSelection, settings: &FrameSettings, arguments: &Render) -> Outcome<Option<FrameOutput>> {
    let centred = kajo_techniques::default_of(Role::AntiAlias).expect("each role has a technique");
    let is_centred =
        arguments.spp.is_none_or(|count| count <= 1) && roles.technique(Role::AntiAlias).is_none_or(|chosen| chosen.id == centred.id);
    if is_centred || !shadow_class::is_asked(&arguments.aov) {
        return Ok(None);
    }
    Ok(Some(renderer.render(&roles.clone().with(centred, ParamValues::defaults(centred.params)), settings)?))
}

/// Writes each picture twice: as a display shows it, and with its numbers. The light's number in its name tells lights whose names look alike in a file's;
/// without pictures no folder is made.
fn write_debug_views(folder: &Path, views: &[DebugView], lights: &[String]) -> Outcome {
    if views.is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(folder).map_err(|reason| Failure::run(format!("cannot make the folder {}: {reason}", folder.display())))?;
    for view in views {
        let name = match lights.get(view.light as usize) {
            Some(light) => format!("{}.{}.{}", view.name, view.light, slug(light)),
            None => view.name.to_owned(),
        };
        let picture = view.pixels.to_color();
        write_png(&folder.join(format!("{name}.png")), &tone_map(&picture, 0.0, ToneMap::Linear), &provenance())?;
        let mut file = ExrFile::new(picture.size());
        file.layers.push(match &view.pixels {
            DebugPixels::Scalar(image) => Layer::scalar("", image),
            DebugPixels::Color(image) => Layer::color("", image),
        });
        file.metadata = provenance();
        file.write(&folder.join(format!("{name}.exr")))?;
    }
    Ok(())
}

/// A light's name as part of a file's.
fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '-' }).collect()
}

/// The techniques of `--technique`, the default of each role elsewhere.
fn roles(words: &[String]) -> Outcome<RoleSelection> {
    let usage = |error: Error| Failure::Usage(error.into());
    let mut roles = RoleSelection::new();
    for word in words {
        let (role, rest) = word
            .split_once('=')
            .filter(|(role, _)| !role.contains(['/', ':']))
            .ok_or_else(|| Failure::usage(format!("--technique takes ROLE=ID[:param=value,…]; got `{word}`")))?;
        let role: Role = role.parse().map_err(usage)?;
        let (technique, params) = kajo_techniques::parse(rest).map_err(usage)?;
        if technique.role != role {
            return Err(Failure::usage(format!("{} fills the role {}, not {role}", technique.id, technique.role)));
        }
        if role == Role::ToneMap {
            return Err(Failure::usage("the tone map is chosen by --tone-map"));
        }
        roles = roles.with(technique, params);
    }
    Ok(roles)
}

/// Everything the frame left, under the names that the path tracer's images have.
fn layers(frame: &FrameOutput, lights: &[String]) -> Vec<Layer> {
    let mut layers = vec![Layer::color("direct", &frame.direct)];
    layers.extend(lights.iter().zip(&frame.visibility).map(|(name, image)| Layer::scalar(format!("visibility.{name}"), image)));
    layers.extend(frame.estimates.iter().map(|(role, image)| match role {
        Role::AmbientVisibility => Layer::scalar(role.judged_by(), &image.map(|v| v.0.x)),
        _ => Layer::color(role.judged_by(), image),
    }));
    if let Some(GBufferImages { depth, position, shading_normal, normal, albedo, motion, instance, material, .. }) = &frame.gbuffer {
        let id = |image: &kajo_image::Image<Option<u32>>| image.map(|id| id.map_or(-1.0, |id| id as f32));
        layers.extend([
            Layer::color("albedo", albedo),
            Layer::vector("normal", normal),
            Layer::vector("shading-normal", shading_normal),
            Layer::scalar("depth", depth),
            Layer::vector("position", position),
            Layer::vector("motion", &motion.map(|m| m.extend(0.0))),
            Layer::scalar("instance-id", &id(instance)),
            Layer::scalar("material-id", &id(material)),
        ]);
    }
    layers
}

/// Umbra, penumbra and lit of each light that `words` ask them of.
fn classes(frame: &FrameOutput, lights: &[String], words: &[String]) -> Outcome<Vec<Classes>> {
    let Some(gbuffer) = &frame.gbuffer else { return Ok(Vec::new()) };
    let seen = gbuffer.depth.map(|depth| depth.is_finite());
    let asked = |light: &str| words.iter().filter_map(|word| shadow_class::light_of(word)).any(|word| word == "*" || word == light);
    let of_lights = lights.iter().zip(&frame.visibility).filter(|(light, _)| asked(light));
    of_lights.map(|(light, visibility)| Classes::new(light, visibility, &seen)).collect()
}

/// The layers that `--aov` names; `all` is every one, `visibility.*` those of every light.
fn chosen_layers(words: &[String], layers: Vec<Layer>) -> Outcome<Vec<Layer>> {
    let matches =
        |word: &str, name: &str| word == "all" || word == name || word.strip_suffix('*').is_some_and(|start| name.starts_with(start));
    for word in words.iter().filter(|word| *word != "beauty") {
        if !layers.iter().any(|layer| matches(word, &layer.name)) {
            let known: Vec<&str> = layers.iter().map(|layer| layer.name.as_str()).collect();
            return Err(Failure::usage(format!("output image `{word}` does not exist; the real-time renderer has {}", known.join(", "))));
        }
    }
    Ok(layers.into_iter().filter(|layer| words.iter().any(|word| matches(word, &layer.name))).collect())
}

fn stats(device: &Device, renderer: &Renderer, roles: &RoleSelection, frame: &FrameOutput, seconds: f64) -> Value {
    let lights = renderer.light_names();
    let techniques: serde_json::Map<String, Value> =
        Role::ALL.iter().filter_map(|role| Some((role.id().to_string(), roles.technique(*role)?.id.into()))).collect();
    json!({
        "width": frame.color.width(),
        "height": frame.color.height(),
        "render_seconds": seconds,
        "rays": frame.rays,
        "gpu_ms": frame.timings.total_ms(),
        "passes": frame.timings.passes.iter().map(|(name, ms)| json!({ "name": name, "ms": ms })).collect::<Vec<_>>(),
        "timed_on_device": frame.timings.on_device,
        "memory_bytes": frame.memory_bytes,
        "draws": frame.draws,
        "culled_draws": frame.culled_draws,
        "statistics": frame.statistics.iter().map(|s| json!({ "name": s.name, "light": lights.get(s.light as usize), "value": s.value })).collect::<Vec<_>>(),
        "adapter": device.info().name,
        "driver": device.info().driver,
        "trace_backend": renderer.backend().id(),
        "techniques": techniques,
    })
}
