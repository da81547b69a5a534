//! The tracer: a scene at one time, ready for rays.

use crate::fingerprint::{StableHasher, scene_hash};
use crate::lights::Lights;
use crate::world::World;
use crate::{Aov, CameraChoice, EnvironmentSampler, LightSampler, PathTracerError, Settings};
use kajo_scene::{Culling, PlacedCamera, Scene, Snapshot};
use std::sync::OnceLock;

/// A scene evaluated at one time, with its hierarchy and light tables. Renders any number of pictures, see [`render`](crate::render).
pub struct Tracer {
    pub(crate) world: World,
    pub(crate) lights: Lights,
    pub(crate) previous: Option<Snapshot>,
    environment_sampler: EnvironmentSampler,
    light_sampler: LightSampler,
    culling: Culling,
    hash: OnceLock<u64>,
}

impl Tracer {
    /// Builds the hierarchy and the light tables. `snapshot` must be one of `scene`.
    ///
    /// # Errors
    /// [`PathTracerError::Bvh`] for geometry that is not finite or too much, [`PathTracerError::Environment`].
    pub fn new(scene: &Scene, snapshot: Snapshot) -> Result<Self, PathTracerError> {
        let world = World::new(scene, snapshot)?;
        let (environment_sampler, light_sampler) = (EnvironmentSampler::default(), LightSampler::default());
        let lights = Lights::new(&world, environment_sampler, light_sampler)?;
        Ok(Self { world, lights, previous: None, environment_sampler, light_sampler, culling: Culling::Off, hash: OnceLock::new() })
    }

    /// The same scene with another way to sample its environment; changes the noise and never the mean.
    ///
    /// # Errors
    /// [`PathTracerError::Environment`] for an image that the sampler cannot be made of.
    pub fn with_environment_sampler(mut self, sampler: EnvironmentSampler) -> Result<Self, PathTracerError> {
        if sampler != self.environment_sampler {
            self.lights = Lights::new(&self.world, sampler, self.light_sampler)?;
            self.environment_sampler = sampler;
            self.hash = OnceLock::new();
        }
        Ok(self)
    }

    /// The same scene with another way to choose among its lights; changes the noise and never the mean.
    pub fn with_light_sampler(mut self, sampler: LightSampler) -> Self {
        if sampler != self.light_sampler {
            self.lights.select_by(&self.world, sampler);
            self.light_sampler = sampler;
            self.hash = OnceLock::new();
        }
        self
    }

    /// The same scene in which rays that start on surfaces do not meet what `culling` leaves out for the camera of `settings`. A judge of techniques has all; this
    /// tells what leaving out costs a picture.
    ///
    /// # Errors
    /// [`PathTracerError::Camera`] with the cameras there are, [`PathTracerError::Bvh`].
    pub fn with_culling(mut self, culling: Culling, settings: &Settings) -> Result<Self, PathTracerError> {
        let camera = &self.world.snapshot.cameras[self.camera(settings)?];
        let aspect = settings.size.x as f32 / settings.size.y.max(1) as f32;
        let kept = culling.kept(&self.world.scene, &self.world.snapshot, camera, aspect);
        self.world.keep_for_secondary_rays(&kept)?;
        self.culling = culling;
        self.hash = OnceLock::new();
        Ok(self)
    }

    /// Adds the scene one frame earlier, which the image `motion` needs.
    ///
    /// # Errors
    /// [`PathTracerError::PreviousDiffers`] for a snapshot of another scene.
    pub fn with_previous(mut self, previous: Snapshot) -> Result<Self, PathTracerError> {
        let (got, expected) = (previous.instances.len(), self.world.snapshot.instances.len());
        if got != expected {
            return Err(PathTracerError::PreviousDiffers { got, expected });
        }
        self.previous = Some(previous);
        self.hash = OnceLock::new();
        Ok(self)
    }

    /// Puts another camera in the place of camera `index`; hierarchy and light tables stay.
    ///
    /// # Errors
    /// [`PathTracerError::Camera`] with the cameras there are.
    pub fn set_camera(&mut self, index: usize, camera: PlacedCamera) -> Result<(), PathTracerError> {
        let index = self.camera(&Settings { camera: CameraChoice::Index(index), ..Settings::default() })?;
        self.world.snapshot.cameras[index] = camera;
        self.hash = OnceLock::new();
        Ok(())
    }

