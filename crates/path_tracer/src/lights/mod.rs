//! All lights of a scene: choosing one, sampling a direction towards it, and the density of that for a direction found otherwise.
//!
//! A light is chosen, of a mesh a triangle, then a point of it; how is the subject of [`selection`]. The constant environment is never chosen:
//! sampling the BSDF alone is the better strategy for it, with weight 1.

mod area;
mod environment;
mod mesh;
mod punctual;
mod selection;
mod shape_tree;

use crate::world::World;
use crate::{EnvironmentSampler, LightSampler, PathTracerError};
use area::AreaLight;
use environment::EnvironmentLight;
use glam::{Vec2, Vec3};
use kajo_bvh::PrimitiveRef;
use kajo_sampling::Rng;
use kajo_sampling::light_tree::Receiver;
use kajo_scene::{EmissiveMesh, LightShape, PlacedLight};
use kajo_units::LinearRgb;
use mesh::MeshLight;
use punctual::{DirectionalLight, PointLight, SpotCone};
use selection::{Chosen, Selection};
use shape_tree::ShapeTree;

/// A direction towards a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Distance of the light, m; infinite at infinity.
    pub distance: f32,
    /// Incident radiance if nothing is in the way; for a light without extent the irradiance on a surface that faces it.
    pub radiance: LinearRgb,
    /// Density per solid angle; infinite for a light without extent.
    pub pdf: f32,
}

/// A chosen light and a direction towards it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChosenLight {
    /// Index into [`Lights::names`].
    pub light: u32,
    /// `pdf` includes the probability of the choice, and is infinite for lights without extent.
    pub sample: LightSample,
    /// `sample.radiance` divided by the density.
    pub value: LinearRgb,
    /// The emissive triangle, which must not shadow itself.
    pub primitive: Option<PrimitiveRef>,
}

/// Light that a ray meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenLight {
    /// Index into [`Lights::names`].
    pub light: u32,
    pub radiance: LinearRgb,
    /// Density with which [`Lights::sample`] finds this direction for the receiver that the ray comes from; 0 without one.
    pub pdf: f32,
}

/// A point of a light for `visibility.<light>`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// Unit length.
    pub direction: Vec3,
    /// Infinite for directional lights.
    pub distance: f32,
    /// The emissive triangle, which must not shadow itself.
    pub primitive: Option<PrimitiveRef>,
}

/// Random numbers that follow from those of a choice.
pub(crate) fn rng_of(choice: f32, u: Vec2) -> Rng {
    Rng::new(u64::from(choice.to_bits()) << 32 ^ u64::from(u.x.to_bits()) ^ u64::from(u.y.to_bits()) << 16)
}

#[derive(Clone, Debug)]
enum Emitter {
    Point(PointLight),
    Directional(DirectionalLight),
    Area(AreaLight),
    Mesh(MeshLight),
    /// `None` for the constant environment, which is left to BSDF sampling. Boxed, because the others are small.
    Environment(Option<Box<EnvironmentLight>>),
    /// All unlit surfaces together; they are met, never sampled.
    Unlit,
}

/// The lights of a scene. Analytic ones come first, in the snapshot's order, then emissive instances, then the environment.
pub(crate) struct Lights {
    emitters: Vec<Emitter>,
    /// Unique names: the file's or `light <index>`, the node's for emissive instances, `environment`, `unlit`.
    pub names: Vec<String>,
    /// Number of analytic lights.
    pub analytic: usize,
    selection: Selection,
    /// Area lights that rays meet.
    shapes: ShapeTree,
    /// Lights that rays meet where they leave the scene.
    at_infinity: Vec<u32>,
    /// For each instance the light it is, or `NO_LIGHT`.
    light_of_instance: Vec<u32>,
    /// True when a ray can meet light at all: there are other lights than points and parallel ones.
    pub can_be_met: bool,
    /// True when some light is never sampled and can only be met: the constant environment, unlit surfaces.
    pub only_met: bool,
}

const NO_LIGHT: u32 = u32::MAX;

