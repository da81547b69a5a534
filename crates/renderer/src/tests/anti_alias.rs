//! The role anti-alias: coverage of edges, history that follows and history that is refused.

use super::scenes::*;
use crate::{FrameOutput, FrameSettings, Renderer, RendererSettings, RoleSelection};
use glam::{Affine3A, Quat, UVec2, Vec2, Vec3};
use kajo_render_graph::Device;
use kajo_scene::{LightShape, Material, Projection, Scene, Snapshot, builtin, shapes};
use kajo_units::{LinearRgb, Meters, Seconds};
use std::f32::consts::{FRAC_PI_2, PI};

const SIZE: UVec2 = UVec2::new(96, 48);

/// Looks along −z, 1 m a pixel, at nothing yet: black.
fn stage() -> Scene {
    let mut scene = Scene::default();
    let half = SIZE.as_vec2() / 2.0;
    let projection = Projection::Orthographic { xmag: Meters(half.x), ymag: Meters(half.y) };
    camera(&mut scene, projection, Vec3::Z * 10.0, Vec3::ZERO);
    scene
}

/// A square that shines with radiance 1, of half the side `HALF`, around `middle` (px from the middle of the image, y up).
struct Square {
    middle: Vec2,
    turn: f32,
}

const HALF: f32 = 8.3;

/// Four straight edges each, of random places and directions.
fn squares() -> impl Iterator<Item = Square> {
    (0..8u32).map(|i| {
        let random = kajo_sampling::halton_2d(i + 1);
        let cell = Vec2::new((i % 4) as f32 * 24.0 - 36.0, (i / 4) as f32 * 24.0 - 12.0);
        Square { middle: cell + random - 0.5, turn: FRAC_PI_2 * kajo_sampling::halton_2d(i + 9).x }
    })
}

impl Square {
    /// Distance to its border, negative inside; nearer to the corners less than that.
    fn distance(&self, pixel: Vec2) -> f32 {
        let at = (pixel - SIZE.as_vec2() / 2.0) * Vec2::new(1.0, -1.0) - self.middle;
        Vec2::from_angle(-self.turn).rotate(at).abs().max_element() - HALF
    }

    /// Share of the pixel inside, by 64 × 64 points.
    fn coverage(&self, corner: Vec2) -> f32 {
        let at = |i: u32| corner + (Vec2::new((i % 64) as f32, (i / 64) as f32) + 0.5) / 64.0;
        (0..4096).filter(|&i| self.distance(at(i)) < 0.0).count() as f32 / 4096.0
    }
}

/// Pixels whose middle is within half a pixel of an edge, with what is covered of each.
fn edge_pixels() -> Vec<(u32, u32, f32)> {
    let pixels = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| (x, y)));
    let of = |square: &Square, (x, y): (u32, u32)| {
        let corner = Vec2::new(x as f32, y as f32);
        (square.distance(corner + 0.5).abs() < 0.5).then(|| (x, y, square.coverage(corner)))
    };
    squares().flat_map(|square| pixels.clone().filter_map(|pixel| of(&square, pixel)).collect::<Vec<_>>()).collect()
}

fn at_rest(device: &Device, scene: &Scene, size: UVec2) -> Renderer {
    Renderer::new(device, scene, &Snapshot::new(scene, START), RendererSettings::new(size)).unwrap()
}

fn roles(id: &str, params: &[(&str, &str)]) -> RoleSelection {
    RoleSelection::new().choose("shadow/none", &[]).unwrap().choose(id, params).unwrap()
}

/// The picture after `count` frames.
fn after(renderer: &mut Renderer, roles: &RoleSelection, first: u32, count: u32) -> FrameOutput {
    let mut last = None;
    for index in first..first + count {
        last = Some(renderer.render(roles, &FrameSettings { index, ..Default::default() }).unwrap());
    }
    last.unwrap()
}

