//! Lights without area: point, spot, directional.

use super::LightSample;
use glam::{Vec2, Vec3};
use kajo_sampling::light_tree::EmitterBounds;
use kajo_sampling::{Frame, warp::Cone};
use kajo_units::LinearRgb;
use std::f32::consts::PI;

/// A point, or with `cone` a spot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointLight {
    pub position: Vec3,
    /// Radiant intensity, on the axis for a spot, W/sr.
    pub intensity: LinearRgb,
    pub cone: Option<SpotCone>,
}

/// Falloff of a spot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpotCone {
    axis: Vec3,
    cos_inner: f32,
    cos_outer: f32,
}

impl SpotCone {
    /// Below this difference of cosines the falloff would divide by zero.    KHR_lights_punctual, "Inner and Outer Cone Angles"
    const NARROWEST: f32 = 0.001;

    pub(crate) fn new(axis: Vec3, inner: f32, outer: f32) -> Self {
        Self { axis, cos_inner: inner.cos(), cos_outer: outer.cos() }
    }

    /// saturate((cos θ − cos outer) / (cos inner − cos outer))², `direction` away from the light.    KHR_lights_punctual
    fn falloff(&self, direction: Vec3) -> f32 {
        let t = (self.axis.dot(direction) - self.cos_outer) / (self.cos_inner - self.cos_outer).max(Self::NARROWEST);
        t.clamp(0.0, 1.0).powi(2)
    }
}

impl PointLight {
    pub(crate) fn sample(&self, from: Vec3) -> Option<LightSample> {
        let to_light = self.position - from;
        let distance2 = to_light.length_squared();
        if distance2 == 0.0 {
            return None;
        }
        let distance = distance2.sqrt();
        let wi = to_light / distance;
        let falloff = self.cone.map_or(1.0, |cone| cone.falloff(-wi));
        let radiance = self.intensity * (falloff / distance2);
        (falloff > 0.0).then_some(LightSample { wi, distance, radiance, pdf: f32::INFINITY })
    }

    /// What a light tree knows of it.
    pub(crate) fn emitter_bounds(&self) -> EmitterBounds {
        let everywhere = EmitterBounds::point(self.position, self.intensity.luminance());
        match self.cone {
            None => everywhere,
            Some(cone) => EmitterBounds { axis: cone.axis, cos_normals: 1.0, cos_emission: cone.cos_outer, ..everywhere },
        }
    }

    /// Flux, W: 4π I, or for a spot that of a cone halfway between the inner and the outer one.
    pub(crate) fn power(&self) -> f32 {
        let solid_angle = self.cone.map_or(4.0 * PI, |cone| 2.0 * PI * (1.0 - 0.5 * (cone.cos_inner + cone.cos_outer)));
        self.intensity.luminance() * solid_angle
    }
}

/// Light from infinity: parallel, or from a disk in the sky.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectionalLight {
    /// z points towards the light.
    frame: Frame,
    /// Irradiance on a surface that faces it (parallel), or radiance of the disk.
    value: LinearRgb,
    disk: Option<Cone>,
}

impl DirectionalLight {
    /// `towards` points to the light, `irradiance` falls on a surface that faces it; a disk of half angle θ has radiance E/(π sin² θ).
    pub(crate) fn new(towards: Vec3, irradiance: LinearRgb, half_angle: f32) -> Self {
        let sin2 = half_angle.clamp(0.0, 0.5 * PI).sin().powi(2);
        let frame = Frame::from_z(towards);
        // Half angles below 1e-12 rad: the radiance would leave the range of f32.
        if sin2 < 1e-24 {
            return Self { frame, value: irradiance, disk: None };
        }
        Self { frame, value: irradiance / (PI * sin2), disk: Some(Cone::from_sin2(sin2)) }
    }

    pub(crate) fn sample(&self, u: Vec2) -> LightSample {
        let (wi, pdf) = match self.disk {
            None => (self.frame.z, f32::INFINITY),
            Some(cone) => (self.frame.to_world(cone.sample(u)), 1.0 / cone.solid_angle()),
        };
        LightSample { wi, distance: f32::INFINITY, radiance: self.value, pdf }
    }

    /// Radiance from, and density of, a direction towards the sky; `None` outside the disk.
    pub(crate) fn seen_along(&self, direction: Vec3) -> Option<(LinearRgb, f32)> {
        let cone = self.disk?;
        cone.contains(self.frame.to_local(direction)).then(|| (self.value, 1.0 / cone.solid_angle()))
    }

    /// True for a disk in the sky, which rays can meet.
    pub(crate) fn has_disk(&self) -> bool {
        self.disk.is_some()
    }

    /// Flux through a disk of the scene's radius, W.
    pub(crate) fn power(&self, scene_radius: f32) -> f32 {
        let irradiance = match self.disk {
            None => self.value,
            // ∫ cos θ dω over the cone = π sin² θ = Ω (1 − Ω/4π).
            Some(cone) => self.value * (cone.solid_angle() * (1.0 - 0.25 * cone.solid_angle() / PI)),
        };
        irradiance.luminance() * PI * scene_radius * scene_radius
    }
}