impl Lights {
    /// The lights of a world.
    ///
    /// # Errors
    /// [`PathTracerError::Environment`] for an image that the sampler cannot be made of.
    pub(crate) fn new(world: &World, environment_sampler: EnvironmentSampler, by: LightSampler) -> Result<Self, PathTracerError> {
        let scene = &world.scene;
        let mut lights = Self {
            emitters: Vec::new(),
            names: Vec::new(),
            analytic: world.snapshot.lights.len(),
            selection: Selection::default(),
            shapes: ShapeTree::default(),
            at_infinity: Vec::new(),
            light_of_instance: vec![NO_LIGHT; world.instances.len()],
            can_be_met: false,
            only_met: false,
        };
        let emissive = world.snapshot.emissive_meshes(scene);
        let names = world.snapshot.light_names(scene, &emissive);
        let meshes = emissive.iter().map(|mesh| Emitter::Mesh(MeshLight::new(mesh)));
        lights.emitters = world.snapshot.lights.iter().map(analytic).chain(meshes).collect();
        lights.names = names;
        for (index, mesh) in emissive.iter().enumerate() {
            lights.light_of_instance[mesh.instance] = (lights.analytic + index) as u32;
        }
        if let Some(environment) = &scene.environment {
            let light = EnvironmentLight::new(environment, environment_sampler)?;
            lights.push("environment".into(), Emitter::Environment(light.map(Box::new)));
        }
        let unlit = |placed: &crate::world::Placed| scene.materials[placed.material as usize].unlit;
        if world.instances.iter().any(unlit) {
            let light = lights.emitters.len() as u32;
            lights.push("unlit".into(), Emitter::Unlit);
            for (instance, _) in world.instances.iter().enumerate().filter(|(_, placed)| unlit(placed)) {
                lights.light_of_instance[instance] = light;
            }
        }
        lights.index();
        lights.select(world, by, &emissive);
        Ok(lights)
    }

    /// Chooses lights in another way from now on.
    pub(crate) fn select_by(&mut self, world: &World, by: LightSampler) {
        if !self.selection.change(by) {
            self.select(world, by, &world.snapshot.emissive_meshes(&world.scene));
        }
    }

    fn select(&mut self, world: &World, by: LightSampler, emissive: &[EmissiveMesh]) {
        self.selection = Selection::new(by, &self.emitters, world, emissive);
    }

    /// The light of that name; with `visible`, only those that have an image `visibility.<light>`.
    ///
    /// # Errors
    /// [`PathTracerError::Aov`] with the names there are.
    pub(crate) fn index_of(&self, name: &str, visible: bool) -> Result<usize, PathTracerError> {
        let eligible = |light: &usize| !visible || self.has_visibility(*light);
        self.names.iter().position(|n| n == name).filter(eligible).ok_or_else(|| {
            let what = if visible { "visibility" } else { "direct" };
            let known: Vec<_> = (0..self.names.len()).filter(eligible).map(|light| format!("{what}.{}", self.names[light])).collect();
            let known = if known.is_empty() { "none: the scene has no such light".into() } else { known.join(", ") };
            PathTracerError::Aov { got: format!("{what}.{name}"), known }
        })
    }

    fn push(&mut self, name: String, emitter: Emitter) {
        let taken = |name: &String, names: &[String]| names.contains(name);
        let mut unique = name.clone();
        let mut number = 2;
        while taken(&unique, &self.names) {
            unique = format!("{name} {number}");
            number += 1;
        }
        self.names.push(unique);
        self.emitters.push(emitter);
    }

    /// Estimated flux into the scene, W; 0 for what is only met.
    pub(crate) fn power(&self, world: &World, light: usize) -> f32 {
        self.emitters[light].power(world).unwrap_or(0.0)
    }

