use super::*;
use crate::judge::{Composed, Part};

const SIZE: UVec2 = UVec2::new(64, 48);

/// A disc of shadow with a hard border.
fn shadow(center: f32) -> Image<LinearRgb> {
    Image::from_fn(SIZE, |x, y| {
        let d = (x as f32 + 0.5 - center).hypot(y as f32 + 0.5 - 24.0);
        LinearRgb::splat(if d < 12.0 { 0.0 } else { 1.0 })
    })
}

fn judge() -> Judge {
    let part = |name: &str, center: f32| Part {
        name: format!("visibility.{name}"),
        image: shadow(center),
        variance: Some(shadow(center).map(|_| LinearRgb::BLACK)),
        settled: None,
    };
    Judge { parts: vec![part("Key", 20.0), part("Fill", 40.0)], mask: None, kind: Kind::Visibility, composed: None }
}

fn exact() -> Take {
    Take { parts: vec![shadow(20.0), shadow(40.0)], composed: None }
}

#[test]
fn an_exact_technique_has_no_error_anywhere() {
    let e = evaluate(&judge(), &[exact(), exact()], "exact").unwrap();
    assert_eq!((e.error.image.rmse, e.error.bias, e.error.noise), (0.0, Some(0.0), Some(0.0)));
    assert_eq!((e.error.off_border_mismatch, e.error.border_px, e.temporal.flicker), (Some(0.0), Some(0.0), Some(0.0)));
    assert_eq!(e.error.image.distinguishable, Some(false));
    assert!(pictures(&judge(), &exact(), &e, None).crops.is_empty());
}

/// Two lights whose errors cancel in their mean are still seen.
#[test]
fn planted_swap_of_lights_is_found() {
    let swapped = Take { parts: vec![shadow(40.0), shadow(20.0)], composed: None };
    let e = evaluate(&judge(), std::slice::from_ref(&swapped), "swapped").unwrap();
    assert!(e.error.image.rmse > 0.4 && e.error.off_border_mismatch.unwrap() > 0.1, "{:?}", e.error);
    assert_eq!((e.error.bias, e.error.noise), (None, None), "one seed cannot be split");
    assert_eq!(e.error.lights.len(), 2);
    let pictures = pictures(&judge(), &swapped, &e, None);
    assert!(!pictures.crops.is_empty() && pictures.heat.get(20, 24) != pictures.heat.get(2, 2));
}

#[test]
fn a_moved_border_is_told_from_a_wrong_shadow() {
    let moved = Take { parts: vec![shadow(21.0), shadow(41.0)], composed: None };
    let e = evaluate(&judge(), &[moved], "moved").unwrap();
    assert!(e.error.off_border_mismatches.unwrap() < 10, "{:?}", e.error);
    assert!(e.error.border_px.unwrap() > 0.3 && e.error.border_px.unwrap() < 1.1, "{:?}", e.error.border_px);
}

#[test]
fn pixels_without_a_surface_do_not_count() {
    let mut judge = judge();
    judge.mask = Some(Image::from_fn(SIZE, |_, y| y < 10));
    let none = Take { parts: vec![shadow(20.0).map(|_| LinearRgb::WHITE); 2], composed: None };
    assert_eq!(evaluate(&judge, &[none], "masked").unwrap().error.image.rmse, 0.0);
}

#[test]
fn seeds_give_noise_flicker_and_a_standard_error() {
    let take = |v: f32| Take { parts: exact().parts.iter().map(|p| p.map(|q| *q + LinearRgb::splat(v))).collect(), composed: None };
    let e = evaluate(&judge(), &[take(0.1), take(-0.1), take(0.1), take(-0.2)], "noisy").unwrap();
    assert!((e.error.noise.unwrap() - 0.15).abs() < 1e-5, "{:?}", e.error.noise);
    assert!((e.temporal.flicker.unwrap() - (0.2 + 0.2 + 0.3) / 3.0).abs() < 1e-5);
    assert_eq!(e.error.label, Some("unbiased"));
    assert!((e.error.image.mse - (3.0 * 0.01 + 0.04) / 4.0).abs() < 1e-6 && e.error.mse_standard_error > 0.005);
}

#[test]
fn a_nan_of_a_technique_names_the_run() {
    let mut take = exact();
    *take.parts[1].get_mut(3, 4) = LinearRgb::splat(f32::NAN);
    let message = evaluate(&judge(), &[take], "s, r, t/x").unwrap_err().to_string();
    assert!(message.starts_with("s, r, t/x: the image has 1 pixels that are NaN"), "{message}");
}

#[test]
fn composed_picture_is_a_second_number() {
    let mut judge = judge();
    let part = Part { name: "direct".into(), image: shadow(20.0).map(|p| *p * 3.0), variance: None, settled: None };
    judge.composed = Some(Composed { part, simulated: Some(shadow(20.0).map(|p| *p * 3.3)) });
    let mut take = exact();
    take.composed = Some(shadow(20.0).map(|p| *p * 3.3));
    let composed = evaluate(&judge, &[take], "composed").unwrap().error.composed.unwrap();
    assert!((composed.image.mean_ratio.unwrap() - 1.1).abs() < 1e-5 && composed.against == "direct");
    assert_eq!(composed.approximation_rmse, Some(0.0), "all of the error is light that is not simulated");
    assert!((composed.not_simulated_rmse.unwrap() - composed.image.rmse).abs() < 1e-6);
}

#[test]
fn files_keep_every_light_and_the_variance() {
    let e = evaluate(&judge(), &[exact()], "exact").unwrap();
    let names = |file: ExrFile| file.layers.into_iter().map(|l| l.name).collect::<Vec<_>>();
    assert_eq!(names(run_exr(&judge(), &exact(), &e)), ["", "visibility.Key", "visibility.Fill", "flip"]);
    let reference = names(reference_exr(&judge()));
    assert!(reference.contains(&"variance.visibility.Fill".to_owned()), "{reference:?}");
}

/// Row RM-66: a mean relative error with its interval, and a verdict for each technique.
#[test]
fn bias_is_stated_with_an_interval_and_a_verdict() {
    let mut state = 1u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let mut take = |scale: f32| Take {
        parts: exact().parts.iter().map(|p| p.map(|q| LinearRgb::splat(q[0] * scale + 0.2 * noise()))).collect(),
        composed: None,
    };
    let (fair, dim) = ([1.0; 4].map(&mut take), [0.95; 4].map(&mut take));
    let fair = evaluate(&judge(), &fair, "fair").unwrap().error;
    let dim = evaluate(&judge(), &dim, "dim").unwrap().error;
    assert_eq!((fair.label, dim.label), (Some("unbiased"), Some("biased")));
    let interval = |e: &RunError| (e.mean_relative_error.unwrap(), e.mean_relative_error_95.unwrap());
    let ((m, w), (dm, dw)) = (interval(&fair), interval(&dim));
    assert!(m.abs() < w, "0 lies in {m} ± {w}");
    assert!((dm + 0.05).abs() < dw && dm.abs() > dw, "-0.05 lies in {dm} ± {dw} and 0 does not");
}
