//! Everything of a scene that shaders read, whoever renders it.

use crate::Error;
use crate::gpu::GpuFrame;
use crate::upload::environment::EnvironmentMap;
use crate::upload::geometry::Geometry;
use crate::upload::lights::Lights;
use crate::upload::materials;
use crate::upload::tables::ModelTables;
use crate::upload::textures::Textures;
use crate::upload::trace::TraceScene;
use glam::{Mat4, Vec3};
use kajo_bsdf::models::ModelEntry;
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Bindings, Buffer, Device};
use kajo_scene::{Environment, Scene, Snapshot};
use kajo_shader_lib::BSDF_TABLES;
use kajo_techniques::shaders::Variant;
use kajo_techniques::{TraceBackend, View};
use kajo_units::LinearRgb;

/// A scene on the device.
pub(crate) struct UploadedScene {
    /// Who traces rays.
    pub backend: TraceBackend,
    /// Reflectance models of its materials.
    models: Vec<&'static ModelEntry>,
    pub geometry: Geometry,
    pub textures: Textures,
    pub lights: Lights,
    pub model_tables: ModelTables,
    materials: Buffer,
    bsdf_tables: Buffer,
    frame: Buffer,
    trace: TraceScene,
    environment: EnvironmentMap,
}

/// What differs from frame to frame.
pub(crate) struct Seen<'a> {
    /// The scene at the time.
    pub snapshot: &'a Snapshot,
    /// The camera.
    pub view: View,
}

impl UploadedScene {
    /// Uploads the scene; rays meet the instances that are `kept`. `backend` `None` takes ray queries where the adapter has them; textures are a list
    /// where that is wanted and the adapter can.
    ///
    /// # Errors
    /// A backend the adapter lacks, or a scene that does not fit.
    pub fn new(
        device: &Device,
        scene: &Scene,
        snapshot: &Snapshot,
        kept: &[bool],
        (backend, bindless): (Option<TraceBackend>, bool),
    ) -> Result<Self, Error> {
        let backend = backend.unwrap_or_else(|| TraceBackend::best(device));
        if backend == TraceBackend::RayQuery && !device.has_ray_query() {
            return Err(Error::NoRayQuery { adapter: device.info().name.clone() });
        }
        let limit = device.info().max_bindless_textures as usize;
        let bindless = bindless && limit > 0 && scene.textures.len() <= limit;
        let geometry = Geometry::new(device, snapshot, snapshot, scene)?;
        let (model_tables, tables) = ModelTables::new(scene);
        Ok(Self {
            backend,
            models: models_of(scene),
            textures: Textures::new(device, scene, bindless)?,
            lights: Lights::new(device, scene, snapshot, None)?,
            materials: device.buffer_with("materials", &materials::pack_all(scene, &model_tables), BufferUsages::STORAGE)?,
            bsdf_tables: device.buffer_with(BSDF_TABLES, tables.numbers(), BufferUsages::STORAGE)?,
            model_tables,
            frame: device.buffer("frame", size_of::<GpuFrame>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)?,
            trace: TraceScene::new(device, backend, snapshot, &geometry, kept, None)?,
            environment: EnvironmentMap::new(device, scene.environment.as_ref())?,
            geometry,
        })
    }

    /// Follows the scene to `current`; what did not change since the last snapshot stays.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn update(&mut self, device: &Device, scene: &Scene, current: &Snapshot, previous: &Snapshot, kept: &[bool]) -> Result<(), Error> {
        self.hold(device, scene, current, previous)?;
        self.keep_for_rays(device, current, kept)?;
        self.lights = Lights::new(device, scene, current, Some(&self.lights))?;
        Ok(())
    }

    /// Rays meet the instances that are `kept` from now on.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn keep_for_rays(&mut self, device: &Device, snapshot: &Snapshot, kept: &[bool]) -> Result<(), Error> {
        self.trace = TraceScene::new(device, self.backend, snapshot, &self.geometry, kept, Some(&self.trace))?;
        Ok(())
    }

    /// Uploads the vertices of both snapshots where they are not there.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn hold(&mut self, device: &Device, scene: &Scene, current: &Snapshot, previous: &Snapshot) -> Result<(), Error> {
        if !self.geometry.holds(current, previous) {
            self.geometry = Geometry::new(device, current, previous, scene)?;
        }
        Ok(())
    }

    /// What its shaders depend on.
    pub fn variant(&self) -> Variant<'_> {
        Variant { backend: self.backend, bindless: self.textures.is_list(), models: &self.models }
    }

    /// Uploads camera, instances and lights of frame number `index`.
    pub fn place(&self, device: &Device, scene: &Scene, now: &Seen, before: &Seen, index: u32, environment_light: bool) {
        let (view, previous) = (&now.view, &before.view);
        let environment = scene.environment.as_ref();
        let clip_from_relative = view.jittered_clip_from_relative();
        let frame = GpuFrame {
            clip_from_relative: clip_from_relative.to_cols_array_2d(),
            relative_from_clip: inverse(clip_from_relative).to_cols_array_2d(),
            previous_clip_from_relative: previous.clip_from_relative().to_cols_array_2d(),
            camera_position: view.position.to_array(),
            index,
            previous_camera_position: previous.position.to_array(),
            light_count: self.lights.list.len() as u32,
            forward: view.relative_from_view.transform_vector3(Vec3::NEG_Z).to_array(),
            near: view.near,
            jitter: view.jitter.to_array(),
            size: view.size.to_array(),
            environment_scale: environment.map_or(LinearRgb::BLACK, |e: &Environment| e.scale).0.to_array(),
            environment_rotation: environment.map_or(0.0, |e| e.rotation.0),
            perspective: u32::from(view.perspective),
            environment_image: u32::from(environment.is_some_and(|e| e.image.is_some())),
            depth_range: view.depth_range(),
            environment_light: u32::from(environment_light),
        };
        self.frame.write(&device.queue, bytemuck::bytes_of(&frame));
        self.geometry.place(device, scene, &self.lights, (now.snapshot, view.position), (before.snapshot, previous.position));
        self.lights.place(device, view.position);
    }

    /// What the shared modules declare, by name.
    pub fn bind(&self) -> Bindings<'_> {
        let shared = Bindings::new()
            .with("frame", &self.frame)
            .with("instances", &self.geometry.instances)
            .with("positions", &self.geometry.positions)
            .with("attributes", &self.geometry.attributes)
            .with("indices", &self.geometry.indices)
            .with("materials", &self.materials)
            .with(BSDF_TABLES, &self.bsdf_tables);
        self.trace.bind(self.textures.bind(self.lights.bind(self.environment.bind(shared))))
    }
}

/// The reflectance models that materials name, each once.
fn models_of(scene: &Scene) -> Vec<&'static ModelEntry> {
    let named = |entry: &&ModelEntry| scene.materials.iter().filter_map(|m| m.model.as_ref()).any(|model| model.entry.id == entry.id);
    kajo_bsdf::models::all().filter(named).collect()
}

/// Inverted in double precision: an infinite far plane makes the numbers of the matrix uneven.
fn inverse(m: Mat4) -> Mat4 {
    m.as_dmat4().inverse().as_mat4()
}
