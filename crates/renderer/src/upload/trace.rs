//! What rays are traced through: acceleration structures of the device, or the hierarchy of `kajo_bvh` in buffers.

use crate::Error;
use crate::gpu::GpuBvhInfo;
use crate::upload::geometry::{Geometry, MeshRange};
use glam::{Affine3A, Vec3};
use kajo_bvh::gpu::FlatBvh;
use kajo_bvh::{Blas, BuildOptions, BvhInstance, Tlas};
use kajo_render_graph::wgpu;
use kajo_render_graph::{Bindings, Buffer, Device};
use kajo_scene::{Mesh, Snapshot};
use kajo_techniques::{Coverage, TraceBackend};
use std::sync::Arc;

/// Entries of the shader's stack, both levels together: `STACK` in trace.wesl.
const STACK: u32 = 96;

/// The scene as rays meet it.
#[allow(clippy::large_enum_variant, reason = "a renderer has one")]
pub(crate) enum TraceScene {
    /// Ray queries.
    RayQuery { tlas: wgpu::Tlas },
    /// Buffers.
    Compute { meshes: Vec<(Arc<Mesh>, Arc<Blas>)>, info: Buffer, nodes: Buffer, instances: Buffer, blas_nodes: Buffer, triangles: Buffer },
}

impl TraceScene {
    /// Builds everything over the instances that are `kept`; structures of meshes that `old` has are taken over.
    pub fn new(
        device: &Device,
        backend: TraceBackend,
        snapshot: &Snapshot,
        geometry: &Geometry,
        kept: &[bool],
        old: Option<&Self>,
    ) -> Result<Self, Error> {
        match (backend, old) {
            (TraceBackend::RayQuery, _) => Ok(ray_query(device, snapshot, geometry, kept)),
            (TraceBackend::Compute, Some(Self::Compute { meshes, .. })) => compute(device, snapshot, (geometry, kept), meshes),
            (TraceBackend::Compute, _) => compute(device, snapshot, (geometry, kept), &[]),
        }
    }

    pub fn bind<'a>(&'a self, bindings: Bindings<'a>) -> Bindings<'a> {
        match self {
            Self::RayQuery { tlas } => bindings.with("tlas", tlas),
            Self::Compute { info, nodes, instances, blas_nodes, triangles, .. } => bindings
                .with("bvh_info", info)
                .with("bvh_tlas", nodes)
                .with("bvh_instances", instances)
                .with("bvh_nodes", blas_nodes)
                .with("bvh_triangles", triangles),
        }
    }
}

/// Bits of an instance that rays ask for, as in trace.wesl: seen, and in the way of light. Unlit surfaces block light too, as in the path tracer.
const MASK: u32 = 1 | 2;

/// True where a hit on the instance needs no look at its material.
fn is_opaque(geometry: &Geometry, instance: usize) -> bool {
    geometry.draws[instance].coverage == Coverage::Opaque
}

