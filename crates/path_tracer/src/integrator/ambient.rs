//! Ambient visibility: how much of the hemisphere sees the open sky, and from where it mostly comes.

use super::{Chance, Context};
use crate::surface::Surface;
use glam::{Vec2, Vec3};
use kajo_bvh::Ray;
use kajo_sampling::Frame;
use kajo_sampling::warp::{cosine_hemisphere, uniform_hemisphere};

impl Context<'_> {
    /// One ray from a surface: the direction it takes and 1 if nothing is met within the ambient distance, else 0.
    ///
    /// ```text
    /// cosine:  mean → (1/π) ∫ V cos θ dω        uniform:  mean → 1/2π ∫ V dω             [Zhukov98]
    /// ```
    ///
    /// Directions below the geometric surface are blocked. A lone wall at distance d, seen with a longest ray r and a = d/r, leaves
    /// 1 − (1 − a)/2 (uniform) and 1 − (acos a − a √(1 − a²))/π (cosine).
    pub(crate) fn ambient(&self, surface: &Surface, uniform: bool, u: Vec2, chance: &mut Chance) -> (Vec3, f32) {
        let local = if uniform { uniform_hemisphere(u) } else { cosine_hemisphere(u) };
        let direction = Frame::from_z(surface.normal()).to_world(local);
        if direction.dot(surface.geometric_normal) <= 0.0 {
            return (direction, 0.0);
        }
        let ray = Ray { t_max: self.settings.ambient_distance, ..Ray::new(surface.origin_flat(), direction) };
        let blocked = self.world.occluded(&ray, Some(surface.primitive), chance.next());
        (direction, f32::from(u8::from(!blocked)))
    }
}