    /// Fills the lists of what rays meet.
    fn index(&mut self) {
        self.only_met = self.emitters.iter().any(|emitter| matches!(emitter, Emitter::Environment(None) | Emitter::Unlit));
        self.can_be_met = self.emitters.iter().any(Emitter::can_be_met);
        let mut boxes = Vec::new();
        for (index, emitter) in self.emitters.iter().enumerate() {
            match emitter {
                Emitter::Area(light) => boxes.push((index as u32, light.bounds())),
                Emitter::Environment(_) => self.at_infinity.push(index as u32),
                Emitter::Directional(_) if emitter.can_be_met() => self.at_infinity.push(index as u32),
                _ => {}
            }
        }
        self.shapes = ShapeTree::new(&boxes);
    }

    /// How many candidates light sampling draws at a surface that the path reached after `bounces`, of which it keeps one.
    #[inline]
    pub(crate) fn candidates(&self, bounces: u32) -> u32 {
        self.selection.candidates(bounces)
    }

    /// A direction towards some light. `None` when the chosen light does not shine there.
    #[inline]
    pub(crate) fn sample(&self, world: &World, receiver: &Receiver, choice: f32, u: Vec2) -> Option<ChosenLight> {
        let Chosen { light, triangle, pmf, rest } = self.selection.choose(&self.emitters, receiver, choice, u)?;
        let from = receiver.point;
        let (mut sample, primitive) = match &self.emitters[light as usize] {
            Emitter::Point(point) => (point.sample(from)?, None),
            Emitter::Directional(directional) => (directional.sample(u), None),
            Emitter::Area(area) => (area.sample(from, u)?, None),
            Emitter::Mesh(mesh) => {
                let (sample, primitive) = mesh.sample(world, from, triangle, u)?;
                (sample, Some(primitive))
            }
            Emitter::Environment(light) => (light.as_ref()?.sample(world.scene.environment.as_ref()?, rest, u)?, None),
            Emitter::Unlit => return None,
        };
        let value = if sample.pdf.is_finite() {
            sample.pdf *= pmf;
            sample.radiance / sample.pdf
        } else {
            sample.radiance / pmf
        };
        Some(ChosenLight { light, sample, value, primitive })
    }

    /// Probability of choosing a light for the receiver; 0 without one.
    #[inline]
    fn probability(&self, receiver: Option<&Receiver>, light: u32) -> f32 {
        receiver.map_or(0.0, |receiver| self.selection.pmf(&self.emitters, receiver, light, 0))
    }

    /// The analytic area lights that a ray passes before `t_max`.
    #[inline]
    pub(crate) fn along(
        &self,
        receiver: Option<&Receiver>,
        origin: Vec3,
        direction: Vec3,
        t_max: f32,
        mut see: impl FnMut(f32, SeenLight),
    ) {
        if self.shapes.is_empty() {
            return;
        }
        self.shapes.visit(origin, direction, t_max, |light| {
            let Emitter::Area(area) = &self.emitters[light as usize] else { return };
            if let Some((t, radiance)) = area.seen_along(origin, direction)
                && t < t_max
            {
                let pdf = receiver.map_or(0.0, |_| self.probability(receiver, light) * area.pdf(origin, direction, t));
                see(t, SeenLight { light, radiance, pdf });
            }
        });
    }

    /// What a ray meets that leaves the scene.
    pub(crate) fn beyond(&self, world: &World, receiver: Option<&Receiver>, direction: Vec3, mut see: impl FnMut(SeenLight)) {
        for &light in &self.at_infinity {
            match (&self.emitters[light as usize], &world.scene.environment) {
                (Emitter::Directional(directional), _) => {
                    if let Some((radiance, pdf)) = directional.seen_along(direction) {
                        see(SeenLight { light, radiance, pdf: self.probability(receiver, light) * pdf });
                    }
                }
                (Emitter::Environment(table), Some(environment)) => {
                    let pdf = match (table, receiver) {
                        (Some(table), Some(_)) => self.probability(receiver, light) * table.pdf(environment, direction),
                        _ => 0.0,
                    };
                    see(SeenLight { light, radiance: environment.radiance(direction), pdf });
                }
                _ => {}
            }
        }
    }

