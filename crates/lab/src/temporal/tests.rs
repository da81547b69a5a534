use super::metrics::{Flicker, ghost, progress};
use super::track::Track;
use super::*;
use crate::progress::Unwatched;
use glam::Vec2;
use kajo_params::ParamValues;

const SIZE: UVec2 = UVec2::new(48, 16);

/// A bright bar that moves `speed` px a frame.
fn bar(frame: u32, speed: f32) -> Image<LinearRgb> {
    Image::from_fn(SIZE, |x, _| {
        let at = x as f32 - 6.0 - speed * frame as f32;
        LinearRgb::splat((4.0 - at.abs()).clamp(0.0, 1.0))
    })
}

/// The edge of a shadow that moves 3 px a frame: what it has left stays bright.
fn edge(frame: u32) -> Image<LinearRgb> {
    Image::from_fn(SIZE, |x, _| LinearRgb::splat((6.0 + 3.0 * frame as f32 - x as f32).clamp(0.0, 1.0)))
}

/// Numbers in [−1, 1] that depend on frame and pixel alone.
fn noise(image: &Image<LinearRgb>, frame: u32, size: f32) -> Image<LinearRgb> {
    Image::from_fn(image.size(), |x, y| {
        let mut state = frame.wrapping_mul(0x9E37_79B9) ^ x.wrapping_mul(0x85EB_CA6B) ^ y.wrapping_mul(0xC2B2_AE35);
        state = (state ^ (state >> 16)).wrapping_mul(0x7FEB_352D);
        state = (state ^ (state >> 15)).wrapping_mul(0x846C_A68B);
        *image.get(x, y) + LinearRgb::splat(size * (2.0 * ((state ^ (state >> 16)) as f32 / u32::MAX as f32) - 1.0))
    })
}

/// Every frame blended with those before.
fn blended(images: &[Image<LinearRgb>], alpha: f32) -> Vec<Image<LinearRgb>> {
    let mut out = vec![images[0].clone()];
    for image in &images[1..] {
        let last = &out[out.len() - 1];
        out.push(Image::from_fn(image.size(), |x, y| *last.get(x, y) * (1.0 - alpha) + *image.get(x, y) * alpha));
    }
    out
}

fn flicker(images: &[Image<LinearRgb>], references: &[Image<LinearRgb>], tracks: &[Track]) -> Option<f64> {
    Flicker::new(images, references, tracks).mean
}

fn still(count: usize) -> Vec<Track> {
    vec![Image::from_fn(SIZE, |x, y| Some(Vec2::new(x as f32, y as f32) + 0.5)); count]
}

/// A light moves over things at rest: an exact technique shows nothing, noise flickers by its expectation and leaves no ghost, a blend of a tenth is a ghost.
#[test]
fn planted_flicker_and_ghosts_are_measured_and_exact_pictures_have_none() {
    let references: Vec<_> = (0..10).map(edge).collect();
    let tracks = still(9);
    assert_eq!(flicker(&references, &references, &tracks), Some(0.0));
    assert_eq!(ghost(&references, &references, None), Some(0.0));

    let noisy: Vec<_> = references.iter().zip(0..).map(|(r, frame)| noise(r, frame, 0.15)).collect();
    let at_rest = vec![references[0].clone(); 10];
    let noisy_at_rest: Vec<_> = at_rest.iter().zip(0..).map(|(r, frame)| noise(r, frame, 0.15)).collect();
    // Mean |difference| of two even numbers in [−s, s]: 2 s / 3.
    let measured = flicker(&noisy_at_rest, &at_rest, &tracks).unwrap();
    assert!((measured - 0.1).abs() < 0.003, "{measured}");
    assert!(flicker(&noisy, &references, &tracks).unwrap() > 0.07);
    assert!(ghost(&noisy, &references, None).unwrap() < 0.04);

    let slow = blended(&references, 0.1);
    let (tenth, half) = (ghost(&slow, &references, None).unwrap(), ghost(&blended(&references, 0.5), &references, None).unwrap());
    assert!((tenth - 0.9).abs() < 0.15 && (half - 0.5).abs() < 0.15, "{tenth} {half}");
    // A constant error is none of time.
    let darker: Vec<_> = references.iter().map(|r| r.map(|c| *c + LinearRgb::splat(0.2))).collect();
    assert!(flicker(&darker, &references, &tracks).unwrap() < 1e-6 && ghost(&darker, &references, None).unwrap() < 1e-4);
    // Nor is a picture in which a thing that passes is missing.
    let passing: Vec<_> = (0..10).map(|frame| bar(frame, 3.0)).collect();
    let missing = ghost(&vec![references[0].map(|_| LinearRgb::BLACK); 10], &passing, None).unwrap();
    assert!(missing < 0.2, "{missing}");
    let late: Vec<_> = (0..10u32).map(|frame| references[frame.max(1) as usize - 1].clone()).collect();
    assert!((ghost(&late, &references, None).unwrap() - 1.0).abs() < 0.15);
}

/// The noise of the references is not taken for a ghost of an exact technique.
#[test]
fn noise_of_the_reference_is_taken_out_of_ghosts() {
    let exact: Vec<_> = (0..12).map(edge).collect();
    let references: Vec<_> = exact.iter().zip(100..).map(|(r, frame)| noise(r, frame, 0.3)).collect();
    let variances = vec![Image::from_fn(SIZE, |_, _| LinearRgb::splat(0.03)); 12];
    assert!(ghost(&exact, &references, Some(&variances)).unwrap() < 0.1);
    // Without its variance, noise hides a ghost: it counts as change.
    let slow = blended(&exact, 0.1);
    let (with, without) = (ghost(&slow, &references, Some(&variances)).unwrap(), ghost(&slow, &references, None).unwrap());
    assert!((with - 0.9).abs() < 0.2 && without < 0.8 * with, "{with} with variances, {without} without");
}

