//! What moves: the animation of the scene where it has one, else its camera, its strongest light and one of its things.

use crate::subject::Subject;
use glam::{Affine3A, Mat4, Quat, UVec2, Vec3};
use kajo_path_tracer::Tracer;
use kajo_renderer::{GBufferImages, nothing_moves};
use kajo_scene::framing::bounds;
use kajo_scene::{LightShape, Projection, Snapshot};
use kajo_units::Seconds;
use std::collections::BTreeMap;

/// A sequence of snapshots.
pub struct Motion {
    /// What moves.
    pub name: &'static str,
    /// One for each frame.
    pub snapshots: Vec<Snapshot>,
}

/// Frames a second.
const RATE: f32 = 30.0;

/// Turn of the camera about the middle of what it sees, and of parallel light about the vertical, a frame.
const TURN: f32 = 0.5 / 180.0 * std::f32::consts::PI;

/// Way of a light, a frame, as a share of the size of the scene.
const LIGHT_STEP: f32 = 0.01;

/// Way of a thing, a frame, px.
const THING_STEP: f32 = 3.0;

/// Frames of ordinary motion that a light jumps by at once.
const JUMP: f32 = 10.0;

/// Share of the picture that the thing which moves has best.
const THING_SHARE: f32 = 0.04;

/// Things that have less or more of the picture do not move: specks, and walls.
const THING_SHARES: std::ops::RangeInclusive<f32> = 0.002..=0.3;

/// `count` frames of each motion that the scene allows.
pub fn motions(subject: &Subject, tracer: &Tracer, first: &GBufferImages, size: UVec2, count: u32) -> Vec<Motion> {
    let frames = |of: &dyn Fn(f32) -> Snapshot| (0..count).map(|frame| of(frame as f32)).collect::<Vec<_>>();
    let start = &subject.snapshot;
    let played = frames(&|frame| Snapshot::new(&subject.scene, Seconds(start.time.0 + frame / RATE)));
    if played.windows(2).any(|pair| !nothing_moves(&pair[0], &pair[1])) {
        return vec![Motion { name: "animation", snapshots: played }];
    }
    let mut out = vec![Motion { name: "camera", snapshots: frames(&|frame| orbit(subject, frame * TURN)) }];
    if strongest(tracer).is_some() {
        out.push(Motion { name: "light", snapshots: frames(&|frame| moved_light(subject, tracer, frame)) });
    }
    if let Some((instance, step)) = thing(subject, first, size) {
        let snapshots = frames(&|frame| moved_thing(start, instance, step * frame));
        out.push(Motion { name: "object", snapshots });
    }
    out
}

/// The scene, and the scene after its strongest light has jumped.
pub fn step_of_a_light(subject: &Subject, tracer: &Tracer) -> Option<[Snapshot; 2]> {
    strongest(tracer)?;
    Some([subject.snapshot.clone(), moved_light(subject, tracer, JUMP)])
}

fn strongest(tracer: &Tracer) -> Option<usize> {
    tracer.strongest_lights(1).first().copied()
}

/// Middle and size of the scene.
fn extent(snapshot: &Snapshot) -> (Vec3, f32) {
    let [low, high] = bounds(&snapshot.meshes, &snapshot.instances);
    (0.5 * (low + high), (high - low).length())
}

/// Axes of the camera: to the right, and where it looks.
fn axes(subject: &Subject) -> (Vec3, Vec3) {
    let world_from_view = subject.snapshot.cameras[subject.camera].world_from_view;
    (world_from_view.x_axis.truncate(), -world_from_view.z_axis.truncate())
}

fn orbit(subject: &Subject, angle: f32) -> Snapshot {
    let mut out = subject.snapshot.clone();
    let (middle, size) = extent(&out);
    let (_, forward) = axes(subject);
    let camera = &mut out.cameras[subject.camera].world_from_view;
    let eye = camera.w_axis.truncate();
    let pivot = eye + forward * (middle - eye).dot(forward).clamp(0.05 * size, size);
    *camera = Mat4::from_translation(pivot) * Mat4::from_rotation_y(angle) * Mat4::from_translation(-pivot) * *camera;
    out
}

fn moved_light(subject: &Subject, tracer: &Tracer, frames: f32) -> Snapshot {
    let mut out = subject.snapshot.clone();
    let (_, size) = extent(&out);
    let (right, _) = axes(subject);
    let way = right * (LIGHT_STEP * size * frames);
    let Some(light) = strongest(tracer) else { return out };
    let analytic = out.lights.len();
    if let Some(placed) = out.lights.get_mut(light) {
        let world = &mut placed.world_from_light;
        if let LightShape::Directional { .. } = placed.light.shape {
            *world = Affine3A::from_quat(Quat::from_rotation_y(TURN * frames)) * *world;
        } else {
            world.translation += glam::Vec3A::from(way);
        }
    } else {
        let scene = &subject.scene;
        let emits = |mesh: usize| scene.materials.get(out.meshes[mesh].material).is_some_and(|material| material.is_emissive());
        let emitters: Vec<usize> = (0..out.instances.len()).filter(|&i| emits(out.instances[i].mesh)).collect();
        if let Some(&instance) = emitters.get(light - analytic) {
            return moved_thing(&out, instance, way);
        }
    }
    out
}

fn moved_thing(start: &Snapshot, instance: usize, way: Vec3) -> Snapshot {
    let mut out = start.clone();
    out.instances[instance].world_from_object.translation += glam::Vec3A::from(way);
    out
}

/// The instance that moves, and its way a frame: [`THING_STEP`] to the right in the picture.
fn thing(subject: &Subject, first: &GBufferImages, size: UVec2) -> Option<(usize, Vec3)> {
    let mut pixels: BTreeMap<u32, (u32, f32)> = BTreeMap::new();
    for (id, depth) in first.instance.pixels().iter().zip(first.depth.pixels()) {
        if let Some(id) = id {
            let entry = pixels.entry(*id).or_default();
            *entry = (entry.0 + 1, entry.1 + depth);
        }
    }
    let share = |count: u32| count as f32 / size.element_product() as f32;
    let miss = |count: u32| (share(count) / THING_SHARE).ln().abs();
    let candidates = pixels.iter().filter(|(_, (count, _))| THING_SHARES.contains(&share(*count)));
    let (id, (count, depth)) = candidates.min_by(|a, b| miss(a.1.0).total_cmp(&miss(b.1.0)))?;
    let pixel = match subject.snapshot.cameras[subject.camera].camera.projection {
        Projection::Perspective { yfov, .. } => 2.0 * (0.5 * yfov.0).tan() * depth / *count as f32,
        Projection::Orthographic { ymag, .. } => 2.0 * ymag.0,
    } / size.y as f32;
    Some((*id as usize, axes(subject).0 * (pixel * THING_STEP)))
}