fn ray_query(device: &Device, snapshot: &Snapshot, geometry: &Geometry, kept: &[bool]) -> TraceScene {
    // A mesh has one material, so opacity is a property of the mesh.
    let mut opaque = vec![true; snapshot.meshes.len()];
    for (index, instance) in snapshot.instances.iter().enumerate() {
        opaque[instance.mesh] = is_opaque(geometry, index);
    }
    let sizes: Vec<wgpu::BlasTriangleGeometrySizeDescriptor> =
        geometry.ranges.iter().zip(&opaque).map(|(range, &opaque)| size_of_mesh(range, opaque)).collect();
    let structures: Vec<Option<wgpu::Blas>> = snapshot
        .meshes
        .iter()
        .zip(&sizes)
        .map(|(mesh, size)| {
            let descriptors = vec![size.clone()];
            let blas = || {
                device.wgpu.create_blas(
                    &wgpu::CreateBlasDescriptor {
                        label: Some(&mesh.name),
                        flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
                        update_mode: wgpu::AccelerationStructureUpdateMode::Build,
                    },
                    wgpu::BlasGeometrySizeDescriptors::Triangles { descriptors },
                )
            };
            (!mesh.indices.is_empty()).then(blas)
        })
        .collect();
    let entries: Vec<wgpu::BlasBuildEntry> = structures
        .iter()
        .enumerate()
        .filter_map(|(index, structure)| {
            let blas = structure.as_ref()?;
            let range = geometry.ranges[index];
            let triangles = wgpu::BlasTriangleGeometry {
                size: &sizes[index],
                vertex_buffer: &geometry.positions.wgpu,
                first_vertex: range.first_vertex,
                vertex_stride: 12,
                index_buffer: Some(&geometry.indices.wgpu),
                first_index: Some(range.first_index),
                transform_buffer: None,
                transform_buffer_offset: None,
            };
            Some(wgpu::BlasBuildEntry { blas, geometry: wgpu::BlasGeometries::TriangleGeometries(vec![triangles]) })
        })
        .collect();
    let mut tlas = device.wgpu.create_tlas(&wgpu::CreateTlasDescriptor {
        label: Some("scene"),
        max_instances: snapshot.instances.len().max(1) as u32,
        flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
        update_mode: wgpu::AccelerationStructureUpdateMode::Build,
    });
    for (index, instance) in snapshot.instances.iter().enumerate() {
        let Some(blas) = &structures[instance.mesh] else { continue };
        let m = instance.world_from_object;
        if m.matrix3.determinant() == 0.0 || !kept[index] {
            continue;
        }
        let row = |r: usize| [m.matrix3.x_axis[r], m.matrix3.y_axis[r], m.matrix3.z_axis[r], m.translation[r]];
        let rows = [row(0), row(1), row(2)];
        tlas[index] = Some(wgpu::TlasInstance::new(blas, bytemuck::cast(rows), index as u32, MASK as u8));
    }
    let mut encoder = device.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("acceleration structures") });
    encoder.build_acceleration_structures(entries.iter(), [&tlas]);
    device.queue.submit([encoder.finish()]);
    TraceScene::RayQuery { tlas }
}

fn size_of_mesh(range: &MeshRange, opaque: bool) -> wgpu::BlasTriangleGeometrySizeDescriptor {
    wgpu::BlasTriangleGeometrySizeDescriptor {
        vertex_format: wgpu::VertexFormat::Float32x3,
        vertex_count: range.vertex_count,
        index_format: Some(wgpu::IndexFormat::Uint32),
        index_count: Some(range.index_count),
        flags: if opaque { wgpu::AccelerationStructureGeometryFlags::OPAQUE } else { wgpu::AccelerationStructureGeometryFlags::empty() },
    }
}

fn compute(
    device: &Device,
    snapshot: &Snapshot,
    (geometry, kept): (&Geometry, &[bool]),
    old: &[(Arc<Mesh>, Arc<Blas>)],
) -> Result<TraceScene, Error> {
    let meshes = snapshot
        .meshes
        .iter()
        .enumerate()
        .map(|(index, mesh)| {
            let known = old.get(index).filter(|(known, _)| Arc::ptr_eq(known, mesh)).map(|(_, blas)| blas.clone());
            let blas = match known {
                Some(blas) => blas,
                None => Arc::new(Blas::build(&mesh.positions, &mesh.indices, &BuildOptions::default())?),
            };
            Ok((mesh.clone(), blas))
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let instances = snapshot
        .instances
        .iter()
        .enumerate()
        .map(|(index, instance)| BvhInstance {
            opaque: is_opaque(geometry, index),
            mask: MASK,
            // Instances keep their numbers; one without extent is left out of the structure.
            ..BvhInstance::new(instance.mesh, if kept[index] { instance.world_from_object } else { Affine3A::from_scale(Vec3::ZERO) })
        })
        .collect();
    let flat = FlatBvh::new(&Tlas::build(meshes.iter().map(|(_, blas)| blas.clone()).collect(), instances)?);
    let depth = flat.tlas_stack + flat.blas_stack;
    if depth > STACK {
        return Err(Error::TooDeep { got: depth, limit: STACK });
    }
    let info =
        GpuBvhInfo { margin: flat.margin, extra: flat.extra, mesh_margin: kajo_bvh::slab::MARGIN, empty: u32::from(flat.is_empty()) };
    let storage = wgpu::BufferUsages::STORAGE;
    Ok(TraceScene::Compute {
        info: device.buffer_with("bvh info", &[info], wgpu::BufferUsages::UNIFORM)?,
        nodes: device.buffer_with("bvh upper nodes", &flat.tlas_nodes, storage)?,
        instances: device.buffer_with("bvh instances", &flat.instances, storage)?,
        blas_nodes: device.buffer_with("bvh nodes", &flat.blas_nodes, storage)?,
        triangles: device.buffer_with("bvh triangles", &flat.triangles, storage)?,
        meshes,
    })
}
