//! The scene as rays see it: the two-level hierarchy, placed meshes, and materials ready for lookup.

use crate::PathTracerError;
use crate::geometry::Geometry;
use crate::points::PointFrame;
use glam::{Affine3A, Mat3A, Vec3};
use kajo_bsdf::{AnyBsdf, Bsdf};
use kajo_bvh::{Hit, PrimitiveRef, Ray};
use kajo_sampling::{hash_u64, unit_f32};
use kajo_scene::{Material, Mesh, Scene, Snapshot, SurfaceMaterial, SurfaceUv};
use rayon::prelude::*;
use std::sync::Arc;

/// Geometry and materials of one snapshot.
pub(crate) struct World {
    pub scene: Scene,
    pub snapshot: Snapshot,
    pub geometry: Geometry,
    /// What rays meet that start on surfaces, where that is less.
    pub secondary: Option<Geometry>,
    pub instances: Vec<Placed>,
    pub materials: Vec<MaterialInfo>,
    /// Radius of a sphere around everything, m.
    pub radius: f32,
    /// True when no ray can pass a surface.
    all_opaque: bool,
}

/// An instance as shading needs it.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub mesh: Arc<Mesh>,
    pub material: u32,
    pub world_from_object: Affine3A,
    pub points: PointFrame,
    /// Inverse transpose of the linear part.
    pub normal_from_object: Mat3A,
    /// −1 for a mirroring transform, else 1.
    pub handedness: f32,
    /// The vertex normals say nothing that the triangles do not.
    pub flat: bool,
}

/// Rays that leave no surface, traced together, each with the number that decides what is there for it.
#[derive(Default)]
pub(crate) struct Rays {
    rays: Vec<Ray>,
    chances: Vec<u64>,
}

impl Rays {
    pub(crate) fn clear(&mut self) {
        self.rays.clear();
        self.chances.clear();
    }

    #[inline]
    pub(crate) fn push(&mut self, ray: Ray, chance: u64) {
        self.rays.push(ray);
        self.chances.push(chance);
    }

    /// Ray number `number`.
    #[inline]
    pub(crate) fn ray(&self, number: usize) -> Ray {
        self.rays[number]
    }
}

/// What is known of a material before any hit.
#[derive(Clone)]
pub(crate) struct MaterialInfo {
    /// The material everywhere, when it has no textures.
    pub constant: Option<SurfaceMaterial>,
    /// Its BSDF, when that depends neither on textures nor on tangents.
    pub bsdf: Option<AnyBsdf>,
    pub alpha_test: bool,
    /// A tangent frame is worth computing.
    pub needs_tangent: bool,
}

impl MaterialInfo {
    fn new(scene: &Scene, material: &Material) -> Self {
        let constant = textures(material).iter().all(|t| t.is_none()).then(|| material.at(scene, &SurfaceUv::default()));
        let needs_tangent = material.normal_texture.is_some()
            || material.clearcoat_normal_texture.is_some()
            || material.anisotropy > 0.0
            || material.model.is_some();
        Self {
            bsdf: match &material.model {
                Some(model) => Some(AnyBsdf::Model(model.reflectance.clone())),
                None => constant.as_ref().filter(|_| !needs_tangent).map(|constant| AnyBsdf::Layered(Bsdf::new(&constant.params))),
            },
            constant,
            needs_tangent,
            alpha_test: material.needs_alpha_test(),
        }
    }
}

/// Every texture that changes what [`Material::at`] answers.
fn textures(m: &Material) -> [&Option<kajo_scene::TextureRef>; 17] {
    [
        &m.base_color_texture,
        &m.metallic_roughness_texture,
        &m.normal_texture,
        &m.occlusion_texture,
        &m.emission_texture,
        &m.specular_texture,
        &m.specular_color_texture,
        &m.clearcoat_texture,
        &m.clearcoat_roughness_texture,
        &m.clearcoat_normal_texture,
        &m.sheen_color_texture,
        &m.sheen_roughness_texture,
        &m.anisotropy_texture,
        &m.transmission_texture,
        &m.thickness_texture,
        &m.iridescence_texture,
        &m.iridescence_thickness_texture,
    ]
}

impl World {
    pub(crate) fn new(scene: &Scene, snapshot: Snapshot) -> Result<Self, PathTracerError> {
        let materials: Vec<_> = scene.materials.iter().map(|material| MaterialInfo::new(scene, material)).collect();
        let flat: Vec<bool> = snapshot.meshes.par_iter().map(|mesh| is_flat(mesh)).collect();
        let instances: Vec<_> = snapshot
            .instances
            .iter()
            .map(|instance| {
                let mesh = snapshot.meshes[instance.mesh].clone();
                let linear = instance.world_from_object.matrix3;
                let determinant = linear.determinant();
                // The cofactor matrix is the inverse transpose times the determinant: no division, and defined for flat transforms.
                let cofactor = Mat3A::from_cols(
                    linear.y_axis.cross(linear.z_axis),
                    linear.z_axis.cross(linear.x_axis),
                    linear.x_axis.cross(linear.y_axis),
                );
                let handedness = 1.0f32.copysign(determinant);
                Placed {
                    flat: flat[instance.mesh],
                    material: mesh.material as u32,
                    mesh,
                    points: PointFrame::new(&instance.world_from_object),
                    world_from_object: instance.world_from_object,
                    normal_from_object: cofactor * handedness,
                    handedness,
                }
            })
            .collect();
        let opaque: Vec<bool> = instances.iter().map(|placed| !materials[placed.material as usize].alpha_test).collect();
        let geometry = Geometry::new(&snapshot, &opaque)?;
        let bounds = geometry.bounds();
        let radius = if bounds.is_empty() { 1.0 } else { 0.5 * (bounds.max - bounds.min).length() };
        let all_opaque = opaque.iter().all(|&opaque| opaque);
        Ok(Self { scene: scene.clone(), snapshot, geometry, secondary: None, instances, materials, radius, all_opaque })
    }