/// Row R-05.
#[test]
fn jittered_frames_cover_edges_as_their_area_does() {
    let device = Device::new().unwrap();
    let mut scene = stage();
    for square in squares() {
        let glow = Material { emission: LinearRgb::WHITE, double_sided: true, ..lambert(0.0) };
        let place_at = Affine3A::from_rotation_translation(Quat::from_rotation_z(square.turn), square.middle.extend(0.0));
        place(&mut scene, shapes::rectangle(2.0 * HALF, 2.0 * HALF), glow, place_at);
    }
    let mut renderer = at_rest(&device, &scene, SIZE);
    let pixels = edge_pixels();
    assert!(pixels.len() > 400, "edges cross {} pixels", pixels.len());
    let mut error = |id: &str, params: &[(&str, &str)], frames: u32| {
        let color = after(&mut renderer, &roles(id, params), 0, frames).color;
        pixels.iter().map(|&(x, y, covered)| (color.get(x, y).0.x - covered).abs()).sum::<f32>() / pixels.len() as f32
    };
    let one = error("aa/none", &[], 1);
    let mean = error("aa/accumulate", &[("frames", "16")], 16);
    let blend = error("aa/taa", &[("alpha", "0.1"), ("rejection", "none")], 48);
    let clipped = error("aa/taa", &[("alpha", "0.1")], 48);
    let spatial = error("aa/fxaa", &[], 1);
    eprintln!("coverage error: 1 sample {one:.3}, mean {mean:.3}, blend {blend:.3}, clipped {clipped:.3}, within one frame {spatial:.3}");
    assert!((0.22..0.26).contains(&one), "one sample a pixel: {one}");
    assert!(mean <= 0.06, "mean of 16: {mean}");
    assert!(blend <= 0.06, "blend of 0.1: {blend}");
    assert!(clipped <= 0.06, "clipped to the neighbourhood: {clipped}");
    assert!(spatial < 0.6 * one, "edges of one frame: {spatial}");
}

/// Frames until a pixel has gone 95 % of the way after the light on it jumps.
fn frames_to_follow(device: &Device, params: &[(&str, &str)]) -> u32 {
    let mut scene = stage();
    place(&mut scene, shapes::rectangle(100.0, 100.0), lambert(0.5), Affine3A::IDENTITY);
    light(&mut scene, LightShape::Directional { half_angle: Default::default() }, 1.0, Vec3::ZERO, Vec3::NEG_Z);
    let mut renderer = at_rest(device, &scene, UVec2::splat(8));
    let roles = roles("aa/taa", params);
    let before = after(&mut renderer, &roles, 0, 64).color.get(4, 4).0.x;
    assert!((before - 0.5 / PI).abs() < 1e-3, "{before}");
    let mut bright = Snapshot::new(&scene, START);
    bright.lights[0].light.emission = LinearRgb::splat(5.0);
    renderer.set_snapshot(&bright, &bright).unwrap();
    for count in 1..100 {
        let value = after(&mut renderer, &roles, 63 + count, 1).color.get(4, 4).0.x;
        if value - before >= 0.95 * 4.0 * before {
            return count;
        }
    }
    panic!("never");
}

/// Row R-06.
#[test]
fn a_step_is_followed_at_once_with_rejection_and_in_29_frames_without() {
    let device = Device::new().unwrap();
    assert!(frames_to_follow(&device, &[("alpha", "0.1")]) <= 2);
    assert!(frames_to_follow(&device, &[("alpha", "0.1"), ("rejection", "min-max")]) <= 2);
    assert_eq!(frames_to_follow(&device, &[("alpha", "0.1"), ("rejection", "none")]), 29);
}

/// Light that is no number for some frames leaves nothing behind, in whatever way history is judged; nor does the first frame, which has none.
#[test]
fn what_is_no_number_does_not_survive() {
    let device = Device::new().unwrap();
    let mut scene = stage();
    place(&mut scene, shapes::rectangle(100.0, 100.0), lambert(0.5), Affine3A::IDENTITY);
    for emission in [1.0, 0.0] {
        light(&mut scene, LightShape::Directional { half_angle: Default::default() }, emission, Vec3::ZERO, Vec3::NEG_Z);
    }
    let mut renderer = at_rest(&device, &scene, UVec2::splat(8));
    let sane = Snapshot::new(&scene, START);
    // ∞, and ∞ − ∞.
    for second in [0.0, f32::NEG_INFINITY] {
        let mut mad = sane.clone();
        for (light, emission) in mad.lights.iter_mut().zip([f32::INFINITY, second]) {
            light.light.emission = LinearRgb::splat(emission);
        }
        let mut shown = |roles: &RoleSelection, snapshot: &Snapshot, index: u32, count: u32| {
            renderer.set_snapshot(snapshot, snapshot).unwrap();
            after(&mut renderer, roles, index, count).color.get(3, 3).0.x
        };
        assert!(!shown(&roles("aa/none", &[]), &mad, 0, 1).is_finite(), "the fault is planted");
        let taa = ["none", "min-max", "variance"].map(|rejection| roles("aa/taa", &[("rejection", rejection)]));
        for roles in taa.into_iter().chain([roles("aa/accumulate", &[])]) {
            let first = shown(&roles, &mad, 100, 1);
            assert!(first == 0.0, "without history: {first}");
            let (before, later) = (shown(&roles, &sane, 0, 4), [shown(&roles, &mad, 4, 3), shown(&roles, &sane, 7, 1)]);
            assert!((before - 0.5 / PI).abs() < 1e-3, "{before}");
            let accumulates = roles.technique(kajo_techniques::Role::AntiAlias).unwrap().id == "aa/accumulate";
            assert!(later.iter().all(|value| value.is_finite()), "{later:?}");
            // A mean begins anew when the light changes; history goes on.
            assert!(accumulates || later.iter().all(|value| (value - before).abs() < 1e-3), "{before} {later:?}");
        }
    }
}