/// Motion is taken out: what moves as its track says does not flicker; a picture that stays behind (the planted fault) does.
#[test]
fn flicker_is_measured_along_motion() {
    let references: Vec<_> = (0..6).map(|frame| bar(frame, 2.5)).collect();
    let track = Image::from_fn(SIZE, |x, y| Some(Vec2::new(x as f32 + 0.5 - 2.5, y as f32 + 0.5)).filter(|then| then.x >= 0.5));
    let tracks = vec![track; 5];
    assert!(flicker(&references, &references, &tracks).unwrap() < 1e-6);
    let behind = vec![references[0].clone(); 6];
    assert!(flicker(&behind, &references, &tracks).unwrap() > 0.05);
    assert_eq!(flicker(&references, &references, &[Image::from_fn(SIZE, |_, _| None)]), None);
}

/// A blend of a tenth takes 29 frames to 95 %, with noise in every picture.
#[test]
fn progress_is_the_way_gone_without_the_noise() {
    let (old, new) = (bar(0, 1.0), bar(20, 1.0));
    let starts = [noise(&old, 1, 0.1), noise(&old, 2, 0.1)];
    let goals = [noise(&new, 3, 0.1), noise(&new, 4, 0.1)];
    let mut frames = vec![old.clone()];
    frames.extend((0..60).map(|_| new.clone()));
    let ways: Vec<f64> = blended(&frames, 0.1)[1..].iter().map(|image| progress(image, &starts, &goals).unwrap()).collect();
    let expected = |n: i32| 1.0 - 0.9f64.powi(n);
    for (n, way) in (1..).zip(&ways) {
        assert!((way - expected(n)).abs() < 0.03, "frame {n}: {way}");
    }
    let noise_alone = [noise(&old, 5, 0.1), noise(&old, 6, 0.1)];
    assert_eq!(progress(&old, &starts, &noise_alone), None, "nothing has changed");
    // Few pixels, where chance often points somewhere.
    let still = Image::from_fn(UVec2::new(4, 2), |_, _| LinearRgb::splat(0.5));
    for seed in (0..200).step_by(4) {
        let [a, a2, b, b2] = [0, 1, 2, 3].map(|i| noise(&still, seed + i, 0.1));
        assert_eq!(progress(&still, &[a, a2], &[b, b2]), None, "seed {seed}");
    }
}

fn measured(scene: &str, role: Role, techniques: &[(&str, &[(&str, &str)])], frames: u32) -> Vec<Temporal> {
    let options = CompareOptions {
        scenes: vec![scene.into()],
        size: Some(UVec2::new(96, 54)),
        temporal: frames,
        time: 0.5,
        ..CompareOptions::default()
    };
    let subject = Subject::load(&options, 0).unwrap();
    let device = Device::new().unwrap();
    let pool = rayon::ThreadPoolBuilder::new().build().unwrap();
    let mut sequences = Sequences::new(&subject, &[role.id()], &options, (&device, &pool), &Unwatched, &|f| f).unwrap().unwrap();
    let choice = |(id, params): &(&str, &[(&str, &str)])| {
        let technique = kajo_techniques::find(id).unwrap();
        Choice { technique, params: ParamValues::from_pairs(technique.params, params).unwrap() }
    };
    techniques.iter().map(|technique| sequences.measure(role, &choice(technique)).unwrap().0).collect()
}

/// Row RM-65: camera, light and thing move; rays forget at once, and flicker less with more of them.
#[test]
fn shadow_rays_have_no_lag_and_no_ghost_and_flicker_by_their_noise() {
    let techniques: [(&str, &[(&str, &str)]); 2] =
        [("shadow/ray-traced", &[("samples", "64")]), ("shadow/ray-traced", &[("samples", "1")])];
    let [many, one] = &measured("builtin:penumbra", Role::DirectVisibility, &techniques, 4)[..] else { panic!("two results") };
    let motions: Vec<&str> = many.sequences.iter().map(|s| s.motion.as_str()).collect();
    assert_eq!(motions, ["camera", "light", "object"]);
    for temporal in [many, one] {
        assert_eq!(temporal.lag, Some(0.0), "{:?}", temporal.response);
        assert!(temporal.ghost.unwrap() < 0.1, "{temporal:?}");
    }
    assert!(one.flicker.unwrap() > 3.0 * many.flicker.unwrap() && many.flicker.unwrap() < 0.01, "{one:?} {many:?}");
}

/// A blend without rejection, the planted fault, is found out by lag and ghost; with rejection both are small. The scene has its own animation.
#[test]
fn history_that_is_not_rejected_lags_and_leaves_ghosts() {
    let techniques: [(&str, &[(&str, &str)]); 3] =
        [("aa/none", &[]), ("aa/taa", &[("rejection", "none"), ("alpha", "0.1")]), ("aa/taa", &[])];
    let [none, blend, clipped] = &measured("builtin:moving", Role::AntiAlias, &techniques, 6)[..] else { panic!("three results") };
    assert_eq!(none.sequences[0].motion, "animation");
    assert_eq!(none.lag, Some(0.0));
    let lag = blend.lag.unwrap();
    // Noise of jitter and shadows may cross the line some frames early.
    assert!((18.0..=32.0).contains(&lag), "{:?}", blend.response);
    assert!(clipped.lag.unwrap() < lag && clipped.response[0] > 3.0 * blend.response[0], "{:?}", clipped.response);
    assert!(blend.ghost.unwrap() > 3.0 * none.ghost.unwrap().max(0.02), "{none:?} {blend:?}");
    assert!(clipped.ghost.unwrap() < blend.ghost.unwrap(), "{clipped:?} {blend:?}");
}
