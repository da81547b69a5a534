//! Emissive meshes: a triangle is chosen by its power, a point on it by solid angle.

use super::LightSample;
use super::area::towards_area;
use crate::world::World;
use glam::{Vec2, Vec3};
use kajo_bvh::PrimitiveRef;
use kajo_sampling::AliasTable;
use kajo_sampling::warp::{SphericalTriangle, triangle_barycentrics};
use kajo_units::LinearRgb;
use std::f32::consts::PI;

/// One instance whose material emits.
#[derive(Clone, Debug)]
pub(crate) struct MeshLight {
    instance: u32,
    /// Chooses among the triangles.
    triangles: AliasTable,
    /// Emission where it has no texture.
    constant: Option<LinearRgb>,
    double_sided: bool,
    power: f32,
    area: f32,
}

/// Solid angle, sr, from which on a triangle is sampled by solid angle; smaller ones are so far that the area does as well for less.
const BY_SOLID_ANGLE: f32 = 1e-4;

/// Share of choices by area alone: a textured triangle that looks black where it was probed may still emit.
const BY_AREA: f32 = 0.1;

/// Points of a triangle at which a textured emission is probed.
const PROBES: [[f32; 2]; 7] = [[1. / 3., 1. / 3.], [0.1, 0.1], [0.8, 0.1], [0.1, 0.8], [0.45, 0.45], [0.1, 0.45], [0.45, 0.1]];

impl MeshLight {
    /// `None` for an instance without area or emission.
    pub(crate) fn new(world: &World, instance: u32) -> Option<Self> {
        let placed = &world.instances[instance as usize];
        let info = &world.materials[placed.material as usize];
        let material = &world.scene.materials[placed.material as usize];
        let constant = info.constant.filter(|_| placed.mesh.colors.is_empty()).map(|m| m.emission);
        let emission = |triangle: u32| match constant {
            Some(emission) => emission.luminance(),
            None => {
                let probe = |[u, v]: [f32; 2]| material.emission_at(&world.scene, &placed.uv_at(triangle, u, v)).luminance();
                PROBES.into_iter().map(probe).sum::<f32>() / PROBES.len() as f32
            }
        };
        let count = placed.mesh.indices.len() as u32;
        let areas: Vec<f32> = (0..count).map(|triangle| area_of(placed.world_triangle(triangle))).collect();
        let powers: Vec<f32> = areas.iter().zip(0..).map(|(area, triangle)| area * emission(triangle)).collect();
        let (area, power) = (areas.iter().sum::<f32>(), powers.iter().sum::<f32>());
        if area.is_nan() || area <= 0.0 {
            return None;
        }
        let share = |value: f32, total: f32| if total > 0.0 { value / total } else { 0.0 };
        let by_area = if constant.is_some() { 0.0 } else { BY_AREA };
        let weights: Vec<f32> =
            areas.iter().zip(&powers).map(|(&a, &p)| (1.0 - by_area) * share(p, power) + by_area * share(a, area)).collect();
        let sides = if material.double_sided { 2.0 } else { 1.0 };
        Some(Self {
            instance,
            triangles: AliasTable::new(&weights)?,
            constant,
            double_sided: material.double_sided,
            power: PI * power * sides,
            area,
        })
    }

    /// Emitted flux, W; estimated for textures.
    pub(crate) fn power(&self) -> f32 {
        self.power
    }

    /// A direction towards a point of the mesh, and the triangle it lies on.
    pub(crate) fn sample(&self, world: &World, from: Vec3, choice: f32, u: Vec2) -> Option<(LightSample, PrimitiveRef)> {
        let (triangle, pmf, _) = self.triangles.sample(choice);
        let primitive = triangle as u32;
        let placed = &world.instances[self.instance as usize];
        let corners = placed.world_triangle(primitive);
        let normal = self.facing_normal(world, corners, from)?;
        let seen = SphericalTriangle::new(from, corners);
        let (wi, distance, pdf) = if seen.solid_angle() > BY_SOLID_ANGLE {
            let wi = seen.sample(u);
            let distance = (corners[0] - from).dot(normal) / wi.dot(normal);
            (wi, distance, seen.pdf())
        } else {
            let [a, b, c] = corners;
            let w = triangle_barycentrics(u);
            towards_area(from, a * w.x + b * w.y + c * w.z, normal, area_of(corners))
        };
        let pdf = pmf * pdf;
        if !(pdf > 0.0 && pdf.is_finite() && distance > 0.0) {
            return None;
        }
        let radiance = self.radiance_at(world, primitive, corners, from + wi * distance);
        Some((LightSample { wi, distance, radiance, pdf }, PrimitiveRef { instance: self.instance, primitive }))
    }

    /// Density per solid angle of [`MeshLight::sample`] at a point of `primitive` seen from `from`.
    pub(crate) fn pdf(&self, world: &World, primitive: u32, from: Vec3, direction: Vec3, distance: f32) -> f32 {
        let corners = world.instances[self.instance as usize].world_triangle(primitive);
        let seen = SphericalTriangle::new(from, corners);
        let pdf = if seen.solid_angle() > BY_SOLID_ANGLE {
            seen.pdf()
        } else {
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            super::area::pdf_from_area(distance, normal.dot(direction).abs(), area_of(corners))
        };
        self.triangles.pmf(primitive as usize) * pdf
    }

    /// A point of the mesh and the weight that makes its mean one over the area.
    pub(crate) fn point_of_visibility(&self, world: &World, choice: f32, u: Vec2) -> (Vec3, PrimitiveRef, f32) {
        let (triangle, pmf, _) = self.triangles.sample(choice);
        let [a, b, c] = world.instances[self.instance as usize].world_triangle(triangle as u32);
        let w = triangle_barycentrics(u);
        let weight = area_of([a, b, c]) / (self.area * pmf);
        (a * w.x + b * w.y + c * w.z, PrimitiveRef { instance: self.instance, primitive: triangle as u32 }, weight)
    }

    /// Unit normal of the triangle towards `from`; `None` from the side that does not emit.
    fn facing_normal(&self, world: &World, [a, b, c]: [Vec3; 3], from: Vec3) -> Option<Vec3> {
        let front = world.instances[self.instance as usize].handedness * (b - a).cross(c - a).normalize_or_zero();
        let height = (from - a).dot(front);
        if height > 0.0 { Some(front) } else { (self.double_sided && height < 0.0).then_some(-front) }
    }

    /// Emission at a point of a triangle, weighed with the share of the surface that is there.
    fn radiance_at(&self, world: &World, primitive: u32, [a, b, c]: [Vec3; 3], point: Vec3) -> LinearRgb {
        let placed = &world.instances[self.instance as usize];
        let info = &world.materials[placed.material as usize];
        if let (Some(emission), false) = (self.constant, info.alpha_test) {
            return emission;
        }
        let cross = (b - a).cross(c - a);
        let scale = 1.0 / cross.length_squared();
        let (v, w) = ((point - a).cross(c - a).dot(cross) * scale, (b - a).cross(point - a).dot(cross) * scale);
        let uv = placed.uv_at(primitive, v.clamp(0.0, 1.0), w.clamp(0.0, 1.0 - v.clamp(0.0, 1.0)));
        let material = &world.scene.materials[placed.material as usize];
        material.emission_at(&world.scene, &uv) * material.coverage_at(&world.scene, &uv)
    }
}

fn area_of([a, b, c]: [Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}