/// What was hidden one frame ago shows the new frame alone; a tolerance that takes any depth for the same (the planted fault) leaves a ghost.
#[test]
fn disoccluded_pixels_take_no_history() {
    let device = Device::new().unwrap();
    let mut scene = stage();
    let glow = |radiance| Material { emission: LinearRgb::splat(radiance), double_sided: true, ..lambert(0.0) };
    place(&mut scene, shapes::rectangle(200.0, 200.0), glow(0.25), Affine3A::IDENTITY);
    place(&mut scene, shapes::rectangle(20.0, 20.0), glow(1.0), Affine3A::from_translation(Vec3::new(-30.0, 0.0, 4.0)));
    let at = |frame: u32| {
        let mut snapshot = Snapshot::new(&scene, START);
        snapshot.instances[1].world_from_object.translation.x += 6.0 * frame as f32;
        snapshot
    };
    let ghost = |tolerance: &str| {
        let mut renderer = at_rest(&device, &scene, SIZE);
        let roles = roles("aa/taa", &[("rejection", "none"), ("depth_tolerance", tolerance)]);
        let mut last = None;
        for frame in 0..8 {
            renderer.set_snapshot(&at(frame), &at(frame.max(1) - 1)).unwrap();
            last = Some(after(&mut renderer, &roles, frame, 1));
        }
        let color = last.unwrap().color;
        // Right of it from 48 − 30 + 42 − 10 on; where it was: 6 px a frame.
        let left = (20..48).map(|x| color.get(x, 24).0.x - 0.25).fold(0.0, f32::max);
        let inside = (52..68).map(|x| (color.get(x, 24).0.x - 1.0).abs()).fold(0.0, f32::max);
        assert!(inside < 1e-3, "the thing itself is smooth: {inside}");
        left
    };
    let (refused, taken) = (ghost("0.02"), ghost("1"));
    assert!(refused < 1e-3, "ghost {refused}");
    assert!(taken > 0.2, "planted fault: {taken}");
}

/// The picture of a frame is its history: what another technique draws in between has an image of its own.
#[test]
fn other_techniques_do_not_draw_over_the_history() {
    let device = Device::new().unwrap();
    let scene = builtin::load("shadows").unwrap();
    let taa = roles("aa/taa", &[]);
    let size = UVec2::new(64, 36);
    let unbroken = after(&mut at_rest(&device, &scene, size), &taa, 0, 5);
    let mut renderer = at_rest(&device, &scene, size);
    after(&mut renderer, &taa, 0, 4);
    after(&mut renderer, &roles("aa/fxaa", &[]), 4, 1);
    let again = after(&mut renderer, &taa, 4, 1);
    assert_eq!(unbroken.color, again.color);
}

/// A camera comes nearer to a wall by a tenth from one frame to the next, while its light doubles: the history was taken and kept its brightness between pixels where the picture is
/// the mean of both frames.
#[test]
fn what_comes_nearer_keeps_its_history() {
    let device = Device::new().unwrap();
    let mut scene = Scene::default();
    camera(&mut scene, PERSPECTIVE, Vec3::Z * 10.0, Vec3::ZERO);
    place(&mut scene, shapes::rectangle(100.0, 100.0), lambert(0.5), Affine3A::IDENTITY);
    light(&mut scene, LightShape::Directional { half_angle: Default::default() }, 1.0, Vec3::ZERO, Vec3::NEG_Z);
    let far = Snapshot::new(&scene, START);
    let mut near = far.clone();
    near.cameras[0].world_from_view.w_axis.z = 9.0;
    near.lights[0].light.emission = LinearRgb::splat(2.0);
    let size = UVec2::new(48, 32);
    let mut renderer = Renderer::new(&device, &scene, &far, RendererSettings::new(size)).unwrap();
    let roles = roles("aa/taa", &[("rejection", "none")]);
    after(&mut renderer, &roles, 0, 1);
    renderer.set_snapshot(&near, &far).unwrap();
    let picture = after(&mut renderer, &roles, 1, 1).color;
    for (x, y) in (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y))) {
        let mean = 1.5 * 0.5 / PI;
        let value = picture.get(x, y).0.x;
        assert!((value / mean - 1.0).abs() < 1e-4, "({x}, {y}): {value}, not {mean}");
    }
}

