//! Threads, passes, interruptions and files leave no trace.

use super::scenes::{cornell, film_at, sized, tracer};
use crate::{Aov, Control, Film, LightSampler, PathTracerError, Progress, Settings, Stop, render, uncontrolled};
use kajo_sampling::SamplerKind;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

fn settings() -> Settings {
    let aovs = ["direct", "visibility.light", "depth", "instance-id", "diffuse-indirect"];
    Settings { aovs: aovs.map(|name| name.parse().unwrap()).into(), max_depth: 4, ..sized(20, 14) }
}

/// Everything but the time that it took.
fn samples(mut film: Film) -> Film {
    film.seconds = 0.0;
    film
}

fn whole() -> Film {
    samples(film_at(&cornell(), &settings(), 13))
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let one = whole();
    for threads in [1, 2, 3, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(samples(pool.install(|| film_at(&cornell(), &settings(), 13))) == one, "{threads} threads");
    }
}

#[test]
fn resumed_from_a_file_equals_uninterrupted() {
    let (tracer, directory) = (tracer(&cornell()), tempfile::tempdir().unwrap());
    let path = directory.path().join("film");
    let mut film = None;
    for spp in [1, 5, 6, 13] {
        let part = render(&tracer, &settings(), Stop::at_spp(spp), film.take(), &uncontrolled).unwrap();
        part.save(&path).unwrap();
        film = Some(Film::load(&path).unwrap());
    }
    assert!(samples(film.unwrap()) == whole());
}

fn adaptive() -> Settings {
    let aovs = ["samples", "depth"].map(|name| name.parse().unwrap()).into();
    Settings { adaptive: true, aovs, max_depth: 3, ..sized(20, 14) }
}

/// Past two revisions of the plan.
const ADAPTIVE_SPP: u32 = 420;

#[test]
fn adaptive_films_are_the_same_at_any_number_of_threads_and_interruptions() {
    let (tracer, directory) = (tracer(&cornell()), tempfile::tempdir().unwrap());
    let whole = samples(film_at(&cornell(), &adaptive(), ADAPTIVE_SPP));
    let path = directory.path().join("film");
    let mut film = None;
    for (spp, threads) in [(5, 1), (16, 3), (17, 2), (200, 5), (ADAPTIVE_SPP, 2)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let part = pool.install(|| render(&tracer, &adaptive(), Stop::at_spp(spp), film.take(), &uncontrolled)).unwrap();
        part.save(&path).unwrap();
        film = Some(Film::load(&path).unwrap());
    }
    assert!(samples(film.unwrap()) == whole);
    let cancelled = render(&tracer, &adaptive(), Stop::at_spp(ADAPTIVE_SPP), None, &Impatient::after(34)).unwrap();
    let finished = render(&tracer, &adaptive(), Stop::at_spp(ADAPTIVE_SPP), Some(cancelled), &uncontrolled).unwrap();
    assert!(samples(finished) == whole);
    let even = film_at(&cornell(), &Settings { adaptive: false, ..adaptive() }, 16);
    assert_eq!(film_at(&cornell(), &adaptive(), 16).develop().beauty(), even.develop().beauty(), "the pilot is the same");
    assert!(matches!(
        render(&tracer, &adaptive(), Stop::at_spp(17), Some(even), &uncontrolled),
        Err(PathTracerError::CheckpointMismatch { what: "the settings differ" })
    ));
}

/// Breaks after this many rows.
struct Impatient(AtomicU32);

impl Impatient {
    fn after(rows: u32) -> Self {
        Self(AtomicU32::new(rows))
    }
}

