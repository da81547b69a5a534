//! What this tracer can do and how much, in the words of a graphics driver.
//!
//! The fields are those of Vulkan's `VkPhysicalDeviceAccelerationStructure…KHR` and `VkPhysicalDeviceRayTracingPipeline…KHR`, so that a program can ask a processor
//! the questions it asks an adapter. There is no ray tracing pipeline here: rays are traced by function calls (ray queries), shaders and their tables are closures.

use crate::{error::BvhError, wide::Child};

/// What is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features {
    /// Two-level structures can be built and traced.
    pub acceleration_structure: bool,
    /// They can be captured and replayed at the same addresses.
    pub acceleration_structure_capture_replay: bool,
    /// Their sizes may come from a buffer of the device.
    pub acceleration_structure_indirect_build: bool,
    /// They are built by the processor.
    pub acceleration_structure_host_commands: bool,
    /// Descriptors of structures may change after they were bound.
    pub descriptor_binding_acceleration_structure_update_after_bind: bool,
    /// Rays may be traced from any place in a program.
    pub ray_query: bool,
    /// A pipeline of ray generation, hit and miss shaders.
    pub ray_tracing_pipeline: bool,
    /// Its handles can be captured and replayed.
    pub ray_tracing_pipeline_shader_group_handle_capture_replay: bool,
    /// And mixed with fresh ones.
    pub ray_tracing_pipeline_shader_group_handle_capture_replay_mixed: bool,
    /// Its size may come from a buffer of the device.
    pub ray_tracing_pipeline_trace_rays_indirect: bool,
    /// Rays may skip triangles or shapes as a kind.
    pub ray_traversal_primitive_culling: bool,
}

/// How much of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Geometries of a mesh: one list of triangles, one of shapes.
    pub max_geometry_count: usize,
    /// Instances of a world.
    pub max_instance_count: usize,
    /// Triangles and shapes of a mesh.
    pub max_primitive_count: usize,
    /// Structures that one stage can see. There are no descriptors: as many as fit into memory.
    pub max_per_stage_descriptor_acceleration_structures: usize,
    /// The same, changed after binding.
    pub max_per_stage_descriptor_update_after_bind_acceleration_structures: usize,
    /// Structures of a descriptor set.
    pub max_descriptor_set_acceleration_structures: usize,
    /// The same, changed after binding.
    pub max_descriptor_set_update_after_bind_acceleration_structures: usize,
    /// Alignment of scratch memory, bytes; the builder finds its own.
    pub min_acceleration_structure_scratch_offset_alignment: usize,
    /// Bytes of a shader group's handle; 0 without a pipeline, like all below.
    pub shader_group_handle_size: usize,
    /// Rays that a ray may start in turn.
    pub max_ray_recursion_depth: usize,
    /// Bytes from one shader group to the next.
    pub max_shader_group_stride: usize,
    /// Alignment of a table, bytes.
    pub shader_group_base_alignment: usize,
    /// Bytes of a handle that can be replayed.
    pub shader_group_handle_capture_replay_size: usize,
    /// Rays of a command.
    pub max_ray_dispatch_invocation_count: usize,
    /// Alignment of a handle, bytes.
    pub shader_group_handle_alignment: usize,
    /// Bytes that a hit may carry: `u` and `v`.
    pub max_ray_hit_attribute_size: usize,
}

impl Features {
    /// Those of this crate.
    pub const HERE: Self = Self {
        acceleration_structure: true,
        acceleration_structure_capture_replay: false,
        acceleration_structure_indirect_build: false,
        acceleration_structure_host_commands: true,
        descriptor_binding_acceleration_structure_update_after_bind: true,
        ray_query: true,
        ray_tracing_pipeline: false,
        ray_tracing_pipeline_shader_group_handle_capture_replay: false,
        ray_tracing_pipeline_shader_group_handle_capture_replay_mixed: false,
        ray_tracing_pipeline_trace_rays_indirect: false,
        ray_traversal_primitive_culling: false,
    };
}

impl Limits {
    /// Those of this crate.
    pub const HERE: Self = Self {
        max_geometry_count: 2,
        max_instance_count: Child::MAX_INDEX,
        max_primitive_count: Child::MAX_INDEX / 2,
        max_per_stage_descriptor_acceleration_structures: usize::MAX,
        max_per_stage_descriptor_update_after_bind_acceleration_structures: usize::MAX,
        max_descriptor_set_acceleration_structures: usize::MAX,
        max_descriptor_set_update_after_bind_acceleration_structures: usize::MAX,
        min_acceleration_structure_scratch_offset_alignment: 1,
        shader_group_handle_size: 0,
        max_ray_recursion_depth: 0,
        max_shader_group_stride: 0,
        shader_group_base_alignment: 0,
        shader_group_handle_capture_replay_size: 0,
        max_ray_dispatch_invocation_count: 0,
        shader_group_handle_alignment: 0,
        max_ray_hit_attribute_size: 8,
    };

    /// Whether a world may have so many instances.
    ///
    /// # Errors
    /// It may not.
    pub fn check_instances(&self, got: usize) -> Result<(), BvhError> {
        at_most("instances", got, self.max_instance_count)
    }

    /// Whether a mesh may have so many triangles and shapes.
    ///
    /// # Errors
    /// It may not.
    pub fn check_primitives(&self, got: usize) -> Result<(), BvhError> {
        at_most("triangles and shapes", got, self.max_primitive_count)
    }
}

fn at_most(what: &'static str, got: usize, max: usize) -> Result<(), BvhError> {
    if got <= max { Ok(()) } else { Err(BvhError::TooMany { what, got, max }) }
}