/// Root mean square difference of two pictures as a display may show them.
fn rmse(a: &FrameOutput, b: &FrameOutput) -> f32 {
    let shown = |c: &LinearRgb| c.0.min(Vec3::ONE);
    let sum: f32 = a.color.pixels().iter().zip(b.color.pixels()).map(|(a, b)| (shown(a) - shown(b)).length_squared()).sum();
    (sum / (3.0 * a.color.pixels().len() as f32)).sqrt()
}

/// While the camera pans, the history follows: the picture is nearer to the mean over the pixels than one sample is, and not much farther than that
/// of a scene at rest.
#[test]
fn history_follows_a_camera() {
    let device = Device::new().unwrap();
    let scene = builtin::load("moving").unwrap();
    let size = UVec2::new(128, 72);
    let start = Snapshot::new(&scene, Seconds(0.8));
    let at = |frame: u32| Snapshot { cameras: Snapshot::new(&scene, Seconds(0.4 + frame as f32 / 60.0)).cameras, ..start.clone() };
    const LAST: u32 = 24;
    let mut renderer = at_rest(&device, &scene, size);
    renderer.set_snapshot(&at(LAST), &at(LAST)).unwrap();
    let expected = renderer.accumulate(&roles("aa/none", &[]), &FrameSettings::default(), 64).unwrap();
    let one = rmse(&renderer.render(&roles("aa/none", &[]), &FrameSettings::default()).unwrap(), &expected);
    for (rejection, most) in [("variance", 0.8), ("none", 0.6)] {
        let roles = roles("aa/taa", &[("rejection", rejection)]);
        let still = renderer.accumulate(&roles, &FrameSettings { index: 1000, ..Default::default() }, LAST + 1).unwrap();
        let mut moved = None;
        for frame in 0..=LAST {
            renderer.set_snapshot(&at(frame), &at(frame.max(1) - 1)).unwrap();
            moved = Some(after(&mut renderer, &roles, frame, 1));
        }
        let (still, moved) = (rmse(&still, &expected), rmse(&moved.unwrap(), &expected));
        assert!(still < moved && moved < most * one, "{rejection}: one sample {one}, at rest {still}, moving {moved}");
    }
}

/// The edges of a thing that moves are smoothed, too, by history that moves with it: without (numbers of frames that do not follow each other, the
/// planted fault) they are not.
#[test]
fn edges_of_a_moving_thing_stay_smooth() {
    let device = Device::new().unwrap();
    let mut scene = stage();
    let glow = Material { emission: LinearRgb::WHITE, double_sided: true, ..lambert(0.0) };
    let square = Square { middle: Vec2::new(-20.0, 0.3), turn: 0.4 };
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_z(square.turn), square.middle.extend(0.0));
    place(&mut scene, shapes::rectangle(2.0 * HALF, 2.0 * HALF), glow, turned);
    let mut renderer = at_rest(&device, &scene, SIZE);
    let step = Vec2::new(2.37, 0.21);
    let at = |frame: u32| {
        let mut snapshot = Snapshot::new(&scene, START);
        snapshot.instances[0].world_from_object.translation += glam::Vec3A::from((step * frame as f32).extend(0.0));
        snapshot
    };
    let mut error = |stride: u32| {
        let roles = roles("aa/taa", &[]);
        let mut last = None;
        for frame in 0..=16 {
            renderer.set_snapshot(&at(frame), &at(frame.max(1) - 1)).unwrap();
            last = Some(after(&mut renderer, &roles, frame * stride, 1));
        }
        let color = last.unwrap().color;
        let there = Square { middle: square.middle + step * 16.0, turn: square.turn };
        let corners = (0..SIZE.y).flat_map(|y| (0..SIZE.x).map(move |x| Vec2::new(x as f32, y as f32)));
        let near: Vec<Vec2> = corners.filter(|corner| there.distance(*corner + 0.5).abs() < 0.5).collect();
        let off = |corner: &Vec2| (color.get(corner.x as u32, corner.y as u32).0.x - there.coverage(*corner)).abs();
        near.iter().map(off).sum::<f32>() / near.len() as f32
    };
    let (follows, fault) = (error(1), error(2));
    assert!(follows < 0.14 && fault > 0.2, "moving {follows}, without history {fault}");
}
