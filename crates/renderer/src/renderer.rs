//! A scene on the device, and its frames.

use crate::effects::{Effects, Insight, Made};
use crate::output::FrameOutput;
use crate::passes::{
    Setup, background::Background, direct::Direct, forward::Forward, gbuffer::GBuffer, gbuffer::TARGETS, lit::Lit, picture::Picture,
};
use crate::placement::Boxes;
use crate::settings::{FrameSettings, RendererSettings, RoleSelection};
use crate::upload::scene::{Seen, UploadedScene};
use crate::{Error, ignored, motion, nothing_moves, read};
use glam::UVec2;
use kajo_image::Image;
use kajo_render_graph::wgpu;
use kajo_render_graph::{Device, Graph, Pool, Slot, Timings, slot};
use kajo_sampling::halton_2d;
use kajo_scene::{Ignored, PlacedCamera, Scene, Snapshot};
use kajo_techniques::{FrameContext, MakeContext, Role, TraceBackend, View};
use kajo_units::LinearRgb;

/// A scene on the device, ready to be rendered.
pub struct Renderer {
    device: Device,
    settings: RendererSettings,
    scene: Scene,
    uploaded: UploadedScene,
    current: Snapshot,
    previous: Snapshot,
    boxes: Boxes,
    /// Lights whose visibility is read back.
    watched: Vec<usize>,
    /// Instances that rays meet.
    kept: Vec<bool>,
    gbuffer: GBuffer,
    background: Background,
    direct: Direct,
    lit: Lit,
    picture: Picture,
    forward: Option<Forward>,
    effects: Vec<Made>,
    pool: Pool,
    /// Number of the last frame since the scene was moved.
    last_index: Option<u32>,
    /// Nothing moved since the frame before.
    still: bool,
}

/// Instances that rays meet, as the camera is placed in the snapshot.
fn kept_for_rays(scene: &Scene, snapshot: &Snapshot, settings: &RendererSettings) -> Vec<bool> {
    let camera = &snapshot.cameras[settings.camera.min(snapshot.cameras.len() - 1)];
    settings.ray_culling.kept(scene, snapshot, camera, settings.size.x as f32 / settings.size.y as f32)
}

/// Slots that the first graph of a frame makes for the others.
fn made_first() -> Vec<Slot> {
    TARGETS.into_iter().chain([slot::DEPTH, slot::BACKGROUND, slot::DIRECT]).collect()
}

/// A graph whose passes find the images of these slots made.
fn graph_after<'a>(slots: &[Slot]) -> Graph<'a> {
    let mut graph = Graph::new();
    graph.import(&made_first());
    graph.import(slots);
    graph
}

impl Renderer {
    /// Uploads the scene as `snapshot` has it and makes the pipelines that every frame needs.
    ///
    /// # Errors
    /// A size of 0 or beyond the adapter's limit, a camera that is not there, a backend the adapter lacks, or a scene that does not fit.
    pub fn new(device: &Device, scene: &Scene, snapshot: &Snapshot, settings: RendererSettings) -> Result<Self, Error> {
        device.check_size(settings.size)?;
        if settings.camera >= snapshot.cameras.len() {
            return Err(Error::NoSuchCamera { got: settings.camera, count: snapshot.cameras.len() });
        }
        let kept = kept_for_rays(scene, snapshot, &settings);
        let uploaded = UploadedScene::new(device, scene, snapshot, &kept, (settings.backend, settings.bindless))?;
        let setup = Setup { device, variant: uploaded.variant(), textures: uploaded.textures.count() };
        let blendable = device.features().contains(wgpu::Features::FLOAT32_BLENDABLE);
        let lights = uploaded.lights.list.len();
        let out = Self {
            settings,
            boxes: Boxes::new(snapshot),
            watched: (0..lights).collect(),
            gbuffer: GBuffer::new(setup)?,
            background: Background::new(setup)?,
            direct: Direct::new(setup, settings.light_samples)?,
            lit: Lit::new(setup)?,
            picture: Picture::new(setup)?,
            forward: if blendable { Some(Forward::new(setup, settings.light_samples)?) } else { None },
            effects: Vec::new(),
            pool: pool(&settings, lights),
            last_index: None,
            still: true,
            uploaded,
            kept,
            current: snapshot.clone(),
            previous: snapshot.clone(),
            scene: scene.clone(),
            device: device.clone(),
        };
        device.wait()?;
        Ok(out)
    }

