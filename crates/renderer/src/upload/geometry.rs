//! Vertices, indices and instances.
//!
//! All meshes share one buffer of positions, one of other attributes and one of indices. Positions of meshes that deform stand twice: now
//! and one frame ago, so that the rasteriser can say where each point was.

use crate::Error;
use crate::gpu::{GpuAttributes, GpuInstance};
use crate::upload::lights::Lights;
use glam::{Affine3A, Vec2, Vec3, Vec4};
use kajo_render_graph::wgpu::BufferUsages;
use kajo_render_graph::{Buffer, Device};
use kajo_scene::{AlphaMode, Mesh, Scene, Snapshot};
use kajo_techniques::{Coverage, Draw};
use std::sync::Arc;

/// Where a mesh lies in the buffers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MeshRange {
    pub first_vertex: u32,
    pub vertex_count: u32,
    pub previous_first_vertex: u32,
    pub first_index: u32,
    pub index_count: u32,
}

/// The scene's triangles on the device.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub positions: Buffer,
    pub attributes: Buffer,
    pub indices: Buffer,
    pub instances: Buffer,
    /// One for each mesh of the snapshot.
    pub ranges: Vec<MeshRange>,
    /// Meshes as uploaded; an unchanged list is not uploaded again.
    meshes: Vec<Arc<Mesh>>,
    previous_meshes: Vec<Arc<Mesh>>,
    /// One for each instance, in the snapshot's order.
    pub draws: Vec<Draw>,
}

impl Geometry {
    pub fn new(device: &Device, current: &Snapshot, previous: &Snapshot, scene: &Scene) -> Result<Self, Error> {
        let mut positions: Vec<Vec3> = Vec::new();
        let mut attributes: Vec<GpuAttributes> = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        let mut ranges = Vec::with_capacity(current.meshes.len());
        for mesh in &current.meshes {
            let first_vertex = positions.len() as u32;
            ranges.push(MeshRange {
                first_vertex,
                vertex_count: mesh.positions.len() as u32,
                previous_first_vertex: first_vertex,
                first_index: indices.len() as u32,
                index_count: mesh.indices.len() as u32 * 3,
            });
            positions.extend(&mesh.positions);
            attributes.extend((0..mesh.positions.len()).map(|vertex| vertex_attributes(mesh, vertex)));
            indices.extend(mesh.indices.iter().flatten());
        }
        for (range, (now, then)) in ranges.iter_mut().zip(current.meshes.iter().zip(&previous.meshes)) {
            if !Arc::ptr_eq(now, then) && now.positions.len() == then.positions.len() {
                range.previous_first_vertex = positions.len() as u32;
                positions.extend(&then.positions);
            }
        }
        let storage = BufferUsages::STORAGE;
        let flat: &[f32] = bytemuck::cast_slice(&positions);
        let traced = if device.has_ray_query() { BufferUsages::BLAS_INPUT } else { BufferUsages::empty() };
        let instances = current.instances.len().max(1) * size_of::<GpuInstance>();
        Ok(Self {
            positions: device.buffer_with("positions", flat, storage | traced)?,
            attributes: device.buffer_with("attributes", &attributes, storage)?,
            indices: device.buffer_with("indices", &indices, storage | BufferUsages::INDEX | traced)?,
            instances: device.buffer("instances", instances as u64, storage | BufferUsages::COPY_DST)?,
            draws: draws(current, scene, &ranges),
            ranges,
            meshes: current.meshes.clone(),
            previous_meshes: previous.meshes.clone(),
        })
    }

    /// True when the buffers hold the meshes of these snapshots.
    pub fn holds(&self, current: &Snapshot, previous: &Snapshot) -> bool {
        let same = |a: &[Arc<Mesh>], b: &[Arc<Mesh>]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| Arc::ptr_eq(a, b));
        same(&self.meshes, &current.meshes) && same(&self.previous_meshes, &previous.meshes)
    }

    /// Uploads the transforms, relative to the camera of now and of one frame ago.
    pub fn place(&self, device: &Device, scene: &Scene, lights: &Lights, now: (&Snapshot, Vec3), before: (&Snapshot, Vec3)) {
        let ((current, camera), (previous, previous_camera)) = (now, before);
        let place = |(index, instance): (usize, &kajo_scene::Instance)| {
            let range = self.ranges[instance.mesh];
            let mesh = &current.meshes[instance.mesh];
            let before = previous.instances.get(index).filter(|before| before.node == instance.node).unwrap_or(instance);
            let mirrored = instance.world_from_object.matrix3.determinant() < 0.0;
            let tangents = !mesh.tangents.is_empty();
            GpuInstance {
                relative_from_object: columns(&instance.world_from_object, camera),
                previous_relative_from_object: columns(&before.world_from_object, previous_camera),
                first_vertex: range.first_vertex,
                previous_first_vertex: range.previous_first_vertex,
                first_index: range.first_index,
                material: material_of(scene, mesh) as u32,
                flags: if mirrored { GpuInstance::MIRRORED } else { 0 } | if tangents { GpuInstance::HAS_TANGENTS } else { 0 },
                light: lights.place_of(index),
                padding_b: 0,
                padding_c: 0,
            }
        };
        let instances: Vec<GpuInstance> = current.instances.iter().enumerate().map(place).collect();
        self.instances.write(&device.queue, bytemuck::cast_slice(&instances));
    }
}

/// The material of a mesh; the default material, which is uploaded last, where the mesh names none that exists.
pub(crate) fn material_of(scene: &Scene, mesh: &Mesh) -> usize {
    mesh.material.min(scene.materials.len())
}

fn draws(current: &Snapshot, scene: &Scene, ranges: &[MeshRange]) -> Vec<Draw> {
    current
        .instances
        .iter()
        .enumerate()
        .map(|(index, instance)| {
            let range = ranges[instance.mesh];
            let material = scene.materials.get(current.meshes[instance.mesh].material);
            Draw {
                instance: index as u32,
                first_index: range.first_index,
                index_count: range.index_count,
                base_vertex: range.first_vertex as i32,
                coverage: match material.map_or(AlphaMode::Opaque, |material| material.alpha_mode) {
                    AlphaMode::Opaque => Coverage::Opaque,
                    AlphaMode::Mask(_) => Coverage::Mask,
                    AlphaMode::Blend => Coverage::Blend,
                },
            }
        })
        .collect()
}

fn vertex_attributes(mesh: &Mesh, vertex: usize) -> GpuAttributes {
    let uv = |set: usize| mesh.uvs[set].get(vertex).copied().unwrap_or(Vec2::ZERO);
    GpuAttributes {
        normal: mesh.normals.get(vertex).copied().unwrap_or(Vec3::Z).to_array(),
        u0: uv(0).x,
        tangent: mesh.tangents.get(vertex).copied().unwrap_or(Vec4::ZERO).to_array(),
        v0: uv(0).y,
        u1: uv(1).x,
        v1: uv(1).y,
        padding: 0.0,
        color: mesh.colors.get(vertex).copied().unwrap_or(Vec4::ONE).to_array(),
    }
}

/// The columns of a transform whose target has its origin at `origin`; the subtraction is done in double precision.
fn columns(world_from_object: &Affine3A, origin: Vec3) -> [[f32; 4]; 4] {
    let m = world_from_object.matrix3;
    let translation = (world_from_object.translation.as_dvec3() - origin.as_dvec3()).as_vec3();
    let column = |v: Vec3| [v.x, v.y, v.z, 0.0];
    [column(m.x_axis.into()), column(m.y_axis.into()), column(m.z_axis.into()), column(translation)]
}