    /// The snapshot that is rendered.
    pub fn snapshot(&self) -> &Snapshot {
        &self.world.snapshot
    }

    /// Names of all lights, as `direct.<light>` takes them: analytic lights in the snapshot's order, then emissive instances, then
    /// `environment` and `unlit` where the scene has them.
    pub fn light_names(&self) -> &[String] {
        &self.lights.names
    }

    /// Names of the lights that have an image `visibility.<light>`: all but `environment` and `unlit`.
    pub fn visibility_light_names(&self) -> impl Iterator<Item = &str> {
        (0..self.lights.names.len()).filter(|&light| self.lights.has_visibility(light)).map(|light| self.lights.names[light].as_str())
    }

    /// The `count` lights of most power among those that have an image `visibility.<light>`: indices into [`Self::light_names`], ascending.
    pub fn strongest_lights(&self, count: usize) -> Vec<usize> {
        let mut lights: Vec<usize> = (0..self.lights.names.len()).filter(|&light| self.lights.has_visibility(light)).collect();
        lights.sort_by(|&a, &b| self.lights.power(&self.world, b).total_cmp(&self.lights.power(&self.world, a)));
        lights.truncate(count);
        lights.sort_unstable();
        lights
    }

    /// Bytes of the hierarchy.
    pub fn bvh_bytes(&self) -> usize {
        self.world.geometry.memory()
    }

    /// Every image that can be asked for, `bounce.<n>` up to `max_bounce`.
    pub fn all_aovs(&self, max_bounce: u32) -> Vec<Aov> {
        let any = |light: &str| light.to_owned();
        let mut aovs: Vec<_> = Aov::PLAIN.iter().filter(|aov| **aov != Aov::Motion || self.previous.is_some()).cloned().collect();
        aovs.extend(self.lights.names.iter().map(|light| Aov::DirectLight(any(light))));
        aovs.extend(self.visibility_light_names().map(|light| Aov::Visibility(any(light))));
        aovs.extend((0..=max_bounce).map(Aov::Bounce));
        aovs
    }

    /// `aovs` with the light `*` replaced by every light.
    ///
    /// # Errors
    /// [`PathTracerError::NoPrevious`].
    pub(crate) fn resolve_aovs(&self, aovs: &[Aov]) -> Result<Vec<Aov>, PathTracerError> {
        if aovs.contains(&Aov::Motion) && self.previous.is_none() {
            return Err(PathTracerError::NoPrevious);
        }
        let expand = |aov: &Aov| match aov {
            Aov::DirectLight(light) if light == "*" => self.lights.names.iter().cloned().map(Aov::DirectLight).collect(),
            Aov::Visibility(light) if light == "*" => self.visibility_light_names().map(|l| Aov::Visibility(l.into())).collect(),
            _ => vec![aov.clone()],
        };
        Ok(aovs.iter().flat_map(expand).collect())
    }

    /// Index of the camera that the settings choose.
    ///
    /// # Errors
    /// [`PathTracerError::Camera`] with the cameras there are.
    pub(crate) fn camera(&self, settings: &Settings) -> Result<usize, PathTracerError> {
        let cameras = &self.world.snapshot.cameras;
        let found = match &settings.camera {
            CameraChoice::Index(index) => Some(*index).filter(|&index| index < cameras.len()),
            CameraChoice::Name(name) => cameras.iter().position(|camera| &camera.camera.name == name),
        };
        found.ok_or_else(|| {
            let got = match &settings.camera {
                CameraChoice::Index(index) => index.to_string(),
                CameraChoice::Name(name) => name.clone(),
            };
            let name = |(index, camera): (usize, &PlacedCamera)| format!("{index} `{}`", camera.camera.name);
            PathTracerError::Camera { got, have: cameras.iter().enumerate().map(name).collect::<Vec<_>>().join(", ") }
        })
    }

    pub(crate) fn hash(&self) -> u64 {
        let samplers = (self.environment_sampler, self.light_sampler);
        let culled = match self.culling {
            Culling::Off => 0,
            culling => StableHasher::hash(culling.to_string().as_bytes()),
        };
        *self.hash.get_or_init(|| culled ^ scene_hash(&self.world.scene, &self.world.snapshot, self.previous.as_ref(), samplers))
    }
}
