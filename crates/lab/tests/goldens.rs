//! Did a picture change? Every technique of the registry, and the path tracer, against pictures stored in `crates/lab/goldens`.
//!
//! A failure leaves picture, reference and heat map in `target/goldens`. Where the change is meant, make the pictures again, look at them, and commit
//! them with the code that changed them:
//!
//! ```text
//! KAJO_GOLDENS=make cargo test --release -p kajo-lab --test goldens
//! ```
//!
//! `KAJO_GOLDENS=make:reflection.` makes those alone whose names begin so.

use glam::{UVec2, Vec3Swizzles};
use kajo_image::{Image, ToneMap, decode_image, encode_png, read_image, tone_map, write_atomic, write_png};
use kajo_image_metrics::flip::{self, PIXELS_PER_DEGREE, flip};
use kajo_image_metrics::{Palette, heat_map};
use kajo_path_tracer::{Settings, Stop, Tracer, uncontrolled};
use kajo_render_graph::Device;
use kajo_renderer::{FrameOutput, FrameSettings, Read, Renderer, RendererSettings, RoleSelection};
use kajo_scene::{Snapshot, builtin};
use kajo_techniques::{Role, Technique, TraceBackend};
use kajo_units::{LinearRgb, Seconds, Srgb8};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const SIZE: UVec2 = UVec2::new(96, 54);

/// Largest mean FLIP that passes: above twice what adapters may do (the other ray-tracing backend with samples 1/256 px off), below every fault of
/// `planted_faults_are_noticed`.
const THRESHOLD: f64 = 0.02;

const COMMAND: &str = "KAJO_GOLDENS=make cargo test --release -p kajo-lab --test goldens";

fn stored() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("goldens")
}

/// Scenes that show what techniques of a role do.
fn scenes(role: Role) -> &'static [&'static str] {
    match role {
        Role::DirectVisibility => &["shadows", "penumbra"],
        Role::AmbientVisibility => &["shadows", "two-rooms"],
        Role::DiffuseIndirect => &["cornell", "two-rooms"],
        Role::SpecularIndirect => &["glossy-floor", "mirror-room", "spheres"],
        _ => &["shadows"],
    }
}

/// Scenes that the path tracer renders: diffuse light that bounces, and glossy reflection.
const TRACED: [&str; 2] = ["cornell", "glossy-floor"];

fn file_of(technique: &Technique, scene: &str) -> String {
    format!("{}.{scene}.png", technique.id.replace('/', "."))
}

fn file_of_traced(scene: &str) -> String {
    format!("path-tracer.{scene}.png")
}

/// What a technique of the role contributes: V of each light side by side; otherwise the picture.
fn picture(role: Role, output: &FrameOutput) -> Image<Srgb8> {
    match role {
        Role::DirectVisibility => {
            let size = output.visibility[0].size();
            let lights = output.visibility.len() as u32;
            Image::from_fn(UVec2::new(size.x * lights, size.y), |x, y| {
                LinearRgb::splat(*output.visibility[(x / size.x) as usize].get(x % size.x, y)).to_srgb8()
            })
        }
        Role::AmbientVisibility => output.estimate(role).unwrap().map(|v| v.to_srgb8()),
        _ => output.display.clone(),
    }
}

fn frame(device: &Device, technique: &'static Technique, scene: &str, backend: Option<TraceBackend>, jitter: glam::Vec2) -> Image<Srgb8> {
    let scene = builtin::load(scene).unwrap();
    let snapshot = Snapshot::new(&scene, Seconds(0.0));
    let settings = RendererSettings { backend, ..RendererSettings::new(SIZE) };
    let mut renderer = Renderer::new(device, &scene, &snapshot, settings).unwrap();
    let roles = RoleSelection::new().choose(technique.id, &[]).unwrap();
    // Bright enough that every tone map has highlights to compress.
    let settings =
        FrameSettings { exposure: Some(1.5), jitter, ambient_distance: 0.5, read: Read::One(technique.role), ..FrameSettings::default() };
    // What keeps a history shows what becomes of it.
    let settled = renderer.history(&roles).unwrap().max(1);
    let frames = (0..settled).map(|index| renderer.render(&roles, &FrameSettings { index, ..settings }).unwrap());
    picture(technique.role, &frames.last().unwrap())
}

fn traced(scene: &str) -> Image<Srgb8> {
    let scene = builtin::load(scene).unwrap();
    let tracer = Tracer::new(&scene, Snapshot::new(&scene, Seconds(0.0))).unwrap();
    let settings = Settings { size: SIZE, ..Settings::default() };
    let frame = kajo_path_tracer::render(&tracer, &settings, Stop::at_spp(32), None, &uncontrolled).unwrap().develop();
    tone_map(frame.beauty(), scene.exposure.unwrap_or(0.0), ToneMap::Agx)
}

/// As a stored picture is read.
fn decoded(image: &Image<Srgb8>) -> Image<LinearRgb> {
    decode_image(Path::new("picture.png"), &encode_png(image, &Default::default()).unwrap()).unwrap()
}

fn difference(image: &Image<LinearRgb>, reference: &Image<LinearRgb>) -> f64 {
    flip(image, reference, PIXELS_PER_DEGREE).map_or(1.0, |map| flip::mean(&map))
}