    /// Leaves instances that are not `kept` out of what rays meet that start on surfaces.
    ///
    /// # Errors
    /// [`PathTracerError::Bvh`].
    pub(crate) fn keep_for_secondary_rays(&mut self, kept: &[bool]) -> Result<(), PathTracerError> {
        let opaque: Vec<bool> = self.instances.iter().map(|placed| !self.materials[placed.material as usize].alpha_test).collect();
        let all = kept.iter().all(|kept| *kept);
        self.secondary = if all { None } else { Some(Geometry::of_kept(&self.snapshot, &opaque, kept)?) };
        Ok(())
    }

    /// What a ray meets that starts on a surface.
    #[inline]
    fn met_from_surfaces(&self) -> &Geometry {
        self.secondary.as_ref().unwrap_or(&self.geometry)
    }

    /// The nearest surface that is there, by masks and, for blended surfaces, by chance. A ray that leaves no surface is the camera's.
    #[inline]
    pub(crate) fn closest(&self, ray: &Ray, leaving: Option<PrimitiveRef>, chance: u64) -> Option<Hit> {
        let geometry = if leaving.is_some() { self.met_from_surfaces() } else { &self.geometry };
        if self.all_opaque {
            geometry.closest_opaque(ray, leaving)
        } else {
            geometry.closest(ray, leaving, |hit| self.is_there(hit, chance))
        }
    }

    /// Whether something lies on the segment, masks and blended surfaces counting as in [`World::closest`].
    #[inline]
    pub(crate) fn occluded(&self, ray: &Ray, leaving: Option<PrimitiveRef>, chance: u64) -> bool {
        let geometry = self.met_from_surfaces();
        if self.all_opaque { geometry.any_opaque(ray, leaving) } else { geometry.any(ray, leaving, |hit| self.is_there(hit, chance)) }
    }

    /// [`World::closest`] of each ray; neighbours that run alike share a walk.
    pub(crate) fn closest_of(&self, rays: &Rays, hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.resize(rays.rays.len(), None);
        self.geometry.closest_of(&rays.rays, |ray, hit| self.is_there(hit, rays.chances[ray]), hits);
    }

    /// Whether the surface is there for this ray: the coverage against a number made of the ray's `chance` and the triangle, so that the answer
    /// does not depend on the order of traversal.
    fn is_there(&self, hit: &Hit, chance: u64) -> bool {
        let placed = &self.instances[hit.instance as usize];
        let material = &self.scene.materials[placed.material as usize];
        let coverage = material.coverage_at(&self.scene, &placed.uv_at(hit.primitive, hit.u, hit.v));
        coverage >= 1.0 || {
            let triangle = u64::from(hit.instance) << 32 | u64::from(hit.primitive);
            unit_f32((hash_u64(chance ^ hash_u64(triangle)) >> 32) as u32) < coverage
        }
    }
}

/// Whether every triangle's vertex normals are its own normal.
fn is_flat(mesh: &Mesh) -> bool {
    /// Squared length of a difference of unit vectors that is rounding.
    const ROUNDING: f32 = 1e-11;
    mesh.normals.is_empty()
        || mesh.indices.iter().all(|triangle| {
            let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            normal == Vec3::ZERO || triangle.iter().all(|&i| mesh.normals[i as usize].distance_squared(normal) < ROUNDING)
        })
}

/// Interpolates three vertex values, `weights` summing to 1.
pub(crate) fn interpolate<T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>>(
    values: &[T],
    indices: [u32; 3],
    [a, b, c]: [f32; 3],
) -> T {
    let [i, j, k] = indices.map(|i| values[i as usize]);
    i * a + j * b + k * c
}

impl Placed {
    /// Texture coordinates and colour at a point of a triangle.
    pub(crate) fn uv_at(&self, primitive: u32, u: f32, v: f32) -> SurfaceUv {
        self.mesh.uv_at(primitive, u, v)
    }

    /// Object-space corners of a triangle.
    #[inline]
    pub(crate) fn triangle(&self, primitive: u32) -> [Vec3; 3] {
        let [a, b, c] = self.mesh.indices[primitive as usize];
        let corner = |i: u32| self.mesh.positions[i as usize];
        [corner(a), corner(b), corner(c)]
    }

    /// World-space corners of a triangle.
    pub(crate) fn world_triangle(&self, primitive: u32) -> [Vec3; 3] {
        self.triangle(primitive).map(|p| self.world_from_object.transform_point3(p))
    }
}
