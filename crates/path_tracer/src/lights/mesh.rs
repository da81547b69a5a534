//! Emissive meshes: a point on a chosen triangle, by solid angle.

use super::area::towards_area;
use super::{LightSample, rng_of};
use crate::world::World;
use glam::{Vec2, Vec3};
use kajo_bvh::PrimitiveRef;
use kajo_sampling::AliasTable;
use kajo_sampling::warp::{SphericalTriangle, triangle_barycentrics};
use kajo_scene::EmissiveMesh;
use kajo_units::LinearRgb;

/// One instance whose material emits.
#[derive(Clone, Debug)]
pub(crate) struct MeshLight {
    instance: u32,
    /// Chooses among the triangles by power.
    triangles: AliasTable,
    /// For each triangle the share of its choices that makes the rest go by emission; empty where they do already.
    keep: Vec<f32>,
    /// Emission where it has no texture.
    constant: Option<LinearRgb>,
    double_sided: bool,
    power: f32,
}

/// Solid angle, sr, from which on a triangle is sampled by solid angle; smaller ones are so far that the area does as well for less.
const BY_SOLID_ANGLE: f32 = 1e-4;

/// Height over a triangle, in units of the greatest coordinate around, up to which a point counts as lying in its plane: twice what
/// renderers move the origins of rays by.
const IN_PLANE: f32 = 1.0 / 32768.0;

/// Points tried before no part of a mesh counts as facing a point.
const TRIES: u32 = 32;

impl MeshLight {
    pub(crate) fn new(mesh: &EmissiveMesh) -> Self {
        let keep = |(share, choice): (&f32, &f32)| if *choice > 0.0 { share / choice } else { 0.0 };
        let mut keep: Vec<f32> =
            if mesh.chooses_by_area() { mesh.shares.iter().zip(&mesh.choices).map(keep).collect() } else { Vec::new() };
        let most = keep.iter().copied().fold(0.0, f32::max);
        keep.iter_mut().for_each(|keep| *keep /= most);
        Self {
            instance: mesh.instance as u32,
            triangles: AliasTable::new(&mesh.choices).expect("a mesh with area has triangles"),
            keep,
            constant: mesh.constant,
            double_sided: mesh.double_sided,
            power: mesh.power(),
        }
    }

    /// Emitted flux, W; estimated for textures.
    pub(crate) fn power(&self) -> f32 {
        self.power
    }

    /// The triangles by their power.
    pub(crate) fn triangles(&self) -> &AliasTable {
        &self.triangles
    }

    /// A direction towards a point of a triangle.
    pub(crate) fn sample(&self, world: &World, from: Vec3, primitive: u32, u: Vec2) -> Option<(LightSample, PrimitiveRef)> {
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
        if !(pdf > 0.0 && pdf.is_finite() && distance > 0.0) {
            return None;
        }
        let radiance = self.radiance_at(world, primitive, corners, from + wi * distance);
        Some((LightSample { wi, distance, radiance, pdf }, PrimitiveRef { instance: self.instance, primitive }))
    }

    /// Density per solid angle of [`MeshLight::sample`] at a point of the triangle seen from `from`.
    pub(crate) fn pdf(&self, world: &World, primitive: u32, from: Vec3, direction: Vec3, distance: f32) -> f32 {
        let corners = world.instances[self.instance as usize].world_triangle(primitive);
        let seen = SphericalTriangle::new(from, corners);
        if seen.solid_angle() > BY_SOLID_ANGLE {
            seen.pdf()
        } else {
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            super::area::pdf_from_area(distance, normal.dot(direction).abs(), area_of(corners))
        }
    }

    /// A point of the part that faces `from`, chosen by emission: the measure of `visibility.<light>`. `None` where nothing was found to
    /// face it. `choice` and `u` decide the first try; what they leave is seed of the others.
    pub(crate) fn point_of_visibility(&self, world: &World, from: Vec3, choice: f32, u: Vec2) -> Option<(Vec3, PrimitiveRef)> {
        let (mut random, mut choice, mut u) = (rng_of(choice, u), choice, u);
        for _ in 0..TRIES {
            let (triangle, _, rest) = self.triangles.sample(choice);
            let corners = world.instances[self.instance as usize].world_triangle(triangle as u32);
            if self.keep.get(triangle).is_none_or(|&keep| rest < keep) && self.faces(world, corners, from) {
                let [a, b, c] = corners;
                let w = triangle_barycentrics(u);
                return Some((a * w.x + b * w.y + c * w.z, PrimitiveRef { instance: self.instance, primitive: triangle as u32 }));
            }
            (choice, u) = (random.next_1d(), random.next_2d());
        }
        None
    }

    /// Whether a triangle emits towards a point that does not lie in its plane.
    fn faces(&self, world: &World, corners: [Vec3; 3], from: Vec3) -> bool {
        let height = |normal: Vec3| (from - corners[0]).dot(normal);
        let reach = from.abs().max(corners[0].abs()).max_element();
        self.facing_normal(world, corners, from).is_some_and(|normal| height(normal) > IN_PLANE * reach)
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