/// Beginnings of the names of pictures that are to be made in the place of being compared with.
fn made() -> Option<String> {
    let word = std::env::var("KAJO_GOLDENS").ok()?;
    word.strip_prefix("make").map(|rest| rest.trim_start_matches(':').to_owned())
}

/// Compares with the stored picture of that name, or stores it when that is asked for; what is wrong otherwise.
fn check(name: &str, image: &Image<Srgb8>) -> Result<(), String> {
    let path = stored().join(name);
    if made().is_some_and(|prefix| name.starts_with(&prefix)) {
        std::fs::create_dir_all(stored()).unwrap();
        write_atomic(&path, &encode_png(image, &Default::default()).unwrap()).unwrap();
        return Ok(());
    }
    if !path.exists() {
        return Err(format!("{name} is not stored; make it with `{COMMAND}`"));
    }
    let (image, reference) = (decoded(image), read_image(&path).unwrap());
    let error = difference(&image, &reference);
    if error <= THRESHOLD {
        return Ok(());
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/goldens");
    std::fs::create_dir_all(&folder).unwrap();
    let keep = |what: &str, image: &Image<Srgb8>| {
        let path = folder.join(name.replace(".png", &format!(".{what}.png")));
        write_png(&path, image, &Default::default()).unwrap();
    };
    keep("picture", &image.map(|c| c.to_srgb8()));
    keep("reference", &reference.map(|c| c.to_srgb8()));
    if let Ok(map) = flip(&image, &reference, PIXELS_PER_DEGREE) {
        keep("difference", &heat_map(&map, 1.0, Palette::Magma));
    }
    Err(format!("{name}: mean FLIP {error:.4}, allowed {THRESHOLD}; look into {}; if the change is meant, `{COMMAND}`", folder.display()))
}

fn report(faults: Vec<String>) {
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// A technique without a stored picture fails, as does one whose picture changed; those that the device cannot run are told.
#[test]
fn every_technique_looks_as_it_did() {
    let device = Device::new().unwrap();
    let mut faults = Vec::new();
    for technique in kajo_techniques::all() {
        if let Some(needs) = technique.missing(&device) {
            eprintln!("{} is skipped: needs {needs}", technique.id);
            continue;
        }
        for scene in scenes(technique.role) {
            if made().is_some_and(|prefix| !file_of(technique, scene).starts_with(&prefix)) {
                continue;
            }
            faults.extend(check(&file_of(technique, scene), &frame(&device, technique, scene, None, glam::Vec2::ZERO)).err());
        }
    }
    report(faults);
}

#[test]
fn the_path_tracer_draws_as_it_did() {
    report(TRACED.iter().filter_map(|scene| check(&file_of_traced(scene), &traced(scene)).err()).collect());
}

/// No picture is stored that nothing is compared with.
#[test]
fn stored_pictures_are_those_of_the_registry() {
    let techniques = kajo_techniques::all().flat_map(|technique| scenes(technique.role).iter().map(|scene| file_of(technique, scene)));
    let expected: BTreeSet<String> = techniques.chain(TRACED.map(file_of_traced)).collect();
    let found = std::fs::read_dir(stored()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(expected, found, "make missing ones with `{COMMAND}`, remove the others");
}

/// What adapters may do: the other backend, and samples off by the 1/256 px that rasterisers snap to, pass with room to spare.
#[test]
fn rounding_stays_below_half_of_what_is_allowed() {
    let device = Device::new().unwrap();
    let nudged = glam::Vec2::new(1.0, -1.0) / 256.0;
    for id in ["shadow/map", "shadow/ray-traced"] {
        let technique = kajo_techniques::find(id).unwrap();
        for scene in scenes(technique.role) {
            let reference = read_image(&stored().join(file_of(technique, scene))).unwrap();
            let error = difference(&decoded(&frame(&device, technique, scene, Some(TraceBackend::Compute), nudged)), &reference);
            assert!(error < 0.5 * THRESHOLD, "{id} in {scene}: mean FLIP {error}");
        }
    }
}

/// Faults as code has them: each is above what is allowed.
#[test]
fn planted_faults_are_noticed() {
    let read = |name: &str| read_image(&stored().join(name)).unwrap();
    let (map, none, agx) = (read("shadow.map.shadows.png"), read("shadow.none.shadows.png"), read("tone.agx.shadows.png"));
    let shifted = |image: &Image<LinearRgb>| Image::from_fn(image.size(), |x, y| *image.get(x.saturating_sub(1), y));
    let faults = [
        ("a pixel off", difference(&shifted(&map), &map)),
        ("no shadows", difference(&none, &map)),
        ("lights in another order", difference(&Image::from_fn(map.size(), |x, y| *map.get((x + SIZE.x) % map.width(), y)), &map)),
        ("upside down", difference(&Image::from_fn(map.size(), |x, y| *map.get(x, map.height() - 1 - y)), &map)),
        ("another curve", difference(&read("tone.aces.shadows.png"), &agx)),
        ("a tenth darker", difference(&agx.map(|c| *c * 0.9), &agx)),
        ("red and blue swapped", difference(&agx.map(|c| LinearRgb(c.0.zyx())), &agx)),
        ("encoded twice", difference(&agx.map(|c| LinearRgb(c.0.powf(1.0 / 2.2))), &agx)),
    ];
    for (name, error) in faults {
        assert!(error > 1.2 * THRESHOLD, "{name}: mean FLIP {error}");
    }
    assert_eq!(difference(&agx, &agx), 0.0);
}
