//! Frames sampled at different points of their pixels.

use super::scenes::*;
use crate::{FrameSettings, RoleSelection};
use glam::{UVec2, Vec2};
use kajo_image::Image;
use kajo_path_tracer::{Aov, Filter, Pixels, Settings, Stop, Tracer, render, uncontrolled};
use kajo_render_graph::Device;
use kajo_scene::{Snapshot, builtin};
use kajo_units::LinearRgb;

const SIZE: UVec2 = UVec2::new(96, 54);

/// Direct light averaged over the area of each pixel.
fn over_pixels(scene: &kajo_scene::Scene) -> Image<LinearRgb> {
    let tracer = Tracer::new(scene, Snapshot::new(scene, START)).unwrap();
    let filter = Filter::Box;
    let settings = Settings { size: SIZE, filter, max_depth: 1, aovs: vec![Aov::Direct], smooth_terminator: false, ..Settings::default() };
    let frame = render(&tracer, &settings, Stop::at_spp(256), None, &uncontrolled).unwrap().develop();
    let Pixels::Color(direct) = &frame.image("direct").unwrap().pixels else { panic!("direct light is a colour") };
    direct.clone()
}

/// Root mean square error in the range that a display shows.
fn rmse(a: &Image<LinearRgb>, b: &Image<LinearRgb>) -> f32 {
    let shown = |c: &LinearRgb| c.0.min(glam::Vec3::ONE);
    let sum: f32 = a.pixels().iter().zip(b.pixels()).map(|(a, b)| (shown(a) - shown(b)).length_squared()).sum();
    (sum / (3.0 * a.pixels().len() as f32)).sqrt()
}

/// Row M-14: the mean of frames jittered by Halton points is the light over the area of each pixel; one frame at the centres is not, nor are frames
/// that are jittered by half a pixel too much.
#[test]
fn jittered_frames_converge_to_the_area_of_the_pixel() {
    let device = Device::new().unwrap();
    let scene = builtin::load("moving").unwrap();
    let expected = over_pixels(&scene);
    let mut renderer = renderer(&device, &scene, SIZE, None);
    let roles = RoleSelection::new().choose("shadow/ray-traced", &[]).unwrap();
    let one = renderer.render(&roles, &FrameSettings::default()).unwrap();
    let many = renderer.accumulate(&roles, &FrameSettings::default(), 64).unwrap();
    let (alone, together) = (rmse(&one.direct, &expected), rmse(&many.direct, &expected));
    assert!(together < 0.35 * alone, "64 frames: {together}, one: {alone}");
    assert!(many.rays > 60 * one.rays, "{} rays in 64 frames, {} in one", many.rays, one.rays);
    let shifted = FrameSettings { jitter: Vec2::splat(0.5), ..FrameSettings::default() };
    let fault = rmse(&renderer.accumulate(&roles, &shifted, 64).unwrap().direct, &expected);
    assert!(fault > 2.0 * together, "planted fault: {fault} against {together}");
}
