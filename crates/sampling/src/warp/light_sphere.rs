//! A sphere seen from a point.

use super::{Cone, uniform_sphere, uniform_sphere_inverse, uniform_sphere_pdf};
use crate::Frame;
use glam::{Vec2, Vec3};

/// Directions from a point that meet a sphere, uniform in solid angle.    \[Shirley96] section 3.2
///
/// From inside the sphere every direction meets it, and the whole sphere of directions is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSphere {
    frame: Frame,
    /// `None` from inside.
    cone: Option<Cone>,
}

impl LightSphere {
    /// The sphere of `center` and `radius` seen from `point`, m.
    pub fn new(point: Vec3, center: Vec3, radius: f32) -> Self {
        let to_center = center - point;
        let distance2 = to_center.length_squared();
        if distance2 <= radius * radius {
            return Self { frame: Frame::IDENTITY, cone: None };
        }
        Self { frame: Frame::from_z(to_center / distance2.sqrt()), cone: Some(Cone::from_sin2(radius * radius / distance2)) }
    }

    /// Solid angle of the sphere, sr.
    pub fn solid_angle(&self) -> f32 {
        self.cone.map_or(4.0 * std::f32::consts::PI, |c| c.solid_angle())
    }

    /// A direction towards the sphere, world space.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3 {
        match self.cone {
            Some(cone) => self.frame.to_world(cone.sample(u)),
            None => uniform_sphere(u),
        }
    }

    /// 1/Ω towards the sphere, 0 elsewhere.
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        match self.cone {
            Some(cone) => cone.pdf(self.frame.to_local(direction)),
            None => uniform_sphere_pdf(direction),
        }
    }

    /// The inverse of [`LightSphere::sample`].
    pub fn inverse(&self, direction: Vec3) -> Vec2 {
        match self.cone {
            Some(cone) => cone.inverse(self.frame.to_local(direction)),
            None => uniform_sphere_inverse(direction),
        }
    }
}
