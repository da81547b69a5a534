//! What the first hit of a camera ray is, and the role images at it.

use super::{Chance, Context, Sink, Split, TracedRay, open_ray};
use crate::camera::CameraView;
use crate::record::Slots;
use crate::surface::Surface;
use glam::{Vec2, Vec3};
use kajo_bvh::{Hit, Ray};
use kajo_sampling::warp::cosine_hemisphere;
use kajo_sampling::{Frame, Sampler};
use kajo_scene::Snapshot;
use kajo_units::LinearRgb;
use std::f32::consts::PI;

/// First bounce number of the random numbers of role images: far above any path's, so that they share none.
pub(crate) const ROLE_DIMENSIONS: u32 = 1 << 16;
/// Likewise for the path of `diffuse-indirect`.
const INDIRECT_DIMENSIONS: u32 = 1 << 17;

/// The view and the scene one frame earlier.
pub(crate) struct Previous<'a> {
    pub snapshot: &'a Snapshot,
    pub view: CameraView,
}

impl Context<'_> {
    /// Fills the channels of `slots` that belong to the first hit.
    pub(crate) fn first_hit(
        &self,
        start: TracedRay,
        view: &CameraView,
        previous: Option<&Previous>,
        slots: &Slots,
        (sampler, chance): (&mut Sampler, &mut Chance),
        record: &mut [f32],
    ) {
        let hit = start.hit.as_ref();
        let mut room = None;
        let surface = hit.and_then(|hit| Some((hit, Surface::new(self.world, hit, -start.ray.direction, false, &mut room)?)));
        let Some((hit, surface)) = surface else {
            for &(offset, _) in slots.visibility.iter().chain(&slots.ambient_visibility.map(|offset| (offset, 0))) {
                record[offset] = 1.0;
            }
            for offset in [slots.instance_id, slots.material_id].into_iter().flatten() {
                record[offset] = -1.0;
            }
            return;
        };
        let mut put = |offset: Option<usize>, value: Vec3| {
            if let Some(offset) = offset {
                record[offset..offset + 3].copy_from_slice(&value.to_array());
            }
        };
        let position = surface.point.position;
        put(slots.albedo, surface.material.params.base_color.0);
        put(slots.normal, surface.geometric_normal);
        put(slots.shading_normal, surface.normal());
        put(slots.position, position);
        let mut scalar = |offset: Option<usize>, value: f32| {
            if let Some(offset) = offset {
                record[offset] = value;
            }
        };
        scalar(slots.coverage, 1.0);
        scalar(slots.depth, view.depth(position));
        scalar(slots.instance_id, hit.instance as f32);
        scalar(slots.material_id, surface.material_index as f32);
        if let (Some(offset), Some(previous)) = (slots.motion, previous) {
            let motion = self.motion(view, previous, hit, position);
            record[offset..offset + 2].copy_from_slice(&motion.to_array());
        }
        self.roles(&surface, slots, sampler, chance, record);
    }

    /// Pixels that a point of a triangle has moved since the previous snapshot; 0 where it was behind the camera.
    fn motion(&self, view: &CameraView, previous: &Previous, hit: &Hit, position: Vec3) -> Vec2 {
        let instance = &previous.snapshot.instances[hit.instance as usize];
        let mesh = &previous.snapshot.meshes[instance.mesh];
        let [a, b, c] = mesh.indices[hit.primitive as usize].map(|i| mesh.positions[i as usize]);
        let then = instance.world_from_object.transform_point3(a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v);
        match (view.project(position), previous.view.project(then)) {
            (Some(now), Some(then)) => now - then,
            _ => Vec2::ZERO,
        }
    }

    fn roles(&self, surface: &Surface, slots: &Slots, sampler: &mut Sampler, chance: &mut Chance, record: &mut [f32]) {
        for (index, &(offset, light)) in slots.visibility.iter().enumerate() {
            sampler.start_bounce(ROLE_DIMENSIONS + 2 + index as u32);
            record[offset] = self.visibility(surface, light, sampler.next_1d(), sampler.next_2d(), chance);
        }
        if slots.ambient_visibility.is_some() || slots.bent_normal.is_some() {
            sampler.start_bounce(ROLE_DIMENSIONS);
            let (direction, open) = self.ambient(surface, false, sampler.next_2d(), chance);
            if let Some(offset) = slots.ambient_visibility {
                record[offset] = open;
            }
            if let Some(offset) = slots.bent_normal {
                record[offset..offset + 3].copy_from_slice(&(direction * open).to_array());
            }
        }
        if let Some(offset) = slots.diffuse_indirect {
            sampler.start_bounce(ROLE_DIMENSIONS + 1);
            let irradiance = self.indirect_irradiance(surface, sampler, chance);
            record[offset..offset + 3].copy_from_slice(&irradiance.0.to_array());
        }
    }

    /// One sample of `visibility.<light>`, see [`Aov::Visibility`](crate::Aov::Visibility).
    fn visibility(&self, surface: &Surface, light: u32, choice: f32, u: Vec2, chance: &mut Chance) -> f32 {
        let origin = surface.origin_flat();
        let Some(target) = self.lights.point_of_visibility(self.world, light, origin, choice, u) else { return 1.0 };
        if target.direction.dot(surface.geometric_normal) <= 0.0 {
            return 0.0;
        }
        let t_max = target.distance * super::path::BEFORE_LIGHT;
        let ray = Ray { t_max, ..open_ray(origin, target.direction) };
        if self.world.occluded(&ray, target.primitive, chance.next()) { 0.0 } else { 1.0 }
    }

    /// One sample of the irradiance by light that bounced at least once before it arrives.
    fn indirect_irradiance(&self, surface: &Surface, sampler: &mut Sampler, chance: &mut Chance) -> LinearRgb {
        let direction = Frame::from_z(surface.normal()).to_world(cosine_hemisphere(sampler.next_2d()));
        if self.max_depth < 2 || direction.dot(surface.geometric_normal) <= 0.0 {
            return LinearRgb::BLACK;
        }
        let ray = open_ray(surface.origin_in_front, direction);
        let hit = self.world.closest(&ray, Some(surface.primitive), chance.next());
        let mut reflected = Reflected::default();
        let inner = Context { max_depth: self.max_depth - 1, ..*self };
        inner.path(TracedRay { ray, hit }, INDIRECT_DIMENSIONS, sampler, chance, &mut reflected);
        reflected.0 * PI
    }
}

/// Keeps light that bounced, drops emission.
#[derive(Default)]
struct Reflected(LinearRgb);

impl Sink for Reflected {
    fn light(&mut self, bounces: u32, _light: u32, share: Split) {
        if bounces > 0 {
            self.0 += share.total();
        }
    }
}
