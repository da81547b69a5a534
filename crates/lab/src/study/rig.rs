//! Small scenes made for a question, and frames and references of them.

use crate::LabError;
use glam::{Affine3A, Mat4, Quat, UVec2, Vec3};
use kajo_image::Image;
use kajo_path_tracer::{Aov, Filter, Settings, Stop, Tracer, render, uncontrolled};
use kajo_render_graph::Device;
use kajo_renderer::{FrameOutput, FrameSettings, Renderer, RendererSettings, RoleSelection};
use kajo_scene::{Camera, Light, LightShape, Material, Mesh, Node, Projection, Scene, Snapshot, Transform};
use kajo_units::{LinearRgb, Meters, Seconds};
use std::sync::Arc;

/// A scene in the making: everything matt and white.
#[derive(Default)]
pub struct Set {
    /// What it is so far.
    pub scene: Scene,
}

impl Set {
    /// Adds a mesh.
    pub fn place(mut self, mesh: Mesh, world_from_object: Affine3A) -> Self {
        if self.scene.materials.is_empty() {
            let white = LinearRgb::splat(0.7);
            self.scene.materials.push(Material { base_color: white, metallic: 0.0, specular: 0.0, ..Material::default() });
        }
        self.scene.meshes.push(Arc::new(Mesh { material: 0, ..mesh }));
        let meshes = vec![self.scene.meshes.len() - 1];
        self.scene.nodes.push(Node { transform: Transform::Matrix(Mat4::from(world_from_object)), meshes, ..Node::default() });
        self
    }

    /// Adds a light at `position` that shines towards `target`.
    pub fn light(mut self, shape: LightShape, position: Vec3, target: Vec3) -> Self {
        self.scene.lights.push(Light { name: String::new(), shape, emission: LinearRgb::splat(1.0) });
        let transform = Transform::Matrix(Mat4::from(shining(position, target)));
        self.scene.nodes.push(Node { transform, light: Some(self.scene.lights.len() - 1), ..Node::default() });
        self
    }

    /// Adds a camera at `eye` that looks at `target`.
    pub fn camera(mut self, projection: Projection, eye: Vec3, target: Vec3) -> Self {
        let (near, focus_distance) = (Meters(0.01), Meters(1.0));
        self.scene.cameras.push(Camera { name: String::new(), projection, lens_radius: Meters(0.0), focus_distance, near });
        let transform = Transform::Matrix(looking(eye, target));
        self.scene.nodes.push(Node { transform, camera: Some(self.scene.cameras.len() - 1), ..Node::default() });
        self
    }
}

/// The place of a light at `position` that shines towards `target`.
pub fn shining(position: Vec3, target: Vec3) -> Affine3A {
    let rotation = Quat::from_rotation_arc(Vec3::NEG_Z, (target - position).normalize());
    Affine3A::from_rotation_translation(rotation, position)
}

/// The place of a camera at `eye` that looks at `target`.
pub fn looking(eye: Vec3, target: Vec3) -> Mat4 {
    let forward = (target - eye).normalize();
    let up = if forward.y.abs() > 0.9 { Vec3::NEG_Z } else { Vec3::Y };
    glam::camera::rh::view::look_at_mat4(eye, target, up).inverse()
}

/// A scene on the device; its snapshot may be changed between frames.
pub struct Rig {
    renderer: Renderer,
    scene: Scene,
    /// The scene as it stands.
    pub snapshot: Snapshot,
    size: UVec2,
}

impl Rig {
    /// Uploads a scene.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn new(device: &Device, scene: Scene, size: UVec2) -> Result<Self, LabError> {
        let snapshot = Snapshot::new(&scene, Seconds(0.0));
        let renderer = Renderer::new(device, &scene, &snapshot, RendererSettings::new(size)).map_err(not_measured)?;
        Ok(Self { renderer, scene, snapshot, size })
    }

    /// Size of the images, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// One frame with `ID[:param=value,…]`, G-buffer included.
    ///
    /// # Errors
    /// When the technique cannot run.
    pub fn frame(&mut self, technique: &str) -> Result<FrameOutput, LabError> {
        self.run(technique, false)
    }

    /// The frame with the technique's debug views.
    ///
    /// # Errors
    /// As [`Self::frame`].
    pub fn debug_frame(&mut self, technique: &str) -> Result<FrameOutput, LabError> {
        self.run(technique, true)
    }

    fn run(&mut self, technique: &str, debug: bool) -> Result<FrameOutput, LabError> {
        let (technique, params) = kajo_techniques::parse(technique)?;
        self.renderer.set_snapshot(&self.snapshot, &self.snapshot).map_err(not_measured)?;
        let settings = FrameSettings { gbuffer: true, debug, ..FrameSettings::default() };
        self.renderer.render(&RoleSelection::new().with(technique, params), &settings).map_err(not_measured)
    }

    /// Visibility of the first light by the path tracer, at pixel centres.
    ///
    /// # Errors
    /// When the tracer refuses.
    pub fn visibility(&self, spp: u32) -> Result<Image<f32>, LabError> {
        let tracer = Tracer::new(&self.scene, self.snapshot.clone())?;
        let aovs = vec![Aov::Visibility("*".into())];
        let settings = Settings { size: self.size, filter: Filter::Center, max_depth: 1, aovs, ..Settings::default() };
        let frame = render(&tracer, &settings, Stop::at_spp(spp), None, &uncontrolled)?.develop();
        let image = frame.images.iter().find(|image| image.name.starts_with("visibility.")).expect("an image that was asked for");
        Ok(image.pixels.to_color().map(|v| v[0]))
    }
}

fn not_measured(error: kajo_renderer::Error) -> LabError {
    LabError::NotMeasured { reason: error.to_string() }
}