    /// Moves the scene to `current`; motion vectors of the next frame are measured against `previous`, the snapshot of one frame ago. Both must
    /// be snapshots of the scene that the renderer was made with. Frames after the next one show a scene at rest until it is moved again.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn set_snapshot(&mut self, current: &Snapshot, previous: &Snapshot) -> Result<(), Error> {
        if self.settings.camera >= current.cameras.len() {
            return Err(Error::NoSuchCamera { got: self.settings.camera, count: current.cameras.len() });
        }
        self.kept = kept_for_rays(&self.scene, current, &self.settings);
        let all = self.watched.len() == self.uploaded.lights.list.len();
        self.uploaded.update(&self.device, &self.scene, current, previous, &self.kept)?;
        let count = self.uploaded.lights.list.len();
        self.watched = if all { (0..count).collect() } else { self.watched.iter().copied().filter(|&light| light < count).collect() };
        self.boxes = Boxes::new(current);
        self.still = nothing_moves(&self.current, current) && nothing_moves(current, previous);
        self.last_index = None;
        self.current = current.clone();
        self.previous = previous.clone();
        self.device.wait()?;
        Ok(())
    }

    /// Renders images of `size` from now on; everything that does not depend on it stays.
    ///
    /// # Errors
    /// A size of 0 or beyond the adapter's limit; nothing has changed then.
    pub fn resize(&mut self, size: UVec2) -> Result<(), Error> {
        self.device.check_size(size)?;
        if size != self.settings.size {
            self.settings.size = size;
            self.pool = pool(&self.settings, self.uploaded.lights.list.len());
            self.last_index = None;
            self.keep_for_rays()?;
        }
        Ok(())
    }

    /// Chooses again which instances rays meet, after the camera or the shape of its image has changed.
    fn keep_for_rays(&mut self) -> Result<(), Error> {
        let kept = kept_for_rays(&self.scene, &self.current, &self.settings);
        if kept != self.kept {
            self.uploaded.keep_for_rays(&self.device, &self.current, &kept)?;
            self.kept = kept;
        }
        Ok(())
    }

    /// Looks through `current` from now on; motion vectors are measured against `previous`, the camera of one frame ago.
    /// It replaces the chosen camera until the next [`Self::set_snapshot`]. Where rays leave instances out by the camera, the structure
    /// that they walk is built again when others are left out.
    ///
    /// # Errors
    /// When the device refuses.
    pub fn set_camera(&mut self, current: &PlacedCamera, previous: &PlacedCamera) -> Result<(), Error> {
        let index = self.settings.camera.min(self.current.cameras.len() - 1);
        self.still &= motion::same_view(&self.current.cameras[index], current) && motion::same_view(current, previous);
        self.last_index = None;
        self.current.cameras[index] = current.clone();
        self.previous.cameras[index] = previous.clone();
        self.keep_for_rays()
    }

    /// What this renderer does not simulate in this scene.
    pub fn ignored(&self) -> Vec<Ignored> {
        ignored::find(&self.scene, &self.current, &self.uploaded.model_tables, self.settings.camera, self.forward.is_some())
    }

    /// Names of the lights, as the path tracer has them: analytic ones, then emissive meshes, each in the snapshot's order.
    pub fn light_names(&self) -> &[String] {
        &self.uploaded.lights.names
    }

    /// Reads back the visibility of these lights only, by index, in ascending order; at first it is every light.
    pub fn watch(&mut self, lights: &[usize]) {
        self.watched = lights.iter().copied().filter(|&light| light < self.uploaded.lights.list.len()).collect();
        self.watched.sort_unstable();
    }

    /// Who traces rays.
    pub fn backend(&self) -> TraceBackend {
        self.uploaded.backend
    }

    /// Length of the list of textures that shaders choose from.
    #[cfg(test)]
    pub(crate) fn texture_count(&self) -> u32 {
        self.uploaded.textures.count()
    }

    /// The camera of a frame whose technique of the role anti-alias does not choose where pixels are sampled.
    pub fn view(&self, settings: &FrameSettings) -> View {
        self.view_of(&self.current).jittered(settings.jitter)
    }

    /// Renders one frame and reads it back. What techniques keep from frame to frame goes on where `settings.index` follows that of the frame
    /// before, and begins anew elsewhere.
    ///
    /// # Errors
    /// When a chosen technique cannot run on this device, or the device refuses or is lost.
    pub fn render(&mut self, roles: &RoleSelection, settings: &FrameSettings) -> Result<FrameOutput, Error> {
        if self.last_index.is_some_and(|last| last != settings.index) {
            self.rest()?;
        }
        self.last_index = Some(settings.index);
        let mut made = Effects::take(|role| self.take_effect(roles, role))?;
        let still = self.still;
        self.still &= made.anti_alias.beside.as_ref().is_none_or(|beside| beside == roles);
        made.anti_alias.beside = Some(roles.clone());
        let jitter = settings.jitter + made.anti_alias.effect.jitter(settings.index);
        let view = self.view_of(&self.current).jittered(jitter);
        let before = Seen { snapshot: &self.previous, view: self.view_of(&self.previous) };
        let now = Seen { snapshot: &self.current, view };
        self.uploaded.place(&self.device, &self.scene, &now, &before, settings.index, settings.environment_light);
        let rendered = self.run(&view, settings, &mut made);
        self.effects.extend(made.into_all());
        self.still = still;
        rendered
    }

    /// Frames after which the picture of these techniques has forgotten how it began; 0 where no technique keeps anything from frame to frame.
    ///
    /// # Errors
    /// When a chosen technique cannot run on this device.
    pub fn history(&mut self, roles: &RoleSelection) -> Result<u32, Error> {
        let mut longest = 0;
        for made in Effects::take(|role| self.take_effect(roles, role))?.into_all() {
            longest = longest.max(made.effect.history());
            self.effects.push(made);
        }
        Ok(longest)
    }

    /// `count` frames (1 or more), each sampled elsewhere in its pixels, with random numbers of its own: smooth edges, and less noise from techniques
    /// that have some. `color` is their mean, at the points of the Halton sequence in bases 2 and 3; or what the technique of the role anti-alias
    /// made of them, where that keeps a history. `direct` is their mean, timings and rays are sums; the G-buffer is the first frame's, everything
    /// else the last one's.
    ///
    /// # Errors
    /// Those of [`Renderer::render`].
    pub fn accumulate(&mut self, roles: &RoleSelection, settings: &FrameSettings, count: u32) -> Result<FrameOutput, Error> {
        let gathers = self.history(roles)? > 0;
        let mut mean: Option<FrameOutput> = None;
        for i in 0..count.max(1) {
            // Point 0 is the corner of the square.
            let jitter = if gathers { settings.jitter } else { settings.jitter + halton_2d(i + 1) - 0.5 };
            let gbuffer = settings.gbuffer && i == 0;
            let mut frame = self.render(roles, &FrameSettings { index: settings.index.wrapping_add(i), jitter, gbuffer, ..*settings })?;
            if let Some(before) = mean {
                let share = 1.0 / (i + 1) as f32;
                let blend = |now: &Image<LinearRgb>, old: &Image<LinearRgb>| {
                    Image::from_fn(now.size(), |x, y| *old.get(x, y) * (1.0 - share) + *now.get(x, y) * share)
                };
                if !gathers {
                    frame.color = blend(&frame.color, &before.color);
                }
                frame.direct = blend(&frame.direct, &before.direct);
                frame.timings.merge(&before.timings);
                frame.rays += before.rays;
                frame.technique_rays.iter_mut().zip(before.technique_rays).for_each(|(now, before)| now.1 += before.1);
                frame.gbuffer = before.gbuffer;
            }
            mean = Some(frame);
        }
        Ok(mean.expect("at least one frame"))
    }

    /// The scene has not been moved since the last frame.
    fn rest(&mut self) -> Result<(), Error> {
        self.still = true;
        self.uploaded.hold(&self.device, &self.scene, &self.current, &self.current)?;
        self.previous = self.current.clone();
        Ok(())
    }

    fn run(&mut self, view: &View, settings: &FrameSettings, made: &mut Effects) -> Result<FrameOutput, Error> {
        let device = self.device.clone();
        let mut pool = std::mem::take(&mut self.pool);
        let mut visibility: Vec<Image<f32>> = Vec::new();
        let (mut insight, mut timings) = (Insight::default(), Timings::default());
        let Effects { shadow, ambient, diffuse, specular, anti_alias, tone } = made;

        let seen = if settings.culling { self.boxes.seen(&self.current, view) } else { vec![true; self.uploaded.geometry.draws.len()] };
        let all = self.context(view, settings, 0, 0);
        let mut graph = Graph::new();
        self.gbuffer.record(&all, &seen, &mut graph);
        self.background.record(&all, &mut graph);
        Direct::record_clear(&mut graph);
        timings.merge(&graph.execute(&device, &mut pool)?);

        let around = FrameContext { device: &ambient.device.clone(), ..self.context(view, settings, 0, 0) };
        timings.merge(&ambient.prepare(&around, &pool)?);
        let mut graph = graph_after(&[]);
        ambient.record(&around, &mut graph);
        timings.merge(&graph.execute(&device, &mut pool)?);
        ambient.tell(&around, &mut insight)?;

        let group = pool.lights() as usize;
        for start in (0..self.uploaded.lights.list.len()).step_by(group) {
            let count = group.min(self.uploaded.lights.list.len() - start);
            let frame = FrameContext { device: &shadow.device.clone(), ..self.context(view, settings, start, count) };
            timings.merge(&shadow.prepare(&frame, &pool)?);
            self.direct.prepare(&frame, specular.effect.mirrors_up_to());
            let mut graph = graph_after(&[]);
            shadow.record(&frame, &mut graph);
            self.direct.record(&frame, &mut graph);
            timings.merge(&graph.execute(&device, &mut pool)?);
            for light in self.watched.iter().filter(|light| (start..start + count).contains(light)) {
                visibility.push(read::scalar(&device, &pool, slot::SHADOW_VISIBILITY, (light - start) as u32)?);
            }
            shadow.tell(&frame, &mut insight)?;
        }
        if settings.forward
            && let Some(forward) = &self.forward
        {
            forward.prepare_opaque(&all, specular.effect.mirrors_up_to());
            let mut graph = graph_after(&[]);
            forward.record_opaque(&all, &seen, &mut graph);
            timings.merge(&graph.execute(&device, &mut pool)?);
        }

        let bounced = FrameContext { device: &diffuse.device.clone(), ..self.context(view, settings, 0, 0) };
        timings.merge(&diffuse.prepare(&bounced, &pool)?);
        let mut graph = graph_after(&[slot::AMBIENT_VISIBILITY]);
        diffuse.record(&bounced, &mut graph);
        self.lit.record(&all, &mut graph);
        timings.merge(&graph.execute(&device, &mut pool)?);
        diffuse.tell(&bounced, &mut insight)?;

        let mirrored = FrameContext { device: &specular.device.clone(), ..self.context(view, settings, 0, 0) };
        let resolving = FrameContext { device: &anti_alias.device.clone(), ..self.context(view, settings, 0, 0) };
        let last = FrameContext { device: &tone.device.clone(), ..self.context(view, settings, 0, 0) };
        let order = self.boxes.far_to_near(&self.current, &self.uploaded.geometry.draws, &seen, view);
        timings.merge(&specular.prepare(&mirrored, &pool)?);
        timings.merge(&anti_alias.prepare(&resolving, &pool)?);
        timings.merge(&tone.prepare(&last, &pool)?);
        let mut graph = graph_after(&[slot::AMBIENT_VISIBILITY, slot::DIFFUSE_INDIRECT, slot::LIT]);
        specular.record(&mirrored, &mut graph);
        self.picture.record(&all, &mut graph);
        if let (Some(forward), false) = (&self.forward, order.is_empty()) {
            forward.record_blended(&all, &order, &mut graph);
        }
        anti_alias.record(&resolving, &mut graph);
        tone.record(&last, &mut graph);
        timings.merge(&graph.execute(&device, &mut pool)?);
        specular.tell(&mirrored, &mut insight)?;

        let technique_rays = made.rays(&device)?;
        let output = FrameOutput {
            color: read::radiance(&device, &pool, slot::RESOLVED)?,
            display: read::display(&device, &pool)?,
            direct: read::radiance(&device, &pool, slot::DIRECT)?,
            visibility,
            estimates: settings.read.roles().map(|role| Ok((role, read::estimate(&device, &pool, role)?))).collect::<Result<_, Error>>()?,
            gbuffer: if settings.gbuffer { Some(read::gbuffer(&device, &pool, view)?) } else { None },
            timings,
            memory_bytes: device.memory_bytes(),
            technique_bytes: made.bytes(&pool),
            rays: technique_rays.iter().map(|(_, rays)| rays).sum(),
            technique_rays,
            draws: seen.iter().filter(|seen| **seen).count() as u32,
            culled_draws: seen.iter().filter(|seen| !**seen).count() as u32,
            shaded_pixels: if self.uploaded.lights.list.is_empty() { 0 } else { self.direct.shaded(&device)? },
            statistics: insight.statistics,
            debug: insight.debug,
            ignored: self.ignored().into_iter().chain(made.notes()).collect(),
        };
        self.pool = pool;
        Ok(output)
    }

    /// The effect chosen for a role, taken out of those that were made before, or made now.
    fn take_effect(&mut self, roles: &RoleSelection, role: Role) -> Result<Made, Error> {
        let choice = match roles.choice(role) {
            Some(choice) => choice.clone(),
            None => RoleSelection::default().choice(role).expect("every role that a frame needs has a default").clone(),
        };
        if let Some(index) = self.effects.iter().position(|made| made.choice == choice) {
            return Ok(self.effects.swap_remove(index));
        }
        let device = self.device.counting_apart();
        let context = MakeContext { device: &device, variant: self.uploaded.variant(), textures: self.uploaded.textures.count() };
        Made::new(choice, device.clone(), &context)
    }

    fn view_of(&self, snapshot: &Snapshot) -> View {
        let camera = &snapshot.cameras[self.settings.camera.min(snapshot.cameras.len() - 1)];
        self.boxes.view(camera, self.settings.size)
    }

    /// What techniques are given for the lights `start..start + count`.
    pub(crate) fn context(&self, view: &View, settings: &FrameSettings, start: usize, count: usize) -> FrameContext<'_> {
        FrameContext {
            device: &self.device,
            view: *view,
            index: settings.index,
            still: self.still,
            lights: &self.uploaded.lights.list[start..start + count],
            first_light: start as u32,
            draws: &self.uploaded.geometry.draws,
            indices: &self.uploaded.geometry.indices.wgpu,
            scene: &self.scene,
            snapshot: &self.current,
            bounds: self.boxes.world,
            ambient_distance: settings.ambient_distance,
            environment_light: settings.environment_light,
            debug: settings.debug,
            exposure: settings.exposure.or(self.scene.exposure).unwrap_or(0.0),
            shared: self.uploaded.bind(),
        }
    }
}

/// Images for frames, with as many layers for lights as the settings' memory holds.
fn pool(settings: &RendererSettings, lights: usize) -> Pool {
    let layer = u64::from(settings.size.x) * u64::from(settings.size.y) * 4;
    let layers = (settings.light_memory / layer).clamp(1, lights.clamp(1, 64) as u64) as u32;
    Pool::new(settings.size, layers)
}
