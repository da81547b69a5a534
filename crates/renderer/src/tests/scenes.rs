//! Small scenes, frames of them, and what the path tracer says about the same pixels.

use crate::{FrameOutput, FrameSettings, Renderer, RendererSettings, RoleSelection};
use glam::{Affine3A, Mat4, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::{Aov, Filter, Frame, Settings, Stop, Tracer, render, uncontrolled};
use kajo_render_graph::Device;
use kajo_scene::{Camera, Light, LightShape, Material, Mesh, Node, Projection, Scene, Snapshot, Transform};
use kajo_techniques::TraceBackend;
use kajo_units::{LinearRgb, Meters, Radians, Seconds};
use std::path::PathBuf;
use std::sync::Arc;

pub const START: Seconds = Seconds(0.0);

/// A matt surface.
pub fn lambert(albedo: f32) -> Material {
    Material { base_color: LinearRgb::splat(albedo), metallic: 0.0, specular: 0.0, ..Material::default() }
}

/// Adds a mesh with its own material.
pub fn place(scene: &mut Scene, mesh: Mesh, material: Material, parent_from_local: Affine3A) {
    let mesh = Mesh { material: scene.materials.len(), ..mesh };
    scene.materials.push(material);
    scene.meshes.push(Arc::new(mesh));
    let meshes = vec![scene.meshes.len() - 1];
    scene.nodes.push(Node { transform: Transform::Matrix(Mat4::from(parent_from_local)), meshes, ..Node::default() });
}

/// Adds a light at `position` that shines along `direction`.
pub fn light(scene: &mut Scene, shape: LightShape, emission: f32, position: Vec3, direction: Vec3) {
    scene.lights.push(Light { name: String::new(), shape, emission: LinearRgb::splat(emission) });
    let rotation = Quat::from_rotation_arc(Vec3::NEG_Z, direction.normalize());
    let transform = Transform::Trs { translation: position, rotation, scale: Vec3::ONE };
    scene.nodes.push(Node { transform, light: Some(scene.lights.len() - 1), ..Node::default() });
}

/// Adds a camera at `eye` that looks at `target`.
pub fn camera(scene: &mut Scene, projection: Projection, eye: Vec3, target: Vec3) {
    let (near, focus_distance) = (Meters(0.01), Meters(1.0));
    scene.cameras.push(Camera { name: String::new(), projection, lens_radius: Meters(0.0), focus_distance, near });
    let forward = (target - eye).normalize();
    let up = if forward.y.abs() > 0.9 { Vec3::NEG_Z } else { Vec3::Y };
    let transform = Transform::Matrix(glam::camera::rh::view::look_at_mat4(eye, target, up).inverse());
    scene.nodes.push(Node { transform, camera: Some(scene.cameras.len() - 1), ..Node::default() });
}

pub const PERSPECTIVE: Projection = Projection::Perspective { yfov: Radians(0.7), aspect: None };

/// A file of the test assets, or `None` with a note.
pub fn asset(name: &str) -> Option<Scene> {
    let folder = std::env::var_os("KAJO_ASSETS")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets"), PathBuf::from);
    let path = folder.join(name);
    if !path.exists() {
        eprintln!("skipped: {} is not there; set KAJO_ASSETS", path.display());
        return None;
    }
    Some(kajo_scene::load(path.to_str().unwrap(), &Default::default()).unwrap())
}

/// A renderer of the scene at its start, without cached images.
pub fn renderer(device: &Device, scene: &Scene, size: UVec2, backend: Option<TraceBackend>) -> Renderer {
    let settings = RendererSettings { backend, ..RendererSettings::new(size) };
    Renderer::new(device, scene, &Snapshot::new(scene, START), settings).unwrap()
}

/// One frame with one technique.
pub fn frame(device: &Device, scene: &Scene, size: UVec2, technique: &str, params: &[(&str, &str)]) -> FrameOutput {
    let roles = RoleSelection::new().choose(technique, params).unwrap();
    let settings = FrameSettings { gbuffer: true, ..Default::default() };
    renderer(device, scene, size, None).render(&roles, &settings).unwrap()
}

/// The path tracer at pixel centres: `spp` samples of the given images, direct light only.
pub fn reference(scene: &Scene, now: Seconds, before: Option<Seconds>, size: UVec2, spp: u32, aovs: Vec<Aov>) -> Frame {
    let mut tracer = Tracer::new(scene, Snapshot::new(scene, now)).unwrap();
    if let Some(before) = before {
        tracer = tracer.with_previous(Snapshot::new(scene, before)).unwrap();
    }
    traced(&tracer, size, 1, spp, aovs)
}

/// One image of the path tracer at pixel centres, at the start, by light that met at most `depth` surfaces: 2 has bounced once.
pub fn bounced(scene: &Scene, size: UVec2, depth: u32, spp: u32, aov: Aov) -> Image<LinearRgb> {
    let tracer = Tracer::new(scene, Snapshot::new(scene, START)).unwrap();
    traced(&tracer, size, depth, spp, vec![aov.clone()]).image(&aov.to_string()).unwrap().pixels.to_color()
}

fn traced(tracer: &Tracer, size: UVec2, max_depth: u32, spp: u32, aovs: Vec<Aov>) -> Frame {
    let settings = Settings { size, filter: Filter::Center, max_depth, aovs, smooth_terminator: false, ..Settings::default() };
    render(tracer, &settings, Stop::at_spp(spp), None, &uncontrolled).unwrap().develop()
}

/// Pixels more than one pixel away from any change of `image`: off the border.
pub fn off_border(image: &dyn Fn(u32, u32) -> f32, size: UVec2) -> Vec<UVec2> {
    let near = |x: u32, y: u32| {
        let value = image(x, y);
        (y.saturating_sub(1)..=(y + 1).min(size.y - 1))
            .any(|v| (x.saturating_sub(1)..=(x + 1).min(size.x - 1)).any(|u| (image(u, v) - value).abs() > 0.5))
    };
    (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y))).filter(|p| !near(p.x, p.y)).collect()
}