impl Control for Impatient {
    fn progress(&self, _: &Progress) -> ControlFlow<()> {
        let left = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
        if left.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

#[test]
fn cancelled_films_are_usable_and_can_be_finished() {
    let tracer = tracer(&cornell());
    // While it is decided which pixels get additional rays, row by row, there is no sample yet, nor a ray that counts.
    let early = render(&tracer, &settings(), Stop::at_spp(13), None, &Impatient::after(7)).unwrap();
    assert_eq!((early.samples(), early.rays()), (0, 0));
    assert!(early.develop().beauty().pixels().iter().all(|p| p.is_finite()));
    assert!(samples(render(&tracer, &settings(), Stop::at_spp(13), Some(early), &uncontrolled).unwrap()) == whole());
    let cancelled = render(&tracer, &settings(), Stop::at_spp(13), None, &Impatient::after(14 + 20)).unwrap();
    assert!(cancelled.spp() >= 1 && cancelled.spp() < 13, "{} samples per pixel", cancelled.spp());
    assert!(cancelled.develop().beauty().pixels().iter().all(|p| p.is_finite()));
    let finished = render(&tracer, &settings(), Stop::at_spp(13), Some(cancelled), &uncontrolled).unwrap();
    assert!(samples(finished) == whole());
}

const SCENE: &str = "the scene, or the light or environment sampler, differs";

#[test]
fn films_of_other_pictures_are_refused() {
    let film = || film_at(&cornell(), &settings(), 1);
    let other_scene = kajo_scene::load("builtin:furnace", &Default::default()).unwrap();
    let resume =
        |scene: &kajo_scene::Scene, settings: &Settings| render(&tracer(scene), settings, Stop::at_spp(2), Some(film()), &uncontrolled);
    let no_lights = Settings { aovs: Vec::new(), ..settings() };
    let film_of_furnace = render(&tracer(&other_scene), &no_lights, Stop::at_spp(1), None, &uncontrolled).unwrap();
    let wrong_scene = render(&tracer(&cornell()), &no_lights, Stop::at_spp(2), Some(film_of_furnace), &uncontrolled);
    assert!(matches!(wrong_scene, Err(PathTracerError::CheckpointMismatch { what: SCENE })));
    let size = glam::UVec2::new(14, 20);
    for other in [Settings { seed: 1, ..settings() }, Settings { max_depth: 3, ..settings() }, Settings { size, ..settings() }] {
        assert!(matches!(resume(&cornell(), &other), Err(PathTracerError::CheckpointMismatch { what: "the settings differ" })));
    }
    let images = resume(&cornell(), &no_lights).unwrap_err().to_string();
    assert!(images.contains("its images differ: --aov and --denoise"), "{images}");
    for by in [LightSampler::Uniform, LightSampler::Ris { candidates: 4 }] {
        let otherwise = render(&tracer(&cornell()).with_light_sampler(by), &settings(), Stop::at_spp(2), Some(film()), &uncontrolled);
        assert!(matches!(otherwise, Err(PathTracerError::CheckpointMismatch { what: SCENE })));
    }
    let mut darker = cornell();
    darker.materials[0].base_color *= 0.5;
    assert!(matches!(resume(&darker, &settings()), Err(PathTracerError::CheckpointMismatch { what: SCENE })));
    assert!(resume(&cornell(), &settings()).is_ok());
}

#[test]
fn seeds_and_samplers_change_the_noise() {
    let bits = |settings| film_at(&cornell(), &settings, 2).develop().beauty().clone();
    let base = bits(settings());
    assert_ne!(bits(Settings { seed: 1, ..settings() }), base);
    for sampler in [SamplerKind::Independent, SamplerKind::BlueNoise { log2_samples: 1 }] {
        assert_ne!(bits(Settings { sampler, ..settings() }), base, "{sampler:?}");
    }
}

#[test]
fn images_besides_beauty_do_not_change_it() {
    let plain = film_at(&cornell(), &Settings { aovs: Vec::new(), ..settings() }, 4).develop();
    let tracer = tracer(&cornell());
    let all = Settings { aovs: tracer.all_aovs(4), ..settings() };
    let all = render(&tracer, &all, Stop::at_spp(4), None, &uncontrolled).unwrap().develop();
    assert_eq!(plain.beauty(), all.beauty());
    assert_eq!(plain.invalid_samples, 0);
}

#[test]
fn each_stop_condition_stops() {
    let tracer = tracer(&cornell());
    let until = |stop| render(&tracer, &settings(), stop, None, &uncontrolled);
    assert_eq!(until(Stop::at_spp(7)).unwrap().spp(), 7);
    let noise = until(Stop::at_noise(0.25)).unwrap();
    assert!(noise.develop().relative_standard_error <= 0.25 && noise.spp() >= 16);
    let time = until(Stop::at_time(Duration::from_millis(300))).unwrap();
    assert!(time.spp() > 1 && time.seconds() > 0.2 && time.seconds() < 3.0, "{} s", time.seconds());
    let either = Stop { spp: Some(3), time: Some(Duration::from_secs(100)), noise: Some(1e-6) };
    assert_eq!(until(either).unwrap().spp(), 3);
    assert!(matches!(until(Stop::default()), Err(PathTracerError::EndlessStop)));
    assert!(matches!(until(Stop::at_spp(0)), Err(PathTracerError::Range { .. })));
    assert!(matches!(until(Stop::at_noise(f32::NAN)), Err(PathTracerError::Range { .. })));
}

#[test]
fn wrong_settings_are_explained() {
    let tracer = tracer(&cornell());
    let message = |settings: Settings| render(&tracer, &settings, Stop::at_spp(1), None, &uncontrolled).unwrap_err().to_string();
    assert!(message(Settings { camera: "front".into(), ..settings() }).contains("0 `camera`"));
    assert!(message(Settings { camera: "7".into(), ..settings() }).contains("camera `7` does not exist"));
    assert!(message(Settings { size: glam::UVec2::ZERO, ..settings() }).contains("0x0 px"));
    let lamp = Settings { aovs: vec![Aov::Visibility("lamp".into())], ..settings() };
    assert!(message(lamp).contains("visibility.light"));
    assert!(message(Settings { aovs: vec![Aov::Motion], ..settings() }).contains("previous snapshot"));
    let blue_noise = SamplerKind::BlueNoise { log2_samples: 4 };
    assert!(message(Settings { adaptive: true, sampler: blue_noise, ..settings() }).contains("blue noise"));
    assert!(message(Settings { ambient_distance: 0.0, ..settings() }).contains("ambient distance"));
}

#[test]
fn a_camera_put_in_place_equals_a_scene_with_it() {
    let scene = cornell();
    let mut moved = kajo_scene::Snapshot::new(&scene, kajo_units::Seconds(0.0));
    moved.cameras[0].world_from_view *= glam::Mat4::from_translation(glam::Vec3::new(0.1, 0.2, 0.05));
    let mut changed = tracer(&scene);
    let before = render(&changed, &settings(), Stop::at_spp(3), None, &uncontrolled).unwrap();
    changed.set_camera(0, moved.cameras[0].clone()).unwrap();
    let after = samples(render(&changed, &settings(), Stop::at_spp(3), None, &uncontrolled).unwrap());
    let made = crate::Tracer::new(&scene, moved.clone()).unwrap();
    assert!(after == samples(render(&made, &settings(), Stop::at_spp(3), None, &uncontrolled).unwrap()));
    assert!(after != samples(before.clone()), "the camera has moved");
    let resumed = render(&changed, &settings(), Stop::at_spp(4), Some(before), &uncontrolled);
    assert!(matches!(resumed, Err(PathTracerError::CheckpointMismatch { .. })), "a film of the old view is not gone on with");
    assert!(changed.set_camera(1, moved.cameras[0].clone()).is_err());
}