    /// Density with which [`Lights::sample`] finds a point of an instance's triangle for the receiver, `distance` away from `from` in `direction`; 0 for
    /// instances that are no light.
    pub(crate) fn pdf_of_surface(
        &self,
        world: &World,
        receiver: &Receiver,
        primitive: PrimitiveRef,
        (from, direction, distance): (Vec3, Vec3, f32),
    ) -> f32 {
        let light = self.light_of_instance[primitive.instance as usize];
        match self.emitters.get(light as usize) {
            Some(Emitter::Mesh(mesh)) => {
                let pmf = self.selection.pmf(&self.emitters, receiver, light, primitive.primitive);
                pmf * mesh.pdf(world, primitive.primitive, from, direction, distance)
            }
            _ => 0.0,
        }
    }

    /// The light that an instance is.
    pub(crate) fn of_instance(&self, instance: u32) -> Option<u32> {
        Some(self.light_of_instance[instance as usize]).filter(|&light| light != NO_LIGHT)
    }

    /// Where to look from `from` to see whether it sees the light; `None` for the environment, from inside of a sphere, and where no part
    /// of a mesh faces it.
    pub(crate) fn point_of_visibility(&self, world: &World, light: u32, from: Vec3, choice: f32, u: Vec2) -> Option<Target> {
        let (point, primitive) = match &self.emitters[light as usize] {
            Emitter::Point(point) => (point.position, None),
            Emitter::Directional(directional) => {
                return Some(Target { direction: directional.sample(u).wi, distance: f32::INFINITY, primitive: None });
            }
            Emitter::Area(area) => (area.point_of_visibility(from, u)?, None),
            Emitter::Mesh(mesh) => {
                let (point, primitive) = mesh.point_of_visibility(world, from, choice, u)?;
                (point, Some(primitive))
            }
            Emitter::Environment(_) | Emitter::Unlit => return None,
        };
        let distance = point.distance(from);
        Some(Target { direction: (point - from) / distance, distance, primitive })
    }

    /// True for lights that `visibility.<light>` is defined for.
    pub(crate) fn has_visibility(&self, light: usize) -> bool {
        !matches!(self.emitters[light], Emitter::Environment(_) | Emitter::Unlit)
    }
}

fn analytic(placed: &PlacedLight) -> Emitter {
    let frame = &placed.world_from_light;
    let emission = placed.light.emission;
    let axis = (-Vec3::from(frame.matrix3.z_axis)).normalize_or(Vec3::NEG_Z);
    let position = Vec3::from(frame.translation);
    match placed.light.shape {
        LightShape::Point => Emitter::Point(PointLight { position, intensity: emission, cone: None }),
        LightShape::Spot { inner, outer } => {
            Emitter::Point(PointLight { position, intensity: emission, cone: Some(SpotCone::new(axis, inner.0, outer.0)) })
        }
        LightShape::Directional { half_angle } => Emitter::Directional(DirectionalLight::new(-axis, emission, half_angle.0)),
        LightShape::Rectangle { width, height } => Emitter::Area(AreaLight::rectangle(frame, width.0, height.0, emission)),
        LightShape::Disk { radius } => Emitter::Area(AreaLight::disk(frame, radius.0, emission)),
        LightShape::Sphere { radius } => Emitter::Area(AreaLight::sphere(frame, radius.0, emission)),
    }
}

impl Emitter {
    /// Whether a ray can meet it.
    fn can_be_met(&self) -> bool {
        match self {
            Self::Point(_) => false,
            Self::Directional(light) => light.has_disk(),
            Self::Area(_) | Self::Mesh(_) | Self::Environment(_) | Self::Unlit => true,
        }
    }

    /// Estimated flux into the scene, W; `None` for what is never chosen.
    fn power(&self, world: &World) -> Option<f32> {
        match self {
            Self::Point(light) => Some(light.power()),
            Self::Directional(light) => Some(light.power(world.radius)),
            Self::Area(light) => Some(light.power()),
            Self::Mesh(light) => Some(light.power()),
            Self::Unlit => None,
            Self::Environment(light) => light.as_ref().map(|light| light.power(world.radius)),
        }
    }
}
